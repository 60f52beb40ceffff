#include "looks/presets.h"

namespace umbrage {

std::span<const Style> styles() {
  static const std::vector<Style> all = {
      {.name = "white",
       .summary = "a white background, for papers",
       .presets = {"output.background_r=1", "output.background_g=1", "output.background_b=1", "output.gradient=0",
                   "hatching.paper_r=1", "hatching.paper_g=1", "hatching.paper_b=1"}},
      {.name = "dark",
       .summary = "a dark background, for slides",
       .presets = {"output.background_r=0.14", "output.background_g=0.15", "output.background_b=0.17",
                   "output.gradient=0.5", "outline.r=0.85", "outline.g=0.87", "outline.b=0.9", "hatching.strokes=light",
                   "hatching.contrast=2.4", "hatching.paper_r=0.14", "hatching.paper_g=0.15", "hatching.paper_b=0.17"}},
      {.name = "blueprint",
       .summary = "a blue model on dark blue, with light lines where the look draws lines",
       .presets = {"output.background_r=0.07", "output.background_g=0.18", "output.background_b=0.36",
                   "output.gradient=0", "outline.r=0.85", "outline.g=0.92", "outline.b=1", "hatching.strokes=light",
                   "hatching.contrast=2.4", "hatching.paper_r=0.07", "hatching.paper_g=0.18", "hatching.paper_b=0.36"},
       .color = std::array{0.38f, 0.56f, 0.80f}},
      {.name = "clay",
       .summary = "a model of terracotta on a warm background",
       .presets = {"output.background_r=0.93", "output.background_g=0.91", "output.background_b=0.88",
                   "hatching.paper_r=0.93", "hatching.paper_g=0.91", "hatching.paper_b=0.88"},
       .color = std::array{0.80f, 0.56f, 0.44f}}};
  return all;
}

const Style* find_style(std::string_view name) {
  for (const Style& style : styles())
    if (style.name == name) return &style;
  return nullptr;
}

const LookPresets& value_presets() {
  // All light is white, as renderer/plan makes that of the scene: no light from surface to surface, no highlights, no
  // tinted shadows. The exposure does not depend on the colours.
  static const LookPresets presets = {"bitmask.bleeding=0",
                                      "traced.bleeding=0",
                                      "hemisphere.bleeding=0",
                                      "ssdo.bleeding=0",
                                      "lighting.material=scene",
                                      "toon.albedo=texture",
                                      "composite.tint=0",
                                      "lighting.gloss=0",
                                      "lighting.specular=0",
                                      "toon.specular=0",
                                      "toon.shadow_r=0.2",
                                      "toon.shadow_g=0.2",
                                      "toon.shadow_b=0.2",
                                      "gooch.blue=0",
                                      "gooch.yellow=0",
                                      "gooch.alpha=0.45",
                                      "gooch.beta=1",
                                      "gooch.hue=0",
                                      "gooch.highlight=0",
                                      "output.tone=hue",
                                      "output.metering=none",
                                      "output.exposure=0",
                                      "output.transfer=srgb"};
  return presets;
}

std::span<const Quality> qualities() {
  // The settings of `bitmask` are on the Pareto front of error and time in effects/bitmask/README.md.
  static const std::vector<Quality> all = {
      {.name = "draft",
       .summary = "for previews: one frame, screen-space occlusion at half resolution",
       .frames = 1,
       .occlusion_downsampling = 2,
       .shadow_rays = 1,
       .screen_space = true,
       .settings = {"bitmask.slices=1", "bitmask.steps=8", "hemisphere.samples=8", "sphere.samples=8"},
       .settings_of_averaged = {"bitmask.slices=1", "bitmask.steps=8", "hemisphere.samples=8", "sphere.samples=8"}},
      {.name = "normal",
       .summary = "for everyday use: four averaged frames, smooth edges, one ray per pixel for occlusion",
       .frames = 4,
       .occlusion_downsampling = 2,
       .shadow_rays = 2,
       .settings = {"bitmask.slices=2", "bitmask.steps=12", "hemisphere.samples=16", "sphere.samples=16"},
       .settings_of_averaged = {"bitmask.slices=1", "bitmask.steps=12", "hemisphere.samples=8", "sphere.samples=16"}},
      {.name = "high",
       .summary =
           "for print: eight averaged frames, four rays per pixel, or screen-space occlusion from two depth layers",
       .frames = 8,
       .occlusion_downsampling = 1,
       .layers = 2,
       .shadow_rays = 4,
       .settings = {"bitmask.slices=2", "bitmask.steps=16", "bitmask.mode=layers", "hemisphere.samples=32",
                    "sphere.samples=32", "traced.rays=4", "traced.max_rays=16"},
       .settings_of_averaged = {"bitmask.slices=1", "bitmask.steps=16", "bitmask.mode=layers", "hemisphere.samples=16",
                                "sphere.samples=32", "traced.rays=4", "traced.max_rays=16"}},
      {.name = "ultra",
       .summary =
           "for best quality: sixteen frames, six rays per pixel, or screen-space occlusion from four depth layers",
       .frames = 16,
       .occlusion_downsampling = 1,
       .layers = 4,
       .shadow_rays = 8,
       .settings = {"bitmask.slices=4", "bitmask.steps=24", "bitmask.mode=layers", "hemisphere.samples=64",
                    "sphere.samples=64", "traced.rays=6", "traced.max_rays=32"},
       .settings_of_averaged = {"bitmask.slices=2", "bitmask.steps=24", "bitmask.mode=layers", "hemisphere.samples=32",
                                "sphere.samples=32"}}};
  return all;
}

const Quality* find_quality(std::string_view name) {
  for (const Quality& quality : qualities())
    if (quality.name == name) return &quality;
  return nullptr;
}

}  // namespace umbrage
