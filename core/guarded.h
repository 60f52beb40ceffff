// The boundary between Umbrage and its host: no exception leaves Umbrage, and nothing ends the host's process.
#pragma once
#include <atomic>
#include <new>
#include <string>
#include <type_traits>

#include "core/check.h"
#include "core/result.h"

namespace umbrage {

/// Returns the Result of `work`, or converts the exception that it throws: kDevice if memory is exhausted, kInternal
/// otherwise. `memory_purpose()` returns what the memory was requested for, such as "a picture of 64 x 48 pixels".
template <class Purpose, class Work>
std::invoke_result_t<Work> guarded(const Purpose& memory_purpose, const Work& work) {
  try {
    try {
      return work();
    } catch (const std::bad_alloc&) {
      return device_error("not enough memory for {}", memory_purpose());
    } catch (const std::exception& error) {
      return Error{ErrorKind::kInternal, fmt::format("internal error: {}", error.what())};
    } catch (...) {  // a callback of the caller threw something else
      return Error{ErrorKind::kInternal, "internal error: an exception of unknown kind"};
    }
  } catch (const std::exception&) {  // no memory for the message; a string this short allocates none
    return Error{ErrorKind::kDevice, "out of memory"};
  }
}

/// For tests of this boundary: a function that throws, called by the drawing threads through fault_point; null: none.
inline std::atomic<void (*)()> injected_fault{nullptr};

inline void fault_point() {
  if (void (*fault)() = injected_fault.load(std::memory_order_relaxed)) fault();
}

}  // namespace umbrage
