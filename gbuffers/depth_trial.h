// Trials of what depth means: a model of depth and a camera are good if normals rebuilt from the depth agree with the
// stored normals, or, without normals, if flat surfaces come out flat.
#pragma once
#include <glm/vec3.hpp>
#include <vector>

#include "gbuffers/depth_model.h"
#include "gbuffers/fit.h"
#include "gbuffers/samples.h"

namespace umbrage {

/// A sampled pixel with a surface, and surfaces in all neighbours.
struct Cell {
  int x = 0, y = 0;
  double stored[kTaps] = {};  ///< stored depth
  glm::dvec3 normal{0.0};     ///< stored normal, unit; 0: none
};

struct Cells {
  int width = 0, height = 0, reach = 1;
  std::vector<Cell> cells;
  bool have_normals = false;

  /// Returns at most about `count` of the cells, spread evenly over the picture.
  Cells some(std::size_t count) const;
  /// Returns how many clearly different directions the stored normals have.
  int directions() const;
  /// Returns at most about `count` cells whose normals are spread evenly too: one large plane would fit any rotation
  /// and any field of view.
  Cells balanced(std::size_t count) const;
};

struct Trial {
  DepthModel model;
  Camera camera;
  DirectionFit normals;   ///< from stored normals to view space
  double flatness = 1e9;  ///< median of the second differences of depth over its first ones; the lower, the flatter
};

/// Normals rebuilt from depth on smooth surfaces, in view space and facing the camera, with the stored ones.
struct RebuiltNormals {
  DirectionPairs pairs;  ///< from stored to rebuilt ones; flat surfaces, where differences are exact, count more
  double flatness = 1e9;

  /// Returns whether nearly all stored normals are parallel, which leaves a rotation about them open.
  bool have_one_direction() const;
  /// Returns the angle between mapped stored normals and rebuilt ones, both averaged over surfaces of about the same
  /// direction, degrees; the median of all. Normals that are smooth over flat facets deviate, but not in their average.
  double bias_deg(const glm::dmat3& matrix) const;
};
RebuiltNormals rebuild_normals(const Cells& cells, const DepthModel& model, const Camera& camera);

/// Tries one model with a camera.
Trial try_depth(const Cells& cells, const DepthModel& model, const Camera& camera);

/// Returns whether the stored depths are distances in a panorama of all longitudes and latitudes: that explains the
/// samples much better than `best`, the best of all cameras.
bool is_panorama(const Cells& cells, const Trial& best);

/// Returns a symmetric camera. `half_height`: tangent of half the vertical field of view; scene units if orthographic.
Camera symmetric_camera(double half_height, double aspect, Projection projection = Projection::kPerspective);

/// Tries a model with cameras of all fields of view, or of all heights if orthographic, and returns the best;
/// `is_clear`: whether others are worse. `aspect`: width / height of the picture.
Trial try_cameras(const Cells& cells, const DepthModel& model, double aspect, Projection projection, bool& is_clear);

/// Returns whether `other` explains the samples much better than `prior`.
bool is_much_better(const Cells& cells, const Trial& other, const Trial& prior);

}  // namespace umbrage
