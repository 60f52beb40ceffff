#include "effects/ground/ground.h"

#include "core/effect.h"
#include "kernels/ground.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kTable = {
    real_row("strength", &GroundParams::strength, {.initial = 1, .max = 2}, "how dark the shade on the ground is"),
    choice_row("blend", &GroundParams::blend, 0, {"light", "display"},
               "how the shade is laid over a background: as light, or as picture viewers do that know alpha alone"),
};

void fill_constants(const GroundParams& params, const PictureInfo& info, GroundConstants& c) {
  c = {.object = float(info.ground_object),
       .strength = params.strength,
       .display = params.blend,
       .middle_x = info.ground_middle.x,
       .middle_y = info.ground_middle.y,
       .middle_z = info.ground_middle.z,
       .inverse_fades = info.ground_fades > 0.0f ? 1.0f / info.ground_fades : 0.0f};
}

}  // namespace

Effect effect_ground() {
  return shading_effect<fill_constants>(
      kTable, {.name = "ground",
               .summary = "leaves of the ground under a model the shade on it alone",
               .source = "",
               .passes = {{.inputs = {"open_light", "indirect.r", "indirect.g", "indirect.b", "depth", "object_id",
                                      "lit.r", "lit.g", "lit.b"},
                           .outputs = {"lit.r", "lit.g", "lit.b", "cover"},
                           .kernel = ground_kernel(),
                           .reach = own_row}}});
}

}  // namespace umbrage
