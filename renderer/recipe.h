// Recipe: what a request asks for, as far as it can be known without its model. Every name in it is found, every value
// parsed and checked.
#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "looks/looks.h"
#include "renderer/hdri.h"
#include "renderer/options.h"
#include "scene/framing.h"
#include "scene/readers/import.h"

namespace umbrage {

/// Whether a model gets a ground to stand on.
enum class Ground {
  kAuto,  ///< where the look wants one and the model stands in the open without one of its own
  kOn,
  kOff,
};

struct Recipe {
  int width = 0, height = 0;  ///< without the guard band
  const Look* look = nullptr;
  std::shared_ptr<const Look> own_look;  ///< what `look` is where the request names effects in place of a look; or null
  std::string occlusion;                 ///< the technique, or kNoOcclusion
  int occlusion_every = 1;               ///< see LookRun
  int frames = 1;                        ///< pictures that are averaged
  EffectSettings settings;               ///< with all that the request says; `radius` is not in them yet
  std::vector<Setting> said;     ///< what the request sets: it holds whatever follows from something else. No values
  std::optional<Length> radius;  ///< of occlusion; nothing: as the settings have it
  Framing framing;
  std::optional<int> camera_index;  ///< for use_camera
  Ground ground = Ground::kAuto;
  Hdri hdri;
  std::optional<float> light_size_deg;             ///< of the key light; nothing: as it is
  CaptureSettings capture;                         ///< of a frame
  std::vector<std::string> passes;                 ///< that are wanted, by the words of renderer/passes.h
  std::optional<std::vector<std::string>> wanted;  ///< planes that alone are; nothing: the picture, and all behind it
  std::vector<std::string> averaged;  ///< planes besides the picture that are averaged, too, where it is of frames

  /// Whether a plane of the first layer is.
  bool wants(std::string_view plane) const {
    return !wanted || std::find(wanted->begin(), wanted->end(), plane) != wanted->end();
  }
};

/// Occlusion techniques that no device runs, since they need the scene: the ray-traced reference.
std::span<const Effect* const> handed_in();

/// All effects and what is handed in.
std::vector<const Effect*> every_effect();

/// Errors: kUsage, also for a picture of more than `most_pixels`, all layers and its guard band included.
Result<Recipe> make_recipe(const Request& request, long most_pixels = kMaxPixels);

/// Of what another renderer drew: one frame, of a look or of effects in its place, without lights and framing.
Result<Recipe> make_shading_recipe(const Request& request);

/// The index of a text among what an option takes, which check_request has found good.
int choice_of(std::string_view field, std::string_view text);

Framing framing_of(const CameraSettings& camera);
/// How its model is read. Errors: kUsage.
Result<ImportSettings> import_settings(const Request& request);

/// What the device is to capture for a look. Errors: kUsage for too many layers or pixels.
Result<CaptureSettings> capture_settings(const Request& request, const Look& look, int shadows,
                                         long most_pixels = kMaxPixels);

/// Every effect's own settings with these assignments, "effect.parameter=value", applied. Errors: kUsage.
Result<EffectSettings> effect_settings(std::span<const std::string> assignments);

/// Applies the words of a variant, "kernel=15 window=gaussian", to an effect's settings. Errors: kUsage.
Result<void> apply_variant(EffectSettings& settings, const Effect& effect, std::string_view variant);

/// Applies the radius, in scene units, to every technique that has one; what the request says of them holds.
void apply_radius(float radius, const PictureInfo& info, Recipe& recipe);

/// What runs the recipe's look. It refers to the recipe.
LookRun look_run(const Recipe& recipe);

/// The shadows that these effects read and do not leave out, as so many of the first lights: others are not traced.
int shadows_read(const Recipe& recipe, std::span<const Effect* const> steps);

/// Whether an effect sees by the scene's lights, or brings its own.
bool by_scene_lights(const Effect& effect, const EffectSettings& settings);
/// Whether the look shows how bright the scene's lights are.
bool shows_light(const Recipe& recipe);

}  // namespace umbrage
