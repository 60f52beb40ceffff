#include "library/device.h"

#include "core/printable.h"
#include "devices/vulkan/vulkan_device.h"
#include "renderer/devices.h"
#include "renderer/options.h"

namespace umbrage {
namespace {

thread_local bool has_exclusive_use = false;  // this thread has an ExclusiveUse of a device
thread_local bool in_error_callback = false;  // this thread runs an error callback

}  // namespace

Result<std::shared_ptr<Object>> DeviceObject::make(const char* name, int threads) {
  Request request;
  request.device = name ? name : "auto";
  request.threads = threads;
  if (auto status = check_request(request, kMaxPixels); !status) return status.error();
  auto made = make_device(request.device, threads);
  if (!made) return made.error();
  auto object = std::make_shared<DeviceObject>();
  object->device = std::move(*made);
  object->description = object->device->description();
  object->arena.initialize(object->device->threads());
  object->pool_lock.emplace(object->device->pool());
  return std::shared_ptr<Object>(std::move(object));
}

DeviceObject::ExclusiveUse::ExclusiveUse(DeviceObject& device) : device_(device) {
  nested_ = has_exclusive_use;
  if (nested_) return;
  device.in_use_.lock();
  has_exclusive_use = true;
  device.release_deferred();
}

DeviceObject::ExclusiveUse::~ExclusiveUse() {
  if (nested_) return;
  device_.release_deferred();
  has_exclusive_use = false;
  device_.in_use_.unlock();
}

Result<void> DeviceObject::ExclusiveUse::check_begun() const {
  return nested_ ? usage_error("a callback cannot execute a job while another one executes") : Result<void>();
}

void DeviceObject::release_later(std::list<DeferredRelease> deferred) noexcept {
  {
    const std::lock_guard lock(deferred_mutex_);
    deferred_.splice(deferred_.end(), deferred);
  }
  if (has_exclusive_use || !in_use_.try_lock()) return;  // the ExclusiveUse frees the memory when it ends
  release_deferred();
  in_use_.unlock();
}

void DeviceObject::release_deferred() {
  decltype(deferred_) deferred;
  {
    const std::lock_guard lock(deferred_mutex_);
    deferred.swap(deferred_);
  }
  for (const auto& [scene, frames] : deferred)
    if (scene && scene.get() == prepared) {
      prepared = nullptr;
      device->release_scene();
    }
}

void DeviceObject::keep_memory_for(int width, int height) {
  if (width == pool_width_ && height == pool_height_) return;
  pool_lock.reset();
  pool_lock.emplace(device->pool());
  pool_width_ = width;
  pool_height_ = height;
}

void DeviceObject::report_error(const Error& error) {
  UmbErrorCallback callback = nullptr;
  void* user = nullptr;
  {
    const std::lock_guard lock(callbacks_);
    callback = on_error_;
    user = error_user_;
  }
  if (!callback || in_error_callback) return;
  in_error_callback = true;
  struct Done {
    ~Done() { in_error_callback = false; }  // runs also if a C++ callback throws
  } done;
  callback(user, UmbError(error.kind), printable(error.message).c_str());
}

void DeviceObject::report_warning(const std::string& message) {
  UmbLogCallback callback = nullptr;
  void* user = nullptr;
  {
    const std::lock_guard lock(callbacks_);
    callback = on_log_;
    user = log_user_;
  }
  if (callback) callback(user, printable(message).c_str());
}

void DeviceObject::set_error_callback(UmbErrorCallback callback, void* user) {
  const std::lock_guard lock(callbacks_);
  on_error_ = callback;
  error_user_ = user;
}

void DeviceObject::set_log_callback(UmbLogCallback callback, void* user) {
  const std::lock_guard lock(callbacks_);
  on_log_ = callback;
  log_user_ = user;
}

}  // namespace umbrage

using namespace umbrage;  // for the C functions below

int umbGetVersion(void) { return UMB_VERSION; }

UmbDevice umbNewDevice(const char* name, int threads) {
  return make_object<UmbDevice>("umbNewDevice", [&] { return DeviceObject::make(name, threads); });
}

void umbRetainDevice(UmbDevice device) { retain_object<DeviceObject>(device); }
void umbReleaseDevice(UmbDevice device) { release_object<DeviceObject>(device); }

const char* umbGetDeviceDescription(UmbDevice device) {
  const auto object = object_of<DeviceObject>(device);
  return object ? object->description.c_str() : nullptr;
}

uint64_t umbGetDeviceMemory(UmbDevice device) {
  const auto object = object_of<DeviceObject>(device);
  return object ? vulkan_memory(*object->device).device_bytes : 0;
}

UmbError umbSetDeviceErrorCallback(UmbDevice device, UmbErrorCallback callback, void* user) {
  return call_on<DeviceObject>(device, "umbSetDeviceErrorCallback", Use::kFree, [&](DeviceObject& object) {
    object.set_error_callback(callback, user);
    return Result<void>();
  });
}

UmbError umbSetDeviceLogCallback(UmbDevice device, UmbLogCallback callback, void* user) {
  return call_on<DeviceObject>(device, "umbSetDeviceLogCallback", Use::kFree, [&](DeviceObject& object) {
    object.set_log_callback(callback, user);
    return Result<void>();
  });
}

UmbError umbGetDeviceError(UmbDevice device, const char** message) { return take_error<DeviceObject>(device, message); }
