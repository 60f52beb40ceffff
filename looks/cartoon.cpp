// Look `cartoon`: tone steps with coloured shadows, soft contact shadows from a hemisphere of samples, and clean
// outlines. After the idea of [Lajzer and Nottingham], with our own settings. Four pictures are averaged, because tone
// areas that are about one pixel wide would look dashed in one. They are averaged as square roots of light, as lines
// are, so that antialiased lines keep their weight. The radius of every occlusion technique is small: quantized to tone
// steps, the faint outer part of wide occlusion would become large patches with unsteady borders.
#include "core/look.h"

namespace umbrage {

Look look_cartoon() {
  return {.name = "cartoon",
          .summary = "toon shading with coloured shadows, contact shadows and clean outlines",
          .occlusion = "sphere",
          .effects = {"occlusion", "denoise", "gaussian", "toon", "outline", "output", "antialias"},
          .presets = {"sphere.samples=32",        "sphere.shape=hemisphere",
                      "sphere.reach=4%",          "sphere.depth=linear",
                      "sphere.sample_z=on",       "sphere.range=smooth",
                      "sphere.range_factor=1",    "sphere.map=linear",
                      "sphere.threshold=0",       "sphere.border=skip",
                      "sphere.strength=1.3",      "unsharp.kernel=5%",
                      "unsharp.strength=12",      "alchemy.radius=5%",
                      "bitmask.radius=5%",        "hbao.radius=5%",
                      "hemisphere.radius=5%",     "denoise.rounds=2",
                      "denoise.for_height=512",   "gaussian.rounds=4",
                      "gaussian.edges=on",        "outline.width=0.2%",
                      "outline.recede=0.8",       "outline.inner=0.7",
                      "outline.ids=both",         "toon.steps=5",
                      "toon.ambient=0.25",        "toon.extra=0.1",
                      "output.background_r=0.93", "output.background_g=0.91",
                      "output.background_b=0.87"},
          .frames = 4,
          .averages_square_roots = true};
}

}  // namespace umbrage
