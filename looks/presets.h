// Presets of settings, by name. Style: colours of background and model for a purpose, such as a slide; a style changes
// any look. Quality: trades time for quality, for the techniques `traced`, `bitmask`, `hemisphere` and `sphere`.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/look.h"

namespace umbrage {

struct Style {
  std::string_view name, summary;
  LookPresets presets;                          ///< applied after those of the look
  std::optional<std::array<float, 3>> color{};  ///< of the whole model, as clay, display values
};

std::span<const Style> styles();

/// Returns the style of that name, or null.
const Style* find_style(std::string_view name);

/// Returns the settings with which any look shows values as colours: light changes the lightness of a colour, not its
/// hue, so that it can be read against a colour bar.
const LookPresets& value_presets();

struct Quality {
  std::string_view name, summary;
  int frames = 1;                  ///< number of samples of a picture that are averaged
  int occlusion_downsampling = 1;  ///< downsampling factor, see Look
  int layers = 1;                  ///< min, see CaptureSettings
  int shadow_rays = 0;             ///< see CaptureSettings
  bool screen_space = false;       ///< models, too, get the screen-space technique of their look
  /// Settings, "effect.parameter=value": for a single picture, and for each of several whose occlusion is averaged.
  std::vector<std::string_view> settings, settings_of_averaged;
};

/// Returns the presets from the fastest to the best: draft, normal, high, ultra. docs/performance.md lists the time and
/// the error of each.
std::span<const Quality> qualities();

/// Returns the preset of that name, or null.
const Quality* find_quality(std::string_view name);

}  // namespace umbrage
