// Parsing and ranges of numbers in user input.
#pragma once
#include <fmt/core.h>

#include <algorithm>
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

/// Removes a number from the start of `text`, with white space before it, and returns it; nullopt if there is none. NaN
/// and infinity are numbers, as in files. Like parse_number, and unlike strtod, it does not depend on the locale of the
/// process, where the decimal point may be a comma.
inline std::optional<double> take_number(std::string_view& text) {
  std::string_view rest = text;
  rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  if (rest.size() > 1 && rest[0] == '+' && rest[1] != '-') rest.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc()) return std::nullopt;
  text = rest.substr(std::size_t(end - rest.data()));
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
