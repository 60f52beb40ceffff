#include "renderer/flow.h"

#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "core/pixel_grid.h"
#include "core/rows.h"

namespace umbrage {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kLike = 0.05f;  // max. relative difference of depths of one surface, besides motion of the camera

Flow unknown_flow(int width, int height) {
  return {Plane(width, height, kUnknown), Plane(width, height, kUnknown), Plane(width, height, kUnknown)};
}

/// Returns where still surfaces of a frame are in another one, by the cameras; without, where they are in their own.
Flow still_flow(const FlowFrame& from, const FlowFrame& to) {
  Flow flow{from.depth, from.depth, from.depth};
  const Camera camera = from.camera.value_or(Camera()), other = to.camera.value_or(Camera());
  const PixelGrid here(camera, flow.x.width, flow.x.height), there(other, flow.x.width, flow.x.height);
  const glm::dmat4 turn = glm::dmat4(other.view_from_world) * glm::inverse(glm::dmat4(camera.view_from_world));
  for_rows(0, flow.x.height, [&](int y) {
    for (int x = 0; x < flow.x.width; ++x) {
      const double depth = from.depth.at(x, y);
      glm::dvec3 place(x, y, depth);
      if (from.camera && to.camera) place = there.place(glm::dvec3(turn * glm::dvec4(here.point(x, y, depth), 1.0)));
      if (!std::isfinite(depth) || !(place.z > 0.0)) place = glm::dvec3(kUnknown);
      flow.x.at(x, y) = float(place.x), flow.y.at(x, y) = float(place.y), flow.z.at(x, y) = float(place.z);
    }
  });
  return flow;
}

/// What the pixels around a place show of one surface: where it is in another frame, relative to the place, and its
/// inverse depth there.
struct Found {
  float weight = 0.0f, x = 0.0f, y = 0.0f, inverse_z = 0.0f;
};

/// Finds a surface of this depth at a place. `flow`: to the other frame. weight 0: it is not there.
Found found_at(const Plane& depths, const Flow& flow, float x, float y, float depth) {
  constexpr float kMinFound = 0.25f;  // part of the bilinear weights
  Found sum;
  if (!(x > -1.0f && y > -1.0f && x < float(depths.width) && y < float(depths.height))) return sum;
  const int column = int(std::floor(x)), row = int(std::floor(y));
  for (int tap = 0; tap < 4; ++tap) {
    const int i = column + (tap & 1), j = row + (tap >> 1);
    if (i < 0 || j < 0 || i >= depths.width || j >= depths.height) continue;
    const float weight = (1.0f - std::abs(x - float(i))) * (1.0f - std::abs(y - float(j)));
    if (!(std::abs(depths.at(i, j) - depth) <= kLike * depth) || std::isnan(flow.x.at(i, j))) continue;
    sum.weight += weight;
    sum.x += weight * (flow.x.at(i, j) - float(i));
    sum.y += weight * (flow.y.at(i, j) - float(j));
    sum.inverse_z += weight / flow.z.at(i, j);
  }
  if (sum.weight < kMinFound) return {};
  return {sum.weight, sum.x / sum.weight, sum.y / sum.weight, sum.inverse_z / sum.weight};
}

/// Returns where vectors lead; z: the depth of their own pixel. Empty: there are none.
std::optional<Flow> flow_of_vectors(const FlowFrame& frame, const std::string& name) {
  const Plane *right = frame.motion.find(name + ".x"), *down = frame.motion.find(name + ".y");
  if (!right || !down) return std::nullopt;
  Flow flow{*right, *down, frame.depth};
  for_rows(0, flow.x.height, [&](int y) {
    for (int x = 0; x < flow.x.width; ++x) flow.x.at(x, y) += float(x), flow.y.at(x, y) += float(y);
  });
  return flow;
}

/// Returns the way back of a flow that leads to `frame`. Of the surfaces that come to a pixel it takes the one whose
/// depth is most like that of the pixel, and that is nearest to its centre. `depth`: of the surfaces, in `frame`.
Flow inverse(const Flow& flow, const Plane& depth, const FlowFrame& frame) {
  Flow out = unknown_flow(depth.width, depth.height);
  out.z = frame.depth;
  Plane best(depth.width, depth.height, 2.5f);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float to_x = flow.x.at(x, y), to_y = flow.y.at(x, y);
      if (!(to_x > -1.0f && to_y > -1.0f && to_x < float(depth.width) && to_y < float(depth.height))) continue;
      for (int tap = 0; tap < 4; ++tap) {
        const int i = int(std::floor(to_x)) + (tap & 1), j = int(std::floor(to_y)) + (tap >> 1);
        if (i < 0 || j < 0 || i >= depth.width || j >= depth.height) continue;
        const float apart = std::abs(frame.depth.at(i, j) - depth.at(x, y)) / (kLike * depth.at(x, y));
        const float miss = apart + std::hypot(to_x - float(i), to_y - float(j));
        if (!(apart <= 1.0f) || miss >= best.at(i, j)) continue;
        best.at(i, j) = miss;
        out.x.at(i, j) = float(x) + float(i) - to_x;
        out.y.at(i, j) = float(y) + float(j) - to_y;
      }
    }
  return out;
}

}  // namespace

std::optional<Flow> camera_flow(const FlowFrame& from, const FlowFrame& to) {
  return from.camera && to.camera ? std::optional(still_flow(from, to)) : std::nullopt;
}

std::optional<Flow> flow_between(const FlowFrame& from, const FlowFrame& to, bool is_next) {
  std::optional<Flow> there = flow_of_vectors(from, is_next ? "after" : "before"),
                      back = flow_of_vectors(to, is_next ? "before" : "after");
  if (!there && !back) return std::nullopt;
  const Plane depth = still_flow(from, to).z;
  if (!back) back = inverse(*there, depth, to);
  if (!there) there = inverse(*back, still_flow(to, from).z, from);
  constexpr float kMiss_px = 0.5f, kMissOfWay = 0.01f;  // of the way back
  Flow flow = unknown_flow(depth.width, depth.height);
  for_rows(0, depth.height, [&](int y) {
    for (int x = 0; x < depth.width; ++x) {
      const float to_x = there->x.at(x, y), to_y = there->y.at(x, y);
      const Found found = found_at(to.depth, *back, to_x, to_y, depth.at(x, y));
      const float miss = std::hypot(to_x + found.x - float(x), to_y + found.y - float(y));
      if (found.weight == 0.0f || !(miss <= kMiss_px + kMissOfWay * std::hypot(found.x, found.y))) continue;
      flow.x.at(x, y) = to_x;
      flow.y.at(x, y) = to_y;
      flow.z.at(x, y) = 1.0f / found.inverse_z;
    }
  });
  return flow;
}

Flow composed(const Flow& to_second, const Flow& to_third, const Plane& depth) {
  Flow flow = unknown_flow(depth.width, depth.height);
  for_rows(0, depth.height, [&](int y) {
    for (int x = 0; x < depth.width; ++x) {
      const float at_x = to_second.x.at(x, y), at_y = to_second.y.at(x, y);
      const Found found = found_at(depth, to_third, at_x, at_y, to_second.z.at(x, y));
      if (found.weight == 0.0f) continue;
      flow.x.at(x, y) = at_x + found.x;
      flow.y.at(x, y) = at_y + found.y;
      flow.z.at(x, y) = 1.0f / found.inverse_z;
    }
  });
  return flow;
}

bool is_cut(const Flow& flow, const Plane& depth, const Plane& other) {
  constexpr double kFew = 0.02;
  std::size_t surfaces = 0, found = 0;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      surfaces += std::isfinite(depth.at(x, y));
      const float at_x = flow.x.at(x, y) + 0.5f, at_y = flow.y.at(x, y) + 0.5f, z = flow.z.at(x, y);
      if (at_x >= 0.0f && at_y >= 0.0f && at_x < float(other.width) && at_y < float(other.height))
        found += std::abs(other.at(int(at_x), int(at_y)) - z) <= kLike * z;
    }
  return double(found) < kFew * double(surfaces);
}

}  // namespace umbrage
