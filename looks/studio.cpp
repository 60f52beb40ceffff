// Look `studio`: a model as in a photo studio. A key, a fill and a rim light with soft shadows, a shadow catcher as
// ground under models that stand outdoors, indirect light, exposure by the surfaces in the picture.
#include "core/look.h"

namespace umbrage {

Look look_studio() {
  return {.name = "studio",
          .summary = "soft light with shadows, occlusion and indirect light, on a ground that shows only its shadow",
          .occlusion = "bitmask",
          .effects = {"lighting", "occlusion", "denoise", "composite", "ground", "hide_ground", "output", "antialias"},
          .presets = {"bitmask.bleeding=1", "bitmask.radius=50%", "traced.bleeding=1", "traced.radius=50%",
                      "traced.ambient_bounce=1.8", "composite.direct=0.6", "denoise.rounds=2", "denoise.indirect=1",
                      "denoise.light_rounds=3", "lighting.open=on", "lighting.gloss=0.12", "ground.border=15",
                      "output.metering=picture", "output.tone=neutral", "output.background_r=0.91",
                      "output.background_g=0.915", "output.background_b=0.925", "output.gradient=0.3"},
          .lit_by = "lighting",
          .image_lit_presets = {"lighting.ambient=1", "lighting.diffuse=1"},
          .image_exposed_presets = {"output.metering=light", "output.exposure=0"},
          .value_presets = {"lighting.ambient=3", "lighting.diffuse=0.55", "composite.direct=0.3"},
          .model_occlusion = "traced",
          .quality = "normal",
          .studio_lights = true,
          .ground = true,
          .margin = 0.11f,
          .view_angle_deg = 35.0f};
}

}  // namespace umbrage
