// Checks for the case that the programmer is wrong: they throw an InternalError that says both values, in release
// builds too. Who calls the library never sees it: core/guarded.h makes an Error of it.
#pragma once
#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace umbrage {

/// Where a function was called, as its default argument. std::source_location, which Debian 12's clang does not have.
struct CalledAt {
  const char* file = __builtin_FILE();
  int line = __builtin_LINE();
};

/// Something is wrong inside Umbrage.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void fail_check(std::string_view what, CalledAt at = {}) {
  throw InternalError(fmt::format("{} ({}:{})", what, at.file, at.line));
}

/// Fails with both values unless they are equal.
template <class A, class B>
void check_equal(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a == b)) fail_check(fmt::format("{}: {} != {}", what, a, b), at);
}

/// Fails with both values unless a < b.
template <class A, class B>
void check_less(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a < b)) fail_check(fmt::format("{}: {} is not below {}", what, a, b), at);
}

}  // namespace umbrage
