// What slicers add to 3MF files: which parts of a project are the model, and the filaments of its parts. As
// PrusaSlicer 2.7, Bambu Studio 1.9, OrcaSlicer 2 and Cura 5 write it.
#pragma once
#include <cstdint>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// A part of an object.
struct SlicerPart {
  std::string component;  ///< the object that it is; empty: some triangles of the object itself
  std::uint32_t first = 0, last = std::numeric_limits<std::uint32_t>::max();  ///< these
  std::string hidden_as;  ///< what it is, in plural, if it is not a part of the model; else empty
  int extruder = 0;       ///< from 1 on; 0: that of the object
};

struct SlicerObject {
  std::vector<SlicerPart> parts;
  int extruder = 0;  ///< from 1 on; 0: not set
};

struct SlicerProject {
  std::map<std::string, SlicerObject, std::less<>> objects;  ///< by id
  std::vector<std::string> colors;                           ///< of the filament of each extruder, "#RRGGBB"

  void add_objects(const pugi::xml_node& config);
  /// Adds colours from settings as JSON, or as lines "; name = value".
  void add_colors(std::string_view settings);
  /// Returns the part that a triangle belongs to; null if there is none. `root`: the id of the object that the build
  /// names; `object`: that of the object with the mesh.
  const SlicerPart* find(std::string_view root, std::string_view object, std::uint32_t triangle) const;
  /// Returns the colour of a part's filament; empty if none is set.
  std::string_view color(std::string_view root, const SlicerPart* part) const;
};

/// Returns what an object is by its type or Cura's metadata, in plural, if it is not a part of the model; else nothing.
std::string_view hidden_kind(const pugi::xml_node& object);

}  // namespace umbrage
