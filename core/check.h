// Checks for the case that the programmer is wrong: they print both values and abort, in release builds too.
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace umbrage {

/// Where a function was called, as its default argument. std::source_location, which Debian 12's clang does not have.
struct CalledAt {
  const char* file = __builtin_FILE();
  int line = __builtin_LINE();
};

[[noreturn]] inline void fail_check(std::string_view what, CalledAt at = {}) {
  fmt::print(stderr, "umbrage: internal error: {} ({}:{})\n", what, at.file, at.line);
  std::abort();
}

/// Aborts with both values unless they are equal.
template <class A, class B>
void check_equal(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a == b)) fail_check(fmt::format("{}: {} != {}", what, a, b), at);
}

/// Aborts with both values unless a < b.
template <class A, class B>
void check_less(const A& a, const B& b, std::string_view what, CalledAt at = {}) {
  if (!(a < b)) fail_check(fmt::format("{}: {} is not below {}", what, a, b), at);
}

}  // namespace umbrage
