// Conversion between Camera and OpenEXR's matrices, as ImfStandardAttributes.h defines them.
#include "io/exr_camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace umbrage {
namespace {

/// Tolerance of matrix elements. The matrices come from float attributes; inverting one of them adds to their error.
constexpr double kTolerance = 1e-3;

/// Returns the matrix with z flipped: Camera looks along -z of view space, OpenEXR's camera along +z.
glm::dmat4 with_z_flipped(glm::dmat4 m) {
  for (int i = 0; i < 4; ++i) m[i][2] = -m[i][2];
  return m;
}

bool is_rigid(const glm::dmat4& m) {
  const glm::dmat3 rotation(m);
  const glm::dmat3 product = glm::transpose(rotation) * rotation;
  double deviation = std::abs(m[0][3]) + std::abs(m[1][3]) + std::abs(m[2][3]) + std::abs(m[3][3] - 1.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) deviation += std::abs(product[i][j] - (i == j ? 1.0 : 0.0));
  return deviation <= kTolerance;  // false for NaN
}

}  // namespace

ExrCamera exr_camera(const Camera& camera, const glm::dmat4& view_from_world) {
  ExrCamera out;
  out.camera_from_world = with_z_flipped(view_from_world);
  const double width = double(camera.right) - camera.left, height = double(camera.top) - camera.bottom;
  // u and v follow from the camera's x, y and depth d. Perspective: u = (x / d - left) / width, v = (top - y / d) /
  // height.
  glm::dmat4 ndc(0.0);
  ndc[0][0] = 1.0 / width;
  ndc[1][1] = -1.0 / height;
  ndc[2][2] = 1.0;
  const bool perspective = camera.projection == Projection::kPerspective;
  glm::dvec4& offset = ndc[perspective ? 2 : 3];
  offset[0] = -camera.left / width;
  offset[1] = camera.top / height;
  offset[3] = 1.0;
  if (perspective) ndc[3][2] = -1.0;
  out.ndc_from_world = ndc * out.camera_from_world;
  return out;
}

std::optional<Camera> camera_from(const ExrCamera& matrices) {
  if (!is_rigid(matrices.camera_from_world)) return std::nullopt;
  const glm::dmat4 ndc = matrices.ndc_from_world * glm::inverse(matrices.camera_from_world);
  // The columns of ndc are for the camera's x, y, depth and the constant 1; rows 0, 1 and 3 give u, v and w. w may
  // depend only on the depth (perspective) or only on the constant (parallel): on column `used`, which also holds the
  // offset of the window. u may depend on x and that column, v on y and that column. Column `other` must be zero.
  const bool perspective = std::abs(ndc[2][3]) > std::abs(ndc[3][3]);
  const int used = perspective ? 2 : 3, other = perspective ? 3 : 2;
  const double w = ndc[used][3];
  // Rounding errors of the constants grow with the distance from the world's origin.
  const double reach = 1.0 + glm::length(glm::dvec3(matrices.camera_from_world[3]));
  const double other_sum = std::abs(ndc[other][0]) + std::abs(ndc[other][1]) + std::abs(ndc[other][3]);
  const double error_sum = std::abs(ndc[0][3]) + std::abs(ndc[1][3]) + std::abs(ndc[1][0]) + std::abs(ndc[0][1]) +
                           (perspective ? other_sum / reach : other_sum);
  if (!(error_sum <= kTolerance * std::abs(w))) return std::nullopt;
  Camera camera;
  camera.view_from_world = glm::mat4(with_z_flipped(matrices.camera_from_world));
  camera.projection = perspective ? Projection::kPerspective : Projection::kOrthographic;
  camera.left = float(-ndc[used][0] / ndc[0][0]);
  camera.right = float((w - ndc[used][0]) / ndc[0][0]);
  camera.top = float(-ndc[used][1] / ndc[1][1]);
  camera.bottom = float((w - ndc[used][1]) / ndc[1][1]);
  const float width = camera.right - camera.left, height = camera.top - camera.bottom;
  if (!(width > 0.0f && height > 0.0f && std::isfinite(width) && std::isfinite(height))) return std::nullopt;
  return camera;
}

}  // namespace umbrage
