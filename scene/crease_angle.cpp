// The crease angle of a mesh without normals: from how its faces meet, whether it is a part with edges or a scan.
// Differs from published methods, which find sharp edges on scans: this one decides only whether a mesh has any.
#include "scene/crease_angle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numeric>

namespace umbrage {
namespace {

using Index = MeshIndex;

constexpr int kGapDeg = 6;  // width of the range without edges below the creases
constexpr int kMinCreaseDeg =
    int(kMinBendDeg) + kGapDeg;  // the first angle whose edges may be creases: a cylinder of 12 sides bends by 30
constexpr int kMaxDeg = 180;

/// Fraction of the length of creases that the edges in the gap may have.
constexpr double kMaxInGap = 0.04;

/// A face is flat beside an edge if another of its edges bends by less than this fraction of that edge's bend: faces of
/// parts are polygons, of which triangles have an edge without bend, or strips of a finely divided curve.
constexpr float kFlatFraction = 1.0f / 6.0f;

/// Regular polygons of 11 and 12 sides stand for circles: their bends are less than this, equal, and equally far apart.
constexpr float kMaxRoundDeg = 35.0f;
constexpr float kSameBend = 0.1f;   // max difference of equal bends, fraction of the bend
constexpr float kSameWidth = 1.5f;  // max ratio of equal widths

float cos_to(const MeshCorners& corners, Index face, const EdgeNeighbor& other) {
  const float cosine = glm::dot(corners.faces[face].normal, corners.faces[other.face].normal);
  return other.same_direction ? -cosine : cosine;
}

float bend_to(const MeshCorners& corners, Index face, const EdgeNeighbor& other) {
  return glm::degrees(std::acos(std::clamp(cos_to(corners, face, other), -1.0f, 1.0f)));
}

/// The min bend over the edges of each face, computed when first used.
class MinBends {
 public:
  explicit MinBends(const MeshCorners& corners) : corners_(corners) {}

  float of(Index face) {
    if (min_bend_.empty()) min_bend_.assign(corners_.faces.size(), kUnknown);
    float& result = min_bend_[face];
    if (result != kUnknown) return result;
    result = float(kMaxDeg);
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const EdgeNeighbor other = edge_neighbor(corners_, corner);
      if (other.face == kNoIndex32) continue;
      result = std::min(result, bend_to(corners_, face, other));
    }
    return result;
  }

 private:
  static constexpr float kUnknown = -1.0f;
  const MeshCorners& corners_;
  std::vector<float> min_bend_;
};

/// Returns the width of a triangle across its edge that starts at a corner.
float width_across(const MeshCorners& corners, Index corner) {
  const auto at = [&](Index c) { return glm::dvec3(corners.mesh->positions[corners.mesh->indices[c]]); };
  const glm::dvec3 from = at(corner), edge = at(next_corner(corner)) - from, side = at(previous_corner(corner)) - from;
  return float(glm::length(glm::cross(edge, side)) / glm::length(edge));
}

/// Returns whether the edge on the other side of a strip bends as much as the edge that starts at `corner`. The face of
/// `corner` and another form the strip, a flat quadrilateral.
bool is_bend_repeated(const MeshCorners& corners, Index corner, float bend) {
  for (const Index diagonal : {next_corner(corner), previous_corner(corner)}) {
    const EdgeNeighbor half = edge_neighbor(corners, diagonal);
    if (half.face == kNoIndex32 || bend_to(corners, corner / 3, half) >= kFlatFraction * bend) continue;
    const Index shared = corners.point(diagonal == next_corner(corner) ? diagonal : corner);
    for (Index c = 3 * half.face; c < 3 * half.face + 3; ++c) {
      if (corners.point(c) != shared) continue;
      const EdgeNeighbor beyond = edge_neighbor(corners, next_corner(c));
      if (beyond.face == kNoIndex32) return false;
      return std::abs(bend_to(corners, half.face, beyond) - bend) < kSameBend * bend;
    }
  }
  return false;
}

/// Returns whether the edge that starts at corner `a` in one face, and at `b` in the other, is one of a round surface.
bool is_round(const MeshCorners& corners, Index a, Index b, float bend) {
  if (bend >= kMaxRoundDeg) return false;
  const float width_a = width_across(corners, a), width_b = width_across(corners, b);
  return std::max(width_a, width_b) < kSameWidth * std::min(width_a, width_b) && is_bend_repeated(corners, a, bend) &&
         is_bend_repeated(corners, b, bend);
}

/// Lengths of edges by whole degrees of their bend.
using Histogram = std::array<double, kMaxDeg + 1>;

float crease_from(const Histogram& edges, const Histogram& creases, const Histogram& round) {
  double above = std::accumulate(creases.begin() + kMinCreaseDeg, creases.end(), 0.0);
  double round_above = std::accumulate(round.begin() + kMinCreaseDeg, round.end(), 0.0);
  for (int angle = kMinCreaseDeg; angle < int(kSmoothCreaseDeg); ++angle) {
    double in_gap = round_above;
    for (int i = angle - kGapDeg; i < angle; ++i) in_gap += edges[i];
    if (in_gap < kMaxInGap * above) return float(angle) - kGapDeg / 2.0f;
    above -= creases[angle];
    round_above -= round[angle];
  }
  return kSmoothCreaseDeg;
}

}  // namespace

std::vector<std::uint8_t> rough_points(const MeshCorners& corners) {
  const float max_cos = std::cos(glm::radians(kMinBendDeg)), half_cos = std::cos(glm::radians(kMinBendDeg / 2.0f));
  constexpr std::size_t kMaxCompared = 16;  // bounds the work at points where thousands of faces meet
  std::vector<std::uint8_t> rough(corners.vertices.point_count);
  std::vector<glm::vec3> normals;
  for (Index p = 0; p < corners.vertices.point_count; ++p) {
    const std::span<const Index> around = corners.lists.around(p);
    glm::vec3 sum(0.0f);
    for (const Index corner : around) sum += corners.normal(corner);
    const float min = half_cos * glm::length(sum);
    const auto is_near_mean = [&](Index corner) { return min > 0.0f && glm::dot(sum, corners.normal(corner)) >= min; };
    if (std::all_of(around.begin(), around.end(), is_near_mean)) continue;
    normals.clear();
    for (const Index corner : around) normals.push_back(corners.normal(corner));
    rough[p] = normals.size() > kMaxCompared;
    for (std::size_t i = 1; i < normals.size() && !rough[p]; ++i)
      for (std::size_t j = 0; j < i; ++j) rough[p] |= glm::dot(normals[i], normals[j]) < max_cos;
  }
  return rough;
}

EdgeSurvey survey_edges(const MeshCorners& corners, const std::vector<std::uint8_t>& rough, Poll* poll) {
  EdgeSurvey survey;
  Histogram edges{}, creases{}, round{};
  MinBends min_bends(corners);
  const float max_cos = std::cos(glm::radians(kMinBendDeg));
  const auto position = [&](Index corner) {
    return glm::dvec3(corners.mesh->positions[corners.mesh->indices[corner]]);
  };
  for (Index p = 0; p < rough.size(); ++p) {
    if (stops(poll, p, rough.size())) return survey;
    if (!rough[p]) continue;
    for (const Index corner : corners.lists.around(p)) {
      const EdgeNeighbor other = edge_neighbor(corners, corner);
      if (other.face == kNoIndex32) continue;
      survey.mixed_winding |= other.same_direction;
      const Index face = corner / 3;
      if (face < other.face) continue;  // counted from the other face
      if (!(cos_to(corners, face, other) <= max_cos)) continue;
      const float bend = bend_to(corners, face, other);
      const double length = glm::distance(position(corner), position(next_corner(corner)));
      edges[int(bend)] += length;
      if (bend < kMinCreaseDeg) continue;
      const float flat = kFlatFraction * bend;
      if (min_bends.of(face) >= flat || min_bends.of(other.face) >= flat) continue;
      (is_round(corners, corner, other.corner, bend) ? round : creases)[int(bend)] += length;
    }
  }
  survey.crease_deg = crease_from(edges, creases, round);
  return survey;
}

}  // namespace umbrage
