// Look `studio`: a model as in a photo studio. Soft key and fill lights with shadows, a shadow catcher as ground under
// models that stand outdoors, indirect light, exposure by metering of the picture.
#include "core/look.h"

namespace umbrage {

Look look_studio() {
  return {.name = "studio",
          .summary = "soft light with shadows, occlusion and indirect light, on a ground that shows only its shadow",
          .occlusion = "bitmask",
          .effects = {"lighting", "occlusion", "denoise", "composite", "ground", "hide_ground", "output"},
          .presets = {"bitmask.bleeding=1", "bitmask.radius=25%", "denoise.indirect=1", "denoise.light_rounds=3",
                      "lighting.open=on", "output.metering=picture", "output.shoulder=0.8", "output.background_r=0.93",
                      "output.background_g=0.93", "output.background_b=0.94"},
          .lit_by = "lighting",
          .image_lit_presets = {"lighting.ambient=1"},
          .quality = "normal",
          .studio_lights = true,
          .ground = true};
}

}  // namespace umbrage
