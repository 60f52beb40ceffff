// Look `cartoon-paper`: the settings of [Lajzer and Nottingham]. Eight samples in a sphere, blurred four times; tone
// steps of a quarter of the object's colour; black outlines by the rule of eight neighbours; no transfer function, no
// shadow.
#include "core/look.h"

namespace umbrage {

Look look_cartoon_paper() {
  return {.name = "cartoon-paper",
          .summary = "occlusion and cartoon rendering combined, as in the paper",
          .occlusion = "sphere",
          .effects = {"occlusion", "gaussian", "toon", "outline", "output"},
          .presets = {"gaussian.rounds=4", "toon.mode=paper", "toon.rig=key", "toon.shadow=0", "toon.albedo=display",
                      "outline.mode=paper", "output.transfer=none", "output.pivot=0.46", "output.background_r=0.36",
                      "output.background_g=0.40", "output.background_b=0.45"}};
}

}  // namespace umbrage
