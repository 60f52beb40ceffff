#include "gbuffers/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "core/eigen.h"
#include "core/lists.h"

namespace umbrage {
namespace {

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Returns the rotation that maximizes the sum of dot(to, R from).
glm::dmat3 rotation_of(const glm::dmat3& m) {
  // m[i][j] is the sum of from[i] * to[j].
  const double xx = m[0][0], xy = m[0][1], xz = m[0][2], yx = m[1][0], yy = m[1][1], yz = m[1][2], zx = m[2][0],
               zy = m[2][1], zz = m[2][2];
  const SymmetricMatrix<4> n = {{{xx + yy + zz, yz - zy, zx - xz, xy - yx},
                                 {yz - zy, xx - yy - zz, xy + yx, zx + xz},
                                 {zx - xz, xy + yx, yy - xx - zz, yz + zy},
                                 {xy - yx, zx + xz, yz + zy, zz - xx - yy}}};
  const EigenSystem<4> eigen = eigen_of(n);
  const auto& q = eigen.vectors[3];
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  const glm::dmat3 rotation(glm::dvec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
                            glm::dvec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
                            glm::dvec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)));
  return rotation;
}

std::vector<double> angles_of(const DirectionPairs& pairs, const glm::dmat3& m) {
  std::vector<double> angles(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) angles[k] = angle_between(m * pairs.from[k], pairs.to[k]);
  return angles;
}

// Pairs beyond this multiple of this quantile are outliers. A lower quantile would leave only one large plane.
constexpr double kTrimmed = 1.5, kTrimmedQuantile = 0.75;
/// Angles below this are rounding errors, which tell nothing, radians.
constexpr double kRounding = 1e-4;

}  // namespace

DirectionFit rate_directions(const DirectionPairs& pairs, const glm::dmat3& matrix) {
  DirectionFit fit;
  fit.matrix = matrix;
  if (pairs.from.empty()) return fit;
  const std::vector<double> angles = angles_of(pairs, matrix);
  const double median = quantile(angles, 0.5);
  const double outer = quantile(angles, kTrimmedQuantile);
  fit.median_deg = median * 180.0 / std::numbers::pi;
  fit.score_deg = (median + outer) / 2.0 * 180.0 / std::numbers::pi;
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < angles.size(); ++k)
    if (angles[k] <= kTrimmed * outer) {
      sum += pairs.weights[k] * angles[k] * angles[k];
      weights += pairs.weights[k];
    }
  fit.squares = weights > 0.0 ? sum / weights : 0.0;
  return fit;
}

DirectionFit fit_directions(const DirectionPairs& pairs, bool may_mirror) {
  constexpr int kRounds = 5;
  DirectionFit best;
  if (pairs.size() < 3) return best;
  for (const double sign : {1.0, -1.0}) {
    if (sign < 0.0 && !may_mirror) break;
    std::vector<char> used(pairs.size(), 1);
    glm::dmat3 matrix(1.0);
    for (int round = 0; round < kRounds; ++round) {
      glm::dmat3 sums(0.0);
      for (std::size_t k = 0; k < pairs.size(); ++k)
        if (used[k])
          for (int i = 0; i < 3; ++i) sums[i] += sign * pairs.weights[k] * pairs.from[k][i] * pairs.to[k];
      matrix = sign * rotation_of(sums);
      const std::vector<double> angles = angles_of(pairs, matrix);
      const double limit = std::max(kRounding, kTrimmed * quantile(angles, kTrimmedQuantile));
      for (std::size_t k = 0; k < pairs.size(); ++k) used[k] = angles[k] <= limit;
    }
    const DirectionFit fit = rate_directions(pairs, matrix);
    // A mirrored match must be clearly better: with few different directions both fit.
    constexpr double kClearly = 0.7;
    if (sign > 0.0 || fit.score_deg < kClearly * best.score_deg - kRounding * 180.0 / std::numbers::pi) best = fit;
  }
  return best;
}

namespace {

/// A projection matrix, its rows applied to (x, y, z, 1) of normalized points.
using Rows34 = std::array<std::array<double, 4>, 3>;

/// Points and pixels moved and scaled to about unit size.
struct Normalized {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec2> pixels;
  glm::dvec3 shift{0};
  double scale = 1.0;
  double pixel_scale = 1.0;
  glm::dvec2 pixel_shift{0};
};

Normalized normalized(std::span<const glm::dvec3> points, std::span<const glm::dvec2> pixels, int width, int height) {
  Normalized out;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const glm::dvec3& p : points) values.push_back(p[axis]);
    out.shift[axis] = quantile(values, 0.5);
  }
  std::vector<double> distances;
  for (const glm::dvec3& p : points) distances.push_back(glm::length(p - out.shift));
  const double typical = quantile(distances, 0.5);
  out.scale = typical > 0.0 ? 1.0 / typical : 1.0;
  out.pixel_shift = {width / 2.0, height / 2.0};
  out.pixel_scale = 2.0 / std::max(width, height);
  for (const glm::dvec3& p : points) out.points.push_back((p - out.shift) * out.scale);
  for (const glm::dvec2& p : pixels) out.pixels.push_back((p - out.pixel_shift) * out.pixel_scale);
  return out;
}

/// Returns the projection of the used points; nothing if it is not unique.
std::optional<Rows34> linear_fit(const Normalized& data, const std::vector<char>& used) {
  SymmetricMatrix<12> sums{};
  const auto add = [&](const std::array<double, 12>& row) {
    for (std::size_t i = 0; i < 12; ++i)
      if (row[i] != 0.0)
        for (std::size_t j = 0; j < 12; ++j) sums[i][j] += row[i] * row[j];
  };
  for (std::size_t k = 0; k < data.points.size(); ++k) {
    if (!used[k]) continue;
    const glm::dvec3& p = data.points[k];
    const glm::dvec2& q = data.pixels[k];
    add({p.x, p.y, p.z, 1.0, 0, 0, 0, 0, -q.x * p.x, -q.x * p.y, -q.x * p.z, -q.x});
    add({0, 0, 0, 0, p.x, p.y, p.z, 1.0, -q.y * p.x, -q.y * p.y, -q.y * p.z, -q.y});
  }
  const EigenSystem<12> eigen = eigen_of(sums);
  constexpr double kUnique = 1e-9;  // ratio of the second eigenvalue to the last: points in a plane have none
  if (!(eigen.values[1] > kUnique * eigen.values[11])) return std::nullopt;
  Rows34 rows;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) rows[r][c] = eigen.vectors[0][4 * r + c];
  return rows;
}

double applied(const std::array<double, 4>& row, const glm::dvec3& p) {
  return row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
}

/// Returns the distance of each projected point from its pixel, in normalized pixels.
std::vector<double> distances_of(const Normalized& data, const Rows34& rows) {
  std::vector<double> out(data.points.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double w = applied(rows[2], data.points[k]);
    const glm::dvec2 q(applied(rows[0], data.points[k]) / w, applied(rows[1], data.points[k]) / w);
    const double d = glm::length(q - data.pixels[k]);
    out[k] = std::isfinite(d) ? d : 1e9;
  }
  return out;
}

glm::dvec3 vector_of(const std::array<double, 4>& row) { return {row[0], row[1], row[2]}; }

/// Splits a parallel projection into axes and scale.
std::optional<ProjectionFit> parallel_camera(const Normalized& data, const Rows34& rows) {
  ProjectionFit fit;
  fit.orthographic = true;
  const double w = rows[2][3];
  const glm::dvec3 across = vector_of(rows[0]) / w, down = vector_of(rows[1]) / w;
  fit.focal = {glm::length(across), glm::length(down)};
  if (!(fit.focal.x > 0.0 && fit.focal.y > 0.0)) return std::nullopt;
  fit.right = across / fit.focal.x;
  fit.up = -down / fit.focal.y;
  constexpr double kSkew = 1e-2;
  if (std::abs(glm::dot(fit.right, fit.up)) > kSkew) return std::nullopt;
  fit.forward = glm::normalize(-glm::cross(fit.right, fit.up));
  fit.up = glm::cross(fit.right, fit.forward);
  fit.center = {rows[0][3] / w, rows[1][3] / w};
  fit.eye = data.shift;  // the normalized origin projects to `center`
  return fit;
}

/// Splits a perspective projection into axes, eye, focal length and centre.
std::optional<ProjectionFit> pinhole_camera(const Normalized& data, Rows34 rows) {
  double length = glm::length(vector_of(rows[2]));
  int ahead = 0;
  for (const glm::dvec3& p : data.points) ahead += applied(rows[2], p) > 0.0 ? 1 : -1;
  if (ahead < 0) length = -length;
  for (auto& row : rows)
    for (double& v : row) v /= length;
  const glm::dvec3 m0 = vector_of(rows[0]), m1 = vector_of(rows[1]);
  ProjectionFit fit;
  fit.forward = vector_of(rows[2]);
  fit.center = {glm::dot(m0, fit.forward), glm::dot(m1, fit.forward)};
  const glm::dvec3 across = m0 - fit.center.x * fit.forward, down = m1 - fit.center.y * fit.forward;
  fit.focal = {glm::length(across), glm::length(down)};
  if (!(fit.focal.x > 0.0 && fit.focal.y > 0.0)) return std::nullopt;
  fit.right = across / fit.focal.x;
  constexpr double kSkew = 1e-2;
  if (std::abs(glm::dot(fit.right, down / fit.focal.y)) > kSkew) return std::nullopt;
  const glm::dvec3 beside = glm::cross(fit.right, fit.forward);
  fit.up = glm::dot(beside, down) < 0.0 ? beside : -beside;
  const glm::dmat3 m = glm::transpose(glm::dmat3(m0, m1, fit.forward));
  fit.eye = -(glm::inverse(m) * glm::dvec3(rows[0][3], rows[1][3], rows[2][3])) / data.scale + data.shift;
  return fit;
}

}  // namespace

std::optional<ProjectionFit> fit_projection(std::span<const glm::dvec3> points, std::span<const glm::dvec2> pixels,
                                            int width, int height) {
  constexpr std::size_t kMinPoints = 24;  // twice the unknowns of the matrix, twice over
  constexpr int kRounds = 4;
  if (points.size() < kMinPoints) return std::nullopt;
  const Normalized data = normalized(points, pixels, width, height);
  std::vector<char> used(points.size(), 1);
  std::optional<Rows34> rows;
  std::vector<double> distances;
  for (int round = 0; round < kRounds; ++round) {
    rows = linear_fit(data, used);
    if (!rows) return std::nullopt;
    distances = distances_of(data, *rows);
    constexpr double kFew = 3.0, kFloor = 1e-9;
    const double limit = std::max(kFloor, kFew * quantile(distances, 0.5));
    for (std::size_t k = 0; k < used.size(); ++k) used[k] = distances[k] <= limit;
  }
  // In a parallel projection the third row has no part that depends on the point.
  constexpr double kParallel = 1e-4;
  const double slope = glm::length(vector_of((*rows)[2])), constant = std::abs((*rows)[2][3]);
  auto fit = slope < kParallel * constant ? parallel_camera(data, *rows) : pinhole_camera(data, *rows);
  if (!fit) return std::nullopt;
  fit->median_px = quantile(distances, 0.5) / data.pixel_scale;
  fit->center = fit->center / data.pixel_scale + data.pixel_shift;
  fit->focal /= data.pixel_scale;
  if (fit->orthographic) fit->focal *= data.scale;
  return fit;
}

}  // namespace umbrage
