// Parsing and ranges of numbers in user input.
#pragma once
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace umbrage {

/// Returns the number that `text` consists of, or nullopt if it is not a finite number.
inline std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

enum class NumberKind { kReal, kInteger, kEven };

/// The numbers of a kind in [min, max].
struct Interval {
  double min = 0.0, max = 0.0;
  NumberKind kind = NumberKind::kReal;

  bool has(double value) const {
    const double step = kind == NumberKind::kEven ? 2.0 : 1.0;
    return value >= min && value <= max && (kind == NumberKind::kReal || std::fmod(value, step) == 0.0);
  }

  /// Returns the range as text: "an integer from 1 to 16".
  std::string words() const {
    if (kind == NumberKind::kReal) return fmt::format("a number from {:g} to {:g}", min, max);
    return fmt::format("{} from {} to {}", kind == NumberKind::kEven ? "an even number" : "an integer", long(min),
                       long(max));
  }
};

/// Returns the number that `text` consists of, or nullopt if it is not a number in the interval.
inline std::optional<double> parse_number(std::string_view text, const Interval& interval) {
  const auto value = parse_number(text);
  return value && interval.has(*value) ? value : std::nullopt;
}

}  // namespace umbrage
