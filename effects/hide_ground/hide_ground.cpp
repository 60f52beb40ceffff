#include "effects/hide_ground/hide_ground.h"

#include "core/effect.h"
#include "kernels/hide_ground.h"

namespace umbrage {
namespace {

void fill_hide_ground(const ParameterBytes&, const PictureInfo& info, void* out) {
  *static_cast<HideGroundConstants*>(out) = {.object = float(info.ground_object)};
}

}  // namespace

Effect effect_hide_ground() {
  return {.name = "hide_ground",
          .summary = "remove the shadow-catching ground under a model from depth and ids",
          .constants_size = sizeof(HideGroundConstants),
          .constants = fill_hide_ground,
          .dispatches = {{.name = "hide_ground",
                          .inputs = {"depth", "object_id", "material_id"},
                          .outputs = {"depth", "object_id", "material_id"},
                          .kernel = hide_ground_kernel(),
                          .reach = own_pixel}}};
}

}  // namespace umbrage
