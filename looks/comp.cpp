// Look `comp`: the finished picture of another renderer, with occlusion in its ambient part. Where nothing is occluded
// the picture stays as it is; so there is neither a tone curve nor a background of our own.
#include "core/look.h"

namespace umbrage {

Look look_comp() {
  return {.name = "comp",
          .summary = "the renderer's own picture, with occlusion in its ambient light; only for files with a beauty",
          .occlusion = "bitmask",
          .effects = {"relight", "occlusion", "denoise", "composite", "outline", "output"},
          .presets = {"bitmask.slices=2", "bitmask.steps=12", "bitmask.radius=25%", "unsharp.strength=12",
                      "denoise.rounds=2", "denoise.indirect=1", "composite.mode=ambient", "outline.opacity=0",
                      "outline.ids=both", "outline.width=0.2%", "output.sky=on"},
          .needs_beauty = true};
}

}  // namespace umbrage
