#include "library/object.h"

#include <unordered_map>

#include "library/device.h"

namespace umbrage {
namespace {

struct Table {
  std::mutex mutex;
  std::unordered_map<const void*, std::shared_ptr<Object>> objects;
};

/// It is never ended: handles may be released while the process ends.
Table& table() {
  static Table& all = *new Table;
  return all;
}

}  // namespace

UmbError ErrorSlot::note(Error error) {
  const std::lock_guard lock(mutex_);
  const auto code = UmbError(error.kind);
  if (!there_ || !keeps_first_) error_ = std::move(error);
  there_ = true;
  return code;
}

UmbError ErrorSlot::take(const char** message) {
  const std::lock_guard lock(mutex_);
  const UmbError code = there_ ? UmbError(error_.kind) : UMB_ERROR_NONE;
  taken_ = there_ ? std::move(error_.message) : std::string();
  there_ = false;
  if (message) *message = taken_.c_str();
  return code;
}

ErrorSlot& thread_errors() {
  static thread_local ErrorSlot errors(false);
  return errors;
}

bool Workers::begin(Use use) {
  if (use == Use::kFree) return true;
  int seen = count_;
  while (use == Use::kChanges ? seen == 0 : seen != kAlone)
    if (count_.compare_exchange_weak(seen, use == Use::kChanges ? kAlone : seen + 1)) return true;
  return false;
}

void Workers::end(Use use) {
  if (use == Use::kChanges) count_ = 0;
  if (use == Use::kReads) --count_;
}

UmbError Object::fail(Error error) {
  const UmbError code = errors.note(error);
  if (DeviceObject* device = teller()) {
    if (device != this) device->errors.note(error);
    try {
      device->tell_error(error);
    } catch (...) {  // a callback's: it must not go on to C
    }
  }
  return code;
}

void* add_object(std::shared_ptr<Object> object) {
  static std::atomic<std::uintptr_t> last = 0;
  constexpr std::uintptr_t kStep = 16;  // no address is handed out twice, nor one that looks like memory
  void* handle = reinterpret_cast<void*>(last += kStep);
  const std::lock_guard lock(table().mutex);
  table().objects.emplace(handle, std::move(object));
  return handle;
}

std::shared_ptr<Object> find_object(const void* handle) {
  const std::lock_guard lock(table().mutex);
  const auto found = table().objects.find(handle);
  return found != table().objects.end() ? found->second : nullptr;
}

void release_found(const void* handle) {
  std::shared_ptr<Object> last;  // ends outside the lock
  {
    const std::lock_guard lock(table().mutex);
    const auto found = table().objects.find(handle);
    if (found == table().objects.end() || --found->second->references > 0) return;
    last = std::move(found->second);
    table().objects.erase(found);
  }
}

}  // namespace umbrage
