// Look `bleeding`: the scene's own materials and lights, with colour bleeding: a red drape colours the floor. After the
// idea of [Colliander and Törnquist 2015], with our own settings.
#include "core/look.h"

namespace umbrage {

Look look_bleeding() {
  return {.name = "bleeding",
          .summary = "the scene's own materials and lights, with shadows, occlusion and colour bleeding",
          .occlusion = "hemisphere",
          .effects = {"lighting", "occlusion", "denoise", "composite", "output", "antialias"},
          .presets = {"hemisphere.samples=32", "hemisphere.radius=25%", "hemisphere.bleeding=1", "hemisphere.weight=2",
                      "hemisphere.ambient_bounce=0.5", "traced.radius=25%", "traced.bleeding=1",
                      "traced.ambient_bounce=0.5", "denoise.rounds=3", "denoise.indirect=1", "lighting.ambient=0.6",
                      "output.exposure=0.5", "output.background_r=0.72", "output.background_g=0.77",
                      "output.background_b=0.82"},
          .lit_by = "lighting",
          .image_lit_presets = {"lighting.ambient=1"},
          .image_exposed_presets = {"output.metering=light", "output.exposure=0"},
          .layers = 2,
          .back_sides = true,
          .shadow_rays = 1,
          .model_occlusion = "traced"};
}

}  // namespace umbrage
