#include "gbuffers/repair.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <mutex>
#include <optional>

namespace umbrage {
namespace {

constexpr float kNoSurface = std::numeric_limits<float>::infinity();
// A smaller step between two surfaces, in pixel sizes, leaves no visible fringe.
constexpr float kMinStep = 4.0f;
// The step of a discontinuity is at least this many times what either surface changes by from pixel to pixel: else
// curved and noisy surfaces would have discontinuities.
constexpr float kMinContrast = 4.0f;
// Fraction of the step by which a mixed depth differs from either surface, less than one of 16 samples: smaller
// differences are the curvature of one surface.
constexpr float kMinMixture = 0.04f;
// Mixed pixels in a row: filters of renderers are up to three pixels wide.
constexpr int kMaxWidth = 2;

struct Offset {
  int x = 0, y = 0;
};
constexpr std::array<Offset, 4> kDirections = {Offset{1, 0}, Offset{0, 1}, Offset{1, 1}, Offset{1, -1}};

/// One side of a pixel along a line: a surface that two pixels show, or none.
struct Side {
  bool surface = false;      ///< false: neither pixel shows a surface
  float depth = kNoSurface;  ///< of the surface's plane at the pixel in question
  float slope = 0.0f;        ///< change of that depth per pixel, >= 0
  Offset at;                 ///< the nearer of the two pixels
};

/// The planes that are repaired, and the measure of depths.
class Edges {
 public:
  Edges(const Image& rows, float pixel_size, bool orthographic)
      : width_(rows.width), height_(rows.height), pixel_size_(pixel_size), orthographic_(orthographic) {
    depth_ = &rows.plane("depth");
    for (std::size_t k = 0; k < 3; ++k) normal_[k] = rows.find(std::array{"normal.x", "normal.y", "normal.z"}[k]);
  }

  bool has_normals() const { return normal_[0] && normal_[1] && normal_[2]; }
  bool contains(Offset p) const { return p.x >= 0 && p.x < width_ && p.y >= 0 && p.y < height_; }
  float depth(Offset p) const { return depth_->at(p.x, p.y); }
  glm::vec3 normal(Offset p) const {
    return {normal_[0]->at(p.x, p.y), normal_[1]->at(p.x, p.y), normal_[2]->at(p.x, p.y)};
  }
  float pixel_size(float depth) const { return orthographic_ ? pixel_size_ : pixel_size_ * depth; }

  /// Returns the side that the pixels p + distance * step and the one beyond show; empty if they lie outside, or only
  /// one shows a surface, or their plane does not reach the pixel p.
  std::optional<Side> side(Offset p, Offset step, int distance) const {
    const Offset near{p.x + distance * step.x, p.y + distance * step.y}, far{near.x + step.x, near.y + step.y};
    if (!contains(far)) return std::nullopt;
    const float a = depth(near), b = depth(far);
    if (!std::isfinite(a) && !std::isfinite(b)) return Side{.at = near};
    if (!std::isfinite(a) || !std::isfinite(b)) return std::nullopt;
    const float reach = float(distance);
    float predicted = a + reach * (a - b);
    if (!orthographic_) {  // inverse depth is linear in the picture
      const float inverse = 1.0f / a + reach * (1.0f / a - 1.0f / b);
      if (!(inverse > 0.0f)) return std::nullopt;
      predicted = 1.0f / inverse;
    }
    return Side{true, predicted, std::abs(a - b), near};
  }

  /// Returns whether the step between two depths is a discontinuity, for surfaces with these slopes.
  bool is_step(float a, float b, float slope) const {
    const float step = std::abs(a - b);
    return step > kMinStep * pixel_size(std::min(a, b)) && step > kMinContrast * slope;
  }

 private:
  int width_, height_;
  float pixel_size_;
  bool orthographic_;
  const Plane* depth_;
  std::array<const Plane*, 3> normal_{};
};

/// Returns the fraction of a pixel that a surface of depth `surface` covers before a background, from the averaged
/// depth `mixed`. The background's depth was 0, or one of the values that renderers write.
float covered_before_background(float surface, float mixed) {
  if (mixed < surface) return mixed / surface;
  constexpr std::array kBackgrounds = {65504.0f, 1e10f, std::numeric_limits<float>::max()};
  for (const float background : kBackgrounds)
    if (mixed < background && surface < background) return (background - mixed) / (background - surface);
  return 0.0f;
}

/// Returns the side that a mixed pixel belongs to; empty if the pixel lies between no such two sides.
std::optional<Side> side_of_mixture(const Edges& edges, float depth, const Side& a, const Side& b) {
  if (!a.surface && !b.surface) return std::nullopt;
  if (a.surface && b.surface) {
    if (!edges.is_step(a.depth, b.depth, std::max(a.slope, b.slope))) return std::nullopt;
    const float of_b = (depth - a.depth) / (b.depth - a.depth);
    if (!(of_b > kMinMixture && of_b < 1.0f - kMinMixture)) return std::nullopt;
    return of_b < 0.5f ? a : b;
  }
  const Side& surface = a.surface ? a : b;
  const Side& background = a.surface ? b : a;
  if (!edges.is_step(surface.depth, depth, surface.slope)) return std::nullopt;
  return covered_before_background(surface.depth, depth) >= 0.5f ? surface : background;
}

/// Returns whether the pixel p lies on the surface that pixels around it show. Along an edge its neighbours in two
/// opposite directions may be mixed as it is; a third direction is proof.
bool is_on_surface(const Edges& edges, Offset p) {
  constexpr float kMaxDistance = 0.5f;  // from a surface's plane, in pixel sizes and in its slopes per pixel
  constexpr int kProof = 3;
  const float depth = edges.depth(p);
  int directions = 0;
  for (const Offset& step : kDirections)
    for (const int sign : {1, -1})
      if (const auto side = edges.side(p, {sign * step.x, sign * step.y}, 1); side && side->surface)
        directions += std::abs(side->depth - depth) <= kMaxDistance * std::max(edges.pixel_size(depth), side->slope);
  return directions >= kProof;
}

/// Returns the side that the pixel p gets its values from, if it is mixed. Nearer sides are more reliable.
std::optional<Side> repaired_side(const Edges& edges, Offset p) {
  const float depth = edges.depth(p);
  if (!std::isfinite(depth) || is_on_surface(edges, p)) return std::nullopt;
  for (int total = 2; total <= 2 * kMaxWidth; ++total)
    for (const Offset& step : kDirections)
      for (int first = std::max(1, total - kMaxWidth); first <= std::min(kMaxWidth, total - 1); ++first) {
        const auto a = edges.side(p, step, first), b = edges.side(p, {-step.x, -step.y}, total - first);
        if (!a || !b) continue;
        if (const auto side = side_of_mixture(edges, depth, *a, *b)) return side;
      }
  return std::nullopt;
}

/// The normals beside a discontinuity: of the pixel, of its own surface next to it, and of the other one.
struct NormalsAtEdge {
  glm::vec3 here{0.0f}, own{0.0f}, other{0.0f};
  float bend = 0.0f;  ///< change of the own surface's normal per pixel
  Offset own_at;

  /// Returns whether the pixel's normal has some of the other side's, more than the surface itself bends.
  bool is_mixed() const {
    constexpr float kMinDifference = 0.3f, kMinFraction = 0.1f, kMinBend = 0.05f;  // lengths of normals' differences
    const glm::vec3 across = other - own;
    const float square = glm::dot(across, across);
    if (square < kMinDifference * kMinDifference) return false;
    return glm::dot(here - own, across) > kMinFraction * square && glm::length(here - own) > 2.0f * bend + kMinBend;
  }
};

/// Returns the normals if the pixel p belongs to the surface against `step`, which ends before the pixel p + step.
std::optional<NormalsAtEdge> normals_at_edge(const Edges& edges, Offset p, Offset step) {
  const float depth = edges.depth(p);
  const auto own = edges.side(p, {-step.x, -step.y}, 1), other = edges.side(p, step, 1);
  if (!std::isfinite(depth) || !own || !other || !own->surface || !other->surface) return std::nullopt;
  if (!edges.is_step(depth, other->depth, std::max(own->slope, other->slope))) return std::nullopt;
  if (edges.is_step(depth, own->depth, 0.0f)) return std::nullopt;
  const Offset beyond{own->at.x - step.x, own->at.y - step.y};
  const glm::vec3 of_own = edges.normal(own->at);
  // A thin fold turns within two pixels, so that neither of these tells what the normal was: they must agree.
  constexpr float kMaxBend = 0.25f;  // length of the difference of the normals
  if (!(glm::length(of_own - edges.normal(beyond)) < kMaxBend)) return std::nullopt;
  return NormalsAtEdge{.here = edges.normal(p),
                       .own = of_own,
                       .other = edges.normal(other->at),
                       .bend = glm::length(of_own - edges.normal(beyond)),
                       .own_at = own->at};
}

/// Returns the pixel whose normal the pixel p gets, if its own is mixed.
std::optional<Offset> repaired_normal(const Edges& edges, Offset p) {
  for (const Offset& direction : kDirections)
    for (const int sign : {1, -1})
      if (const auto normals = normals_at_edge(edges, p, {sign * direction.x, sign * direction.y});
          normals && normals->is_mixed())
        return normals->own_at;
  return std::nullopt;
}

/// Returns whether the planes of both sides reach one pixel further than the two from which they are predicted: on a
/// rough surface, such as terrain, two pixels are nearly level by chance, and what follows them is not.
bool are_smooth(const Edges& edges, Offset p, Offset step, const Side& before, const Side& after) {
  const auto differs = [&](const Side& side, Offset towards) {
    if (!side.surface) return 0.0f;
    const auto further = edges.side(p, towards, 2);
    return further && further->surface ? std::abs(further->depth - side.depth) : kNoSurface;
  };
  const float rough = std::max(differs(before, {-step.x, -step.y}), differs(after, step));
  if (!after.surface) return rough < kNoSurface;
  return std::abs(after.depth - before.depth) > kMinContrast * rough;
}

/// Counts the discontinuity between the pixels p and p + step, or in the pixel p, if there is one.
void count_edge(const Edges& edges, Offset p, Offset step, EdgeCounts& counts) {
  const float depth = edges.depth(p);
  const Offset next{p.x + step.x, p.y + step.y}, back{-step.x, -step.y};
  if (!std::isfinite(depth) || !edges.contains(next)) return;
  const auto before = edges.side(p, back, 1), after = edges.side(p, step, 1);
  if (!before || !after || !before->surface) return;
  if (side_of_mixture(edges, depth, *before, *after)) {
    ++(are_smooth(edges, p, step, *before, *after) ? counts.mixed : counts.rough);
    return;
  }
  if (edges.is_step(depth, before->depth, before->slope)) return;  // the pixel shows a third surface
  if (after->surface && !edges.is_step(depth, after->depth, std::max(before->slope, after->slope))) return;
  ++counts.sharp;
  if (!edges.has_normals()) return;
  if (const auto normals = normals_at_edge(edges, p, step))
    ++(normals->is_mixed() ? counts.mixed_normals : counts.clean_normals);
}

/// Copies the values of the pixel `from` to the pixel `to` of a row of planes.
void copy_planes(const Image& from_rows, Offset from, std::initializer_list<const char*> names, Image& rows,
                 Offset to) {
  for (const char* name : names)
    if (const Plane* plane = from_rows.find(name)) rows.plane(name).at(to.x, to.y) = plane->at(from.x, from.y);
}

}  // namespace

void EdgeCounts::add(const EdgeCounts& other) {
  sharp += other.sharp;
  rough += other.rough;
  mixed += other.mixed;
  clean_normals += other.clean_normals;
  mixed_normals += other.mixed_normals;
}

EdgeRepair EdgeCounts::needed() const {
  constexpr long kMinCount = 50;        // fewer discontinuities may all be accidents
  constexpr double kMinFraction = 0.5;  // of averaged pictures nearly all are mixed, of others about a tenth
  constexpr double kMinNormals = 0.25;  // a sample in the middle of the pixel hides some mixtures
  const auto is_needed = [](long of, long others, double fraction) {
    return of + others >= kMinCount && double(of) > fraction * double(of + others);
  };
  // Most mixtures that lie between smooth surfaces are averages; few of those on terrain and noise do.
  constexpr double kMinSmooth = 0.3;
  return {.depth = is_needed(mixed, sharp, kMinFraction) && is_needed(mixed, rough, kMinSmooth),
          .normals = is_needed(mixed_normals, clean_normals, kMinNormals)};
}

EdgeCounts count_edges(const Image& rows, float pixel_size, bool orthographic) {
  const Edges edges(rows, pixel_size, orthographic);
  EdgeCounts total;
  std::mutex mutex;
  tbb::parallel_for(tbb::blocked_range<int>(0, rows.height), [&](const tbb::blocked_range<int>& range) {
    EdgeCounts counts;
    for (int y = range.begin(); y < range.end(); ++y)
      for (int x = 0; x < rows.width; ++x)
        for (const Offset step : {Offset{1, 0}, Offset{-1, 0}, Offset{0, 1}, Offset{0, -1}})
          count_edge(edges, {x, y}, step, counts);
    const std::scoped_lock lock(mutex);
    total.add(counts);
  });
  return total;
}

Image repaired_rows(const Image& rows, const Rows& own, const EdgeRepair& repair, float pixel_size, bool orthographic) {
  // Normals are compared after the depth of all pixels around them is repaired: kMaxWidth + 1 rows for that, and 2.
  static_assert(kRepairMargin >= kMaxWidth + 1 + 2);
  const auto repaired = [&](const Image& from, const Rows& range, auto&& repair_pixel) {
    Image to(from.width, range.count());
    for (std::size_t k = 0; k < from.names.size(); ++k) {
      Plane& plane = to.add(from.names[k]) = Plane(to.width, to.height);
      for (int y = 0; y < to.height; ++y) std::copy_n(from.planes[k].row(range.begin + y), to.width, plane.row(y));
    }
    const Edges edges(from, pixel_size, orthographic);
    tbb::parallel_for(tbb::blocked_range<int>(0, to.height), [&](const tbb::blocked_range<int>& some) {
      for (int y = some.begin(); y < some.end(); ++y)
        for (int x = 0; x < to.width; ++x) repair_pixel(edges, Offset{x, range.begin + y}, to, Offset{x, y});
    });
    return to;
  };
  const Rows around{std::max(own.begin - 2, 0), std::min(own.end + 2, rows.height)};
  const Image deep = repaired(rows, around, [&](const Edges& edges, Offset p, Image& to, Offset at) {
    if (!repair.depth) return;
    const auto side = repaired_side(edges, p);
    if (!side) return;
    to.plane("depth").at(at.x, at.y) = side->depth;
    copy_planes(rows, side->at, {"normal.x", "normal.y", "normal.z", "object_id", "material_id"}, to, at);
  });
  const Rows inner{own.begin - around.begin, own.end - around.begin};
  return repaired(deep, inner, [&](const Edges& edges, Offset p, Image& to, Offset at) {
    if (!repair.normals || !edges.has_normals()) return;
    if (const auto from = repaired_normal(edges, p))
      copy_planes(deep, *from, {"normal.x", "normal.y", "normal.z"}, to, at);
  });
}

}  // namespace umbrage
