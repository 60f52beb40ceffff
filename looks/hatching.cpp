// Look `hatching`: a pen drawing. Lines along the surface show the light that falls on clay, with shadows and
// occlusion. The clay is darker where the material is, but less so, since the shape of black materials would be lost.
// Outlines are in the same ink.
#include "core/look.h"

namespace umbrage {

Look look_hatching() {
  return {.name = "hatching",
          .summary = "a pen drawing: hatching along the surface shows its light",
          .occlusion = "unsharp",
          .effects = {"lighting", "occlusion", "denoise", "composite", "outline", "hatching", "output"},
          .presets = {"lighting.material=clay", "hatching.material=0.2", "unsharp.strength=12",
                      "composite.mode=multiply", "outline.width=0.2%", "outline.recede=0.8", "outline.inner=0.7",
                      "outline.ids=both", "output.background_r=1", "output.background_g=1", "output.background_b=1"},
          .lit_by = "lighting",
          .is_colorless = true};
}

}  // namespace umbrage
