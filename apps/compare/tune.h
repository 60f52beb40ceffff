// Tune: searches the settings of an occlusion technique and its filter that come closest to the ray-traced ground truth
// of a scene within a given time.
#pragma once
#include <string>
#include <vector>

#include "apps/compare/measure_settings.h"

namespace umbrage {

inline constexpr Interval kTrials{2, 10000, NumberKind::kInteger}, kBudgetMs{0, 1e6};

/// Settings of a search. `draw` has size, framing, look, technique, radius and the initial settings. The filter is that
/// of the look. The radius is by default that of the technique, if it has one, else that of the reference.
struct TuneSettings : MeasureSettings {
  double budget_ms = 0.0;  ///< max mean time of technique, filter and upsampling; 0: time of the initial settings
  int trials = 100;        ///< max number of trials
};

/// The settings of a technique that were tried, and their score.
struct Trial {
  std::vector<std::string> settings;  ///< "effect.parameter=value" for those that differ from the start
  std::string scale;                  ///< full, half or quarter
  double ms = 0.0;                    ///< mean over all pictures of the median time
  double rmse = 0.0, bias = 0.0;      ///< of occlusion clamped to [0, 1], over the surface pixels of all pictures
  bool frontier = false;              ///< no other trial is both faster and closer
};

/// Result of a search.
struct Tuning {
  std::string technique, filter;  ///< filter: empty if the look has none
  std::string radius;             ///< as an option value
  Trial start, best;  ///< best: fewest changes among trials within the time and 0.5 % of the min error there
  double budget_ms = 0.0;
  std::vector<Trial> trials;          ///< all trials, the start first
  std::vector<std::string> options;   ///< options of `umbrage render` that select the best trial, one word each
  std::vector<std::string> warnings;  ///< warnings about the models, one sentence each
};

/// Checks the settings before any work. Errors: kUsage.
Result<void> check_tune(const TuneSettings& settings);

/// Draws, traces and searches. The search changes one parameter by one step, starting from each trial on the frontier
/// of error against time: the closest within the budget first, or the fastest, and any faster one that it leads to,
/// while none is within it. Settings and scale that `draw` sets stay fixed. A step multiplies or divides a number by
/// about the square root of 2, or selects another choice or another scale. Errors: kUsage, kFile for models,
/// kInterrupted, kInternal if no trial is within the budget.
Result<Tuning> tune(Device& device, const TuneSettings& settings);

}  // namespace umbrage
