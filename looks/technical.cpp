// Look `technical`: the cool-to-warm shading of technical illustrations [Gooch et al. 1998] with black lines over a
// light background, in the tones of the paper's figures. There is no occlusion, as in the paper; a technique that is
// chosen moves occluded surfaces towards the cool tone. Four pictures are averaged, as square roots of light, like
// lines: see cartoon.cpp.
#include "core/look.h"

namespace umbrage {

Look look_technical() {
  return {.name = "technical",
          .summary = "cool-to-warm shading and black lines, as in technical illustrations",
          .occlusion = "none",
          .effects = {"occlusion", "denoise", "gooch", "outline", "hidden", "output", "antialias"},
          .presets = {"gooch.blue=0.4", "gooch.yellow=0.4", "gooch.alpha=0.2", "gooch.beta=0.6", "denoise.rounds=2",
                      "outline.width=0.2%", "outline.recede=0.8", "outline.inner=0.7", "outline.ids=both",
                      "output.background_r=0.96", "output.background_g=0.96", "output.background_b=0.95"},
          .frames = 4,
          .averages_square_roots = true};
}

}  // namespace umbrage
