// Compare: every occlusion technique, at several settings and sizes, over several scenes and cameras, against the
// ray-traced truth; where it is asked for, also the light that techniques gather.
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "apps/compare/measure_settings.h"
#include "reference/metrics.h"

namespace umbrage {

/// What is compared.
enum class Quantity {
  kOcclusion,  ///< the plane `ao`
  kLight,      ///< `indirect`: what surfaces within the radius reflect diffusely of the lights, and emit
};
inline constexpr int kQuantities = 2;
inline constexpr std::array<std::string_view, kQuantities> kQuantityNames = {"occlusion", "light"};

/// `draw` holds framing, settings, guard band, scale and radius (the reference's own where empty).
struct CompareSettings : MeasureSettings {
  std::vector<std::string> techniques;                                ///< names; empty: all that there are
  std::vector<std::pair<int, int>> sizes = {{960, 540}, {480, 270}};  ///< the pictures of the first one are kept
  bool light = false;                                                 ///< compare Quantity::kLight too
  std::string filter;    ///< an effect of kind kFilter that follows each technique but the reference; empty: none
  bool pictures = true;  ///< keep the pictures of the first size
};

/// One technique at one setting in one picture.
struct Score {
  Quantity quantity = Quantity::kOcclusion;
  std::string scene, camera, technique, setting, device;
  std::string view;  ///< the camera in numbers: eye, axis, window
  int width = 0, height = 0;
  double ms = 0.0;  ///< median time of the technique alone, with its filter
  ScoreCard card;   ///< of light: score_light
};

/// The pictures of one camera, of one quantity: one plane, or three of linear light.
struct ComparedView {
  Quantity quantity = Quantity::kOcclusion;
  std::string scene, camera;
  float radius = 0.0f;    ///< scene units
  float exposure = 1.0f;  ///< what light is multiplied with to be shown: makes the truth's mean middle grey
  Image truth;
  ClassMap classes;
  struct Technique {
    std::string name, setting;
    Image picture;
  };
  std::vector<Technique> techniques;
};

/// What scores must share to be comparable, besides scene, camera, size, technique and variant; as it would be written.
struct Terms {
  std::string radius, falloff, normal;  ///< of the truth
  int samples = 0;                      ///< of the truth
  std::string settings;                 ///< --set, joined by spaces
  std::string guard;                    ///< --guard-band
  int layers = 1;                       ///< --layers
  int extra_views = 0;                  ///< --extra-views
  std::string scale;                    ///< --ao-scale
  std::string filter;                   ///< --filter
  std::string quality;                  ///< --quality

  bool operator==(const Terms&) const = default;
};

struct Comparison {
  Terms terms;
  double noise = 0.0;        ///< standard error of a pixel of the truth, root mean square over all pictures
  double mean = 0.0;         ///< mean of the truth over all covered pixels
  double light_noise = 0.0;  ///< as `noise`, of light, as a share of each picture's mean
  std::vector<Score> scores;
  std::vector<ComparedView> views;    ///< of the first size
  std::vector<std::string> warnings;  ///< of the models, one sentence each
};

/// Finds what is wrong with the settings before any work: names, numbers. Errors: kUsage.
Result<void> check_compare(const CompareSettings& settings);

/// The terms of a comparison by these settings, which check_compare has found good.
Terms terms_of(const CompareSettings& settings);

/// Draws, traces and scores. Occlusion counts as it is seen: below 0 as 0, above 1 as 1. The techniques run with the
/// presets of the look `ao`, then the radius, then what the caller set, then the variant. With `light`, the scene's
/// lights are captured with their shadows, the other sides of surfaces too where there is more than one layer, and
/// neither ambient light nor highlights, since the reference's bounce has none; techniques that gather no light are
/// not scored for it, nor are pictures in which the truth has none. Errors: kUsage for names and numbers, kFile for
/// models, kInterrupted.
Result<Comparison> compare(Device& device, const CompareSettings& settings);

}  // namespace umbrage
