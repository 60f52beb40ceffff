// Look: a recipe, as data: which effects, in which order, with which settings, give a finished picture.
#pragma once
#include <string_view>
#include <vector>

namespace umbrage {

/// Settings of a look: "effect.parameter=value".
using LookPresets = std::vector<std::string_view>;

/// Stands for the occlusion technique in Look::effects.
inline constexpr std::string_view kOcclusionStep = "occlusion";

struct Look {
  std::string_view name, summary;
  std::string_view occlusion;  ///< the occlusion technique that it uses unless another is chosen
  /// Names of effects in the order in which they run; "occlusion" stands for the technique.
  std::vector<std::string_view> effects;
  LookPresets presets;  ///< that differ from the effects' own
  /// The effect that lights the picture by how bright the scene's lights are, where it has the parameter `rig` at
  /// `scene`; empty: none does.
  std::string_view lit_by = {};
  LookPresets image_lit_presets = {};      ///< besides, where an image lights the scene and lit_by reads that
  LookPresets image_exposed_presets = {};  ///< and these, unless the look is exposed by something anyway
  // What it wants captured unless the user says otherwise: see CaptureSettings.
  int layers = 1;
  bool back_sides = false;
  int shadow_rays = 0;
  int extra_views = 0;
  /// Occlusion is computed for every so manieth pixel across and down, unless `occlusion_scale` is given: 1, 2 or 4.
  int occlusion_every = 1;
  /// Pictures that are averaged, each sampled elsewhere within its pixels, unless `anti_aliasing` or a quality says.
  int frames = 1;
  bool averages_for_eye = false;  ///< averaged pictures are mixed as square roots of light, as lines are
  std::string_view quality = {};  ///< one of looks/quality.h, unless `quality` is given; empty: as the settings are
  bool studio_lights = false;     ///< a scene without lights gets a soft key and a fill light, else a key light alone
  /// What stands in the open stands on a ground that cannot be seen but for the shadows on it.
  bool ground = false;
};

}  // namespace umbrage
