// Numbers as people write them.
#pragma once
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace umbrage {

/// The number that the whole text is; nothing where it is none, or not finite.
inline std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The numbers from `min` to `max`, both included, or the whole ones among them.
struct Interval {
  double min = 0.0, max = 0.0;
  bool whole = false;

  bool has(double value) const { return value >= min && value <= max && (!whole || value == std::floor(value)); }

  /// "a whole number from 1 to 16"
  std::string words() const {
    return whole ? fmt::format("a whole number from {} to {}", long(min), long(max))
                 : fmt::format("a number from {:g} to {:g}", min, max);
  }
};

/// The number that a text is, where the interval has it.
inline std::optional<double> parse_number(std::string_view text, const Interval& interval) {
  const auto value = parse_number(text);
  return value && interval.has(*value) ? value : std::nullopt;
}

}  // namespace umbrage
