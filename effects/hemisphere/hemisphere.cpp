// The parameter table, kernel constants and dispatches of `hemisphere` [Colliander and Törnquist 2015].
#include "effects/hemisphere/hemisphere.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/effect.h"
#include "core/hash.h"
#include "core/parameters.h"
#include "effects/hemisphere/layer_views.h"
#include "effects/hemisphere/sent_planes.h"
#include "kernels/hemisphere_bleeding.h"
#include "kernels/hemisphere_occlusion.h"
#include "kernels/hemisphere_sent.h"
#include "kernels/hemisphere_tangents.h"

namespace umbrage {
namespace {

// The settings of the paper: its tables of samples and noise; a comparison of depths only; a limit of the range that
// falls with the square of the depth, in window depth; a fixed fragment size.
constexpr std::string_view kPaper =
    "distribution=paper range=quadratic range_depth=window bias_of=depth bias=0 border=clamp bleeding=1 area=paper "
    "floor=0 weight=1 ambient_bounce=0";
constexpr float kMinInner = 1e-3f;       // min of `inner`, radii; lengths uniform in their logarithm need a lower bound
constexpr double kMinRayDistance = 0.1;  // min distance of a view ray from a pixel, relative to the min sample length
constexpr float kAssumedVisibility = 0.7f;  // of ambient light, where it is not computed: typical of a room
constexpr float kMinNearToFar = 1e-4f;      // min near plane, as a fraction of the far plane; avoids division by 0

const std::vector<Parameter> kHemisphereTable = {
    int_row("samples", &HemisphereParams::samples, {.initial = 16, .min = 1, .max = kHemisphereMaxSamples},
            "sample points per pixel"),
    choice_row("shape", &HemisphereParams::shape, 0, {"hemisphere", "sphere"},
               "sample the hemisphere above the surface, or the whole sphere, so that flat surfaces lose half of their "
               "light, and convex corners less"),
    radius_row("radius", &HemisphereParams::radius,
               "radius of the hemisphere, in scene units or in percent of the bounding-sphere radius; "
               "`occlusion_radius` sets it"),
    choice_row("distribution", &HemisphereParams::distribution, 0, {"even", "paper"},
               "sample points: even: directions at equal steps of height; half of the lengths at equal steps, half at "
               "equal steps of their logarithm; paper: a random table"),
    int_row("seed", &HemisphereParams::seed, {.max = 1e6}, "seed of the sample points and of the noise"),
    int_row("noise", &HemisphereParams::noise,
            {.initial = 4, .max = 64, .unit = "px", .zero_means = "as large as the picture"},
            "side of the noise tile that rotates the sample points about the normal and shifts the lengths of even "
            "points; 1: the same for all pixels"),
    choice_row("range", &HemisphereParams::range, kHemisphereRangeSmoothstep,
               {"none", "constant", "linear", "quadratic", "smoothstep"},
               "max difference in depth of an occluder: unlimited, a limit that is constant or falls with the depth or "
               "with its square, or fading beyond the limit"),
    choice_row("range_depth", &HemisphereParams::range_depth, 0, {"view", "window"},
               "depth to which the range applies: distance along the view axis, or window depth in [0, 1]"),
    real_row("range_factor", &HemisphereParams::range_factor, {.initial = 1, .max = 100},
             "limit of the range in radii; for window depth: in radii divided by the depth span, far - near"),
    real_row("near", &HemisphereParams::near_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's near plane"),
    real_row("far", &HemisphereParams::far_depth, {.max = 1e12, .unit = "scene units", .zero_means = "automatic"},
             "distance of window depth's far plane"),
    real_row("bias", &HemisphereParams::bias, {.initial = 0.02, .max = 1},
             "occluders that rise less than this fraction of the radius (above the surface, or in front of the sample: "
             "see bias_of) do not count"),
    choice_row("bias_of", &HemisphereParams::bias_of, 0, {"surface", "depth"},
               "reference of the bias: the surface's plane, which keeps planes unoccluded, or the sample's depth, as "
               "in the paper"),
    real_row("weight", &HemisphereParams::weight, {.initial = 1.5, .max = 10},
             "how much one occluder adds to the occlusion"),
    choice_row("border", &HemisphereParams::border, 0, {"skip", "clamp"},
               "samples outside the picture: not counted, or moved to the nearest pixel"),
    bool_row("occlusion", &HemisphereParams::occlusion, true, "write occlusion; off: visibility is 1 everywhere"),
    real_row("bleeding", &HemisphereParams::bleeding, {.max = 100, .zero_means = "off"},
             "factor for the indirect light from occluders"),
    choice_row(
        "area", &HemisphereParams::area, 0, {"measured", "equal", "paper"},
        "surface area that an occluding sample represents: measured from the samples' density, an equal fraction of "
        "the radius's disc, or the paper's fixed fragment"),
    real_row("fragment_area", &HemisphereParams::fragment_area, {.initial = 0.05, .max = 100},
             "area paper: size of a fragment, A_f in the paper, in squares of the radius"),
    real_row("floor", &HemisphereParams::floor, {.initial = 0.02, .max = 0.5},
             "fraction of the radius: length of the shortest sample of distribution even, and min distance of an "
             "emitter of area equal and paper"),
    int_row("layers", &HemisphereParams::layers, {.max = kLayersRead, .zero_means = "all"},
            "number of captured depth layers in which occluders are searched"),
    real_row("ambient_bounce", &HemisphereParams::ambient_bounce, {.initial = 1, .max = 10},
             "factor for the ambient light that surfaces reflect"),
    int_row("bounces", &HemisphereParams::bounces, {.initial = 1, .min = 1, .max = 16},
            "number of bounces; each reflects the indirect light of the one before"),
    bool_row("tangents", &HemisphereParams::tangents, false,
             "also write the plane `tangent`: the direction, in view space, to which each pixel's points are turned "
             "about the normal"),
};

// With a single sample, a flip of this sample changes occlusion and light from none to full: two quanta.
constexpr double kHemisphereQuantum = 0.5;

/// Fills in the paper's kernel texture: x and y are uniform in [-1, 1], z in [0.05, 1] (shape sphere: in [-1, 1]); each
/// point is scaled to length 1 and then by a quadratic of its index. The paper does not give the factors of the
/// quadratic; here it is that of the tutorial that the paper follows, 0.1 + 0.9 (i/N)^2 [learnopengl.com, "SSAO"].
void fill_paper_points(const HemisphereParams& params, float* points) {
  std::mt19937 random(std::uint32_t(params.seed) + 1u);
  const auto uniform = [&](double min, double max) { return min + (max - min) * (random() * 0x1p-32); };
  for (int i = 0; i < params.samples; ++i) {
    const double x = uniform(-1.0, 1.0), y = uniform(-1.0, 1.0);
    const double z = params.shape == 0 ? uniform(0.05, 1.0) : uniform(-1.0, 1.0);
    const double fraction = double(i) / params.samples;
    const double scale = (0.1 + 0.9 * fraction * fraction) / std::sqrt(std::max(x * x + y * y + z * z, 1e-12));
    const double row[5] = {x * scale, y * scale, z * scale, 1.0, 1.0};
    for (int k = 0; k < 5; ++k) points[5 * i + k] = float(row[k]);
  }
}

/// Fills in the points of distribution `even`.
/// Differs: every other point has a length in equal steps of its logarithm, to find near occluders; the rest have
/// lengths in equal steps, to find far ones. The kernel shifts both by a fraction of their range, per pixel. Heights
/// (in equal steps, for equal solid angles) and azimuths follow the golden-ratio sequence in two dimensions [Roberts
/// 2018], so that neither correlates with the length. In the hemisphere, the weight of a point is its cosine to the
/// normal, times 2, since light from the side matters less; in the whole sphere, all weights are equal.
void fill_even_points(const HemisphereParams& params, double inner, float* points) {
  const int n = params.samples;
  for (int first = 0; first < 2; ++first) {
    const int count = (n + 1 - first) / 2;
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    const auto key = [](int i) { return fractional_part(0.5 + (i + 1) / (kPlasticNumber * kPlasticNumber)); };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
    for (int rank = 0; rank < count; ++rank) {
      const int i = order[rank];
      const double height = (rank + (count > 1 ? 0.25 + 0.5 * first : 0.5)) / count;
      const double z = params.shape == 0 ? height : 2.0 * height - 1.0;
      const double azimuth = 2.0 * std::numbers::pi * fractional_part(0.5 + (i + 1) / kPlasticNumber + 0.5 * first);
      const double across = std::sqrt(1.0 - z * z);
      const double length = first == 0 ? std::pow(inner, double(i) / count) : double(i) / count;
      const double row[5] = {across * std::cos(azimuth), across * std::sin(azimuth), z, length,
                             params.shape == 0 ? 2.0 * z : 1.0};
      for (int k = 0; k < 5; ++k) points[5 * (2 * i + first) + k] = float(row[k]);
    }
  }
}

void fill_hemisphere(const HemisphereParams& params, const PictureInfo& info, HemisphereConstants& c) {
  c.samples = params.samples;
  c.radius = absolute_length(params.radius, info.scene_radius);
  c.even = params.distribution == kHemisphereEven ? 1 : 0;
  c.seed = params.seed;
  c.noise = params.noise;
  c.one_over_noise = 1.0f / float(std::max(1, params.noise));
  c.inner = std::max(params.floor, kMinInner);
  c.one_over_inner = 1.0f / c.inner;
  c.log_inner = std::log(c.inner);
  const double inner = std::max(double(c.inner) * c.radius, 1e-18), radius = std::max(double(c.radius), 1e-18);
  c.one_over_inner2 = float(std::min(1.0 / (inner * inner), 1e30));
  c.min_b2 = float(std::max(kMinRayDistance * kMinRayDistance * inner * inner, 1e-30));
  const double even_fraction = double(params.samples / 2) / params.samples;
  c.log_density = float((1.0 - even_fraction) / -double(c.log_inner));
  c.even_density = float(even_fraction / radius);

  // The default planes bound the scene as closely as possible, for the best resolution of window depth.
  float far_depth = params.far_depth > 0.0f ? params.far_depth : info.depth_max;
  float near_depth = params.near_depth > 0.0f ? params.near_depth : info.depth_min;
  // Kernels must not fail, so a near plane at or behind the far plane is moved to slightly in front of it.
  far_depth = std::max(far_depth, 1e-30f);
  near_depth = std::clamp(near_depth, far_depth * kMinNearToFar, far_depth * 0.999f);
  const double n = near_depth, f = far_depth;
  c.near_depth = near_depth;
  c.far_depth = far_depth;
  c.window_one = float(f / (f - n));
  c.window_inverse = float(f * n / (f - n));
  c.range = params.range;
  c.window = params.range_depth;
  // Window depth is 0 to 1 from n to f, hence the division by f - n. The three limits are equal at the geometric mean
  // of the planes. The quadratic limit is R times the slope of window depth, which everywhere means the same distance.
  c.limit = float(c.radius * double(params.range_factor) / (c.window ? f - n : 1.0));
  c.depth_at_limit = float(std::sqrt(f * n));

  const bool whole = params.shape != 0;
  c.above = whole ? 0 : 1;
  c.rises = !whole && params.bias_of == 0 ? 1 : 0;
  c.min_height = c.rises ? params.bias * c.radius : 0.0f;
  c.min_in_front = c.rises ? 0.0f : params.bias * c.radius;
  c.weight = params.weight;
  c.clamp_border = params.border;
  c.occlusion = params.occlusion;
  c.bleeding = params.bleeding;
  // `measured` requires an integral of the samples' density, which the paper's points do not have.
  c.area = params.area == kHemisphereAreaMeasured && !c.even ? kHemisphereAreaEqual : params.area;
  const double r2 = double(c.radius) * c.radius;
  c.area_factor = float(c.area == kHemisphereAreaPaper   ? params.fragment_area * r2
                        : c.area == kHemisphereAreaEqual ? r2 / params.samples
                                                         : (whole ? 4.0 : 2.0) / params.samples);
  c.min_distance = std::max(params.floor * c.radius, c.radius * 1e-6f);
  c.ambient_bounce = params.ambient_bounce;
  c.assumed_visibility = kAssumedVisibility;
  fill_layer_views(params.layers, info, c);
  if (c.even)
    fill_even_points(params, c.inner, c.points);
  else
    fill_paper_points(params, c.points);
}

bool gathers_light(const ParameterBytes& bytes) { return as<HemisphereParams>(bytes).bleeding > 0.0f; }
bool gathers_no_light(const ParameterBytes& bytes) { return !gathers_light(bytes); }
bool shows_tangents(const ParameterBytes& bytes) { return as<HemisphereParams>(bytes).tangents != 0; }
int hemisphere_rounds(const ParameterBytes& bytes, const PictureInfo&) {
  return gathers_light(bytes) ? as<HemisphereParams>(bytes).bounces : 1;
}

std::vector<std::string_view> bleeding_inputs() {
  return joined(outgoing_light_planes(), {"normal.x", "normal.y", "normal.z"});
}

std::vector<std::string_view> occlusion_inputs() {
  auto inputs = of_all_layers({"depth"});
  inputs.insert(inputs.end(), {"normal.x", "normal.y", "normal.z"});
  return inputs;
}

}  // namespace

Effect effect_hemisphere() {
  return occlusion_effect<fill_hemisphere>(
      kHemisphereTable,
      {.name = "hemisphere",
       .summary = "sample points above the surface: darker where they are occluded, coloured by their occluders",
       .source = "Colliander and Törnquist 2015",
       .set_radius = set_radius_of<&HemisphereParams::radius>,
       .noise = "seed",
       .tunable = {"samples", "distribution", "range", "bias"},
       .variants = {"", "samples=8", "samples=32 bleeding=1", "samples=64", "samples=64 bleeding=1", kPaper},
       .quantum = kHemisphereQuantum,
       .dispatches = {{.name = "sent",
                       .inputs = sent_inputs(),
                       .outputs = packed_planes(),
                       .later_inputs = sent_later_inputs(),
                       .kernel = hemisphere_sent_kernel(),
                       .needed = gathers_light,
                       .reach = own_row},
                      {.name = "occlusion",
                       .inputs = occlusion_inputs(),
                       .outputs = {"ao"},
                       .kernel = hemisphere_occlusion_kernel(),
                       .needed = gathers_no_light,
                       .tile = kSquareTile,
                       .reach = own_row,
                       .unbounded_inputs = of_all_layers({"depth"})},
                      {.name = "bleeding",
                       .inputs = bleeding_inputs(),
                       .outputs = {"ao", "indirect.r", "indirect.g", "indirect.b"},
                       .kernel = hemisphere_bleeding_kernel(),
                       .needed = gathers_light,
                       .tile = {256, 32},
                       .reach = own_row,
                       .unbounded_inputs = outgoing_light_planes()},
                      // Missing pixels get no reflected light, since that would require packing the outgoing light
                      // of the whole picture.
                      {.name = "missing",
                       .inputs = occlusion_inputs(),
                       .outputs = {"ao"},
                       .kernel = hemisphere_occlusion_kernel(),
                       .reach = own_row,
                       .unbounded_inputs = of_all_layers({"depth"}),
                       .for_all = false,
                       .for_missing = true},
                      {.name = "tangents",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"tangent.x", "tangent.y", "tangent.z"},
                       .kernel = hemisphere_tangents_kernel(),
                       .needed = shows_tangents,
                       .reach = own_row}},
       .rounds = hemisphere_rounds});
}

}  // namespace umbrage
