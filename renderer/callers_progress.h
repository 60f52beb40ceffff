// CallersProgress: the callback of who calls the library, which may throw what it likes.
#pragma once
#include <exception>
#include <utility>

#include "umbrage/umbrage.h"

namespace umbrage {

/// A caller's Progress. What it throws ends the work as its false would, and goes on to the caller from there.
class CallersProgress {
 public:
  /// In the request's place.
  Progress watched(const Progress& progress) {
    if (!progress) return {};
    return [this, progress](double done) {
      if (thrown_) return false;
      try {
        return progress(done);
      } catch (...) {
        thrown_ = std::current_exception();
        return false;
      }
    };
  }
  void rethrow() {
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }

 private:
  std::exception_ptr thrown_;
};

}  // namespace umbrage
