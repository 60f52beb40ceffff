// Look `ao`: the occlusion alone, as grey values without a transfer function. White is open.
#include "core/look.h"

namespace umbrage {

Look look_ao() {
  return {.name = "ao",
          .summary = "the occlusion alone: white is open, black is occluded",
          .occlusion = "unsharp",
          .effects = {"occlusion", "denoise", "composite", "output", "antialias"},
          .presets = {"unsharp.kernel=5%", "unsharp.threshold=0.15", "unsharp.linearization=extent",
                      "unsharp.strength=16", "unsharp.background=ignore", "unsharp.white_edge=off",
                      "composite.mode=occlusion", "output.transfer=none", "output.pivot=0.46",
                      "output.background_r=0.8", "output.background_g=0.8", "output.background_b=0.8"}};
}

}  // namespace umbrage
