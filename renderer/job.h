// What every program of ours does: get a model, a camera, a device; draw; time each stage.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/result.h"
#include "looks/looks.h"
#include "scene/environment.h"
#include "scene/framing.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// Milliseconds spent in each stage, in order. Stages of one name add up.
struct StageTimes {
  struct Stage {
    std::string name;
    double ms;
  };
  std::vector<Stage> stages;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

  /// Ends a stage that began when the one before ended.
  void done(std::string_view name);
  double total() const;
};

/// The largest picture, and how many pixels, of all layers together, may be held at once: more need more memory than
/// most machines have (64 million take 8 GB and more). See renderer/bands.h for larger pictures.
inline constexpr int kLargestSide = 16384;
inline constexpr long kMostPixels = 8192L * 8192L;
inline constexpr long kMostBandPixels = 2L * kLargestSide * kLargestSide;

/// Whether a model gets a ground to stand on.
enum class Ground {
  kAuto,  ///< where the look wants one and the model stands in the open without one of its own
  kOn,
  kOff,
};

/// What is around a scene, by an image: names as of the command line's options.
struct Hdri {
  std::string file;  ///< empty: none. "sky:" is the one that is built in
  bool ambient = true, skybox = false;
  float rotation_deg = 0.0f;
  float intensity = 1.0f;
  std::shared_ptr<const Panorama> panorama;  ///< what the file holds, once read_hdri has read it

  bool lights() const { return !file.empty() && ambient; }
  bool shown() const { return !file.empty() && skybox; }
};

struct DrawSettings {
  int width = 1024, height = 1024;
  Framing framing;
  std::optional<int> camera_index;    ///< for use_camera
  std::string look = "ao";            ///< the plainest; programs say which one people get
  std::string occlusion;              ///< empty: the look's own
  std::string occlusion_scale;        ///< --ao-scale: full, half or quarter; empty: the look's own
  std::vector<std::string> settings;  ///< "effect.parameter=value", applied after the look's presets
  std::string radius;  ///< --ao-radius: scene units ("0.3") or a share of the scene ("5%"); empty: the effect's own
  int shadows = 0;     ///< trace the shadows of so many lights though no effect of the look reads them
  std::optional<int> layers;  ///< surfaces captured along each primary ray; nothing: as many as the look wants
  Ground ground = Ground::kAuto;
  Hdri hdri;
  std::optional<float> light_size_deg;  ///< of the key light, seen from the scene; nothing: as it is
  std::string quality;                  ///< a name of looks/quality.h; empty: the look's own
  std::optional<int> frames;            ///< pictures that are averaged; nothing: as quality or look say
  std::vector<std::string> averaged;    ///< planes besides the picture that are averaged, too, where it is of frames
  std::optional<int> extra_views;       ///< further cameras; nothing: as many as the look wants
  float guard_percent = 0.0f;  ///< band drawn beyond each side and cut off, as a share of the picture's longer side
  /// Of pictures that belong together: what metering adds to the exposure, taken where it is known and else told here.
  std::optional<float>* stops = nullptr;
  /// Told the share that is done, now and then, by the thread that draws; false ends the work. See Device::go_on.
  std::function<bool(double)> progress = [](double) { return true; };
};

/// Occlusion techniques that no device runs, since they need the scene: the ray-traced reference.
std::span<const Effect* const> handed_in();

/// All effects and what is handed in.
std::vector<const Effect*> every_effect();

/// A file's scene, or a built-in one for `scene:NAME?detail=N`.
Result<Scene> load_scene(const std::string& model, const ImportSettings& settings = {});

/// Several models side by side in one scene, as they are placed in their files.
Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings = {});

/// Makes the camera of that number the scene's own view: one of the file's, or else of those that a built-in scene
/// suggests. Errors: kUsage for one that there is not.
Result<void> use_camera(int index, Scene& scene);

/// The device that `--device` names: `cpu`, `vulkan` (the best), `vulkan:N`, or `auto`: a real GPU if there is one,
/// else the CPU. Errors: kUsage for a name that does not exist; kDevice for a device that is not there or cannot be
/// used; those of use_isa for UMBRAGE_ISA.
Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads);

/// A length as people write it: "0.3" or "5%". Errors: kUsage unless it is above 0.
Result<Length> parse_radius(std::string_view option, const std::string& text);

/// Of "full", "half" or "quarter": every how manieth pixel is computed, across and down. Errors: kUsage.
Result<int> parse_scale(std::string_view option, std::string_view text);

/// Applies the words of a variant, "kernel=15 window=gaussian", to an effect's settings. Errors: kUsage.
Result<void> apply_variant(EffectSettings& settings, const Effect& effect, std::string_view variant);

/// Every effect's own settings with these assignments, "effect.parameter=value", applied. Errors: kUsage.
Result<EffectSettings> effect_settings(std::span<const std::string> assignments);

/// The look's settings with everything the user said. Errors: kUsage.
struct Recipe {
  const Look* look = nullptr;
  std::string occlusion;
  int occlusion_every = 1;  ///< see LookRun
  int frames = 1;           ///< pictures that are averaged
  EffectSettings settings;
};
Result<Recipe> make_recipe(const DrawSettings& draw);

/// What the device is to capture for a look. Errors: kUsage for too many layers, or a picture that has more than
/// `most` pixels with them and its guard band.
Result<CaptureSettings> capture_settings(const DrawSettings& draw, const Look& look, int shadows,
                                         long most = kMostPixels);

inline constexpr int kMaxThreads = 1024;
inline constexpr double kMostIntensity = 1e6;  ///< of Hdri
inline constexpr double kWidestLight = 90.0;   ///< of light_size_deg

/// Whether it makes sense. Errors: kUsage.
Result<void> check_hdri(const Hdri& hdri, bool transparent);

/// Reads the file of `hdri`, if there is one: EXR, PNG and PFM by io/, others in a process of their own. Gives
/// sentences for people who may have meant another one. Errors: kFile.
Result<std::vector<std::string>> read_hdri(Hdri& hdri);

/// Adds to a scene what the picture wants besides the model: the ground, and the light of `hdri`, which takes the place
/// of the scene's own. Before the device is prepared.
void furnish(Scene& scene, const DrawSettings& draw);

/// Draws a prepared scene: captures, runs the look. Scene must be the one that the device was prepared with; lights are
/// added to it where it has none. Errors: kInterrupted, where the progress ends it, besides those of recipe and device.
Result<Frame> draw(Device& device, Scene& scene, const DrawSettings& settings, StageTimes& times);

/// Shades what another renderer drew, with the look, or with `effects` in its place, one after the other. Without
/// normals they are made of the depth. Of the settings those of the picture's making count: look, occlusion, radius,
/// scale, quality, settings, progress. Where gbuffer.info has no lights a look gets some, as they stand to the camera
/// of a model without lights. Errors: kUsage for names that there are not, planes that are missing, and what needs the
/// model; kInterrupted.
Result<Frame> shade_planes(Device& device, GBuffer gbuffer, const DrawSettings& settings,
                           std::span<const std::string> effects, StageTimes& times);

}  // namespace umbrage
