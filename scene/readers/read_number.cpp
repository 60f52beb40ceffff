#include "scene/readers/read_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace umbrage {
namespace {

/// Returns whether a number that exceeds the range is too large, not too small: by the exponent of its first digit.
bool is_large(std::string_view number) {
  const std::size_t exponent_at = std::min(number.find_first_of("eE"), number.size());
  const std::string_view mantissa = number.substr(0, exponent_at);
  const auto point = std::ptrdiff_t(std::min(mantissa.find('.'), mantissa.size())),
             first = std::ptrdiff_t(std::min(mantissa.find_first_of("123456789"), mantissa.size()));
  std::string_view digits = number.substr(std::min(exponent_at + 1, number.size()));
  if (digits.starts_with('+')) digits.remove_prefix(1);
  std::ptrdiff_t exponent = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  if (error == std::errc::result_out_of_range) return !digits.starts_with('-');
  return point - first + exponent > 0;
}

}  // namespace

bool read_any_number(const char*& at, const char* end, double& value) {
  const char* const start = at;
  const auto [stop, error] = std::from_chars(start, end, value);
  if (stop == start) return false;
  const std::string_view mark = std::string_view(stop, std::size_t(end - stop)).substr(0, 2);
  const std::ptrdiff_t mark_size = mark == "*^" ? 2 : mark.starts_with('d') || mark.starts_with('D') ? 1 : 0;
  int exponent = 0;
  if (mark_size > 0) {
    const char* digits = stop + mark_size;
    if (digits < end && *digits == '+') ++digits;
    const auto [exponent_end, wrong] = std::from_chars(digits, end, exponent);
    if (wrong == std::errc()) {
      const std::string number = std::string(start, stop) + "e" + std::string(digits, exponent_end);
      const char* text = number.data();
      double marked = 0.0;
      if (read_any_number(text, number.data() + number.size(), marked) && text == number.data() + number.size()) {
        value = marked;
        at = exponent_end;
        return true;
      }
    }
  }
  if (error == std::errc::result_out_of_range) {
    value = is_large({start, std::size_t(stop - start)}) ? HUGE_VAL : 0.0;
    if (*start == '-') value = -value;
  }
  at = stop;
  return true;
}

}  // namespace umbrage
