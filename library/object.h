// Object: the object behind a handle of the C interface, with its reference count and errors, and the wrappers of the
// calls.
//
// Handles are keys in a table of all live objects. A released or invalid handle is therefore detected.
#pragma once
#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "core/guarded.h"
#include "core/result.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// Stores an error until it is read: for an object the first one, since later ones may follow from it; for a thread the
/// last one.
class ErrorSlot {
 public:
  explicit ErrorSlot(bool keeps_first) : keeps_first_(keeps_first) {}
  UmbError store(Error error);
  /// Returns and clears the error. The text is valid until the next call.
  UmbError take(const char** message);

 private:
  std::mutex mutex_;
  const bool keeps_first_;
  Error error_;
  bool has_error_ = false;
  std::string taken_message_;
};

/// Returns the slot for errors of this thread's calls that have no object.
ErrorSlot& thread_errors();

/// How a call uses its object.
enum class Use {
  kChanges,  ///< exclusive
  kReads,    ///< concurrent with reads and draws; short, runs no callbacks
  kDraws,    ///< concurrent with reads and other draws; may run callbacks
  kFree,     ///< always allowed; the data that the call uses have their own locks
};

/// Tracks the uses of an object that are in progress. A change waits for reads, but for nothing else: so no callback
/// can wait for the call that runs it.
class UseLock {
 public:
  /// Returns whether the use may begin. If so, the caller must end it.
  bool begin(Use use);
  void end(Use use);

 private:
  std::mutex mutex_;
  std::condition_variable read_;
  int readers_ = 0, drawers_ = 0;
  bool is_changed_ = false;
};

/// Uses an object during the lifetime of this guard. Converts to false if the use is refused.
class UseGuard {
 public:
  UseGuard(UseLock& lock, Use use) : lock_(lock), use_(use), begun_(lock.begin(use)) {}
  ~UseGuard() {
    if (begun_) lock_.end(use_);
  }
  UseGuard(const UseGuard&) = delete;
  UseGuard& operator=(const UseGuard&) = delete;
  explicit operator bool() const { return begun_; }

 private:
  UseLock& lock_;
  const Use use_;
  const bool begun_;
};

class Object {
 public:
  virtual ~Object() = default;
  /// Returns the purpose of a call's memory, for the message if memory runs out: the call's name, or "a picture of
  /// 64 x 48 pixels".
  virtual std::string memory_purpose(const char* call) const { return call; }
  /// Stores an error and reports it to the device's callback.
  UmbError fail(Error error);

  ErrorSlot errors{true};
  UseLock use_lock;
  std::atomic<long> references{1};

 protected:
  /// Returns the device whose callback receives errors; null: none.
  virtual Object* reporting_device() = 0;
  /// Calls the error callback of this object. Only devices have one.
  virtual void report_error(const Error&) {}
};

/// Adds an object to the table. Returns its handle, which is never reused.
void* add_object(std::shared_ptr<Object> object);
/// Returns the object of a handle; null if there is none.
std::shared_ptr<Object> find_object(const void* handle);
/// Removes a reference of an object; with the last one, removes the object from the table.
void release_reference(const void* handle);

/// Returns the object of type T; null if the handle does not refer to one.
template <class T>
std::shared_ptr<T> object_of(const void* handle) {
  return std::dynamic_pointer_cast<T>(find_object(handle));
}

template <class T>
void retain_object(const void* handle) {
  if (const auto object = object_of<T>(handle)) ++object->references;
}
template <class T>
void release_object(const void* handle) {
  if (object_of<T>(handle)) release_reference(handle);
}

/// Runs a call that has no object. Errors are stored with the thread.
template <class Work>
UmbError call_without_object(const char* call, const Work& work) {
  Result<void> status = guarded([&] { return std::string(call); }, work);
  return status ? UMB_ERROR_NONE : thread_errors().store(std::move(status.error()));
}

/// Runs a call on an object. `call`: the name of its function. Errors are stored with the object, except kUsage for an
/// object that is in use: it is stored with the thread, since the object's errors belong to the users of the object.
template <class T, class Work>
UmbError call_on(const void* handle, const char* call, Use use, const Work& work) {
  std::shared_ptr<T> object;
  const UmbError found = call_without_object(call, [&]() -> Result<void> {
    object = object_of<T>(handle);
    if (!object) return usage_error("{}: the handle is NULL, or was released, or is of another kind", call);
    return {};
  });
  if (found != UMB_ERROR_NONE) return found;
  Result<void> status;
  {
    const UseGuard guard(object->use_lock, use);
    if (!guard)
      return call_without_object(call, [&]() -> Result<void> {
        return usage_error("{}: the object is in use by another thread or by the call that runs this callback", call);
      });
    status = guarded([&] { return object->memory_purpose(call); }, [&]() -> Result<void> { return work(*object); });
  }
  // After the guard has ended, since the error callback may use the object.
  return status ? UMB_ERROR_NONE : object->fail(std::move(status.error()));
}

/// Returns what `get` reads of an object; `otherwise` if the handle is invalid or the object is being changed.
template <class T, class Value, class Get>
Value read_of(const void* handle, Value otherwise, const Get& get) {
  const auto object = object_of<T>(handle);
  if (!object) return otherwise;
  const UseGuard guard(object->use_lock, Use::kReads);
  return guard ? get(*object) : otherwise;  // `get` does not throw
}

/// Returns and clears the first error of an object, or the thread's error if the handle is not of type T: see
/// umbGetError.
template <class T>
UmbError take_error(const void* handle, const char** message) {
  const auto object = object_of<T>(handle);
  return object ? object->errors.take(message) : umbGetError(message);
}

/// Creates an object from the Result that `make` returns. Returns null on failure; the error is stored with the thread.
template <class Handle, class Make>
Handle make_object(const char* call, const Make& make) {
  Handle handle = nullptr;
  call_without_object(call, [&]() -> Result<void> {
    auto made = make();
    if (!made) return made.error();
    handle = reinterpret_cast<Handle>(add_object(std::move(*made)));
    return {};
  });
  return handle;
}

/// Converts a string of the caller; null is empty.
inline std::string text_of(const char* text) { return text ? text : ""; }

}  // namespace umbrage
