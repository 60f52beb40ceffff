#include "library/object.h"

#include <new>
#include <unordered_map>

#include "core/printable.h"

namespace umbrage {
namespace {

struct Table {
  std::mutex mutex;
  std::unordered_map<const void*, std::shared_ptr<Object>> objects;
};

/// Returns the table of objects. It is never destroyed: handles may be released during process exit.
Table& table() {
  static Table& all = *new Table;
  return all;
}

}  // namespace

UmbError ErrorSlot::store(Error error) {
  try {
    error.message = printable(error.message);
  } catch (const std::bad_alloc&) {
    error.message = "no memory";  // short enough to need none
  }
  const std::lock_guard lock(mutex_);
  const auto code = UmbError(error.kind);
  if (!has_error_ || !keeps_first_) error_ = std::move(error);
  has_error_ = true;
  return code;
}

UmbError ErrorSlot::take(const char** message) {
  const std::lock_guard lock(mutex_);
  const UmbError code = has_error_ ? UmbError(error_.kind) : UMB_ERROR_NONE;
  taken_message_ = has_error_ ? std::move(error_.message) : std::string();
  has_error_ = false;
  if (message) *message = taken_message_.c_str();
  return code;
}

ErrorSlot& thread_errors() {
  static thread_local ErrorSlot errors(false);
  return errors;
}

bool UseLock::begin(Use use) {
  if (use == Use::kFree) return true;
  std::unique_lock lock(mutex_);
  if (is_changed_ || (use == Use::kChanges && drawers_ > 0)) return false;
  if (use == Use::kReads) ++readers_;
  if (use == Use::kDraws) ++drawers_;
  if (use == Use::kChanges) {
    is_changed_ = true;
    read_.wait(lock, [&] { return readers_ == 0; });
  }
  return true;
}

void UseLock::end(Use use) {
  if (use == Use::kFree) return;
  const std::lock_guard lock(mutex_);
  if (use == Use::kChanges) is_changed_ = false;
  if (use == Use::kDraws) --drawers_;
  if (use == Use::kReads && --readers_ == 0) read_.notify_one();
}

UmbError Object::fail(Error error) {
  const auto code = UmbError(error.kind);
  try {
    Object* device = reporting_device();
    if (device && device != this) device->errors.store(error);
    errors.store(error);
    if (device) device->report_error(error);
  } catch (...) {  // an exception of a callback, or memory for the message ran out; neither may reach C code
  }
  return code;
}

void* add_object(std::shared_ptr<Object> object) {
  static std::atomic<std::uintptr_t> last = 0;
  constexpr std::uintptr_t kStep = 16;  // handles are never reused and do not look like addresses
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

void release_reference(const void* handle) {
  std::shared_ptr<Object> last;  // destroyed after the lock is released
  {
    const std::lock_guard lock(table().mutex);
    const auto found = table().objects.find(handle);
    if (found == table().objects.end() || --found->second->references > 0) return;
    last = std::move(found->second);
    table().objects.erase(found);
  }
}

}  // namespace umbrage

UmbError umbGetError(const char** message) { return umbrage::thread_errors().take(message); }
