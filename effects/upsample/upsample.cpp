#include "effects/upsample/upsample.h"

#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "kernels/upsample_ao.h"
#include "kernels/upsample_light.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kUpsampleTable = {
    choice_row("factor", &UpsampleParams::factor, 0, {"2", "4"},
               "full-resolution pixels per reduced pixel, across and down; `occlusion_scale` sets it"),
    bool_row("indirect", &UpsampleParams::indirect, false,
             "upsample indirect light as well as occlusion; `occlusion_scale` sets it if the technique writes any"),
    bool_row("leave", &UpsampleParams::leave, false,
             "let the technique compute pixels that too few reduced pixels fit; `occlusion_scale` sets it"),
    real_row("distance", &UpsampleParams::distance, {.initial = 1, .min = 0.01, .max = 100, .unit = "px"},
             "max distance of a pixel from another's plane at which it fits fully, in pixels of the whole picture"),
    real_row("angle", &UpsampleParams::angle, {.initial = 25, .min = 1, .max = 180, .unit = "deg"},
             "max angle between normals at which pixels fit fully"),
};

void fill_upsample(const UpsampleParams& params, const PictureInfo&, UpsampleConstants& c) {
  const int factor = params.factor == kUpsampleQuarter ? 4 : 2;
  const double cosine = std::cos(params.angle * std::numbers::pi / 180.0);
  c = {factor, params.leave, params.distance, float(1.0 / (1.0 - cosine))};
}

bool includes_light(const ParameterBytes& bytes) { return as<UpsampleParams>(bytes).indirect != 0; }
bool ao_only(const ParameterBytes& bytes) { return !includes_light(bytes); }

/// Returns the number of rows that the kernels read above and below a pixel: at most two blocks beyond the pixel's own.
int upsample_reach(const void* constants, int) { return 3 * static_cast<const UpsampleConstants*>(constants)->factor; }

void set_reduction(const Reduction& reduction, ParameterBytes& bytes) {
  auto& params = as<UpsampleParams>(bytes);
  params.factor = reduction.factor == 4 ? kUpsampleQuarter : kUpsampleHalf;
  params.indirect = reduction.indirect ? 1 : 0;
  params.leave = reduction.leave ? 1 : 0;
}

}  // namespace

Effect effect_upsample() {
  return shading_effect<fill_upsample>(
      kUpsampleTable, {.name = "upsample",
                       .summary = "upsample occlusion and reflected light to full resolution, along surfaces",
                       .source = "Kopf et al. 2007",
                       .set_reduction = set_reduction,
                       .variants = {"", "factor=4", "indirect=on"},
                       .dispatches = {{.name = "ao",
                                       .inputs = {"reduced_ao", "depth", "normal.x", "normal.y", "normal.z"},
                                       .outputs = {"ao"},
                                       .kernel = upsample_ao_kernel(),
                                       .needed = ao_only,
                                       .reach = upsample_reach},
                                      {.name = "light",
                                       .inputs = {"reduced_ao", "reduced_indirect.r", "reduced_indirect.g",
                                                  "reduced_indirect.b", "depth", "normal.x", "normal.y", "normal.z"},
                                       .outputs = {"ao", "indirect.r", "indirect.g", "indirect.b"},
                                       .kernel = upsample_light_kernel(),
                                       .needed = includes_light,
                                       .reach = upsample_reach}}});
}

}  // namespace umbrage
