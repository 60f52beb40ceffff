#include "effects/hide_ground/hide_ground.h"

#include "core/effect.h"
#include "kernel/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(hide_ground)

namespace {

constexpr std::uint32_t kSpirv[] = {
#include "spirv/hide_ground.inc"
};

void fill_constants(const ParameterBytes&, const PictureInfo& info, void* out) {
  *static_cast<HideGroundConstants*>(out) = {.object = float(info.ground_object)};
}

}  // namespace

const Effect& effect_hide_ground() {
  static const Effect effect = {
      .name = "hide_ground",
      .summary = "takes the ground under a model, of which the shade alone is seen, out of depth and ids",
      .kind = EffectKind::kShading,
      .constants_size = sizeof(HideGroundConstants),
      .constants = fill_constants,
      .passes = {{.name = "hide_ground",
                  .inputs = {"depth", "object_id", "material_id"},
                  .outputs = {"depth", "object_id", "material_id"},
                  .scalar = run_scalar_hide_ground,
                  .lanes = run_lanes_hide_ground,
                  .spirv = kSpirv,
                  .reach = own_row}},
  };
  return effect;
}

}  // namespace umbrage
