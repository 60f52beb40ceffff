// Sections: a finished scene is cut by planes, and what was solid there gets faces in the planes, the caps.
#pragma once
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// A plane that cuts a model.
struct SectionPlane {
  enum class Kept {
    kFar,    ///< the side towards which the default view of the model looks
    kBelow,  ///< what has dot(normal, p) < offset
    kAbove,  ///< what has more
  };
  std::string text;          ///< as in the request
  glm::dvec3 normal{0.0};    ///< unit, in the coordinates of the file
  double offset = 0.0;       ///< dot(normal, p) of its points, in the coordinates of the file
  bool is_fraction = false;  ///< `offset` is a fraction of the model's extent along the axis `normal`
  Kept kept = Kept::kFar;
};

struct SectionSettings {
  std::vector<SectionPlane> planes;
  bool is_blank = false;          ///< caps are white in looks that draw tones by lines
  bool hatched = false;           ///< caps are divided into strips, each an object, between which looks draw lines
  std::optional<glm::vec3> tint;  ///< caps have shades of this colour, linear; not set: a colour for each part
};

/// Returns the planes of a text, separated by commas or spaces: "x=0.4", "x=50%" (of the model's extent from its min
/// x), "x<0.4" and "x>0.4" (what stays), "nx,ny,nz,d" (all with nx x + ny y + nz z < d stays). Errors: kUsage, which
/// names the field `sections`.
Result<std::vector<SectionPlane>> parse_sections(const std::string& text);

/// Returns a text that differs between settings with different results.
std::string key_of(const SectionSettings& settings);

/// Cuts a finished scene, after show_values, since cut meshes lose their fields: what remains is on the kept side of
/// all planes. Triangles are clipped, points stay or go by their centres. Parts are sets of triangles of one object
/// that are connected at equal positions, with the cavities in them; those of an object that are not closed are one
/// part. Where a plane cuts a closed part, the cut is filled by a cap in the plane, which faces what was removed; a
/// part's caps are an object, with a matt material. Cracks up to 3/1000 of the cut's size are closed, and gaps in a
/// chain of edges up to a tenth of its size; edges that are still open get no cap. Warnings count such parts.
/// Scene::ground_object stays whole. The scene as it was becomes Scene::start, and the points around it Scene::motion,
/// so that the camera, the exposure and lengths relative to the model do not depend on the planes. Faces in a plane
/// belong to the removed side. Errors: kUsage if a plane misses the model, or nothing is left.
Result<void> cut_scene(const SectionSettings& settings, Scene& scene);

}  // namespace umbrage
