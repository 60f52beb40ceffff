#include "effects/alchemy/alchemy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/absolute_length.h"
#include "core/effect.h"
#include "kernel/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(alchemy)

namespace {

constexpr std::uint32_t kSpirv[] = {
#include "spirv/alchemy.inc"
};

const std::vector<Parameter> kTable = {
    {.name = "samples",
     .help = "points of the disc per pixel",
     .type = ParameterType::kInt,
     .offset = offsetof(AlchemyParams, samples),
     .initial = 12,
     .least = 1,
     .most = kAlchemyMostSamples},
    {.name = "turns",
     .help = "turns of the spiral on which the points lie; best without a divisor in common with `samples`",
     .type = ParameterType::kInt,
     .offset = offsetof(AlchemyParams, turns),
     .initial = 7,
     .least = 1,
     .most = 255},
    {.name = "radius",
     .help = "radius of the disc, in scene units or as a share of the scene's radius",
     .type = ParameterType::kLength,
     .offset = offsetof(AlchemyParams, radius),
     .initial = 10.0,
     .least = 0.0,
     .most = 1e12,
     .unit = "scene units",
     .initially_relative = true,
     .above_zero = true},
    {.name = "formula",
     .help = "alchemy: what is far counts less, at any distance; scalable: nothing beyond the radius counts",
     .type = ParameterType::kChoice,
     .offset = offsetof(AlchemyParams, formula),
     .choices = {"alchemy", "scalable"}},
    {.name = "strength",
     .help = "factor of the obscurance, for a radius of 1",
     .offset = offsetof(AlchemyParams, strength),
     .initial = 0.4,
     .least = 0.0,
     .most = 100.0},
    {.name = "contrast",
     .help = "power of the result",
     .offset = offsetof(AlchemyParams, contrast),
     .initial = 1.0,
     .least = 0.01,
     .most = 100.0},
    {.name = "bias",
     .help = "share of the depth by which a point must rise over the surface's plane to count",
     .offset = offsetof(AlchemyParams, bias),
     .initial = 1e-4,
     .least = 0.0,
     .most = 1.0},
    {.name = "epsilon",
     .help = "added to the squared distance, in squared radii, against division by 0",
     .offset = offsetof(AlchemyParams, epsilon),
     .initial = 1e-4,
     .least = 1e-8,
     .most = 1.0},
};

// A tap that falls into the next pixel may add a large term: two quanta.
constexpr double kQuantum = 0.5;

void fill_constants(const ParameterBytes& bytes, const PictureInfo& info, void* out) {
  const auto& params = as<AlchemyParams>(bytes);
  auto& c = *static_cast<AlchemyConstants*>(out);
  c = {};
  c.samples = params.samples;
  const float radius = absolute_length(params.radius, info.scene_radius);
  c.radius = std::clamp(radius, 1e-12f, 1e12f);
  c.radius2 = c.radius * c.radius;
  const Camera& camera = info.camera;
  const float column = (camera.right - camera.left) / float(info.width);
  const float row = (camera.top - camera.bottom) / float(info.height);
  c.reach = c.radius / column;
  c.rows = -column / row;
  c.scalable = params.formula;
  // [2011]: 2 sigma / s. [2012]: 5 sigma / (r^6 s), of which the kernel has r^-6. Both are for metres: one radius more.
  c.factor = (c.scalable ? 5.0f : 2.0f) * params.strength * c.radius / float(params.samples);
  c.contrast = params.contrast;
  c.bias = params.bias;
  c.epsilon = params.epsilon * c.radius2;
  for (int i = 0; i < params.samples; ++i) {
    // [McGuire et al. 2012], equation 4: a spiral; by the square root all parts of the disc are alike, as in [2011].
    const double share = (i + 0.5) / params.samples, angle = 2.0 * std::numbers::pi * share * params.turns;
    const double length = c.scalable ? share : std::sqrt(share);
    c.points[2 * i] = float(length * std::cos(angle));
    c.points[2 * i + 1] = float(length * std::sin(angle));
  }
}

void set_radius(float radius, const PictureInfo&, ParameterBytes& bytes) {
  as<AlchemyParams>(bytes).radius = {radius, 0};
}

}  // namespace

const Effect& effect_alchemy() {
  static const Effect effect = {
      .name = "alchemy",
      .summary = "points in a disc: darker by how high what they see stands over the surface",
      .source = "McGuire et al. 2011",
      .kind = EffectKind::kOcclusion,
      .parameters = kTable,
      .params_size = sizeof(AlchemyParams),
      .constants_size = sizeof(AlchemyConstants),
      .constants = fill_constants,
      .set_radius = set_radius,
      .tunable = {"samples", "strength", "contrast", "bias"},
      .variants = {"", "samples=32 turns=13", "formula=scalable samples=11 strength=0.3"},
      .quantum = kQuantum,
      .passes = {{.name = "alchemy",
                  .inputs = {"depth", "normal.x", "normal.y", "normal.z"},
                  .outputs = {"ao"},
                  .scalar = run_scalar_alchemy,
                  .lanes = run_lanes_alchemy,
                  .spirv = kSpirv,
                  .tile_width = 128,
                  .tile_height = 32,
                  .reach = own_row,
                  .far_inputs = {"depth"},
                  .for_missing = true}},
  };
  return effect;
}

}  // namespace umbrage
