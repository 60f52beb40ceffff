// The files that pages can choose: loaded when a state names them, and again when they change.
#pragma once
#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/view/view_model.h"

namespace umbrage::view {

/// A file to show: a model, "scene:NAME" or a G-buffer.
struct ModelSource {
  std::string file, name;  ///< `name`: as pages show it
  bool is_gbuffer = false;
};

/// Thread-safe except for `loaded`, which only the drawing thread calls; a model it returned stays valid until the next
/// call.
class ModelList {
 public:
  /// Adds a file and returns its id.
  int add(ModelSource source);
  /// Returns the list as pages get it.
  nlohmann::json as_json() const;
  bool has(int id) const;
  ModelSource source(int id) const;

  struct Loaded {
    ViewModel* model = nullptr;
    long version = 0;  ///< from 1; grows when the file or what pages know of it has changed
  };
  /// Returns a model, loaded for this request. If the file of a loaded model has changed and cannot be read, calls
  /// `keep` with the error and returns the old one. If it must be loaded, `aside` runs the reading; meanwhile the
  /// drawing thread may call this function for other models. Errors: those of ViewModel::load.
  Result<Loaded> loaded(int id, const Request& request, const std::function<void(const Error&)>& keep,
                        const ProgressMonitor& monitor, const std::function<void(const std::function<void()>&)>& aside);

  /// Forgets the captures of all models, before a device is destroyed. For the drawing thread.
  void forget_captures();

  /// Looks for changes of the files of loaded models. A change counts when the file has stayed the same since the last
  /// call, so that it is not read half-written. Returns the ids of models that must be loaded again.
  std::vector<int> find_changed();

 private:
  struct Stamp {
    std::filesystem::file_time_type time = {};
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stamp_of(const std::string& file);

  struct Entry {
    ModelSource source;
    std::unique_ptr<ViewModel> model;  // only the drawing thread uses it
    bool is_loaded = false, has_changed = false;
    Stamp stamp, seen;  // of the file when it was read, and at the last call of find_changed
    long version = 0;
    std::string summary;  // of the last load, and the up direction
    glm::vec3 up{0.0f};
  };
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::list<int> recent_;  // ids of loaded models, the last used first; only for the drawing thread
};

}  // namespace umbrage::view
