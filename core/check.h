// Checks for the case that the programmer is wrong: they print both values and abort, in release builds too.
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <source_location>
#include <string_view>

namespace umbrage {

[[noreturn]] inline void fail_check(std::string_view what, std::source_location at = std::source_location::current()) {
  fmt::print(stderr, "umbrage: internal error: {} ({}:{})\n", what, at.file_name(), at.line());
  std::abort();
}

/// Aborts with both values unless they are equal.
template <class A, class B>
void check_equal(const A& a, const B& b, std::string_view what,
                 std::source_location at = std::source_location::current()) {
  if (!(a == b)) fail_check(fmt::format("{}: {} != {}", what, a, b), at);
}

/// Aborts with both values unless a < b.
template <class A, class B>
void check_less(const A& a, const B& b, std::string_view what,
                std::source_location at = std::source_location::current()) {
  if (!(a < b)) fail_check(fmt::format("{}: {} is not below {}", what, a, b), at);
}

}  // namespace umbrage
