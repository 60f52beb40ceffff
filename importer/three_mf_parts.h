// What the reader of 3MF files consists of: access to their XML, whose names may have any prefix of a namespace; what
// slicers add, as PrusaSlicer 2.7, Bambu Studio 1.9, OrcaSlicer 2 and Cura 5 write it: which parts of a project are the
// model, and the filaments of its parts; beam lattices [3MF beam lattice extension 1.2] as triangles and spheres.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "importer/common/placed_mesh.h"
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

/// A part of an object.
struct SlicerPart {
  std::uint32_t last = std::numeric_limits<std::uint32_t>::max();  ///< its last triangle
  std::string hidden_as;  ///< what it is, in plural, if it is not a part of the model; else empty
  int extruder = 0;       ///< from 1 on; 0: that of the object
};

struct SlicerObject {
  /// By the object that a part is, empty for some triangles of the object itself, and by its first triangle.
  std::map<std::string, std::map<std::uint32_t, SlicerPart>, std::less<>> parts;
  int extruder = 0;  ///< from 1 on; 0: not set
};

struct SlicerProject {
  std::map<std::string, SlicerObject, std::less<>> objects;  ///< by id
  std::vector<std::string> colors;                           ///< of the filament of each extruder, "#RRGGBB"

  void add_objects(const pugi::xml_node& config);
  /// Adds colours from settings as JSON, or as lines "; name = value".
  void add_colors(std::string_view settings);
  /// Returns the part that a triangle belongs to, or null. The parts of an object are disjoint. `root`: the id of the
  /// object that the build names; `object`: that of the object with the mesh.
  const SlicerPart* find(std::string_view root, std::string_view object, std::uint32_t triangle) const;
  /// Returns the colour of a part's filament; empty if none is set.
  std::string_view color(std::string_view root, const SlicerPart* part) const;
};

/// Returns what an object is by its type or Cura's metadata, in plural, if it is not a part of the model; else nothing.
std::string_view hidden_kind(const pugi::xml_node& object);

/// Returns the beams of a mesh, as triangles, and the balls at their ends, as spheres. `vertices`: those of the mesh,
/// world space; `scale`: the factor of lengths from the mesh to world space. Beams between vertices that the mesh does
/// not have are left out.
std::vector<PlacedMesh> beams_of(const pugi::xml_node& lattice, const std::vector<glm::dvec3>& vertices, double scale);

}  // namespace umbrage
