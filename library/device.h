// DeviceObject: a device of the C interface, and who hears of errors and warnings.
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

  void tell_error(const Error& error);
  void tell_warning(const std::string& message);
  void set_error_callback(UmbErrorCallback callback, void* user);
  void set_log_callback(UmbLogCallback callback, void* user);

  std::unique_ptr<Device> device;
  std::string description;
  /// A picture's turn: jobs of one device execute one after the other. Errors: kUsage from within a callback of a job
  /// of any device, since two of them could wait for each other.
  class Turn {
   public:
    explicit Turn(DeviceObject& device);
    ~Turn();
    Result<void> begun() const;

   private:
    DeviceObject& device_;
    bool nested_ = false;
  };
  /// What a job has of the device's memory.
  struct Left {
    std::unique_ptr<Scene> scene;
    std::vector<Frame> frames;
  };
  /// Frees it now, or at the end of the picture that is being made.
  void leave(std::list<Left> left) noexcept;
  /// Memory of planes stays from picture to picture of one size; under Turn.
  void keep_memory_for(int width, int height);

  const Scene* prepared = nullptr;  ///< with which scene; under Turn
  tbb::task_arena arena{1};         ///< of as many threads, for work on images; making one costs memory each time
  std::optional<HeldPool> held_pool;

 protected:
  DeviceObject* teller() override { return this; }

 private:
  void drop_left();

  std::mutex in_use_;
  std::mutex left_mutex_;
  std::list<Left> left_;
  int kept_width_ = 0, kept_height_ = 0;
  std::mutex callbacks_;
  UmbErrorCallback on_error_ = nullptr;
  UmbLogCallback on_log_ = nullptr;
  void *error_user_ = nullptr, *log_user_ = nullptr;
};

}  // namespace umbrage
