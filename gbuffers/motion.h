// Motion vectors: where the surface of a pixel is in the frames beside, and the meanings that stored ones may have.
#pragma once
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"

namespace umbrage {

struct Conventions;

/// What a pair of stored channels means.
struct MotionConvention {
  bool is_next = false;   ///< about the next frame, otherwise about the previous one
  glm::dvec2 scale{1.0};  ///< pixels to the right and down, per stored unit, towards the other frame
  double zero = 0.0;      ///< stored value of no motion
  std::string meaning;    ///< as messages show it: "px to the next frame, y up"
};

/// The meanings that a pair may have, the likeliest first. One: it is decided. None: it is of no use.
using MotionMeanings = std::vector<MotionConvention>;

/// The planes of two frames, one after the other: those of GBufferFile::rows, and stored motion.
struct MotionFrame {
  const Image& planes;
  const Image& stored;
};

/// Leaves the meanings that lead from one of two neighbouring frames to like surfaces in the other one. Leaves all of
/// them if they lead to the same place, or if none fits, as at a cut. Returns of each pair whether any fits.
std::vector<bool> narrow_meanings(const MotionFrame& here, const MotionFrame& next, std::vector<MotionMeanings>& pairs);

/// Returns the planes `before.x`, `before.y` and `after.x`, `after.y`, those that are known: how far the surface of a
/// pixel is from it in the frames before and after, in pixels to the right and down; NaN if unknown. `stored`: planes
/// of GBufferFile::stored_motion.
Image motion_planes(const Image& stored, std::span<const MotionMeanings> pairs);

}  // namespace umbrage
