#include "scene/readers/read_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>

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
  if (error == std::errc::result_out_of_range) {
    value = is_large({start, std::size_t(stop - start)}) ? HUGE_VAL : 0.0;
    if (*start == '-') value = -value;
  }
  at = stop;
  return true;
}

}  // namespace umbrage
