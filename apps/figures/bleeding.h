// The figures of [Colliander and Törnquist 2015]: what they share, their presets and the drapes of scene:atrium, and
// the figures and diagrams of files of their own.
#pragma once
#include <set>
#include <string_view>
#include <tuple>

#include "apps/figures/studio.h"

namespace umbrage {

inline constexpr const char* kAtrium = "scene:atrium";

struct BleedingPreset {
  std::string_view look, name, tag;  ///< tag: suffix of figure ids and file names
};
inline constexpr BleedingPreset kBleedingPaper = {"bleeding-paper", "paper preset", ""},
                                kBleedingOurs = {"bleeding", "our own", "-ours"};

/// Planes from which the figures are measured.
const std::vector<std::string>& bleeding_planes();

/// Returns a camera; `light_deg`: the sun as seen from it, unless it is the scene's.
Framing bleeding_view(glm::vec3 eye, glm::vec3 target, float angle_deg, std::optional<glm::vec2> light_deg = {});

/// Returns a view of a drape whose lit side faces away, beside a pillar.
Framing unlit_drape_view();

/// Returns the value of the plane `object_id` at the pixels of a mesh.
float object_of(const Studio& studio, std::string_view mesh_name);

/// Returns the number of pixels that are brighter than eight times the median near them. With `without`, the brightness
/// that `shot` adds to it counts.
double spark_count(const Shot& shot, const Shot* without = nullptr);

/// The cells of a grid of 0.1 m that contain cloth, and the objects that are cloth.
class ClothGrid {
 public:
  explicit ClothGrid(const Scene& scene);
  bool has_object(float object_id) const { return objects_.contains(int(object_id)); }
  /// Returns whether there is cloth within `reach` metres.
  bool near(glm::vec3 p, float reach) const;

 private:
  using Cell = std::tuple<int, int, int>;
  static Cell cell(glm::vec3 p);
  std::set<Cell> cells_;
  std::set<int> objects_;
};

/// Draws figures 15 and 16: the side of a pier in front of a drape, whose light ends with the range.
Result<Figure> bleeding_range(Studio& studio);

/// Draws what the discussion of figures 15 and 16 is about: in the paper's preset no light reaches surfaces behind a
/// drape; in ours it does.
Result<Figure> bleeding_behind_drape(Studio& studio, const ClothGrid& cloths);

/// Draws diagrams 2, 3, 4 and 6, from the actual sample tables and planes, for a camera. Sets the framing and look of
/// the studio.
Result<Figure> bleeding_diagrams(Studio& studio, const Framing& view);

}  // namespace umbrage
