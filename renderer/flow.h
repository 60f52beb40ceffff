// Flow: where the surfaces of a frame are in another frame of a sequence, by the motion vectors of its files. Vectors
// lead to a neighbouring frame only; flow to farther ones is composed.
#pragma once
#include <optional>

#include "core/camera.h"
#include "core/image.h"

namespace umbrage {

/// A frame, as far as flow depends on it.
struct FlowFrame {
  std::optional<Camera> camera;  ///< with its place; empty: unknown
  Plane depth;                   ///< view depth
  Image motion;                  ///< planes of motion_planes; none without vectors
};

/// Of each pixel the coordinates (pixel centres at integers) and the view depth of its surface in another frame. NaN
/// where it is not seen there, or not known.
struct Flow {
  Plane x, y, z;
};

/// Returns the flow between neighbouring frames. Vectors of either frame give both directions. A surface is there if
/// the way back leads to its pixel, and depth is like that which the cameras give a still surface; without cameras,
/// like its own. `is_next`: `to` is the later one. Empty: neither frame has vectors that lead to the other one.
std::optional<Flow> flow_between(const FlowFrame& from, const FlowFrame& to, bool is_next);

/// Returns the flow to a third frame. `depth`: that of the frame between both.
Flow composed(const Flow& to_second, const Flow& to_third, const Plane& depth);

/// Returns the flow of a still scene between any frames. Whether surfaces are seen there is not examined. Empty: one of
/// the cameras is unknown.
std::optional<Flow> camera_flow(const FlowFrame& from, const FlowFrame& to);

/// Returns whether flow finds hardly any surface of a picture in the other one, as at a cut. `depth`, `other`: of both.
bool is_cut(const Flow& flow, const Plane& depth, const Plane& other);

}  // namespace umbrage
