// Look `lit`: the scene's own materials and lights, with shadows, darkened by occlusion. A model that stands outdoors
// has a shadow catcher as ground.
#include "core/look.h"

namespace umbrage {

Look look_lit() {
  return {.name = "lit",
          .summary = "the scene's own materials and lights, with shadow and occlusion",
          .occlusion = "bitmask",
          .effects = {"lighting", "occlusion", "denoise", "composite", "ground", "hide_ground", "output", "antialias"},
          .presets = {"bitmask.radius=20%", "traced.radius=25%", "traced.falloff=linear", "traced.rays=2",
                      "denoise.rounds=2", "composite.direct=0.4", "composite.tint=1", "lighting.open=on",
                      "ground.border=15", "output.background_r=0.72", "output.background_g=0.77",
                      "output.background_b=0.82"},
          .lit_by = "lighting",
          .image_lit_presets = {"lighting.ambient=1"},
          .image_exposed_presets = {"output.metering=light", "output.exposure=0"},
          .model_occlusion = "traced",
          .quality = "normal",
          .ground = true,
          .margin = 0.11f};
}

}  // namespace umbrage
