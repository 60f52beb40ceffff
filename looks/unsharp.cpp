// Look `unsharp`: the settings of [Chamberlin 2011]. White material, ambient 0.3 and diffuse 0.7, occlusion subtracted
// from the whole lit colour, no transfer function, no shadow. The window is the paper's 40 pixels of 1024, and the same
// fraction of the picture at other sizes.
#include "core/look.h"

namespace umbrage {

Look look_unsharp() {
  return {.name = "unsharp",
          .summary = "white clay with the unsharp mask of the depth buffer subtracted, as in the paper",
          .occlusion = "unsharp",
          .effects = {"lighting", "occlusion", "composite", "output", "antialias"},
          .presets = {"lighting.material=clay", "lighting.rig=key", "lighting.shadow=0", "unsharp.kernel=3.90625%",
                      "unsharp.threshold=0.02", "unsharp.strength=20", "unsharp.linearization=listing",
                      "unsharp.background=far", "unsharp.white_edge=on", "composite.mode=subtract",
                      "output.transfer=none", "output.pivot=0.46", "output.background_r=0.36",
                      "output.background_g=0.40", "output.background_b=0.45"},
          .lit_by = "lighting",
          .value_presets = {"composite.mode=multiply"}};
}

}  // namespace umbrage
