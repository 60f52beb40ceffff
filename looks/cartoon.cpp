// Toon bands with coloured shadows, soft contact shade from a hemisphere of samples, and outlines that hold up: our own
// settings for what [Lajzer and Nottingham] set out to do. Four pictures are averaged: strips of tone that are hardly a
// pixel wide would be dashes in one. They are mixed as lines are, so that antialiased lines keep their weight.
// Occlusion of any technique is near what casts it: in bands, its faint outer part would be wide patches with wandering
// borders.
#include "core/look.h"

namespace umbrage {

Look look_cartoon() {
  return {.name = "cartoon",
          .summary = "toon bands with coloured shadows, contact shade and clean outlines",
          .occlusion = "sphere",
          .effects = {"occlusion", "denoise", "gaussian", "toon", "outline", "output"},
          .presets = {"sphere.samples=32",        "sphere.shape=hemisphere",
                      "sphere.reach=4%",          "sphere.depth=linear",
                      "sphere.sample_z=on",       "sphere.range=smooth",
                      "sphere.range_factor=1",    "sphere.map=linear",
                      "sphere.threshold=0",       "sphere.border=skip",
                      "sphere.strength=1.3",      "unsharp.kernel=5%",
                      "unsharp.threshold=0.15",   "unsharp.linearization=extent",
                      "unsharp.strength=12",      "unsharp.background=ignore",
                      "unsharp.white_edge=off",   "alchemy.radius=5%",
                      "bitmask.radius=5%",        "hbao.radius=5%",
                      "hemisphere.radius=5%",     "denoise.rounds=2",
                      "denoise.for_height=512",   "gaussian.rounds=4",
                      "gaussian.edges=on",        "outline.width=0.2%",
                      "outline.recede=0.8",       "outline.inner=0.7",
                      "outline.ids=both",         "toon.bands=5",
                      "toon.ambient=0.25",        "toon.extra=0.1",
                      "output.background_r=0.93", "output.background_g=0.91",
                      "output.background_b=0.87"},
          .frames = 4,
          .averages_for_eye = true};
}

}  // namespace umbrage
