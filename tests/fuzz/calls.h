// Calls of the C interface in any order, with any arguments, chosen by bytes: for fuzzers and for a short test.
#pragma once
#include <string_view>

namespace umbrage::fuzz {

/// What was done.
struct CallCounts {
  long calls = 0, failed = 0, executed = 0, cancelled = 0;
  CallCounts& operator+=(const CallCounts& other);
};

/// Makes calls on objects of its own until the bytes are used up. Images and buffers are blocks of the heap, no larger
/// than the header asks for. Aborts, with a sentence, where a promise of umbrage.h is broken: an error without a code
/// or sentence, an internal error, a pixel that was not written, a byte beside the pixels, or of an input, that was, an
/// output that a failing execution touched, a progress that falls, a cancelled call that goes on.
CallCounts make_calls(std::string_view bytes);

/// The same in several threads at once, which share a device and objects of it. Each thread's bytes are mixed from
/// these.
CallCounts make_calls_in_threads(std::string_view bytes, int threads);

}  // namespace umbrage::fuzz
