// Toon bands, soft occlusion, and outlines: our own settings.
#include "core/look.h"

namespace umbrage {

const Look& look_cartoon() {
  static const Look look = {
      .name = "cartoon",
      .summary = "toon bands, occlusion and clean outlines",
      .occlusion = "unsharp",
      .effects = {"lighting", "occlusion", "composite", "outline", "output"},
      .presets = {{"composite.mode", "multiply"},
                  {"output.background_r", "0.9"},
                  {"output.background_g", "0.9"},
                  {"output.background_b", "0.9"}},
  };
  return look;
}

}  // namespace umbrage
