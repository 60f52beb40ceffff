// Quality: presets of how much time a picture may take, for the techniques `bitmask`, `hemisphere` and `sphere`.
#pragma once
#include <span>
#include <string_view>
#include <vector>

namespace umbrage {

struct Quality {
  std::string_view name, summary;
  int frames = 1;           ///< pictures that are averaged
  int occlusion_every = 1;  ///< see Look
  int layers = 1;           ///< at least, see CaptureSettings
  int shadow_rays = 0;      ///< see CaptureSettings
  /// Settings, "effect.parameter=value", of a picture of one frame, and of each frame where several are averaged.
  std::vector<std::string_view> settings, settings_of_frames;
};

/// From the fastest to the best: draft, normal, high, ultra. What each costs and how far it is from the truth stands in
/// docs/performance.md.
std::span<const Quality> qualities();

/// The quality of that name, or null.
const Quality* find_quality(std::string_view name);

}  // namespace umbrage
