// The parameter table: one row per field of an effect's params struct. Command line, help, docs and tests are generated
// from it.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/length.h"
#include "core/result.h"

namespace umbrage {

/// Returns the absolute length. `whole`: the length that is 100%, in the unit of absolute lengths.
inline float absolute_length(const Length& length, float whole) {
  return length.relative != 0 ? length.value / 100.0f * whole : length.value;
}

enum class ParameterType {
  kReal,    ///< float
  kInt,     ///< int
  kBool,    ///< int, 0 or 1; written on, off, true, false, yes, no, 1, 0
  kChoice,  ///< int, an index into `choices`; written as the choice's name
  kLength,  ///< Length: an absolute number in `unit`, or a percentage written with %
};

/// One field of a params struct. The functions below create rows.
struct Parameter {
  std::string_view name, help;
  ParameterType type = ParameterType::kReal;
  std::size_t offset = 0;                      ///< bytes from the start of the struct
  double initial = 0.0;                        ///< default (index of the choice; absolute length)
  double min = 0.0, max = 0.0;                 ///< inclusive range; a percentage is always 0 to 1000
  std::string_view unit = {};                  ///< "px", "deg", "" for a plain number
  std::vector<std::string_view> choices = {};  ///< for kChoice
  bool initially_relative = false;             ///< for kLength: `initial` is in percent
  bool above_zero = false;                     ///< 0 and 0% are errors
  std::string_view zero_means = {};            ///< meaning of 0, such as "automatic"; empty: none
  std::string_view former_name = {};           ///< accepted, with a warning, until the next minor version; or empty
  std::string_view factor = {};                ///< for kReal: the request's field that multiplies it; empty: none
};

/// The range of a number, ends included, and its default; the others as in Parameter.
struct NumberRange {
  double initial = 0.0, min = 0.0, max = 0.0;
  std::string_view unit = {}, zero_means = {}, factor = {};
};

/// The range of a length: absolute from `min` to `max`, or 0% to 1000%. The default is `initial_percent` if that is not
/// 0, else `initial`.
struct LengthRange {
  double initial = 0.0, initial_percent = 0.0, min = 0.0, max = 0.0;
  std::string_view unit = {}, zero_means = {};
  bool above_zero = false;
};

/// Returns the offset of a field in its struct, bytes. Params structs are plain data.
template <class Params, class Field>
std::size_t offset_of(Field Params::*field) {
  const Params params{};
  return std::size_t(reinterpret_cast<const char*>(&(params.*field)) - reinterpret_cast<const char*>(&params));
}

/// Returns a row of kReal or kInt; real_row and int_row below derive the type from the field.
Parameter number_row(ParameterType type, std::string_view name, std::size_t offset, const NumberRange& range,
                     std::string_view help);

/// Return one row of a parameter table. `name` is the name in settings. Choices and switches are fields of type int;
/// the initial choice is an index.
template <class Params>
Parameter real_row(std::string_view name, float Params::*field, const NumberRange& range, std::string_view help) {
  return number_row(ParameterType::kReal, name, offset_of(field), range, help);
}

template <class Params>
Parameter int_row(std::string_view name, int Params::*field, const NumberRange& range, std::string_view help) {
  return number_row(ParameterType::kInt, name, offset_of(field), range, help);
}

template <class Params>
Parameter length_row(std::string_view name, Length Params::*field, const LengthRange& range, std::string_view help) {
  const bool relative = range.initial_percent != 0.0;
  return {.name = name,
          .help = help,
          .type = ParameterType::kLength,
          .offset = offset_of(field),
          .initial = relative ? range.initial_percent : range.initial,
          .min = range.min,
          .max = range.max,
          .unit = range.unit,
          .initially_relative = relative,
          .above_zero = range.above_zero,
          .zero_means = range.zero_means};
}

template <class Params>
Parameter choice_row(std::string_view name, int Params::*field, int initial, std::vector<std::string_view> choices,
                     std::string_view help) {
  return {.name = name,
          .help = help,
          .type = ParameterType::kChoice,
          .offset = offset_of(field),
          .initial = double(initial),
          .choices = std::move(choices)};
}

template <class Params>
Parameter bool_row(std::string_view name, int Params::*field, bool initial, std::string_view help) {
  return {.name = name,
          .help = help,
          .type = ParameterType::kBool,
          .offset = offset_of(field),
          .initial = initial ? 1.0 : 0.0};
}

/// Returns a renamed row, which is still found by its former name.
inline Parameter renamed_from(std::string_view former_name, Parameter row) {
  row.former_name = former_name;
  return row;
}

/// The bytes of one params struct.
using ParameterBytes = std::vector<std::byte>;

std::size_t parameter_size(ParameterType type);

/// Returns the bytes of a params struct with all defaults.
ParameterBytes initial_parameters(std::span<const Parameter> table, std::size_t size);

/// Sets one field from text. `owner` prefixes the name in errors ("unsharp"). Errors: kUsage, with field, value and
/// range.
Result<void> set_parameter(std::string_view owner, const Parameter& row, std::string_view text, ParameterBytes& bytes);

/// Returns the text that sets the field to its current value.
std::string parameter_text(const Parameter& row, const ParameterBytes& bytes);

/// Return, set and multiply the value of an int field (kInt, kBool, kChoice) or a float field.
int int_value(const Parameter& row, const ParameterBytes& bytes);
float real_value(const Parameter& row, const ParameterBytes& bytes);
void set_int(const Parameter& row, int value, ParameterBytes& bytes);
void multiply(const Parameter& row, float factor, ParameterBytes& bytes);

/// Copies one field from other params of the same struct.
void copy_parameter(const Parameter& row, const ParameterBytes& from, ParameterBytes& to);

/// Returns the accepted values as text: "1 to 1023 px", "on or off", "skip, zero, clamp or repeat".
std::string parameter_range(const Parameter& row);

/// Returns the bytes as their params struct. T must be the struct that the table describes.
template <class T>
T& as(ParameterBytes& bytes) {
  return *reinterpret_cast<T*>(bytes.data());
}
template <class T>
const T& as(const ParameterBytes& bytes) {
  return *reinterpret_cast<const T*>(bytes.data());
}

}  // namespace umbrage
