// Tune: searches the settings of an occlusion technique, and of the filter behind it, for those that come closest to
// the ray-traced truth of a scene in a given time.
#pragma once
#include <string>
#include <vector>

#include "apps/compare/measure_settings.h"

namespace umbrage {

inline constexpr Interval kTrials{2, 10000, NumberKind::kWhole}, kBudgetMs{0, 1e6};

/// `draw` holds size, framing, look, technique, radius, and the settings to begin with. The filter is that of the look.
/// The radius is that of the technique, if it has one, and else the reference's.
struct TuneSettings : MeasureSettings {
  double budget_ms = 0.0;  ///< of technique, filter and upsampling, in the mean over all pictures; 0: what it takes now
  int trials = 100;        ///< settings that are tried, at most
};

/// One way to set the technique.
struct Trial {
  std::vector<std::string> settings;  ///< "effect.parameter=value", where they differ from the start's
  std::string scale;                  ///< full, half or quarter
  double ms = 0.0;                    ///< mean over all pictures of the median time
  double rmse = 0.0, bias = 0.0;      ///< of occlusion as it is seen, over the surfaces of all pictures
  bool frontier = false;              ///< nothing that was tried is both faster and closer
};

struct Tuning {
  std::string technique, filter;  ///< filter: empty where the look has none
  std::string radius;             ///< as written
  Trial start, best;              ///< best: the closest one within the time, or, of those
                                  ///< within half a percent of that, the one with the fewest changes
  double budget_ms = 0.0;
  std::vector<Trial> trials;          ///< all, the start first
  std::vector<std::string> options;   ///< what to write behind `umbrage render` to get the best, word by word
  std::vector<std::string> warnings;  ///< of the models, one sentence each
};

/// Finds what is wrong with the settings before any work. Errors: kUsage.
Result<void> check_tune(const TuneSettings& settings);

/// Draws, traces and searches: from each of the settings that are on the frontier of error against time, one parameter
/// is changed by one step. What `draw` sets (settings, scale) stays as it is. Numbers are stepped by about the square
/// root of 2, choices to each other one, the resolution of occlusion to each other one. Errors: kUsage, kFile for
/// models, kInterrupted.
Result<Tuning> tune(Device& device, const TuneSettings& settings);

}  // namespace umbrage
