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
#include <tuple>
#include <vector>

#include "core/basis.h"

namespace umbrage {
namespace {

// Distance, relative to that of discs that touch, at which the weight of a neighbour would be 0; discs that do not
// overlap have none.
constexpr float kReach = 1.5f;
// Added to the variance of the neighbours' positions, as a fraction of the squared reach: few neighbours, or neighbours
// on a line, give no slope rather than a random one.
constexpr float kDamping = 0.001f;
// Bound of the slopes of the normal over a disc: of each entry of their matrix, relative to the radius.
constexpr float kMaxBend = 1.0f;

// The second round fits to smoother normals: their slopes are less noisy, and sharper than those of one wider fit.
constexpr int kRounds = 2;
// In each round a disc moves by at most this fraction of its radius.
constexpr float kMaxMove = 0.25f;

/// A disc that overlaps another one, relative to that.
struct Overlapping {
  glm::vec3 away, normal;
  float weight;
};

using Overlaps = std::vector<Overlapping>;

/// Sets `overlaps` to the discs that overlap one. Their weight falls with the distance, and with the angle between the
/// normals, to 0.75 at 22 degrees, 0.06 at 60 and 0 at 90.
void find_overlaps(const Mesh& mesh, std::size_t i, std::span<const std::uint32_t> neighbors, Overlaps& overlaps) {
  overlaps.clear();
  for (const std::uint32_t k : neighbors) {
    const glm::vec3 away = mesh.positions[k] - mesh.positions[i];
    const glm::vec3 relative = away / (mesh.radii[i] + mesh.radii[k]);
    const float square = glm::dot(relative, relative);
    if (!(square < 1.0f)) continue;
    const float near = 1.0f - square / (kReach * kReach), cosine = glm::dot(mesh.normals[i], mesh.normals[k]);
    overlaps.push_back({away, cosine < 0.0f ? -mesh.normals[k] : mesh.normals[k],
                        near * near * (cosine * cosine) * (cosine * cosine)});
  }
}

/// The fit of one disc: the normal at the centre and its slopes along the axes of the disc with that normal.
struct Fit {
  glm::vec3 normal, right, up, bend{0.0f};
  explicit Fit(const glm::vec3& unit) : normal(unit) { std::tie(right, up) = axes_of_disc(unit); }
};

Fit fit_of(const glm::vec3& normal, float radius, const Overlaps& overlaps) {
  const Fit unfitted(normal);
  // Weighted least squares of normal(x, y) = a + b x + c y, by the normal equations; x, y relative to the reach.
  glm::mat3 moments(0.0f), sums(0.0f);  // columns of `sums`: sum of normals, of x times normals, of y times normals
  const float unit = 2.0f * kReach * radius;
  moments[0][0] = 1.0f, sums[0] = normal;  // of the disc itself
  for (const Overlapping& other : overlaps) {
    const glm::vec3 row(1.0f, glm::dot(other.away, unfitted.right) / unit, glm::dot(other.away, unfitted.up) / unit);
    moments += glm::outerProduct(row, other.weight * row);
    sums += glm::outerProduct(other.weight * other.normal, row);
  }
  moments[1][1] += kDamping * moments[0][0];
  moments[2][2] += kDamping * moments[0][0];
  const glm::mat3 solved = sums * glm::inverse(moments);
  const float length = glm::length(solved[0]);
  if (!(length > 0.0f) || !std::isfinite(length)) return unfitted;
  Fit fit(solved[0] / length);
  // The slopes in the plane of the fitted normal. A smooth surface has a symmetric matrix of slopes.
  const float scale = 1.0f / (length * unit);
  const auto slope = [&](const glm::vec3& along) {
    return (solved[1] * glm::dot(along, unfitted.right) + solved[2] * glm::dot(along, unfitted.up)) * scale;
  };
  const glm::vec3 by_x = slope(fit.right), by_y = slope(fit.up);
  const glm::vec3 bend(glm::dot(by_x, fit.right), 0.5f * (glm::dot(by_x, fit.up) + glm::dot(by_y, fit.right)),
                       glm::dot(by_y, fit.up));
  const float largest = radius * std::max({std::abs(bend.x), std::abs(bend.y), std::abs(bend.z)});
  if (std::isfinite(largest)) fit.bend = largest > kMaxBend ? bend * (kMaxBend / largest) : bend;
  return fit;
}

/// Returns the distance along the fitted normal from a point to the curved surface through it and its neighbours.
float height_of(const Fit& fit, float radius, const Overlaps& overlaps) {
  float weights = 1.0f, sum = 0.0f;
  for (const Overlapping& other : overlaps) {
    const float x = glm::dot(other.away, fit.right), y = glm::dot(other.away, fit.up);
    // A surface whose normal turns by `bend` falls away by half of that, times the squared distance.
    const float fall = 0.5f * (fit.bend.x * x * x + 2.0f * fit.bend.y * x * y + fit.bend.z * y * y);
    sum += other.weight * (glm::dot(other.away, fit.normal) + fall);
    weights += other.weight;
  }
  return std::clamp(sum / weights, -kMaxMove * radius, kMaxMove * radius);
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
      Overlaps overlaps;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const auto own = neighbors.subspan(i * std::size_t(count), std::size_t(count));
        find_overlaps(mesh, i, own, overlaps);
        const Fit fit = fit_of(mesh.normals[i], mesh.radii[i], overlaps);
        positions[i] = mesh.positions[i] + fit.normal * height_of(fit, mesh.radii[i], overlaps);
        normals[i] = fit.normal;
        mesh.bends[i] = fit.bend;
      }
    });
    std::swap(mesh.positions, positions);
    std::swap(mesh.normals, normals);
  }
}

}  // namespace umbrage
