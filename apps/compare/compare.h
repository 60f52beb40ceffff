// Compare: every occlusion technique, at several settings and sizes, over several scenes and cameras, against the
// ray-traced truth.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apps/job/job.h"
#include "reference/metrics.h"

namespace umbrage {

struct CompareSettings {
  std::vector<std::string> models;  ///< as for load_scene
  ImportSettings import;
  std::vector<std::string> techniques;                                ///< names; empty: all that there are
  std::vector<std::pair<int, int>> sizes = {{960, 540}, {480, 270}};  ///< the pictures of the first one are kept
  int cameras = 2;       ///< at most so many per scene: its suggested views, or turns around a file's model
  int samples = 256;     ///< of the truth, per pixel; even
  int runs = 3;          ///< behind each time, after one that does not count; the reference runs once
  DrawSettings draw;     ///< framing, settings, guard band, radius (the reference's own where empty)
  bool pictures = true;  ///< keep the pictures of the first size
  /// Told what is done now; false ends the work.
  std::function<bool(const std::string&)> progress = [](const std::string&) { return true; };
};

/// One technique at one setting in one picture.
struct Score {
  std::string scene, camera, technique, setting, device;
  std::string view;  ///< the camera in numbers: eye, axis, window
  int width = 0, height = 0;
  double ms = 0.0;  ///< median time of the technique alone
  ScoreCard card;
};

/// The pictures of one camera.
struct ComparedView {
  std::string scene, camera;
  float radius = 0.0f;  ///< scene units
  Plane truth;
  ClassMap classes;
  struct Technique {
    std::string name, setting;
    Plane ao;
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

  bool operator==(const Terms&) const = default;
};

struct Comparison {
  Terms terms;
  double noise = 0.0;  ///< standard error of a pixel of the truth, root mean square over all pictures
  double mean = 0.0;   ///< mean of the truth over all covered pixels
  std::vector<Score> scores;
  std::vector<ComparedView> views;    ///< of the first size
  std::vector<std::string> warnings;  ///< of the models, one sentence each
};

/// Finds what is wrong with the settings before any work: names, numbers. Errors: kUsage.
Result<void> check_compare(const CompareSettings& settings);

/// The terms of a comparison by these settings, which check_compare has found good.
Terms terms_of(const CompareSettings& settings);

/// Draws, traces and scores. Occlusion counts as it is seen: below 0 as 0, above 1 as 1. The techniques run with the
/// presets of the look `ao`, then the radius, then the variant, then what the caller set. Errors: kUsage for names and
/// numbers, kFile for models, kInterrupted.
Result<Comparison> compare(Device& device, const CompareSettings& settings);

}  // namespace umbrage
