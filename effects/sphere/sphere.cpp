#include "effects/sphere/sphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/hash.h"
#include "core/parameters.h"
#include "kernels/sphere.h"

namespace umbrage {
namespace {

// Defaults as in the listing: a radius of 16 pixels in a picture 512 wide, and a threshold of 5 of 8 samples.
constexpr double kRadiusPercent = 100.0 * 16.0 / 512.0;
constexpr double kThreshold = 5.0 / 8.0;
constexpr double kRangeValue = 0.55;   // [Mittring 2007]
constexpr double kMaxRadius = 4096.0;  // pixels
// Settings that correct the shortcomings of the listing, and whose result is closest to the ray-traced ground truth.
constexpr std::string_view kCorrected =
    "shape=hemisphere sample_z=on depth=linear range=smooth range_factor=1 map=linear threshold=0 border=skip "
    "strength=1.3";
// The shader of [Mittring 2007], which had twice the samples in its high quality.
constexpr std::string_view kCrytek =
    "radius=6.25% distribution=corners depth=linear sample_z=on projection=parallel softness=0.0893 range=blend "
    "range_factor=3.36 threshold=0 map=linear gain=2 offset=-0.075";
constexpr std::string_view kCrytekHigh =
    "samples=16 radius=6.25% distribution=corners depth=linear sample_z=on projection=parallel softness=0.0893 "
    "range=blend range_factor=3.36 threshold=0 map=linear gain=2 offset=-0.075";
constexpr float kMinNearToFar = 1e-4f;  // min near plane / far plane; window depth is undefined for a near plane of 0

const std::vector<Parameter> kSphereTable = {
    int_row("samples", &SphereParams::samples, {.initial = 8, .min = 1, .max = kSphereMaxSamples},
            "sample points per pixel"),
    length_row("radius", &SphereParams::radius, {.initial_percent = kRadiusPercent, .max = kMaxRadius, .unit = "px"},
               "radius of the sphere, in pixels or in percent of the picture's width"),
    length_row("reach", &SphereParams::reach,
               {.max = 1e12, .unit = "scene units", .zero_means = "off: `radius` applies"},
               "radius of the sphere in scene units or in percent of the bounding-sphere radius; it replaces `radius`; "
               "`occlusion_radius` sets it"),
    choice_row("depth", &SphereParams::depth, 0, {"window", "linear"},
               "depth that is compared: window depth in [0, 1], or distance along the view axis"),
    real_row("near", &SphereParams::near_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's near plane"),
    real_row("far", &SphereParams::far_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's far plane"),
    choice_row(
        "reflect", &SphereParams::reflect, 0, {"random", "normal", "none"},
        "vector that reflects the sample points of each pixel: a tiled random vector, the pixel's normal, or none"),
    int_row("noise_size", &SphereParams::noise_size,
            {.initial = 4, .max = 1024, .unit = "px", .zero_means = "as large as the picture"},
            "side of the tile of random vectors"),
    choice_row("distribution", &SphereParams::distribution, 0, {"even", "corners"},
               "sample points: spread evenly, or towards a cube's eight corners, each at another distance"),
    choice_row(
        "shape", &SphereParams::shape, 0, {"sphere", "hemisphere"},
        "sample the whole sphere, or the half above the surface, where only surfaces that rise above it occlude"),
    bool_row("sample_z", &SphereParams::sample_z, false,
             "give each sample its own depth and project it; off: the depth of the pixel"),
    choice_row("projection", &SphereParams::projection, 0, {"perspective", "parallel"},
               "with `sample_z`: samples move outwards in the picture as they come nearer, or are shifted by the same "
               "number of pixels at every depth"),
    real_row("softness", &SphereParams::softness, {.max = 10, .zero_means = "a step"},
             "distance in front of a surface over which samples become occluded, in radii as for `range_factor`"),
    real_row("threshold", &SphereParams::threshold, {.initial = kThreshold, .max = 1},
             "min fraction of occluding samples; with fewer there is no occlusion"),
    choice_row("map", &SphereParams::map, 0, {"quadratic", "linear"},
               "occlusion from the fraction of occluding samples: its square, or the fraction itself"),
    choice_row(
        "range", &SphereParams::range, 0, {"off", "hard", "smooth", "blend"},
        "how occluders far in front of the pixel count: fully, not at all, or less with distance; blend: samples "
        "far from the surface tend to `range_value`"),
    real_row("range_factor", &SphereParams::range_factor, {.initial = 0.05, .max = 100},
             "end of the range, in radii; for window depth the radius is a fraction of the picture's width"),
    real_row("range_value", &SphereParams::range_value, {.initial = kRangeValue, .max = 1},
             "range blend: visibility of samples that are farther behind a surface than the range; as far in front of "
             "one, samples are halfway there"),
    real_row(
        "bias", &SphereParams::bias, {.initial = 0.02, .max = 1},
        "shape hemisphere: occluders that rise less than this fraction of the radius above the surface do not count"),
    choice_row("border", &SphereParams::border, 0, {"clamp", "skip"},
               "samples outside the picture: moved to the nearest pixel, or not counted"),
    real_row("strength", &SphereParams::strength, {.initial = 1, .max = 10}, "factor for the occlusion"),
    real_row("gain", &SphereParams::gain, {.initial = 1, .max = 10}, "factor for the visibility"),
    real_row("offset", &SphereParams::offset, {.min = -1, .max = 1}, "added to the visibility after `gain`"),
};

// A sample that rounds the other way changes `ao` by up to 25/64, at the listing's threshold; with samples=1, by two
// quanta.
constexpr double kSphereQuantum = 0.5;

/// Writes `count` points that are evenly distributed in the unit sphere. The listing receives "eight uniform points"
/// and does not specify them. Heights are in equal steps (equal areas of the sphere). Azimuth and radius follow the
/// two-dimensional golden ratio [Roberts 2018], so that no two of the three correlate. The radius is uniform in volume.
///
/// If `pairs`, each point comes with its opposite. Of two opposite points, one is in front of a plane through the
/// centre and one behind it, or reads a nearer and a farther pixel of it. So half of the samples count wherever the
/// surface is flat: 4 of 8, which is below the listing's threshold of 5. A hemisphere would flip opposite points onto
/// each other, so it uses points without their opposites.
void fill_points(int count, bool pairs, float* points) {
  const int drawn = pairs ? (count + 1) / 2 : count;
  for (int i = 0; i < drawn; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double azimuth = 2.0 * std::numbers::pi * fractional_part(0.5 + (i + 1) / kPlasticNumber);
    const double radius = std::cbrt(fractional_part(0.5 + (i + 1) / (kPlasticNumber * kPlasticNumber)));
    const double across = std::sqrt(1.0 - z * z);
    const double point[3] = {radius * across * std::cos(azimuth), radius * across * std::sin(azimuth), radius * z};
    for (int k = 0; k < 3; ++k) {
      points[3 * i + k] = float(point[k]);
      if (pairs && drawn + i < count) points[3 * (drawn + i) + k] = float(-point[k]);
    }
  }
}

/// Writes `count` points towards the corners of a cube, at distances of 1/8 to 8/8, as in [Mittring 2007]. Its 16
/// points are these and the same at half the distance; with more points, the distances are divided further. The order
/// of the corners is not known: this one gives the mean values in sphere_test.cpp.
void fill_corners(int count, float* points) {
  constexpr int kCorners[8][3] = {{1, 1, 1},  {-1, -1, -1}, {-1, -1, 1}, {-1, 1, -1},
                                  {-1, 1, 1}, {1, -1, -1},  {1, -1, 1},  {1, 1, -1}};
  const int rings = (count + 7) / 8;
  for (int i = 0; i < count; ++i) {
    const double distance = (i % 8 + 1) / 8.0 * (rings - i / 8) / rings;
    for (int k = 0; k < 3; ++k) points[3 * i + k] = float(kCorners[i % 8][k] * distance / std::numbers::sqrt3);
  }
}

void fill_sphere(const SphereParams& params, const PictureInfo& info, SphereConstants& c) {
  const float width = info.reference_width();
  c.samples = params.samples;
  c.radius_px = length_px(params.radius, width, info);
  c.reach = absolute_length(params.reach, info.scene_radius);
  c.world_radius = c.reach > 0.0f ? 1 : 0;
  c.linear = params.depth == kSphereLinear ? 1 : 0;
  // In the listing the radius is in texture coordinates: a fraction of the width.
  const float radius_unit = c.linear ? 1.0f : width;
  c.limit = params.range_factor / radius_unit;
  c.softness = params.softness / radius_unit;

  // Default: the tightest frustum around the scene, in which window depth has the finest resolution.
  float far_depth = params.far_depth > 0.0f ? params.far_depth : info.depth_max;
  float near_depth = params.near_depth > 0.0f ? params.near_depth : info.depth_min;
  // Kernels must not fail: a near plane at or behind the far plane is moved slightly in front of it.
  far_depth = std::max(far_depth, 1e-30f);
  near_depth = std::clamp(near_depth, far_depth * kMinNearToFar, far_depth * 0.999f);
  c.near_depth = near_depth;
  c.far_depth = far_depth;
  const double n = near_depth, f = far_depth;
  c.window_one = float(f / (f - n));
  c.window_inverse = float(f * n / (f - n));

  c.reflect = params.reflect;
  c.noise_size = float(params.noise_size);
  c.hemisphere = params.shape;
  c.sample_z = params.sample_z;
  c.parallel = params.projection;
  c.threshold = params.threshold;
  c.quadratic = params.map == 0 ? 1 : 0;
  c.range = params.range;
  c.beyond = 1.0f - params.range_value;
  c.bias = params.bias;
  c.skip_outside = params.border;
  c.strength = params.strength;
  c.gain = params.gain;
  c.offset = params.offset;
  if (params.distribution == 0)
    fill_points(params.samples, params.shape == 0, c.points);
  else
    fill_corners(params.samples, c.points);
}

}  // namespace

Effect effect_sphere() {
  return occlusion_effect<fill_sphere>(
      kSphereTable, {.name = "sphere",
                     .summary = "sample points in a sphere: darker where more of them are behind a surface",
                     .source = "Lajzer and Nottingham",
                     .set_radius = set_radius_of<&SphereParams::reach>,
                     .tunable = {"samples", "shape", "threshold", "strength"},
                     .variants = {"", "samples=16", "samples=32", kCorrected, kCrytek, kCrytekHigh},
                     .quantum = kSphereQuantum,
                     .dispatches = {sampling_dispatch(sphere_kernel())}});
}

}  // namespace umbrage
