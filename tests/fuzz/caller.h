// The class that makes calls of the C interface, with its objects and the checks of results. See calls.h.
#pragma once
#include <chrono>
#include <cstdlib>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "call_memory.h"
#include "call_words.h"
#include "calls.h"

namespace umbrage::fuzz {

using Clock = std::chrono::steady_clock;

constexpr int kMaxDepth = 2;                            // max nesting of calls within callbacks
constexpr std::chrono::milliseconds kCancelAfter(700);  // after this time a progress callback cancels
constexpr std::chrono::seconds kMaxCallTime(20);        // max time of a call, even with sanitizers

enum class Kind { kNone, kDevice, kScene, kJob };

/// A handle, and the number of references that these calls hold.
template <class Handle>
struct Ref {
  Handle handle = nullptr;
  int references = 0;
};

struct SceneState {
  Ref<UmbScene> ref;
  std::vector<std::pair<std::size_t, std::size_t>> meshes;  ///< vertices and triangles
};

struct JobState {
  Ref<UmbJob> ref;
  bool renders = false;
  int width = 24, height = 24;  // size of the G-buffer or picture, pixels
  NamedPixels inputs, outputs;
  long executions = 0;
};

/// Objects that several threads call.
struct Shared {
  UmbDevice device = nullptr;
  UmbScene scene = nullptr;
  std::vector<UmbJob> jobs;
};

class Caller;
/// The caller of this thread: callbacks of shared objects run in the calling thread.
inline thread_local Caller* current = nullptr;

class Caller {
 public:
  explicit Caller(std::string_view bytes, const Shared* shared = nullptr) : choose_(bytes), shared_(shared) {
    current = this;
  }
  ~Caller() {
    for (JobState& job : jobs_)
      for (; job.ref.references > 0; --job.ref.references) umbReleaseJob(job.ref.handle);
    for (SceneState& scene : scenes_)
      for (; scene.ref.references > 0; --scene.ref.references) umbReleaseScene(scene.ref.handle);
    for (auto& device : devices_)
      for (; device.references > 0; --device.references) umbReleaseDevice(device.handle);
    current = nullptr;
  }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  void run() {
    new_device("cpu", 2);
    new_scene(0);
    new_job(true);
    new_job(false);
    while (!choose_.used_up()) {
      called_back_ = false;
      call();
      retired_images_.clear();
    }
  }

  CallCounts counts;

  // Callbacks.
  void receive_error(UmbError code, const char* message);
  void receive_warning(const char* message);
  bool receive_progress(double fraction);

 private:
  void call();
  void call_shared();
  void call_nested();

  void new_device(const char* name, int threads);
  void new_scene(std::size_t device);
  void new_job(bool renders);
  void retain_or_release();
  void set_callbacks();
  void query_objects();

  void change_scene();
  void load_model(UmbScene scene);
  void add_mesh(SceneState& state, UmbScene scene);
  void set_mesh_floats(UmbScene scene);
  void set_mesh_buffer();
  void set_mesh_texture();

  void set_parameter();
  void set_image();
  void set_output();
  void execute(JobState& job);
  /// Aborts unless a successful execution has written all pixels of these outputs and nothing beside them.
  void check_written(UmbJob handle, NamedPixels& outputs);
  /// Reads all outputs that the library returns.
  void read_outputs(UmbJob handle);
  void query_job();
  void write_files();
  void query_lists();

  template <class State>
  static int references_of(const State& state) {
    if constexpr (requires { state.ref; })
      return state.ref.references;
    else
      return state.references;
  }
  /// Removes the settings that prevent the execution of a job.
  void make_executable(JobState& job);
  bool is_shared(const void* handle) const;
  /// Counts the code of a call, and checks its error message. Returns `code`.
  UmbError done(UmbError code, Kind kind, const void* handle, const char* call);
  void trace(const char* call, const std::string& with = "") {
    ++counts.calls;
    if (traces_) std::fprintf(stderr, "%*s%s %s\n", 2 * depth_, "", call, with.c_str());
  }

  /// Returns any handle: live, released, null, or of another kind.
  UmbDevice any_device() { return handle_of(pick(devices_)); }
  UmbScene any_scene() { return handle_of(pick(scenes_).ref); }
  UmbJob any_job() { return handle_of(pick(jobs_).ref); }
  template <class State>
  State& pick(std::deque<State>& all) {
    State* state = &all[choose_.below(unsigned(all.size()))];
    // Pick a released object only rarely.
    for (int k = 0; k < 4 && references_of(*state) == 0; ++k) state = &all[choose_.below(unsigned(all.size()))];
    return *state;
  }
  /// Returns the handle, or rarely a null handle, a handle of another kind, or a pointer that is not a handle.
  template <class Handle>
  Handle handle_of(const Ref<Handle>& ref) {
    if (!choose_.one_in(24)) return ref.handle;
    const std::vector<void*> wrong = {nullptr,
                                      devices_[0].handle == static_cast<void*>(ref.handle)
                                          ? static_cast<void*>(this)
                                          : static_cast<void*>(devices_[0].handle),
                                      this};
    return static_cast<Handle>(choose_.one_of(wrong));
  }
  int any_mesh() { return choose_.one_in(12) ? int(choose_.below(2)) * 1000 - 1 : int(choose_.below(4)); }
  int any_int();
  void begin_progress() {
    progress_ = 0.0;
    cancelled_ = false;
    start_ = Clock::now();
  }

  Choices choose_;
  const Shared* shared_;
  const bool traces_ = std::getenv("UMBRAGE_TRACE_CALLS") != nullptr;
  std::deque<Ref<UmbDevice>> devices_;
  std::deque<SceneState> scenes_;
  std::deque<JobState> jobs_;
  std::vector<NamedPixels> retired_images_;  // images of released jobs, which may still be in use
  int depth_ = 0;
  bool called_back_ = false;  // a callback has made calls within the current call
  double progress_ = 0.0;
  bool cancelled_ = false;  // a progress callback has returned false
  Clock::time_point start_;
};

bool on_progress(void*, double fraction);
void on_error(void*, UmbError code, const char* message);
void on_warning(void*, const char* message);

}  // namespace umbrage::fuzz
