// Internals of the C++ interface: errors, handles, and the forwarding of progress to a caller's Progress.
// umbrage/umbrage.hpp includes this header.
#pragma once
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "umbrage/requests.hpp"
#include "umbrage/umbrage.h"

namespace umb {

/// An error of the C interface as an exception.
class Error : public std::runtime_error {
 public:
  Error(UmbError code_, const std::string& message) : std::runtime_error(message), code(code_) {}
  UmbError code;
};

namespace detail {

// ---- Errors ----

/// Returns a generic message for an error whose own message is not available.
inline const char* plain_sentence(UmbError code) {
  switch (code) {
    case UMB_ERROR_USAGE:
      return "an invalid name, value, image or call";
    case UMB_ERROR_FILE:
      return "a file that cannot be read, used or written";
    case UMB_ERROR_DEVICE:
      return "a missing or insufficient device, or too little memory";
    case UMB_ERROR_CANCELLED:
      return "the progress callback returned false";
    default:
      return "a defect of Umbrage";
  }
}

/// Returns the error of a call that returned `code`, and clears it. `take` reads the error of the object. That error
/// may be an older one: a call that was refused because another thread uses the object stores its error with the
/// thread.
template <class Take>
Outcome outcome_of(UmbError code, const Take& take) {
  const char* message = "";
  if (take(&message) == code || umbGetError(&message) == code) return {int(code), message, {}};
  return {int(code), plain_sentence(code), {}};
}

/// Returns and clears the error of a call that returns no code. `otherwise`: the code if no error is stored.
template <class Take>
Outcome told_without_code(UmbError otherwise, const Take& take) {
  const char* message = "";
  UmbError code = take(&message);
  if (code == UMB_ERROR_NONE) code = umbGetError(&message);
  if (code == UMB_ERROR_NONE) return {int(otherwise), plain_sentence(otherwise), {}};
  return {int(code), message, {}};
}

/// Throws the error that `ask` returns. Without exceptions the error stays stored.
template <class Ask>
void fail(const Ask& ask) {
#ifdef __cpp_exceptions
  const Outcome error = ask();
  throw Error(UmbError(error.code), error.message);
#else
  (void)ask;
#endif
}

/// Throws the error of a code. Returns the code if it is UMB_ERROR_NONE, or without exceptions.
template <class Take>
UmbError check_with(UmbError code, const Take& take) {
  if (code != UMB_ERROR_NONE) fail([&] { return outcome_of(code, take); });
  return code;
}

/// The same for a call on an object.
template <class Handle>
UmbError check(UmbError code, Handle handle, UmbError (*take)(Handle, const char**)) {
  return check_with(code, [&](const char** message) { return take(handle, message); });
}

/// Returns and clears the error that `take` reads.
template <class Take>
Outcome taken(const Take& take) {
  const char* message = "";
  const UmbError code = take(&message);
  return {int(code), message, {}};
}

/// Returns the handle of a new object. Throws if it is null.
template <class Handle>
Handle made(Handle handle) {
  if (!handle) fail([] { return told_without_code(UMB_ERROR_INTERNAL, umbGetError); });
  return handle;
}

// ---- Handles ----

/// A reference-counted handle.
template <class Handle, void (*retain)(Handle), void (*release)(Handle)>
class Ref {
 public:
  Ref() = default;
  /// Takes ownership of a reference of the caller.
  explicit Ref(Handle handle) : handle_(handle) {}
  Ref(const Ref& other) : handle_(other.handle_) { retain(handle_); }
  Ref(Ref&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Ref& operator=(Ref other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Ref() { release(handle_); }
  /// Returns the handle, for calls of the C interface.
  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != nullptr; }

 private:
  Handle handle_ = nullptr;
};

/// Marks constructors that take ownership of a reference.
struct Adopted {};

// ---- Progress ----

/// Wraps a caller's Progress, which may throw. An exception cancels the work, as returning false does; rethrow passes
/// it to the caller after the call has returned.
class Watch {
 public:
  explicit Watch(const Progress& progress) : progress_(progress) {}
  UmbProgressCallback callback() const { return progress_ ? &Watch::call : nullptr; }
  /// Returns the callback for work that precedes the reported fractions; it always reports 0.
  UmbProgressCallback callback_before() const { return progress_ ? &Watch::call_before : nullptr; }
  bool has_thrown() const { return thrown_ != nullptr; }
  void rethrow() {
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }
  bool tell(double done) {
    if (thrown_) return false;
#ifdef __cpp_exceptions
    try {
      return progress_(done);
    } catch (...) {
      thrown_ = std::current_exception();
      return false;
    }
#else
    return progress_(done);
#endif
  }

 private:
  static bool call(void* user, double done) { return static_cast<Watch*>(user)->tell(done); }
  static bool call_before(void* user, double) { return static_cast<Watch*>(user)->tell(0.0); }

  Progress progress_;
  std::exception_ptr thrown_;
};

/// A call of this thread on an object that reports to a Watch, during the lifetime of this object.
///
/// The C interface keeps a callback after the call if the callback cannot be removed because another thread already
/// uses the object. The user pointer must therefore not be an address that becomes invalid when the call ends: it is
/// the object's handle, and the callback searches for a call of its own thread on that object. If there is none, it
/// reports nothing and returns true.
class WatchedCall {
 public:
  WatchedCall(const void* object, Watch& watch) : object_(object), watch_(watch), outer_(innermost()) {
    innermost() = this;
  }
  ~WatchedCall() { innermost() = outer_; }
  WatchedCall(const WatchedCall&) = delete;
  WatchedCall& operator=(const WatchedCall&) = delete;
  static bool tell(void* object, double done) {
    const WatchedCall* call = innermost();
    while (call && call->object_ != object) call = call->outer_;
    return !call || call->watch_.tell(done);
  }

 private:
  static const WatchedCall*& innermost() {
    static thread_local const WatchedCall* call = nullptr;
    return call;
  }

  const void* const object_;
  Watch& watch_;
  const WatchedCall* const outer_;
};

/// Selects where calls on an object report their progress: to a Progress passed to the call, or else to the callback
/// that was set, which persists. Copies refer to the same object and share that callback.
template <class Handle, UmbError (*install)(Handle, UmbProgressCallback, void*)>
class Progresses {
 public:
  Progresses() = default;
  explicit Progresses(Handle handle) : kept_(handle ? std::make_shared<Kept>() : nullptr) {}

  /// Sets the persistent callback.
  UmbError set(Handle handle, UmbProgressCallback callback, void* user) const {
    const UmbError code = install(handle, callback, user);
    if (code == UMB_ERROR_NONE) keep({callback, user, false});
    return code;
  }
  /// Runs a call that reports to the persistent callback.
  UmbError run(Handle handle, UmbError (*work)(Handle)) const {
    return run(handle, [work](Handle object) { return work(object); });
  }
  template <class Work>
  UmbError run(Handle handle, const Work& work) const {
    const Callback callback = kept();
    const UmbError code = callback.is_missing ? set(handle, callback.call, callback.user) : UMB_ERROR_NONE;
    return code == UMB_ERROR_NONE ? work(handle) : code;
  }
  /// Runs a call that reports to the Watch.
  template <class Work>
  UmbError run(Handle handle, Watch& watch, const Work& work) const {
    UmbError code = install(handle, &WatchedCall::tell, handle);
    if (code != UMB_ERROR_NONE) return code;
    {
      const WatchedCall call(handle, watch);
      code = work(handle);
    }
    Callback callback = kept();
    callback.is_missing = install(handle, callback.call, callback.user) != UMB_ERROR_NONE;
    if (callback.is_missing && code != UMB_ERROR_USAGE) umbGetError(nullptr);  // discards the error of `install`
    keep(callback);
    return code;
  }

 private:
  struct Callback {
    UmbProgressCallback call = nullptr;
    void* user = nullptr;
    bool is_missing = false;  ///< the C interface has another callback
  };
  struct Kept {
    std::mutex mutex;
    Callback callback;
  };
  Callback kept() const {
    if (!kept_) return {};
    const std::lock_guard<std::mutex> lock(kept_->mutex);
    return kept_->callback;
  }
  void keep(const Callback& callback) const {
    if (!kept_) return;
    const std::lock_guard<std::mutex> lock(kept_->mutex);
    kept_->callback = callback;
  }

  std::shared_ptr<Kept> kept_;
};

}  // namespace detail
}  // namespace umb
