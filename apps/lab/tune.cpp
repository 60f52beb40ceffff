// umbrage tune: searches for the settings of a technique that come closest to the ray-traced ground truth of a scene.
#include "apps/lab/commands.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/progress.h"
#include "apps/compare/tune.h"

namespace umbrage::cli {
namespace {

/// Returns the settings of a trial as on a command line; "as it is" if they equal the initial ones.
std::string setting_text(const Trial& trial, const Trial& start) {
  std::string text = trial.scale == start.scale ? "" : trial.scale;
  for (const std::string& setting : trial.settings) text += (text.empty() ? "" : " ") + setting;
  return text.empty() ? "as it is" : text;
}

void print_json(const Tuning& tuning, const Device& device) {
  nlohmann::json records = nlohmann::json::array();
  for (const Trial& trial : tuning.trials)
    records.push_back({{"technique", tuning.technique},
                       {"filter", tuning.filter},
                       {"scale", trial.scale},
                       {"setting", fmt::format("{}", fmt::join(trial.settings, " "))},
                       {"device", device.name()},
                       {"ms", trial.ms},
                       {"rmse", trial.rmse},
                       {"bias", trial.bias},
                       {"frontier", trial.frontier},
                       {"best", trial.scale == tuning.best.scale && trial.settings == tuning.best.settings}});
  fmt::print("{}\n", records.dump(2));
}

void print_table(const Tuning& tuning) {
  std::vector<Trial> shown;
  for (const Trial& trial : tuning.trials)
    if (trial.frontier) shown.push_back(trial);
  std::sort(shown.begin(), shown.end(), [](const Trial& a, const Trial& b) { return a.ms < b.ms; });
  // Omit trials that are slower but hardly closer.
  constexpr double kMinImprovement = 0.01;
  double last = std::numeric_limits<double>::infinity();
  std::erase_if(shown, [&](const Trial& trial) {
    if (trial.rmse > (1.0 - kMinImprovement) * last) return true;
    last = trial.rmse;
    return false;
  });
  fmt::print("{}{}, {} settings tried; shown if no other was both faster and closer\n{:>9} {:>7} {:>7}  {}\n",
             tuning.technique, tuning.filter.empty() ? "" : " with " + tuning.filter, tuning.trials.size(), "ms",
             "rmse", "bias", "setting");
  for (const Trial& trial : shown)
    fmt::print("{:9.1f} {:7.4f} {:7.4f}  {}\n", trial.ms, trial.rmse, trial.bias, setting_text(trial, tuning.start));
  if (tuning.best.settings.empty() && tuning.best.scale == tuning.start.scale)
    fmt::print("within {:.1f} ms no setting comes closer than the initial ones: RMSE {:.4f}\n", tuning.budget_ms,
               tuning.start.rmse);
  else
    fmt::print("closest within {:.1f} ms: RMSE {:.4f} in {:.1f} ms; initially {:.4f} in {:.1f} ms\n", tuning.budget_ms,
               tuning.best.rmse, tuning.best.ms, tuning.start.rmse, tuning.start.ms);
  fmt::print("{}\n", fmt::join(tuning.options, " "));
}

}  // namespace

Result<void> run_tune(const TuneOptions& o) {
  TuneSettings settings;
  settings.trials = o.trials;
  settings.budget_ms = o.budget_ms;
  if (auto status = apply_measure_options(o, settings); !status) return status;
  if (auto status = check_tune(settings); !status) return status;
  auto device = device_of(o);
  if (!device) return device.error();
  ProgressLine line;
  settings.progress = progress_on(line);
  const auto tuning = tune(**device, settings);
  if (!tuning) return tuning.error();
  print_measured(o, tuning->warnings, **device, line);
  if (o.json)
    print_json(*tuning, **device);
  else
    print_table(*tuning);
  return {};
}

}  // namespace umbrage::cli
