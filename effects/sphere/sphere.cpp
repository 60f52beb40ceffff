#include "effects/sphere/sphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/absolute_length.h"
#include "core/effect.h"
#include "kernels/sphere.h"

namespace umbrage {
namespace {

// The listing: 16 pixels of a picture 512 wide; 5 of 8 samples.
constexpr double kRadiusPercent = 100.0 * 16.0 / 512.0;
constexpr double kThreshold = 5.0 / 8.0;
constexpr double kMaxRadius = 4096.0;  // pixels
// What is right where the listing is short, and closest to the ray-traced truth.
constexpr std::string_view kOurs =
    "shape=hemisphere sample_z=on depth=linear range=smooth range_factor=1 map=linear threshold=0 border=skip "
    "strength=1.3";
constexpr float kMinNearShare = 1e-4f;  // of the far plane: window depth divides by the near plane's distance

const std::vector<Parameter> kTable = {
    int_row("samples", &SphereParams::samples, {.initial = 8, .min = 1, .max = kSphereMostSamples},
            "sample points per pixel"),
    length_row("radius", &SphereParams::radius, {.initial_percent = kRadiusPercent, .max = kMaxRadius, .unit = "px"},
               "radius of the sphere, in pixels or as a share of the picture's width"),
    length_row("reach", &SphereParams::reach, {.max = 1e12, .unit = "scene units", .zero_means = "off: `radius` holds"},
               "radius of the sphere in the scene, in its units or as a share of its radius; it replaces `radius`"),
    choice_row("depth", &SphereParams::depth, 0, {"window", "linear"},
               "the depth that is compared: window depth in [0, 1], or distance along the view axis"),
    real_row("near", &SphereParams::near_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's near plane"),
    real_row("far", &SphereParams::far_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's far plane"),
    choice_row("reflect", &SphereParams::reflect, 0, {"random", "normal", "none"},
               "what turns the sample points of each pixel: a tiled random vector, the pixel's normal, or nothing"),
    int_row("noise_size", &SphereParams::noise_size,
            {.initial = 4, .max = 1024, .unit = "px", .zero_means = "as large as the picture"},
            "side of the tile of random vectors"),
    choice_row("shape", &SphereParams::shape, 0, {"sphere", "hemisphere"},
               "sample the whole sphere, or the half above the surface, where only what rises above it occludes"),
    bool_row("sample_z", &SphereParams::sample_z, false, "give samples a depth of their own; off: that of the pixel"),
    real_row("threshold", &SphereParams::threshold, {.initial = kThreshold, .max = 1},
             "a smaller share of occluding samples is none"),
    choice_row("map", &SphereParams::map, 0, {"quadratic", "linear"},
               "from the share of occluding samples to occlusion: its square, or itself"),
    choice_row("range", &SphereParams::range, 0, {"off", "hard", "smooth"},
               "how occluders far before the pixel count: fully, not at all, or less and less"),
    real_row("range_factor", &SphereParams::range_factor, {.initial = 0.05, .max = 100},
             "where the range ends, in radii; of a difference of window depth, in shares of the width"),
    real_row("bias", &SphereParams::bias, {.initial = 0.02, .max = 1},
             "shape hemisphere: what rises less than this share of the radius above the surface does not occlude"),
    choice_row("border", &SphereParams::border, 0, {"clamp", "skip"},
               "what a sample outside the picture is: the nearest pixel, or left out of the count"),
    real_row("strength", &SphereParams::strength, {.initial = 1, .max = 10}, "factor of the occlusion"),
};

// One flipped sample moves `ao` by 25/64 at the listing's threshold; one of one sample, the fewest, by two quanta.
constexpr double kQuantum = 0.5;

double share_of_one(double v) { return v - std::floor(v); }

/// Points spread evenly over the unit ball. The listing gets "eight uniform points" from outside and does not name
/// them. Heights in equal steps (equal areas of the sphere); azimuth and radius by the two-dimensional golden ratio
/// [Roberts 2018], so that no two of the three go together; the radius by volume.
///
/// `pairs`: each point comes with the one opposite. Of two opposite points one lies before a plane and one behind it,
/// or nearer and farther on it, so that half of the samples count wherever the surface is flat: 4 of 8, which is what
/// the listing's threshold of 5 passes over. A hemisphere folds them onto each other and takes points without their
/// opposites.
void fill_points(int count, bool pairs, float* points) {
  constexpr double kPlastic = 1.32471795724474602596;  // x^3 = x + 1
  const int drawn = pairs ? (count + 1) / 2 : count;
  for (int i = 0; i < drawn; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double azimuth = 2.0 * std::numbers::pi * share_of_one(0.5 + (i + 1) / kPlastic);
    const double radius = std::cbrt(share_of_one(0.5 + (i + 1) / (kPlastic * kPlastic)));
    const double across = std::sqrt(1.0 - z * z);
    const double point[3] = {radius * across * std::cos(azimuth), radius * across * std::sin(azimuth), radius * z};
    for (int k = 0; k < 3; ++k) {
      points[3 * i + k] = float(point[k]);
      if (pairs && drawn + i < count) points[3 * (drawn + i) + k] = float(-point[k]);
    }
  }
}

void fill_constants(const SphereParams& params, const PictureInfo& info, SphereConstants& c) {
  const float width = info.share_width();
  c.samples = params.samples;
  c.radius_px = length_px(params.radius, width, info);
  c.reach = absolute_length(params.reach, info.scene_radius);
  c.world_radius = c.reach > 0.0f ? 1 : 0;
  c.linear = params.depth == kSphereLinear ? 1 : 0;
  // In the listing the radius is in texture coordinates, shares of the width.
  c.limit = c.linear ? params.range_factor : params.range_factor / width;

  // The tightest frustum around the scene, where nobody says: window depth is finest there.
  float far_depth = params.far_depth > 0.0f ? params.far_depth : info.depth_max;
  float near_depth = params.near_depth > 0.0f ? params.near_depth : info.depth_min;
  // Kernels are total: a near plane at or behind the far plane leaves a sliver between them.
  far_depth = std::max(far_depth, 1e-30f);
  near_depth = std::clamp(near_depth, far_depth * kMinNearShare, far_depth * 0.999f);
  c.near_depth = near_depth;
  c.far_depth = far_depth;
  const double n = near_depth, f = far_depth;
  c.window_one = float(f / (f - n));
  c.window_inverse = float(f * n / (f - n));

  c.reflect = params.reflect;
  c.noise_size = float(params.noise_size);
  c.hemisphere = params.shape;
  c.sample_z = params.sample_z;
  c.threshold = params.threshold;
  c.quadratic = params.map == 0 ? 1 : 0;
  c.range = params.range;
  c.bias = params.bias;
  c.skip_outside = params.border;
  c.strength = params.strength;
  fill_points(params.samples, params.shape == 0, c.points);
}

}  // namespace

Effect effect_sphere() {
  return occlusion_effect<fill_constants>(
      kTable, {.name = "sphere",
               .summary = "sample points in a sphere: darker where more of them lie behind something",
               .source = "Lajzer and Nottingham",
               .set_radius = set_radius_of<&SphereParams::reach>,
               .tunable = {"samples", "shape", "threshold", "strength"},
               .variants = {"", "samples=16", "samples=32", kOurs},
               .quantum = kQuantum,
               .passes = {sampling_pass(sphere_kernel())}});
}

}  // namespace umbrage
