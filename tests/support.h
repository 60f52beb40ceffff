// What several tests need: G-buffers made in code, comparisons.
#pragma once
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/gbuffer.h"
#include "scene/scene.h"

namespace umbrage::test {

/// A picture with a perspective camera of 40 degrees, `depth_min` 1 and `depth_max` 10, one light, and no planes yet.
GBuffer empty_gbuffer(int width, int height);

/// A G-buffer with every plane of core/gbuffer.h: bumpy surfaces with steps, holes to the background, varied materials.
/// The same for the same seed.
GBuffer bumpy_gbuffer(int width, int height, unsigned seed);

/// The same with NaN, infinities, zeros, negative and huge numbers strewn over all planes.
GBuffer hostile_gbuffer(int width, int height, unsigned seed);

struct Difference {
  double max = 0.0, mean = 0.0;
  double share_over = 0.0;  ///< share of pixels that differ by more than the bound
};

/// Compares planes of one size; two NaN are equal.
Difference difference(const Plane& a, const Plane& b, double bound);

/// The largest finite value of a plane, or 1: light of many lights, strong factors and depths exceed 1, and bounds hold
/// relative to it.
double scale_of(const Plane& plane);

/// The instruction sets that tests run on: the one in use at the start, and those that are less wide.
std::vector<std::string_view> isas();
/// Those of them that have lanes: all but "scalar".
std::vector<std::string_view> lane_isas();

/// The ray through a pixel's centre, in double and world space: its parameter is depth.
struct PixelRay {
  glm::dvec3 origin, direction;
  glm::dvec3 at(double depth) const { return origin + direction * depth; }
};
PixelRay ray_of(const PictureInfo& info, int x, int y);

/// Makes depth and normals those of a plane that is tilted about the picture's x axis and fills it. Returns how many
/// rows at the top lie above its horizon and show nothing.
int tilt_about_x(GBuffer& g, double tilt_deg);

/// What a closed mesh encloses.
double volume(const Mesh& mesh);

/// A random 32-bit number from a counter.
unsigned hash(unsigned v);

}  // namespace umbrage::test
