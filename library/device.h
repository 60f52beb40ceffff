// DeviceObject: a device of the C interface, with its callbacks for errors and warnings.
#pragma once
#include <tbb/task_arena.h>

#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/device.h"
#include "library/object.h"
#include "scene/scene.h"

namespace umbrage {

class DeviceObject final : public Object {
 public:
  /// Creates a device. Errors: those of make_device.
  static Result<std::shared_ptr<Object>> make(const char* name, int threads);

  void report_warning(const std::string& message);
  void set_error_callback(UmbErrorCallback callback, void* user);
  void set_log_callback(UmbLogCallback callback, void* user);

  std::unique_ptr<Device> device;
  std::string description;
  /// Exclusive use of a device for one picture: jobs of one device execute one after the other.
  class ExclusiveUse {
   public:
    explicit ExclusiveUse(DeviceObject& device);
    ~ExclusiveUse();
    /// Errors: kUsage within a callback of a job of any device, since two jobs could wait for each other.
    Result<void> check_begun() const;

   private:
    DeviceObject& device_;
    bool nested_ = false;  ///< this thread already has an ExclusiveUse
  };
  /// Data of a job that occupy device memory, to be freed.
  struct DeferredRelease {
    std::unique_ptr<Scene> scene;
    Frame frame;
  };
  /// Frees the memory now, or when the current ExclusiveUse ends.
  void release_later(std::list<DeferredRelease> deferred) noexcept;
  /// Keeps the memory of released planes for pictures of this size, and frees that of another size. The caller must
  /// have an ExclusiveUse.
  void keep_memory_for(int width, int height);

  const Scene* prepared = nullptr;  ///< scene for which the device is prepared; guarded by ExclusiveUse
  /// Runs work on images, with as many threads as the device. It is kept because creating one allocates memory.
  tbb::task_arena arena{1};
  std::optional<PlanePoolLock> pool_lock;

 protected:
  Object* reporting_device() override { return this; }
  void report_error(const Error& error) override;

 private:
  void release_deferred();

  std::mutex in_use_;
  std::mutex deferred_mutex_;
  std::list<DeferredRelease> deferred_;
  int pool_width_ = 0, pool_height_ = 0;
  std::mutex callbacks_;
  UmbErrorCallback on_error_ = nullptr;
  UmbLogCallback on_log_ = nullptr;
  void *error_user_ = nullptr, *log_user_ = nullptr;
};

}  // namespace umbrage
