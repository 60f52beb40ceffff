// The parameter table, kernel constants and dispatches of `bitmask` [Therrien et al. 2023].
#include "effects/bitmask/bitmask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/effect.h"
#include "core/parameters.h"
#include "effects/hemisphere/sent_planes.h"
#include "kernels/bitmask_bent.h"
#include "kernels/bitmask_bleeding.h"
#include "kernels/bitmask_horizon.h"
#include "kernels/bitmask_layers.h"
#include "kernels/bitmask_mips.h"
#include "kernels/bitmask_occlusion.h"
#include "kernels/bitmask_sent.h"

namespace umbrage {
namespace {

constexpr float kAssumedVisibility = 0.7f;  // of ambient light, in the first round: typical of a room

// Automatic `slope` with n depth layers: kSlopeBase + kSlopeOverLayers / n. Fitted to minimize the error over the
// built-in scenes, the bunny and Sponza with 1, 2 and 4 layers. The more layers, the less thickness has to be assumed.
constexpr float kSlopeBase = 0.4f, kSlopeOverLayers = 0.4f;

const std::vector<Parameter> kBitmaskTable = {
    int_row("slices", &BitmaskParams::slices, {.initial = 2, .min = 1, .max = 64},
            "planes through the view ray in which occluders are searched"),
    int_row("steps", &BitmaskParams::steps, {.initial = 8, .min = 1, .max = 512},
            "depth taps along each side of a slice"),
    choice_row("distribution", &BitmaskParams::distribution, kBitmaskStep15, {"1", "1.5", "2", "3"},
               "exponent of the steps' distances: higher values put more steps near the pixel"),
    radius_row("radius", &BitmaskParams::radius,
               "search radius for occluders, in scene units or in percent of the bounding-sphere radius; "
               "`occlusion_radius` sets it"),
    choice_row("mode", &BitmaskParams::mode, 0, {"thick", "infinite", "layers"},
               "where occluders end in depth: thick: at the assumed thickness; infinite: never; layers: every captured "
               "layer occludes, up to the next layer, but at most up to the assumed thickness"),
    real_row("thickness", &BitmaskParams::thickness, {.initial = 0.05, .max = 100},
             "assumed thickness of occluders, in radii"),
    real_row("slope", &BitmaskParams::slope, {.max = 100, .zero_means = "automatic"},
             "assumed thickness of occluders, as a fraction of their distance; the larger of `thickness` and `slope` "
             "is used"),
    choice_row("measure", &BitmaskParams::measure, 0, {"exact", "uniform", "sectors"},
               "what a bit of a slice covers: exact: an equal part of the cosine-weighted directions; uniform: an "
               "equal angle; sectors: an equal step of the sine of the angle to the normal"),
    real_row("falloff", &BitmaskParams::falloff, {.max = 1},
             "mode infinite: outer fraction of the radius over which occluders fade out"),
    choice_row("noise", &BitmaskParams::noise, kBitmaskTile, {"hilbert", "tile", "hash", "none"},
               "noise that rotates slices and offsets steps per pixel: a low-discrepancy sequence along a Hilbert "
               "curve of 64x64 pixels, a tile of 4x4 pixels, a hash, or none"),
    renamed_from("frame", int_row("sample_index", &BitmaskParams::sample_index, {.max = 65535},
                                  "index among several pictures that are averaged; each has different noise")),
    bool_row("mips", &BitmaskParams::mips, false, "read distant taps from mip levels of the depth; not in mode layers"),
    choice_row("border", &BitmaskParams::border, 0, {"skip", "open"},
               "taps outside the picture: left out of the estimate, or unoccluded"),
    bool_row("bent", &BitmaskParams::bent, false, "also write the plane `bent`, the mean unoccluded direction"),
    real_row("bleeding", &BitmaskParams::bleeding, {.max = 100, .zero_means = "off"},
             "factor for the indirect light from occluders"),
    real_row("ambient_bounce", &BitmaskParams::ambient_bounce, {.initial = 1, .max = 10},
             "factor for the ambient light that surfaces reflect"),
    real_row("directional", &BitmaskParams::directional, {.max = 10, .zero_means = "off"},
             "factor for the direction of ambient light: open directions take the light that comes from there; as the "
             "factor of ambient light, lighting.ambient"),
    int_row("bounces", &BitmaskParams::bounces, {.initial = 1, .min = 1, .max = 16},
            "number of bounces; each reflects the indirect light of the one before"),
    int_row("layers", &BitmaskParams::layers, {.max = kLayersRead, .zero_means = "all"},
            "mode layers: number of captured depth layers in which occluders are searched"),
};

// With a single tap, that tap may cover a whole slice and change the result by up to two quanta.
constexpr double kBitmaskQuantum = 0.5;

/// Fills in the layers of the first camera to search, nearest first, and for each the layer that shows the back sides
/// of its surfaces, or -1.
void fill_layers(const BitmaskParams& params, const PictureInfo& info, BitmaskConstants& c) {
  const int captured = std::min(int(info.more_layers.size()) + 1, kLayersRead);
  const int max_layers = params.mode != kBitmaskLayers ? 1 : params.layers > 0 ? params.layers : kLayersRead;
  const auto info_of = [&](int layer) -> const LayerInfo& { return info.more_layers[std::size_t(layer) - 1]; };
  int previous = 0;  // the next layer must be behind this one
  for (int layer = 0; layer < captured && c.layer_count < max_layers; ++layer) {
    if (layer > 0 && (info_of(layer).kind != LayerKind::kBehind || info_of(layer).of != previous)) continue;
    previous = layer;
    const int i = c.layer_count++;
    c.layer[i] = layer;
    c.back[i] = -1;
    for (int k = 1; k < captured; ++k)
      if (info_of(k).kind == LayerKind::kBack && info_of(k).of == layer) c.back[i] = k;
  }
}

/// Sets the number of mip levels: as many as fit into one plane of the picture's size, one below the other, but at most
/// kBitmaskMaxMips.
void fill_mips(const PictureInfo& info, BitmaskConstants& c) {
  for (int levels = kBitmaskMaxMips; levels > 0; --levels) {
    const int multiple = 1 << (levels - 1);  // every level begins at an integer row
    const int rows = (info.height / 2 + multiple - 1) / multiple * multiple;
    if (2 * rows - rows / multiple > info.height || info.width >> levels == 0 || info.height >> levels == 0) continue;
    c.mip_levels = levels;
    c.mip_rows = rows;
    return;
  }
}

/// Returns BitmaskConstants::angles for a measure, by quadrature.
std::vector<float> angles_of(int measure) {
  constexpr int kSteps = 1024;  // of the angle, per row
  std::vector<float> angles;
  for (int row = 0; row < kBitmaskRows; ++row) {
    const double normal = std::numbers::pi * (row / double(kBitmaskRows - 1) - 0.5);
    std::array<double, kSteps> weights{}, theta{};
    for (int k = 0; k < kSteps; ++k) {
      const double from_normal = std::numbers::pi * ((k + 0.5) / kSteps - 0.5);
      theta[k] = normal + from_normal;
      weights[k] = measure == kBitmaskUniform ? 1.0 : std::cos(from_normal);
      if (measure == kBitmaskExact) weights[k] *= std::abs(std::sin(theta[k]));
    }
    const double whole = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::array<std::array<double, 5>, kBitmaskGroups> sums{};
    double before = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const double part = before + 0.5 * weights[k];
      before += weights[k];
      auto& sum = sums[std::min(std::size_t(part / whole * kBitmaskGroups), sums.size() - 1)];
      const double values[] = {std::cos(theta[k]), std::sin(theta[k]), std::cos(2.0 * theta[k]),
                               std::sin(2.0 * theta[k]), 1.0};
      for (int i = 0; i < 5; ++i) sum[i] += weights[k] * values[i];
    }
    for (const auto& sum : sums)
      for (int i = 0; i < 4; ++i) angles.push_back(float(sum[i] / sum[4]));
  }
  return angles;
}

/// Fills in the constants of bitmask_sky.kernel.h.
void fill_sky(const BitmaskParams& params, const PictureInfo& info, BitmaskConstants& c) {
  c.directional = info.ambient_shape.even() ? 0.0f : params.directional;
  if (c.directional == 0.0f) return;
  static const std::vector<float> tables[] = {angles_of(kBitmaskExact), angles_of(kBitmaskUniform),
                                              angles_of(kBitmaskSectors)};
  std::copy(tables[params.measure].begin(), tables[params.measure].end(), c.angles);
  const auto factors = sky_factors(info.ambient_shape);
  std::copy(factors.begin(), factors.end(), c.sky);
}

void fill_bitmask(const BitmaskParams& params, const PictureInfo& info, BitmaskConstants& c) {
  c.slices = params.slices;
  c.steps = params.steps;
  c.one_over_steps = 1.0f / float(params.steps);
  c.distribution = params.distribution;
  const double turn = std::numbers::pi / params.slices;
  c.turn_cos = float(std::cos(turn));
  c.turn_sin = float(std::sin(turn));
  c.one_over_slices = 1.0f / float(params.slices);
  c.radius = std::clamp(absolute_length(params.radius, info.scene_radius), 1e-15f, 1e15f);  // its square stays finite
  c.radius2 = c.radius * c.radius;
  const float column = info.pixel_width(), row = -info.pixel_height();
  c.radius_px = c.radius / column;
  c.rows_per_column = column / row;
  c.columns_per_row = row / column;
  c.infinite = params.mode == kBitmaskInfinite ? 1 : 0;
  c.thickness = params.thickness * c.radius;
  c.measure = params.measure;
  c.falloff = params.falloff;
  c.fade = params.falloff > 0.0f ? 1.0f / (c.radius * params.falloff) : 0.0f;
  c.noise = params.noise;
  // Steps of the three-dimensional golden-ratio sequence [Roberts 2018].
  const auto fraction = [&](double step) { return float(std::fmod(step * params.sample_index, 1.0)); };
  c.sample_turn = fraction(0.8191725133961644);
  c.sample_step = fraction(0.6710436067037893);
  c.sample_bit = fraction(0.5497004779019703);
  c.skip_outside = params.border == 0 ? 1 : 0;
  if (params.mips && params.mode != kBitmaskLayers) fill_mips(info, c);
  c.bleeding = params.bleeding;
  c.ambient_bounce = params.ambient_bounce;
  c.assumed_visibility = kAssumedVisibility;
  fill_layers(params, info, c);
  fill_sky(params, info, c);
  c.slope = params.slope > 0.0f ? params.slope : kSlopeBase + kSlopeOverLayers / float(std::max(c.layer_count, 1));
}

bool has_mips(const ParameterBytes& bytes) {
  const auto& params = as<BitmaskParams>(bytes);
  return params.mips != 0 && params.mode != kBitmaskLayers;
}
bool gathers_light(const ParameterBytes& bytes) {
  const auto& params = as<BitmaskParams>(bytes);
  return params.bleeding > 0.0f || params.directional > 0.0f;
}
bool stores_bent(const ParameterBytes& bytes) { return as<BitmaskParams>(bytes).bent != 0; }
bool uses_layer_bits(const ParameterBytes& bytes) {
  return as<BitmaskParams>(bytes).mode == kBitmaskLayers && !gathers_light(bytes) && !stores_bent(bytes);
}
/// Returns whether the highest occluder on each side of a slice determines the result, so that no bits are needed.
bool uses_horizon(const ParameterBytes& bytes) {
  const auto& params = as<BitmaskParams>(bytes);
  return params.mode == kBitmaskInfinite && params.measure == kBitmaskExact && !gathers_light(bytes) &&
         !stores_bent(bytes);
}
bool uses_first_layer_bits(const ParameterBytes& bytes) {
  return !gathers_light(bytes) && !stores_bent(bytes) && !uses_layer_bits(bytes) && !uses_horizon(bytes);
}
int bitmask_rounds(const ParameterBytes& bytes, const PictureInfo&) {
  return gathers_light(bytes) ? as<BitmaskParams>(bytes).bounces : 1;
}

/// Returns a dispatch that reads the planes `searched` anywhere in the picture, to find occluders, and writes `ao` and
/// `more_outputs`.
Dispatch search_dispatch(std::string_view name, const Kernel& kernel, bool (*needed)(const ParameterBytes&),
                         const PlaneNames& searched, const PlaneNames& more_outputs = {}) {
  return {.name = name,
          .inputs = joined(searched, {"normal.x", "normal.y", "normal.z", "bitmask_mips"}),
          .outputs = joined({"ao"}, more_outputs),
          .kernel = kernel,
          .needed = needed,
          .tile = kSquareTile,
          .reach = own_row,
          .unbounded_inputs = joined(searched, {"bitmask_mips"})};
}

}  // namespace

Effect effect_bitmask() {
  return occlusion_effect<fill_bitmask>(
      kBitmaskTable,
      {.name = "bitmask",
       .summary =
           "slices of the hemisphere as 32 bits of equal weight: the most accurate technique; also indirect light",
       .source = "Therrien et al. 2023",
       .set_radius = set_radius_of<&BitmaskParams::radius>,
       .noise = "sample_index",
       .tunable = {"slices", "steps", "distribution", "mode", "thickness", "slope"},
       .variants = {"", "slices=1 steps=6", "slices=2 steps=12", "slices=4 steps=24", "mode=infinite",
                    "measure=uniform slope=0.01 thickness=1", "mode=infinite falloff=0.6", "mode=layers", "bleeding=1",
                    "mode=layers bleeding=1"},
       .quantum = kBitmaskQuantum,
       .neutral = {{"bitmask_mips", 0.0f}},
       .dispatches = {{.name = "mips",
                       .inputs = {"depth"},
                       .outputs = {"bitmask_mips"},
                       .kernel = bitmask_mips_kernel(),
                       .needed = has_mips},
                      {.name = "sent",
                       .inputs = sent_inputs(),
                       .outputs = packed_planes(),
                       .kernel = bitmask_sent_kernel(),
                       .needed = gathers_light,
                       .reach = own_row},
                      search_dispatch("horizon", bitmask_horizon_kernel(), uses_horizon, {"depth"}),
                      search_dispatch("occlusion", bitmask_occlusion_kernel(), uses_first_layer_bits, {"depth"}),
                      search_dispatch("layers", bitmask_layers_kernel(), uses_layer_bits, of_all_layers({"depth"})),
                      search_dispatch("bleeding", bitmask_bleeding_kernel(), gathers_light, outgoing_light_planes(),
                                      {"indirect.r", "indirect.g", "indirect.b"}),
                      search_dispatch("bent", bitmask_bent_kernel(), stores_bent, of_all_layers({"depth"}),
                                      {"bent.x", "bent.y", "bent.z"})},
       .rounds = bitmask_rounds});
}

}  // namespace umbrage
