// Calls of the C interface in any order with any arguments, which the given bytes select. For random tests.
#pragma once
#include <string_view>

namespace umbrage::fuzz {

/// The number of calls, by result.
struct CallCounts {
  long calls = 0, failed = 0, executed = 0, cancelled = 0;
  CallCounts& operator+=(const CallCounts& other);
};

/// Makes calls on its own objects until the bytes are used up. Images and buffers are heap blocks of exactly the size
/// that the header requires. Aborts with a message if a guarantee of umbrage.h is violated: an error without code or
/// message, an internal error, a pixel that was not written, a write outside the pixels or to an input, an output
/// changed by a failing execution, decreasing progress, or a cancelled call that continues.
CallCounts make_calls(std::string_view bytes);

/// Makes calls in several threads at once. The threads share a device and objects of it. Each thread derives its own
/// bytes from `bytes`.
CallCounts make_calls_in_threads(std::string_view bytes, int threads);

}  // namespace umbrage::fuzz
