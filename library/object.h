// Object: what a handle of the C interface stands for; its references, its errors, and the border around each call.
//
// Handles are numbers in a table of all objects that live: one that was released, or is none, is found out.
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

/// An error until somebody asks: the first of an object, whose calls follow from each other; the last of a thread.
class ErrorSlot {
 public:
  explicit ErrorSlot(bool keeps_first) : keeps_first_(keeps_first) {}
  UmbError note(Error error);
  /// Gives it away. The text lives until the next call.
  UmbError take(const char** message);

 private:
  std::mutex mutex_;
  const bool keeps_first_;
  Error error_;
  bool there_ = false;
  std::string taken_;
};

/// Of calls that have no object.
ErrorSlot& thread_errors();

/// How a call uses its object.
enum class Use {
  kChanges,  ///< alone
  kReads,    ///< beside others that read; it is short, and calls nobody back
  kDraws,    ///< beside others that read or draw; it may call back
  kFree,     ///< what it uses has locks of its own
};

/// Who is at work on an object. A change waits for those that read, and for nobody else: no callback waits for the call
/// that it is a part of.
class Workers {
 public:
  /// Whether the use may begin; then it has to end.
  bool begin(Use use);
  void end(Use use);

 private:
  std::mutex mutex_;
  std::condition_variable read_;
  int readers_ = 0, drawers_ = 0;
  bool is_changed_ = false;
};

/// A use of an object, from begin to end, unless it is refused.
class Held {
 public:
  Held(Workers& workers, Use use) : workers_(workers), use_(use), begun_(workers.begin(use)) {}
  ~Held() {
    if (begun_) workers_.end(use_);
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  explicit operator bool() const { return begun_; }

 private:
  Workers& workers_;
  const Use use_;
  const bool begun_;
};

class DeviceObject;

class Object {
 public:
  virtual ~Object() = default;
  /// What a call is for, where memory is short: the call's name, or "a picture of 64 x 48 pixels".
  virtual std::string asked(const char* call) const { return call; }
  /// Notes an error and tells the device's callback.
  UmbError fail(Error error);

  ErrorSlot errors{true};
  Workers workers;
  std::atomic<long> references{1};

 protected:
  /// Whose callback is told.
  virtual DeviceObject* teller() = 0;
};

/// Makes an object known. Returns its handle, a number that no other object gets.
void* add_object(std::shared_ptr<Object> object);
/// The object of a handle; null where there is none.
std::shared_ptr<Object> find_object(const void* handle);
/// Takes a reference of an object that is there.
void release_found(const void* handle);

/// The object of that kind; null where the handle is none.
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
  if (object_of<T>(handle)) release_found(handle);
}

/// Runs a call that has no object. Errors are the thread's.
template <class Work>
UmbError call_alone(const char* call, const Work& work) {
  Result<void> done = guarded([&] { return std::string(call); }, work);
  return done ? UMB_ERROR_NONE : thread_errors().note(std::move(done.error()));
}

/// Runs a call on an object, by the name of its function. Errors are the object's, but for kUsage where others are at
/// work on it: that is the thread's, since the object's belong to those.
template <class T, class Work>
UmbError call_on(const void* handle, const char* call, Use use, const Work& work) {
  std::shared_ptr<T> object;
  const UmbError found = call_alone(call, [&]() -> Result<void> {
    object = object_of<T>(handle);
    if (!object) return usage_error("{}: the handle is NULL, or was released, or is of another kind", call);
    return {};
  });
  if (found != UMB_ERROR_NONE) return found;
  Result<void> done;
  {
    const Held held(object->workers, use);
    if (!held)
      return call_alone(call, [&]() -> Result<void> {
        return usage_error("{}: another thread is at work on the object, or the call that calls back", call);
      });
    done = guarded([&] { return object->asked(call); }, [&]() -> Result<void> { return work(*object); });
  }
  return done ? UMB_ERROR_NONE : object->fail(std::move(done.error()));  // whose callback may use the object
}

/// What `get` reads of an object; `otherwise` where the handle is none, or others change the object.
template <class T, class Value, class Get>
Value read_of(const void* handle, Value otherwise, const Get& get) {
  const auto object = object_of<T>(handle);
  if (!object) return otherwise;
  const Held held(object->workers, Use::kReads);
  return held ? get(*object) : otherwise;  // which throws nothing
}

/// The first error of an object, or, where the handle is none of that kind, the thread's: see umbGetError.
template <class T>
UmbError take_error(const void* handle, const char** message) {
  const auto object = object_of<T>(handle);
  return object ? object->errors.take(message) : umbGetError(message);
}

/// Makes an object; `make` gives a Result of it. Null on an error, which is the thread's.
template <class Handle, class Make>
Handle make_object(const char* call, const Make& make) {
  Handle handle = nullptr;
  call_alone(call, [&]() -> Result<void> {
    auto made = make();
    if (!made) return made.error();
    handle = reinterpret_cast<Handle>(add_object(std::move(*made)));
    return {};
  });
  return handle;
}

/// Text of a caller's; null is empty.
inline std::string text_of(const char* text) { return text ? text : ""; }

}  // namespace umbrage
