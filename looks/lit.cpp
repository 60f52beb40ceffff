// Look `lit`: the scene's own materials and lights, with shadows, darkened by occlusion.
#include "core/look.h"

namespace umbrage {

Look look_lit() {
  return {
      .name = "lit",
      .summary = "the scene's own materials and lights, with shadow and occlusion",
      .occlusion = "unsharp",
      .effects = {"lighting", "occlusion", "composite", "output", "antialias"},
      .presets = {"unsharp.kernel=4%", "unsharp.threshold=0.15", "unsharp.linearization=extent", "unsharp.strength=12",
                  "unsharp.background=ignore", "unsharp.white_edge=off", "composite.mode=multiply",
                  "output.background_r=0.72", "output.background_g=0.77", "output.background_b=0.82"},
      .lit_by = "lighting",
      .image_lit_presets = {"lighting.ambient=1"},
      .image_exposed_presets = {"output.metering=light", "output.exposure=0"}};
}

}  // namespace umbrage
