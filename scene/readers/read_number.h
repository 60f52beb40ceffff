// Numbers in texts. They are the time of large files: those of up to 15 digits without an exponent are a quotient of
// two exact doubles, which rounds correctly [Clinger 1990]; all others take std::from_chars.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace umbrage {

/// read_number without the shortcut for short numbers.
bool read_any_number(const char*& at, const char* end, double& value);

/// Reads the longest number at this place, such as 1, +1, .5, 1. or 1e3, also inf and nan, and moves `at` past it. An
/// exponent may begin with d, as Fortran writes it, or with *^, as Mathematica does.
/// Returns false if there is none. Numbers that exceed the range become infinite or 0. Does not depend on the locale.
inline bool read_number(const char*& at, const char* end, double& value) {
  static constexpr double kPowers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  constexpr std::ptrdiff_t kMaxExactDigits = 15;  // an integer of 15 digits and 1e15 are exact doubles
  const char* here = at;
  if (here < end && *here == '+' && here + 1 < end && here[1] != '-') at = ++here;
  const bool is_negative = here < end && *here == '-';
  here += is_negative;
  const char* const first = here;
  std::int64_t digits = 0;
  std::ptrdiff_t point = 0;  // digits after the decimal point
  const auto read_digits = [&] {
    const char* const start = here;
    for (; here < end && *here >= '0' && *here <= '9' && here - first <= kMaxExactDigits; ++here)
      digits = 10 * digits + (*here - '0');
    return here - start;
  };
  std::ptrdiff_t count = read_digits();
  if (here < end && *here == '.') {
    ++here;
    count += point = read_digits();
  }
  const auto goes_on_at = [](char c) {
    return (c >= '0' && c <= '9') || c == 'e' || c == 'E' || c == 'd' || c == 'D' || c == '*';
  };
  const bool goes_on = here < end && goes_on_at(*here);
  if (count == 0 || count > kMaxExactDigits || goes_on) return read_any_number(at, end, value);
  const double exact = double(digits) / kPowers[point];
  value = is_negative ? -exact : exact;
  at = here;
  return true;
}

/// Returns the number that is the whole of a text; nothing if it is something else.
inline std::optional<double> number_of(std::string_view text) {
  const char *at = text.data(), *const end = at + text.size();
  double value = 0.0;
  return read_number(at, end, value) && at == end ? std::optional(value) : std::nullopt;
}

}  // namespace umbrage
