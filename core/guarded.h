// The border between Umbrage and its host: no exception of Umbrage's crosses it, and nothing ends the host's process.
#pragma once
#include <atomic>
#include <new>
#include <string>
#include <type_traits>

#include "core/check.h"
#include "core/result.h"

namespace umbrage {

/// The Result of `work`, or the exception that it throws as an Error: kDevice where memory is short, kInternal
/// otherwise. `asked()` says what memory was asked for, such as "a picture of 64 x 48 pixels".
template <class Asked, class Work>
std::invoke_result_t<Work> guarded(const Asked& asked, const Work& work) {
  try {
    try {
      return work();
    } catch (const std::bad_alloc&) {
      return device_error("not enough memory for {}", asked());
    } catch (const std::exception& error) {
      return Error{ErrorKind::kInternal, fmt::format("internal error: {}", error.what())};
    } catch (...) {  // a caller's callback threw something else
      return Error{ErrorKind::kInternal, "internal error: an exception of unknown kind"};
    }
  } catch (const std::exception&) {  // no memory even for the sentence; a string this short needs none
    return Error{ErrorKind::kDevice, "out of memory"};
  }
}

/// For tests of this border: called, where it is set, by the threads that draw. It throws.
inline std::atomic<void (*)()> injected_fault{nullptr};

inline void fault_point() {
  if (void (*fault)() = injected_fault.load(std::memory_order_relaxed)) fault();
}

}  // namespace umbrage
