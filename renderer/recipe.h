// Recipe: a request resolved as far as possible without its model. Names are resolved, values are parsed and checked.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/lists.h"
#include "program/program.h"
#include "renderer/hdri.h"
#include "renderer/options.h"
#include "renderer/request.h"
#include "scene/framing.h"
#include "scene/readers/import.h"
#include "scene/section.h"
#include "scene/value_colors.h"

namespace umbrage {

/// Whether a ground is added below the model.
enum class Ground {
  kAuto,  ///< added if the look has a ground and the model is outdoors without a ground of its own
  kOn,
  kOff,
};

struct Recipe {
  int width = 0, height = 0;  ///< pixels, without the guard band
  const Look* look = nullptr;
  std::shared_ptr<const Look> effects_look;  ///< owns `look` if the request names effects in place of a look; else null
  std::string occlusion;                     ///< the technique, or kNoOcclusion
  int occlusion_downsampling = 1;            ///< downsampling factor of occlusion: 1, 2 or 4; see LookRun
  int frames = 1;                            ///< number of averaged pictures
  bool is_steady = false;                    ///< occlusion is joined with that of other frames of a sequence
  bool edges_alone = false;                  ///< all but the first are for edges, not to reduce noise
  bool lines_apart = false;                  ///< a picture is drawn without lines, which are traced all the same
  EffectSettings settings;                   ///< with all settings of the request, but not yet `radius`
  /// The parameters that the request sets, without values. They take precedence over derived values.
  std::vector<Setting> set_by_request;
  std::optional<Length> radius;  ///< radius of occlusion; empty: as in the settings
  Framing framing;
  std::optional<int> camera_index;  ///< for use_camera
  bool from_above = false;          ///< the G-buffer is an elevation model: its vertical is the view axis
  int reduction = 1;                ///< of a G-buffer: factor by which the finished picture is reduced
  Ground ground = Ground::kAuto;
  Hdri hdri;
  std::optional<float> light_size_deg;                   ///< angular diameter of the key light; empty: unchanged
  std::array<float, 3> light_factors{1.0f, 1.0f, 1.0f};  ///< for the key, the fill and the rim light
  std::optional<ValueSettings> values;                   ///< shown as colours
  std::optional<glm::vec3> clay;                         ///< linear albedo of the whole model; empty: its materials
  SectionSettings sections;                              ///< cut the model
  float explode = 0.0f;                                  ///< see explode in scene/scene.h
  CaptureSettings capture;                               ///< for one sample
  std::vector<std::string> passes;                       ///< requested passes, by the names of renderer/passes.h
  /// The only planes that are needed; empty: the picture and all its intermediate planes.
  std::optional<std::vector<std::string>> wanted;
  std::optional<std::vector<std::string>> kept;  ///< as in LookRun; empty: all planes
  /// The picture is `beauty`, scene-linear and premultiplied, in place of `color`.
  bool scene_linear = false;
  std::vector<std::string> averaged;  ///< planes besides the picture that are averaged if frames > 1

  /// Returns the pass that holds the picture.
  std::string_view picture() const { return scene_linear ? "beauty" : "color"; }
  /// Returns whether a plane of the first layer is needed.
  bool wants(std::string_view plane) const { return !wanted || contains(*wanted, plane); }
};

/// Returns the occlusion techniques that devices cannot run because they need the scene: the ray-traced reference.
std::span<const Effect* const> external_effects();

/// Returns all effects and the techniques of external_effects.
std::vector<const Effect*> effects_with_external();

/// Resolves a request. Errors: kUsage, also for more than `max_pixels` pixels in all layers, guard band included.
Result<Recipe> make_recipe(const Request& request, long max_pixels = kMaxPixels);

/// Resolves a request to shade a G-buffer: one sample, a look or a list of effects, no lights and no framing.
/// Errors: kUsage, also for more than `max_pixels` pixels.
Result<Recipe> make_shading_recipe(const Request& request, long max_pixels = kMaxPixels);

/// Resolves a request with a look of either kind.
Result<Recipe> make_recipe_of_look(const Request& request);

/// Returns the index of a text in the choices of an option; check_request must have accepted it.
int choice_index(std::string_view field, std::string_view text);

/// Returns whether a look has lines that can be curves.
bool has_lines(const Look& look);

Framing framing_of(const CameraSettings& camera);
/// Returns the import settings for the model of a request. Errors: kUsage.
Result<ImportSettings> import_settings(const Request& request);
/// Returns ImportSettings::fitted_px for pictures whose camera is that of the request.
int fitted_px(const Request& request);

/// Returns what the device captures for a look. Errors: kUsage for too many layers or pixels.
Result<CaptureSettings> capture_settings(const Request& request, const Look& look, int shadows,
                                         long max_pixels = kMaxPixels);

/// Returns the default settings of all effects with these assignments, "effect.parameter=value", applied.
/// Errors: kUsage.
Result<EffectSettings> effect_settings(std::span<const std::string> assignments);

/// Applies a variant, "kernel=15 window=gaussian", to an effect's settings. Errors: kUsage.
Result<void> apply_variant(EffectSettings& settings, const Effect& effect, std::string_view variant);

/// Applies the radius, in scene units, to all techniques that have one, except for parameters that the request sets.
void apply_radius(float radius, const PictureInfo& info, Recipe& recipe);

/// Returns whether the request sets this parameter of the effect with the params struct `Params`.
template <class Params>
bool is_set(const Recipe& recipe, std::string_view parameter) {
  return std::any_of(recipe.set_by_request.begin(), recipe.set_by_request.end(), [&](const Setting& setting) {
    return setting.effect == &effect_with<Params>() && setting.parameter->name == parameter;
  });
}

/// Returns the run of the recipe's look. It refers to the recipe, which must outlive it.
LookRun look_run(const Recipe& recipe);

/// Returns the number of shadow planes to trace: 1 + the largest light index whose shadow these effects use.
int shadows_read(const Recipe& recipe, std::span<const Effect* const> steps);

/// Returns whether an effect uses the scene's lights rather than a light rig of its own.
bool uses_scene_lights(const Effect& effect, const EffectSettings& settings);
/// Returns whether the technique or an effect of the look uses them.
bool uses_scene_lights(const Recipe& recipe);
/// Returns whether the picture depends on the brightness of the scene's lights.
bool depends_on_light_brightness(const Recipe& recipe);

/// Returns warnings about settings that do not affect the picture, and about former names of parameters, one sentence
/// each. `scene`: null for a G-buffer. `is_reported`: returns whether to warn that
/// this "effect.parameter=value" does nothing; settings for other looks may be intended. `word` precedes settings.
std::vector<std::string> setting_warnings(const Request& request, const Recipe& recipe, const Scene* scene,
                                          const std::function<bool(std::string_view setting)>& is_reported,
                                          std::string_view word = "`settings` ");

}  // namespace umbrage
