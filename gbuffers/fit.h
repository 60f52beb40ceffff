// Fits: rotations between sets of directions, and the pinhole camera that projects points to pixels.
#pragma once
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace umbrage {

/// Unit vectors, those that they are to be mapped onto, and how much each pair counts.
struct DirectionPairs {
  std::vector<glm::dvec3> from, to;
  std::vector<double> weights;

  std::size_t size() const { return from.size(); }
};

/// An orthogonal matrix, of determinant 1 or -1, and how well it maps directions onto others.
struct DirectionFit {
  glm::dmat3 matrix{1.0};
  double median_deg = 180.0;  ///< angle between mapped and wanted directions
  double score_deg = 180.0;   ///< mean of the median and the outer angles: one large plane alone does not lower it
  double squares = 1e9;       ///< weighted mean of squared angles without outliers, rad^2: smoother than the median
};

/// Returns the rotation, or rotation with mirroring, that maps the unit vectors `from` onto `to` best, by quaternions
/// [Horn 1987]. Outliers are left out in several rounds. With fewer than 3 vectors the median is 180 degrees.
DirectionFit fit_directions(const DirectionPairs& pairs, bool may_mirror);

/// Returns how well a given matrix maps `from` onto `to`.
DirectionFit rate_directions(const DirectionPairs& pairs, const glm::dmat3& matrix);

/// A camera that projects points of some space to pixels.
struct ProjectionFit {
  bool orthographic = false;
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< orthonormal, in the space of the points
  glm::dvec3 eye{0};       ///< in the space of the points; orthographic: any point on the axis through pixel `center`
  glm::dvec2 center{0};    ///< pixel that `forward` goes through
  glm::dvec2 focal{1};     ///< pixels per unit at distance 1; orthographic: pixels per unit
  double median_px = 0.0;  ///< median distance between projected points and their pixels
};

/// Returns the camera that maps `points` to `pixels` (x to the right, y down), by direct linear transformation
/// [Hartley and Zisserman 2003, 7.1] with outliers left out in several rounds; nothing if there is none, as for points
/// in a plane. `width` and `height`: size of the picture.
std::optional<ProjectionFit> fit_projection(std::span<const glm::dvec3> points, std::span<const glm::dvec2> pixels,
                                            int width, int height);

}  // namespace umbrage
