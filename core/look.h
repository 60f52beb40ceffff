// Look: a named style as data: the effects, their order and their settings.
#pragma once
#include <string_view>
#include <vector>

namespace umbrage {

/// Settings of a look: "effect.parameter=value".
using LookPresets = std::vector<std::string_view>;

/// Placeholder of the occlusion technique in Look::effects.
inline constexpr std::string_view kOcclusionStep = "occlusion";

struct Look {
  std::string_view name, summary;
  std::string_view occlusion;  ///< the default occlusion technique
  /// Names of effects in the order in which they run; "occlusion" is replaced by the technique.
  std::vector<std::string_view> effects;
  LookPresets presets;  ///< settings that differ from the defaults of the effects
  /// The effect whose output is proportional to the scene's lights, if its parameter `rig` is `scene`; empty: none.
  std::string_view lit_by = {};
  LookPresets image_lit_presets = {};      ///< further settings if an image lights the scene and lit_by uses it
  LookPresets image_exposed_presets = {};  ///< and these, unless the exposure is metered anyway
  LookPresets value_presets = {};  ///< and these, after those of value_presets(), if values are shown as colours
  bool is_colorless = false;       ///< it shows no colours of surfaces
  // Default capture settings: see CaptureSettings.
  int layers = 1;
  bool back_sides = false;
  int shadow_rays = 0;
  int extra_views = 0;
  /// Downsampling factor of the occlusion, unless `occlusion_scale` is given: 1, 2 or 4.
  int occlusion_downsampling = 1;
  /// Number of pictures that are averaged, each with other sample positions within the pixels, unless `anti_aliasing`
  /// or a quality sets it.
  int frames = 1;
  /// The same if that is 1: of pictures after the first that are drawn at edges only, where the look allows it.
  int edge_frames = 1;
  bool averages_square_roots = false;  ///< averages square roots of light, like lines
  /// The technique for models in place of `occlusion`, except with a quality of screen space; empty: `occlusion` too.
  std::string_view model_occlusion = {};
  std::string_view quality = {};  ///< default quality, one of looks/presets.h; empty: the settings as they are
  bool studio_lights = false;     ///< a scene without lights gets studio_lighting instead of a key light alone
  bool needs_beauty = false;      ///< changes a finished picture, so that it only applies to files that have one
  /// Outdoor objects get a ground that is invisible except for the shadows on it.
  bool ground = false;
  // The automatic camera: see Framing.
  float margin = 0.06f;
  float view_angle_deg = 30.0f;
};

}  // namespace umbrage
