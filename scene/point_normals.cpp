// Discs that blend: positions and normals are smoothed over neighbouring points, and normals change across each disc,
// so that the discs of a surface look like one smooth surface [Botsch et al. 2004].
#include "scene/points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/basis.h"

namespace umbrage {
namespace {

// Distance, relative to that of discs that touch, at which the weight of a neighbour would be 0; discs that do not
// overlap have none.
constexpr double kReach = 1.5;
// Added to the variance of the neighbours' positions, as a fraction of the squared reach: few neighbours, or neighbours
// on a line, give no slope rather than a random one.
constexpr double kDamping = 0.001;
// Bound of the slopes of the normal over a disc: of each entry of their matrix, relative to the radius.
constexpr float kMaxBend = 1.0f;

// The second round fits to smoother normals: their slopes are less noisy, and sharper than those of one wider fit.
constexpr int kRounds = 2;
// In each round a disc moves by at most this fraction of its radius.
constexpr double kMaxMove = 0.25;

/// The fit of one disc: the normal at the centre and its slopes.
struct Fit {
  glm::vec3 normal, bend;
};

/// Returns the weight of a neighbour `away` from a disc: 0 if the discs do not overlap. It falls with the distance, and
/// with the angle between their normals, to 0.75 at 22 degrees, 0.06 at 60 and 0 at 90.
double weight_of(const Mesh& mesh, std::size_t i, std::size_t k, const glm::dvec3& away) {
  const double touching = double(mesh.radii[i]) + double(mesh.radii[k]), reach = kReach * touching;
  const double square = glm::dot(away, away);
  if (!(square < touching * touching)) return 0.0;
  const double near = 1.0 - square / (reach * reach);
  const double cosine = glm::dot(glm::dvec3(mesh.normals[i]), glm::dvec3(mesh.normals[k]));
  return near * near * (cosine * cosine) * (cosine * cosine);
}

Fit fit_of(const Mesh& mesh, std::size_t i, std::span<const std::uint32_t> neighbors) {
  const glm::dvec3 center(mesh.positions[i]), normal(mesh.normals[i]);
  glm::vec3 right, up;
  std::tie(right, up) = axes_of_disc(mesh.normals[i]);  // clang 14 captures no structured bindings
  // Weighted least squares of normal(x, y) = a + b x + c y, by the normal equations; x, y relative to the reach.
  glm::dmat3 moments(0.0), sums(0.0);  // columns of `sums`: sum of normals, of x times normals, of y times normals
  const double unit = 2.0 * kReach * double(mesh.radii[i]);
  const auto add = [&](double x, double y, double weight, const glm::dvec3& n) {
    const glm::dvec3 row(1.0, x, y);
    moments += weight * glm::outerProduct(row, row);
    sums += weight * glm::outerProduct(n, row);
  };
  add(0.0, 0.0, 1.0, normal);
  for (const std::uint32_t k : neighbors) {
    const glm::dvec3 away = glm::dvec3(mesh.positions[k]) - center;
    const double weight = weight_of(mesh, i, k, away);
    if (!(weight > 0.0)) continue;
    const glm::dvec3 other(mesh.normals[k]);
    add(glm::dot(away, glm::dvec3(right)) / unit, glm::dot(away, glm::dvec3(up)) / unit, weight,
        glm::dot(other, normal) < 0.0 ? -other : other);
  }
  moments[1][1] += kDamping * moments[0][0];
  moments[2][2] += kDamping * moments[0][0];
  const glm::dmat3 solved = sums * glm::inverse(moments);
  const double length = glm::length(solved[0]);
  if (!(length > 0.0) || !std::isfinite(length)) return {mesh.normals[i], glm::vec3(0.0f)};
  Fit fit{glm::vec3(solved[0] / length), glm::vec3(0.0f)};
  // The slopes in the plane of the fitted normal. A smooth surface has a symmetric matrix of slopes.
  const auto [x_axis, y_axis] = axes_of_disc(fit.normal);
  const double scale = 1.0 / (length * unit);
  const auto slope = [&](const glm::vec3& along) {
    return (solved[1] * double(glm::dot(along, right)) + solved[2] * double(glm::dot(along, up))) * scale;
  };
  const glm::dvec3 by_x = slope(x_axis), by_y = slope(y_axis);
  fit.bend = glm::vec3(glm::dot(by_x, glm::dvec3(x_axis)),
                       0.5 * (glm::dot(by_x, glm::dvec3(y_axis)) + glm::dot(by_y, glm::dvec3(x_axis))),
                       glm::dot(by_y, glm::dvec3(y_axis)));
  const float largest = mesh.radii[i] * std::max({std::abs(fit.bend.x), std::abs(fit.bend.y), std::abs(fit.bend.z)});
  if (!std::isfinite(largest)) return {fit.normal, glm::vec3(0.0f)};
  if (largest > kMaxBend) fit.bend *= kMaxBend / largest;
  return fit;
}

/// Returns the distance along the fitted normal from a point to the curved surface through it and its neighbours.
double height_of(const Mesh& mesh, std::size_t i, const Fit& fit, std::span<const std::uint32_t> neighbors) {
  const auto [right, up] = axes_of_disc(fit.normal);
  double weights = 1.0, sum = 0.0;
  for (const std::uint32_t k : neighbors) {
    const glm::dvec3 away = glm::dvec3(mesh.positions[k]) - glm::dvec3(mesh.positions[i]);
    const double weight = weight_of(mesh, i, k, away);
    const double x = glm::dot(away, glm::dvec3(right)), y = glm::dot(away, glm::dvec3(up));
    // A surface whose normal turns by `bend` falls away by half of that, times the squared distance.
    const double fall = 0.5 * (fit.bend.x * x * x + 2.0 * fit.bend.y * x * y + fit.bend.z * y * y);
    sum += weight * (glm::dot(away, glm::dvec3(fit.normal)) + fall);
    weights += weight;
  }
  const double max = kMaxMove * double(mesh.radii[i]);
  return std::clamp(sum / weights, -max, max);
}

}  // namespace

std::pair<glm::vec3, glm::vec3> axes_of_disc(const glm::vec3& normal) {
  const glm::vec3 right = glm::normalize(glm::cross(normal, axis_beside(normal)));
  return {right, glm::cross(right, normal)};
}

glm::vec3 bent_normal(const glm::vec3& normal, const glm::vec3& bend, const glm::vec3& offset) {
  const auto [right, up] = axes_of_disc(normal);
  const float x = glm::dot(offset, right), y = glm::dot(offset, up);
  return glm::normalize(normal + right * (bend.x * x + bend.y * y) + up * (bend.y * x + bend.z * y));
}

void blend_discs(Mesh& mesh, std::span<const std::uint32_t> neighbors, int count) {
  const std::size_t size = mesh.positions.size();
  std::vector<glm::vec3> positions(size), normals(size);
  mesh.bends.resize(size);
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const auto own = neighbors.subspan(i * std::size_t(count), std::size_t(count));
        const Fit fit = fit_of(mesh, i, own);
        positions[i] = mesh.positions[i] + fit.normal * float(height_of(mesh, i, fit, own));
        normals[i] = fit.normal;
        mesh.bends[i] = fit.bend;
      }
    });
    std::swap(mesh.positions, positions);
    std::swap(mesh.normals, normals);
  }
}

}  // namespace umbrage
