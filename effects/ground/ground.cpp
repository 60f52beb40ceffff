#include "effects/ground/ground.h"

#include <algorithm>

#include "core/effect.h"
#include "kernels/ground.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kGroundTable = {
    real_row("strength", &GroundParams::strength, {.initial = 1, .max = 2},
             "darkness of the shadow on the ground; 0: none; above 1 its light parts get darker"),
    real_row("border", &GroundParams::border, {.max = 50, .unit = "%", .zero_means = "off"},
             "the shadow fades out towards a rounded rectangle that touches the picture's borders, over this part of "
             "the sides"),
    choice_row(
        "blend", &GroundParams::blend, 0, {"light", "display"},
        "how the shadow is blended over a background: in linear light, or in display values, as image viewers do"),
};

void fill_ground(const GroundParams& params, const PictureInfo& info, GroundConstants& c) {
  c = {.object = float(info.ground_object),
       .strength = std::min(params.strength, 1.0f),
       .excess = std::max(params.strength - 1.0f, 0.0f),
       .display = params.blend,
       .middle_x = info.ground_center.x,
       .middle_y = info.ground_center.y,
       .middle_z = info.ground_center.z,
       .middle_px = 0.5f * float(info.width),
       .middle_py = 0.5f * float(info.height),
       .inverse_half_width = 2.0f / float(info.inner_width()),
       .inverse_half_height = 2.0f / float(info.inner_height()),
       .inverse_border = params.border > 0.0f ? 50.0f / params.border : 0.0f,
       .inverse_fade_distance = info.ground_fade_distance > 0.0f ? 1.0f / info.ground_fade_distance : 0.0f};
}

}  // namespace

Effect effect_ground() {
  return shading_effect<fill_ground>(
      kGroundTable, {.name = "ground",
                     .summary = "make the ground under a model a shadow catcher: only the shadow on it is visible",
                     .source = "",
                     .neutral = {{"shadow_catcher", 0.0f}},
                     .dispatches = {{.inputs = {"open_light", "indirect.r", "indirect.g", "indirect.b", "depth",
                                                "object_id", "lit.r", "lit.g", "lit.b"},
                                     .outputs = {"lit.r", "lit.g", "lit.b", "shadow_catcher"},
                                     .kernel = ground_kernel(),
                                     .reach = own_pixel}}});
}

}  // namespace umbrage
