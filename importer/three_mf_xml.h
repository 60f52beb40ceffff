// Access to the XML of 3MF files, whose names may have any prefix of a namespace.
#pragma once
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/vec4.hpp>
#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <type_traits>

#include "scene/readers/read_number.h"

namespace umbrage {

inline std::string_view local_name(const char* name) {
  const char* colon = std::strchr(name, ':');
  return colon ? colon + 1 : name;
}

/// Returns an attribute by its name without the namespace's prefix, of which files may choose any.
inline std::string_view attribute(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_attribute& each : node.attributes())
    if (local_name(each.name()) == name) return each.value();
  return {};
}

inline pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& each : node.children())
    if (local_name(each.name()) == name) return each;
  return {};
}

/// Returns the number at the start of a text; nothing if there is none.
template <class T>
std::optional<T> number(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '+')) text.remove_prefix(1);
  if constexpr (std::is_floating_point_v<T>) {
    const char* at = text.data();
    double value = 0.0;
    const bool found = read_number(at, at + text.size(), value) && std::isfinite(value);
    return found ? std::optional(T(value)) : std::nullopt;
  }
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end != text.data() ? std::optional(value) : std::nullopt;
}

}  // namespace umbrage
