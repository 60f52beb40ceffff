#include "importer/gltf_json.h"

#include <fmt/format.h>

#include <algorithm>

namespace umbrage {

const Json& member(const Json& object, const char* name) {
  static const Json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(name);
  return found == object.end() ? nothing : *found;
}

const Json& element(const Json& list, std::size_t index) {
  static const Json nothing;
  return list.is_array() && index < list.size() ? list[index] : nothing;
}

std::size_t count_of(const Json& list) { return list.is_array() ? list.size() : 0; }

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

std::int64_t integer_of(const Json& value) {
  constexpr double kMax = 9007199254740992.0;  // 2^53
  // Some exporters write integers as "3.0".
  const double number = value.is_number() ? value.get<double>() : -1.0;
  const bool fits = number >= 0.0 && number < kMax && number == double(std::int64_t(number));
  return fits ? std::int64_t(number) : -1;
}

int index_of(const Json& value) {
  constexpr std::int64_t kMax = 1 << 30;
  const std::int64_t index = integer_of(value);
  return index < kMax ? int(index) : -1;
}

const Json& extension_of(const Json& object, const char* name) { return member(member(object, "extensions"), name); }

void JsonFaults::add(const JsonPlace& place, const char* name) {
  if (count++ == 0) first = fmt::format("{}[{}].{}", place.list, place.index, name);
}

double number_in(const Json& object, const char* name, double fallback, double low, double high, const JsonPlace& place,
                 JsonFaults& faults) {
  const Json& value = member(object, name);
  if (value.is_null()) return fallback;
  const double number = value.is_number() ? value.get<double>() : fallback;
  const bool in_range = number >= low && number <= high;
  if (!value.is_number() || !in_range) faults.add(place, name);
  return number >= low ? std::min(number, high) : low;
}

glm::vec3 color_in(const Json& object, const char* name, double fallback, double high, const JsonPlace& place,
                   JsonFaults& faults) {
  const auto c = numbers_in<3>(object, name, {fallback, fallback, fallback}, 0.0, high, place, faults);
  return {float(c[0]), float(c[1]), float(c[2])};
}

std::int64_t integer_in(const Json& object, const char* name, std::int64_t fallback, const JsonPlace& place,
                        JsonFaults& faults) {
  const Json& value = member(object, name);
  if (value.is_null()) return fallback;
  const std::int64_t number = integer_of(value);
  if (number < 0) faults.add(place, name);
  return number < 0 ? fallback : number;
}

}  // namespace umbrage
