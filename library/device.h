// DeviceObject: a device of the C interface, with its callbacks for errors and warnings.
#pragma once
#include <tbb/task_arena.h>

#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/device.h"
#include "library/object.h"
#include "scene/scene.h"

namespace umbrage {

class DeviceObject final : public Object {
 public:
  /// Errors: those of make_device.
  static Result<std::shared_ptr<Object>> make(const char* name, int threads);

  void report_error(const Error& error);
  void report_warning(const std::string& message);
  void set_error_callback(UmbErrorCallback callback, void* user);
  void set_log_callback(UmbLogCallback callback, void* user);

  std::unique_ptr<Device> device;
  std::string description;
  /// Exclusive use of a device for one picture: jobs of one device execute one after the other. Errors: kUsage from
  /// within a callback of a job of any device, since two jobs could wait for each other.
  class Turn {
   public:
    explicit Turn(DeviceObject& device);
    ~Turn();
    Result<void> begun() const;

   private:
    DeviceObject& device_;
    bool nested_ = false;
  };
  /// Device memory of a job that is to be freed.
  struct Left {
    std::unique_ptr<Scene> scene;
    std::vector<Frame> frames;
  };
  /// Frees the memory now, or at the end of the current picture.
  void leave(std::list<Left> left) noexcept;
  /// Keeps the memory of planes for pictures of one size. The caller holds a Turn.
  void keep_memory_for(int width, int height);

  const Scene* prepared = nullptr;  ///< scene that the device is prepared for; guarded by Turn
  /// Has as many threads as the device, for work on images. It is kept since each creation allocates memory.
  tbb::task_arena arena{1};
  std::optional<PlanePoolLock> held_pool;

 protected:
  DeviceObject* reporting_device() override { return this; }

 private:
  void free_deferred();

  std::mutex in_use_;
  std::mutex deferred_mutex_;
  std::list<Left> deferred_;
  int kept_width_ = 0, kept_height_ = 0;
  std::mutex callbacks_;
  UmbErrorCallback on_error_ = nullptr;
  UmbLogCallback on_log_ = nullptr;
  void *error_user_ = nullptr, *log_user_ = nullptr;
};

}  // namespace umbrage
