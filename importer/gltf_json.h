// Access to values of a glTF file's JSON text. Values of a wrong type or out of range never fail: they are counted, and
// a default is used.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace umbrage {

using Json = nlohmann::json;

/// Returns a member of an object, or null if it is missing or `object` is no object.
const Json& member(const Json& object, const char* name);
/// Returns an element of an array, or null.
const Json& element(const Json& list, std::size_t index);
/// Returns the number of elements of an array; 0 if it is none.
std::size_t count_of(const Json& list);
/// Returns a text, or an empty one if the value is none.
std::string text_of(const Json& value);
/// Returns a non-negative integer below 2^53, or -1.
std::int64_t integer_of(const Json& value);
/// Returns an index, or -1 if the value is none.
int index_of(const Json& value);
/// Returns the extension `name` of an object, or null.
const Json& extension_of(const Json& object, const char* name);

/// The place of an object in a file: "materials" and 3.
struct JsonPlace {
  const char* list = "";
  std::size_t index = 0;
};

/// The values of a file that are of a wrong type or out of range.
struct JsonFaults {
  std::size_t count = 0;
  std::string first;  ///< "materials[3].roughnessFactor"

  void add(const JsonPlace& place, const char* name);
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Returns the number `name` of an object, clamped to a range; `fallback` if it is missing.
double number_in(const Json& object, const char* name, double fallback, double low, double high, const JsonPlace& place,
                 JsonFaults& faults);

/// Returns an array of numbers, each clamped to a range; `fallback` if it is missing or has fewer numbers.
template <std::size_t N>
std::array<double, N> numbers_in(const Json& object, const char* name, const std::array<double, N>& fallback,
                                 double low, double high, const JsonPlace& place, JsonFaults& faults) {
  const Json& list = member(object, name);
  if (list.is_null()) return fallback;
  std::array<double, N> numbers = fallback;
  bool fits = count_of(list) >= N;
  for (std::size_t k = 0; fits && k < N; ++k) {
    fits = list[k].is_number();
    if (fits) numbers[k] = list[k].template get<double>();
  }
  if (!fits) numbers = fallback;
  bool in_range = true;
  for (double& v : numbers) {
    in_range = in_range && v >= low && v <= high;
    v = v < low ? low : v > high ? high : v;
  }
  if (!fits || !in_range) faults.add(place, name);
  return numbers;
}

/// Returns three numbers as a colour, 0 to `high`.
glm::vec3 color_in(const Json& object, const char* name, double fallback, double high, const JsonPlace& place,
                   JsonFaults& faults);

/// Returns a non-negative integer; `fallback` if it is missing or not one.
std::int64_t integer_in(const Json& object, const char* name, std::int64_t fallback, const JsonPlace& place,
                        JsonFaults& faults);

}  // namespace umbrage
