#include "core/parameters.h"

#include <cmath>
#include <cstring>

#include "core/check.h"
#include "core/numbers.h"
#include "core/suggest.h"

namespace umbrage {
namespace {

constexpr double kMaxPercent = 1000.0;

template <class T>
void store(ParameterBytes& bytes, std::size_t offset, T value) {
  check_less(offset + sizeof(T), bytes.size() + 1, "parameter outside its struct");
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

template <class T>
T load(const ParameterBytes& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

void store_initial(const Parameter& row, ParameterBytes& bytes) {
  switch (row.type) {
    case ParameterType::kReal:
      return store(bytes, row.offset, float(row.initial));
    case ParameterType::kLength:
      return store(bytes, row.offset, Length{float(row.initial), row.initially_relative ? 1 : 0});
    default:
      return store(bytes, row.offset, int(row.initial));
  }
}

}  // namespace

std::size_t parameter_size(ParameterType type) { return type == ParameterType::kLength ? sizeof(Length) : 4; }

Parameter number_row(ParameterType type, std::string_view name, std::size_t offset, const NumberRange& range,
                     std::string_view help) {
  return {.name = name,
          .help = help,
          .type = type,
          .offset = offset,
          .initial = range.initial,
          .min = range.min,
          .max = range.max,
          .unit = range.unit,
          .zero_means = range.zero_means,
          .factor = range.factor};
}

ParameterBytes initial_parameters(std::span<const Parameter> table, std::size_t size) {
  ParameterBytes bytes(size);
  for (const Parameter& row : table) store_initial(row, bytes);
  return bytes;
}

std::string parameter_range(const Parameter& row) {
  const std::string unit = row.unit.empty() ? "" : " " + std::string(row.unit);
  const std::string of_unit = row.unit.empty() ? "" : " in " + std::string(row.unit);
  const std::string zero = row.zero_means.empty() ? "" : fmt::format(" (0: {})", row.zero_means);
  switch (row.type) {
    case ParameterType::kBool:
      return "on or off";
    case ParameterType::kChoice:
      return joined_by_or(row.choices);
    case ParameterType::kLength:
      if (row.above_zero) return fmt::format("a number above 0{} or a percentage up to {:g}%", of_unit, kMaxPercent);
      return fmt::format("{:.7g} to {:.7g}{} or 0% to {:g}%{}", row.min, row.max, unit, kMaxPercent, zero);
    default:
      return fmt::format("{:.7g} to {:.7g}{}{}", row.min, row.max, unit, zero);
  }
}

Result<void> set_parameter(std::string_view owner, const Parameter& row, std::string_view text, ParameterBytes& bytes) {
  const auto wrong = [&] {
    return usage_error("{}.{} cannot be '{}': it takes {}{}", owner, row.name, text,
                       row.type == ParameterType::kInt ? "an integer from " : "", parameter_range(row));
  };
  if (row.type == ParameterType::kChoice) {
    for (std::size_t i = 0; i < row.choices.size(); ++i)
      if (row.choices[i] == text) return store(bytes, row.offset, int(i)), Result<void>();
    return usage_error("{}.{} cannot be '{}'{}", owner, row.name, text, suggestion(text, row.choices));
  }
  if (row.type == ParameterType::kBool) {
    for (std::string_view yes : {"on", "true", "yes", "1"})
      if (text == yes) return store(bytes, row.offset, 1), Result<void>();
    for (std::string_view no : {"off", "false", "no", "0"})
      if (text == no) return store(bytes, row.offset, 0), Result<void>();
    return wrong();
  }
  const bool percent = row.type == ParameterType::kLength && text.ends_with('%');
  const auto parsed = parse_number(percent ? text.substr(0, text.size() - 1) : text);
  if (!parsed) return wrong();
  const double value = *parsed;
  if (row.above_zero && !(value > 0.0)) return wrong();
  if (percent ? (value < 0.0 || value > kMaxPercent) : (value < row.min || value > row.max)) return wrong();
  if (row.type == ParameterType::kLength)
    store(bytes, row.offset, Length{float(value), percent ? 1 : 0});
  else if (row.type == ParameterType::kReal)
    store(bytes, row.offset, float(value));
  else if (value != std::floor(value))
    return wrong();
  else
    store(bytes, row.offset, int(value));
  return {};
}

std::string parameter_text(const Parameter& row, const ParameterBytes& bytes) {
  switch (row.type) {
    case ParameterType::kReal:
      return fmt::format("{:g}", load<float>(bytes, row.offset));
    case ParameterType::kBool:
      return load<int>(bytes, row.offset) ? "on" : "off";
    case ParameterType::kChoice:
      return std::string(row.choices[load<int>(bytes, row.offset)]);
    case ParameterType::kLength: {
      const auto length = load<Length>(bytes, row.offset);
      return fmt::format("{:g}{}", length.value, length.relative ? "%" : "");
    }
    default:
      return fmt::format("{}", load<int>(bytes, row.offset));
  }
}

int int_value(const Parameter& row, const ParameterBytes& bytes) { return load<int>(bytes, row.offset); }

float real_value(const Parameter& row, const ParameterBytes& bytes) { return load<float>(bytes, row.offset); }

void set_int(const Parameter& row, int value, ParameterBytes& bytes) { store(bytes, row.offset, value); }

void multiply(const Parameter& row, float factor, ParameterBytes& bytes) {
  store(bytes, row.offset, factor * real_value(row, bytes));
}

void copy_parameter(const Parameter& row, const ParameterBytes& from, ParameterBytes& to) {
  std::memcpy(to.data() + row.offset, from.data() + row.offset, parameter_size(row.type));
}

}  // namespace umbrage
