// Compare: scores occlusion techniques, at several settings and sizes, over several scenes and cameras, against
// ray-traced ground truth. Optionally also scores the indirect light that techniques gather.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/compare/measure_settings.h"
#include "reference/metrics.h"

namespace umbrage {

/// The quantity that is compared.
enum class Quantity {
  kOcclusion,  ///< the plane `ao`
  kLight,      ///< the planes `indirect`: light that surfaces within the radius emit, or reflect from the lights
  // Light of a white surface under one of environments(), as far as nothing within the radius occludes it.
  kClearSky,
  kStudio,
  kSunset,
};
inline constexpr int kQuantities = 5;
inline constexpr std::array<std::string_view, kQuantities> kQuantityNames = {"occlusion", "light", "clear sky",
                                                                             "studio", "sunset"};
inline constexpr int kFirstEnvironment = int(Quantity::kClearSky);

/// Value of CompareSettings::filter for techniques without a filter.
inline constexpr std::string_view kNoFilter = "none";

/// Settings of a comparison. `draw` provides framing, settings, guard band, scale and radius (if empty: the radius of
/// the reference).
struct CompareSettings : MeasureSettings {
  std::vector<std::string> techniques;                                ///< names; empty: all
  std::vector<std::pair<int, int>> sizes = {{960, 540}, {480, 270}};  ///< width, height in pixels
  bool light = false;   ///< compare all other quantities than occlusion, too
  bool budget = false;  ///< divide errors: see ErrorBudget
  /// Effect of kind kFilter that follows each technique except the reference and those that filter themselves;
  /// kNoFilter, or empty for that of the look `ao`.
  std::string filter;
  bool pictures = true;  ///< keep the pictures of the first size
};

/// The two parts of the error of a screen-space technique. What the view holds are the occluders that the captured
/// layers hold: see Occluders::kLayers.
struct ErrorBudget {
  double view = 0.0;  ///< RMSE of the ground truth of what the view holds against the whole ground truth
  double own = 0.0;   ///< RMSE of the technique against the ground truth of what the view holds
};

/// The score of one technique at one setting in one picture.
struct Score {
  Quantity quantity = Quantity::kOcclusion;
  std::string scene, camera, technique, setting, device;
  std::string view;  ///< the camera as text: position, axis, window
  int width = 0, height = 0;
  double ms = 0.0;                    ///< median time of the technique with its filter, milliseconds
  std::optional<ErrorBudget> budget;  ///< of occlusion by screen-space techniques, with CompareSettings::budget
  ScoreCard card;                     ///< from score, for occlusion; else from score_light
};

/// The pictures of one camera and quantity: one plane of occlusion, or three planes of linear light.
struct ComparedView {
  Quantity quantity = Quantity::kOcclusion;
  std::string scene, camera;
  float radius = 0.0f;    ///< scene units
  float exposure = 1.0f;  ///< factor for the display of light; makes the mean of the ground truth middle grey
  Image truth;
  ClassMap classes;
  struct Technique {
    std::string name, setting;
    Image picture;
  };
  std::vector<Technique> techniques;
};

/// Terms of a measurement, as option values. Scores are comparable if their terms, scene, camera, size, technique and
/// variant are equal.
struct Terms {
  std::string radius, falloff, normal;  ///< of the ground truth
  int samples = 0;                      ///< rays per pixel of the ground truth
  std::string settings;                 ///< values of --set, joined by spaces
  std::string guard;                    ///< --guard-band
  int layers = 1;                       ///< --layers
  int extra_views = 0;                  ///< --extra-views
  std::string scale;                    ///< --ao-scale
  std::string filter;                   ///< name of the filter; empty: none
  std::string quality;                  ///< --quality

  bool operator==(const Terms&) const = default;
};

/// Result of a comparison.
struct Comparison {
  Terms terms;
  double noise = 0.0;        ///< standard error of a pixel of the ground truth, root mean square over all pictures
  double mean = 0.0;         ///< mean of the ground truth over all pixels that show a surface
  double light_noise = 0.0;  ///< `noise` for light, as a fraction of each picture's mean
  std::vector<Score> scores;
  std::vector<ComparedView> views;    ///< pictures of the first size
  std::vector<std::string> warnings;  ///< warnings about the models, one sentence each
};

/// Checks names and numbers of the settings before any work. Errors: kUsage.
Result<void> check_compare(const CompareSettings& settings);

/// Returns the terms of a comparison. The settings must have passed check_compare.
Terms terms_of(const CompareSettings& settings);

/// Draws every picture with each technique, traces its ground truth and scores the techniques. Occlusion is clamped to
/// [0, 1] before it is scored. Techniques run with the presets of the look `ao`, overridden by the radius, then by the
/// caller's settings, then by the variant. With `light`, the scene's lights are captured with shadows, and back sides
/// of surfaces are captured if there is more than one layer. Ambient light and highlights are off, since the
/// reference's bounce has neither. Techniques that gather no light, and pictures whose ground truth has no light, have
/// no score for Quantity::kLight. Under the environments, all techniques but the reference are scored at the settings
/// that gather no light: with the parameter `directional` if they have it, else ambient light is multiplied by their
/// occlusion. Errors: kUsage for names and numbers, kFile for models, kInterrupted.
Result<Comparison> compare(Device& device, const CompareSettings& settings);

}  // namespace umbrage
