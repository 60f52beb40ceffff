// Helpers for tests: generated G-buffers, comparisons.
#pragma once
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/gbuffer.h"
#include "scene/scene.h"

namespace umbrage::test {

/// Returns a G-buffer without planes, with a perspective camera of 40 degrees, `depth_min` 1 and `depth_max` 10 and one
/// light.
GBuffer empty_gbuffer(int width, int height);

/// Returns a G-buffer with every plane of core/gbuffer.h: bumpy surfaces with steps, holes to the background, varied
/// materials. Deterministic for a seed.
GBuffer bumpy_gbuffer(int width, int height, unsigned seed);

/// Returns a bumpy_gbuffer with NaN, infinities, zeros, negative and huge numbers spread over all planes.
GBuffer hostile_gbuffer(int width, int height, unsigned seed);

struct Difference {
  double max = 0.0, mean = 0.0;
  double fraction_over = 0.0;  ///< fraction of pixels that differ by more than the bound
};

/// Compares planes of the same size. Two NaN count as equal.
Difference difference(const Plane& a, const Plane& b, double bound);

/// Returns where a bit of two pictures differs, such as "depth, row 7", or "names or size"; empty: nowhere.
std::string first_difference(const Image& a, const Image& b);

/// Returns the max finite value of a plane, at least 1. Error bounds are relative to it, since light of many lights,
/// large factors and depths exceed 1.
double scale_of(const Plane& plane);

/// Returns the instruction sets that tests run on: the one in use at the start, and all narrower ones.
std::vector<std::string_view> isas();
/// Returns those of isas() that have lanes: all except "scalar".
std::vector<std::string_view> lane_isas();

/// The ray through a pixel's centre in world space, in double. The ray's parameter is depth.
struct PixelRay {
  glm::dvec3 origin, direction;
  glm::dvec3 at(double depth) const { return origin + direction * depth; }
};
PixelRay ray_of(const PictureInfo& info, int x, int y);

/// Fills depth and normals with a plane that is tilted about the picture's x axis. Returns the number of rows at the
/// top that are above its horizon and empty.
int tilt_about_x(GBuffer& g, double tilt_deg);

/// Returns the volume that a closed mesh encloses.
double volume(const Mesh& mesh);

/// Returns a random 32-bit number for a counter.
unsigned hash(unsigned v);

}  // namespace umbrage::test
