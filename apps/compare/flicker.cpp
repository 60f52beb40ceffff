#include "apps/compare/flicker.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/pixel_grid.h"

namespace umbrage {
namespace {

constexpr double kMaxDistancePx = 4.0;  // of a point from another's plane, in pixel sizes
constexpr double kMinCosine = 0.9;      // between the normals of two pixels of one surface
constexpr double kMinFound = 0.99;      // bilinear weight that must belong to the surface

/// The surface points of a frame in world space, at rest: as if the object that moves had not moved.
class RestPoints {
 public:
  explicit RestPoints(const FrameSurfaces& frame)
      : frame_(frame), camera_(frame.gbuffer.info.camera), planes_(frame.gbuffer.layers[0]) {}

  int width() const { return planes_.width; }
  int height() const { return planes_.height; }
  double depth(int x, int y) const { return depth_.at(x, y); }
  int object(int x, int y) const { return int(std::lround(object_.at(x, y))); }
  /// Returns the size of a pixel at a depth, scene units.
  double pixel_size(double depth) const { return grid_.step_y * (grid_.orthographic ? 1.0 : depth); }

  glm::dvec3 point(int x, int y) const {
    return glm::dvec3(rest_from_view_[moves(x, y)] * glm::dvec4(grid_.point(x, y, depth(x, y)), 1.0));
  }
  glm::dvec3 normal(int x, int y) const {
    const glm::dvec3 n(normal_[0]->at(x, y), normal_[1]->at(x, y), normal_[2]->at(x, y));
    return glm::dmat3(rest_from_view_[moves(x, y)]) * n;
  }
  /// Returns the place of a point of an object in the picture: x, y in pixels, and the depth.
  glm::dvec3 place(const glm::dvec3& point, int object) const {
    return grid_.place(glm::dvec3(view_from_rest_[object == frame_.moving_object] * glm::dvec4(point, 1.0)));
  }

 private:
  bool moves(int x, int y) const { return frame_.moving_object >= 0 && object(x, y) == frame_.moving_object; }

  const FrameSurfaces& frame_;
  const Camera& camera_;
  const Image& planes_;
  const PixelGrid grid_{camera_, planes_.width, planes_.height};
  const Plane &depth_ = planes_.plane("depth"), &object_ = planes_.plane("object_id");
  const Plane* const normal_[3] = {&planes_.plane("normal.x"), &planes_.plane("normal.y"), &planes_.plane("normal.z")};
  // Of what stands still, and of what moves.
  const glm::dmat4 view_from_rest_[2] = {glm::dmat4(camera_.view_from_world),
                                         glm::dmat4(camera_.view_from_world) * frame_.object_pose};
  const glm::dmat4 rest_from_view_[2] = {glm::inverse(view_from_rest_[0]), glm::inverse(view_from_rest_[1])};
};

/// Sums of products over the planes and counted pixels of pairs of pictures.
struct Sums {
  double own = 0.0, truth = 0.0, difference = 0.0, truth_squares = 0.0;
  long pixels = 0, values = 0;
  double root(double sum) const { return values > 0 ? std::sqrt(std::max(sum, 0.0) / double(values)) : 0.0; }
};

/// Returns a frame warped to another minus that one, 0 where unseen.
Image change_of(const Warp& warp, const Image& from, const Image& to) {
  Image change(to.width, to.height);
  for (std::size_t p = 0; p < to.planes.size(); ++p) {
    Plane& plane = change.add(to.names[p]) = warp.warped(from.planes[p]);
    for (int y = 0; y < to.height; ++y)
      for (int x = 0; x < to.width; ++x)
        if (is_counted(warp.seen().row(y)[x])) plane.at(x, y) -= finite_or_zero(to.planes[p].at(x, y));
  }
  return change;
}

/// Adds a picture, and both halves of the truth, over counted pixels. `visit` gets each value of the picture.
template <class Visit>
void add(const ClassMap& classes, const Image& own, const Image& first, const Image& second, Sums& sums, Visit visit) {
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x) {
      if (!is_counted(classes.row(y)[x])) continue;
      ++sums.pixels;
      for (std::size_t p = 0; p < own.planes.size(); ++p) {
        const double value = finite_or_zero(own.planes[p].at(x, y)), a = finite_or_zero(first.planes[p].at(x, y)),
                     b = finite_or_zero(second.planes[p].at(x, y));
        sums.own += value * value;
        sums.truth += a * b;
        sums.truth_squares += a * a * b * b;
        sums.difference += (value - a) * (value - b);
        ++sums.values;
        visit(x, y, value);
      }
    }
}

/// Returns the sum of FLIP between a frame warped to the next one and that one.
double flip_sum(const Warp& warp, const Image& from, const Image& to, const std::function<float(float)>& shown) {
  Image warped(to.width, to.height), next(to.width, to.height);
  for (std::size_t p = 0; p < to.planes.size(); ++p) {
    Plane& a = warped.add(to.names[p]) = warp.warped(from.planes[p]);
    Plane& b = next.add(to.names[p]) = to.planes[p];
    for (Plane* plane : {&a, &b})
      for (int y = 0; y < to.height; ++y) std::transform(plane->row(y), plane->row(y) + to.width, plane->row(y), shown);
  }
  const Plane map = flip_map(warped, next, warp.seen());
  double sum = 0.0;
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x)
      if (is_counted(warp.seen().row(y)[x])) sum += map.at(x, y);
  return sum;
}

}  // namespace

Warp::Warp(const FrameSurfaces& from, const FrameSurfaces& to)
    : seen_(classify(to.gbuffer)), taps_(seen_.classes.size()) {
  const RestPoints source(from), target(to);
  for (int y = 0; y < target.height(); ++y)
    for (int x = 0; x < target.width(); ++x) {
      const std::size_t pixel = std::size_t(y) * target.width() + x;
      if (!is_counted(seen_.classes[pixel])) continue;
      const int object = target.object(x, y);
      const glm::dvec3 point = target.point(x, y), normal = target.normal(x, y), place = source.place(point, object);
      const bool is_near =
          place.z > 0.0 && place.x > -1.0 && place.y > -1.0 && place.x < source.width() && place.y < source.height();
      Taps taps;
      if (is_near) taps.x = int(std::floor(place.x)), taps.y = int(std::floor(place.y));
      const double right = place.x - taps.x, below = place.y - taps.y;
      const double max_distance = kMaxDistancePx * source.pixel_size(place.z);
      double found = 0.0, weights[4] = {};
      for (int k = 0; k < 4 && is_near; ++k) {
        const int i = taps.x + k % 2, j = taps.y + k / 2;
        if (i < 0 || j < 0 || i >= source.width() || j >= source.height() || source.object(i, j) != object) continue;
        if (!std::isfinite(source.depth(i, j))) continue;
        const glm::dvec3 between = source.point(i, j) - point, other = source.normal(i, j);
        if (std::max(std::abs(glm::dot(between, normal)), std::abs(glm::dot(between, other))) > max_distance) continue;
        if (glm::dot(normal, other) < kMinCosine) continue;
        found += weights[k] = (k % 2 ? right : 1.0 - right) * (k / 2 ? below : 1.0 - below);
      }
      if (found < kMinFound)
        seen_.classes[pixel] = PixelClass::kBackground;
      else
        for (int k = 0; k < 4; ++k) taps.weights[k] = float(weights[k] / found);
      taps_[pixel] = taps;
    }
}

Plane Warp::warped(const Plane& plane) const {
  Plane out(seen_.width, seen_.height, 0.0f);
  for (int y = 0; y < seen_.height; ++y)
    for (int x = 0; x < seen_.width; ++x) {
      const Taps& taps = taps_[std::size_t(y) * seen_.width + x];
      for (int k = 0; k < 4; ++k)
        if (taps.weights[k] > 0.0f)
          out.at(x, y) += taps.weights[k] * finite_or_zero(plane.at(taps.x + k % 2, taps.y + k / 2));
    }
  return out;
}

Warps::Warps(const std::vector<FrameSurfaces>& frames) {
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) next.emplace_back(frames[i], frames[i + 1]);
  for (std::size_t i = 0; i + kFarFrames < frames.size(); ++i) far.emplace_back(frames[i], frames[i + kFarFrames]);
}

Flicker measure_flicker(const Warps& warps, const SequencePlanes& frames, const std::array<SequencePlanes, 2>& truth,
                        const std::vector<FrameSurfaces>& surfaces, const std::function<float(float)>& shown,
                        Plane* map) {
  Flicker result;
  Sums next, far, error;
  std::vector<float> open;
  double open_squares = 0.0;
  if (map) *map = Plane(frames[0].width, frames[0].height, 0.0f);
  for (std::size_t i = 0; i < warps.next.size(); ++i) {
    const Warp& warp = warps.next[i];
    const auto change = [&](const SequencePlanes& of) { return change_of(warp, of[i], of[i + 1]); };
    add(warp.seen(), change(frames), change(truth[0]), change(truth[1]), next, [&](int x, int y, double value) {
      if (map) map->at(x, y) += float(value * value / double(frames[i].planes.size() * warps.next.size()));
      if (warp.seen().row(y)[x] != PixelClass::kOpen) return;
      open.push_back(float(std::abs(value)));
      open_squares += value * value;
    });
    result.flip += flip_sum(warp, frames[i], frames[i + 1], shown);
    result.truth_flip += flip_sum(warp, truth[0][i], truth[0][i + 1], shown);
  }
  for (std::size_t i = 0; i < warps.far.size(); ++i) {
    const auto change = [&](const SequencePlanes& of) { return change_of(warps.far[i], of[i], of[i + kFarFrames]); };
    add(warps.far[i].seen(), change(frames), change(truth[0]), change(truth[1]), far, [](int, int, double) {});
  }
  for (std::size_t i = 0; i < frames.size(); ++i)
    add(classify(surfaces[i].gbuffer), frames[i], truth[0][i], truth[1][i], error, [](int, int, double) {});
  if (map)
    for (int y = 0; y < map->height; ++y)
      for (int x = 0; x < map->width; ++x) map->at(x, y) = std::sqrt(map->at(x, y));
  result.pixels = next.pixels;
  result.next = next.root(next.own);
  result.truth_next = next.root(next.truth);
  result.truth_noise = next.root(std::sqrt(next.truth_squares));
  result.own = next.root(next.difference);
  if (!warps.far.empty()) result.far = far.root(far.own), result.truth_far = far.root(far.truth);
  result.error = error.root(error.difference);
  if (!open.empty()) {
    const auto place = open.begin() + long((open.size() - 1) * 99 / 100);
    std::nth_element(open.begin(), place, open.end());
    result.open_p99 = *place;
    result.open_rms = std::sqrt(open_squares / double(open.size()));
  }
  for (double* sum : {&result.flip, &result.truth_flip}) *sum /= double(std::max(next.pixels, 1L));
  return result;
}

}  // namespace umbrage
