// Checks for programming errors, in release builds too. They throw an InternalError that contains both values;
// core/guarded.h turns it into an Error before it reaches the caller of the library.
#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace umbrage {

/// The source location of a call, as a default argument. Replaces std::source_location, which clang of Debian 12 lacks.
struct CalledAt {
  const char* file = __builtin_FILE();
  int line = __builtin_LINE();
};

/// A programming error inside Umbrage.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void fail_check(std::string_view what, CalledAt at = {}) {
  throw InternalError(fmt::format("{} ({}:{})", what, at.file, at.line));
}

/// Throws InternalError with both values unless a == b.
template <class A, class B>
void check_equal(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a == b)) fail_check(fmt::format("{}: {} != {}", what, a, b), at);
}

/// Throws InternalError with both values unless a < b.
template <class A, class B>
void check_less(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a < b)) fail_check(fmt::format("{}: {} is not below {}", what, a, b), at);
}

}  // namespace umbrage
