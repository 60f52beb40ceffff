#include "looks/quality.h"

namespace umbrage {

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
