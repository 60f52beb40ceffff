// Look `ao`: the occlusion alone, as grey values without a transfer function. White is open.
#include "core/look.h"

namespace umbrage {

Look look_ao() {
  return {
      .name = "ao",
      .summary = "the occlusion alone: white is open, black is occluded",
      .occlusion = "bitmask",
      .effects = {"occlusion", "denoise", "composite", "output", "antialias"},
      .presets = {"bitmask.radius=20%", "traced.radius=20%", "traced.rays=4", "traced.max_rays=16",
                  "composite.mode=occlusion", "unsharp.kernel=6%", "unsharp.strength=24", "output.transfer=none",
                  "output.pivot=0.46", "output.background_r=0.8", "output.background_g=0.8", "output.background_b=0.8"},
      .value_presets = {"composite.mode=albedo", "composite.occlusion=2"},
      .edge_frames = 5,
      .model_occlusion = "traced"};
}

}  // namespace umbrage
