// The parameter table, kernel constants and dispatches of `alchemy` [McGuire et al. 2011].
#include "effects/alchemy/alchemy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/parameters.h"
#include "kernels/alchemy.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kAlchemyTable = {
    int_row("samples", &AlchemyParams::samples, {.initial = 12, .min = 1, .max = kAlchemyMaxSamples},
            "number N of points in the disc, per pixel"),
    int_row("turns", &AlchemyParams::turns, {.initial = 7, .min = 1, .max = 255},
            "turns of the spiral of points; best coprime to `samples`"),
    radius_row(
        "radius", &AlchemyParams::radius,
        "radius R of the disc, in scene units or in percent of the bounding-sphere radius; `occlusion_radius` sets it"),
    choice_row(
        "formula", &AlchemyParams::formula, 0, {"alchemy", "scalable"},
        "alchemy: distant occluders count less, without a limit; scalable: occluders beyond the radius do not count"),
    real_row("strength", &AlchemyParams::strength, {.initial = 0.4, .max = 100},
             "factor s for the obscurance, with lengths in radii; sigma in the papers"),
    real_row("contrast", &AlchemyParams::contrast, {.initial = 1, .min = 0.01, .max = 100}, "exponent k of the result"),
    real_row("bias", &AlchemyParams::bias, {.initial = 1e-4, .max = 1},
             "min height b above the surface's plane at which a point occludes, as a fraction of the depth"),
    real_row("epsilon", &AlchemyParams::epsilon, {.initial = 1e-4, .min = 1e-8, .max = 1},
             "e, added to the squared distance to avoid division by 0, in squared radii"),
};

// A tap that rounding moves to the next pixel may change the result by a large term, up to two quanta.
constexpr double kAlchemyQuantum = 0.5;

void fill_alchemy(const AlchemyParams& params, const PictureInfo& info, AlchemyConstants& c) {
  c.samples = params.samples;
  c.radius = std::clamp(absolute_length(params.radius, info.scene_radius), 1e-12f, 1e12f);
  c.radius2 = c.radius * c.radius;
  const float column = info.pixel_width(), row = info.pixel_height();
  c.radius_px = c.radius / column;
  c.rows_per_column = -column / row;
  c.scalable = params.formula;
  // The factor is 2 sigma / s in [2011], and 5 sigma / (r^6 s) in [2012], where the kernel applies r^-6. Both formulas
  // are for metres; the extra factor of the radius makes the strength independent of the unit.
  c.factor = (c.scalable ? 5.0f : 2.0f) * params.strength * c.radius / float(params.samples);
  c.contrast = params.contrast;
  c.bias = params.bias;
  c.epsilon = params.epsilon * c.radius2;
  for (int i = 0; i < params.samples; ++i) {
    // A spiral [McGuire et al. 2012, equation 4]. The square root, for `alchemy` only, makes the points uniform in the
    // disc, as in [2011].
    const double fraction = (i + 0.5) / params.samples, angle = 2.0 * std::numbers::pi * fraction * params.turns;
    const double length = c.scalable ? fraction : std::sqrt(fraction);
    c.points[2 * i] = float(length * std::cos(angle));
    c.points[2 * i + 1] = float(length * std::sin(angle));
  }
}

}  // namespace

Effect effect_alchemy() {
  return occlusion_effect<fill_alchemy>(
      kAlchemyTable, {.name = "alchemy",
                      .summary = "sample points in a disc: darker the higher they lie above the surface's plane",
                      .source = "McGuire et al. 2011",
                      .set_radius = set_radius_of<&AlchemyParams::radius>,
                      .tunable = {"samples", "strength", "contrast", "bias"},
                      .variants = {"", "samples=32 turns=13", "formula=scalable samples=11 strength=0.3"},
                      .quantum = kAlchemyQuantum,
                      .dispatches = {sampling_dispatch(alchemy_kernel())}});
}

}  // namespace umbrage
