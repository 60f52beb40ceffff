// The parameter table, kernel constants and dispatches of `hbao` [Bavoil et al. 2008].
#include "effects/hbao/hbao.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/parameters.h"
#include "kernels/hbao.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kHbaoTable = {
    int_row("directions", &HbaoParams::directions, {.initial = 6, .min = 1, .max = 64},
            "directions in the picture in which the horizon is searched"),
    int_row("steps", &HbaoParams::steps, {.initial = 6, .min = 1, .max = 256}, "depth taps in each direction"),
    radius_row("radius", &HbaoParams::radius,
               "search radius for occluders, in scene units or in percent of the bounding-sphere radius; "
               "`occlusion_radius` sets it"),
    real_row("angle_bias", &HbaoParams::angle_bias, {.initial = 10, .max = 89, .unit = "deg"},
             "elevation above the tangent plane below which nothing occludes"),
    bool_row("attenuation", &HbaoParams::attenuation, true,
             "weight occluders by 1 - r^2, with distances r in radii; off: by 1"),
    real_row("strength", &HbaoParams::strength, {.initial = 1, .max = 10}, "factor for the occlusion"),
};

// With a single tap, that tap determines the horizon and may change the result by up to two quanta.
constexpr double kHbaoQuantum = 0.5;

void fill_hbao(const HbaoParams& params, const PictureInfo& info, HbaoConstants& c) {
  c.directions = params.directions;
  c.steps = params.steps;
  c.one_over_steps = 1.0f / float(params.steps);
  const double turn = 2.0 * std::numbers::pi / params.directions;
  c.turn_cos = float(std::cos(turn));
  c.turn_sin = float(std::sin(turn));
  c.turn_fraction = 1.0f / float(params.directions);
  c.radius = std::clamp(absolute_length(params.radius, info.scene_radius), 1e-15f, 1e15f);
  c.radius2 = c.radius * c.radius;
  const float column = info.pixel_width(), row = info.pixel_height();
  c.radius_px = c.radius / column;
  c.rows_per_column = -column / row;
  const double bias = params.angle_bias * std::numbers::pi / 180.0;
  c.bias_cos = float(std::cos(bias));
  c.bias_sin = float(std::sin(bias));
  c.attenuation = params.attenuation;
  c.factor = params.strength / float(params.directions);
}

}  // namespace

Effect effect_hbao() {
  return occlusion_effect<fill_hbao>(
      kHbaoTable, {.name = "hbao",
                   .summary = "horizons in several directions: darker the higher they rise above the surface",
                   .source = "Bavoil et al. 2008",
                   .set_radius = set_radius_of<&HbaoParams::radius>,
                   .tunable = {"directions", "steps", "angle_bias", "attenuation", "strength"},
                   .variants = {"", "angle_bias=30", "directions=4 steps=8 attenuation=off"},
                   .quantum = kHbaoQuantum,
                   .dispatches = {sampling_dispatch(hbao_kernel())}});
}

}  // namespace umbrage
