// The commands that measure techniques against ray-traced ground truth. umbrage compare writes scores and an HTML page;
// umbrage tune searches for the settings of a technique that come closest for a scene.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/progress.h"
#include "apps/cli/standard_input.h"
#include "apps/compare/compare.h"
#include "apps/compare/flicker.h"
#include "apps/compare/report.h"
#include "apps/compare/tune.h"
#include "apps/lab/commands.h"
#include "core/lists.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

/// Fills in the settings from the options. Errors: kUsage.
Result<void> apply_measure_options(const MeasureOptions& o, MeasureSettings& settings) {
  settings.models = o.models;
  settings.cameras = o.cameras;
  settings.samples = o.samples;
  settings.runs = o.runs;
  const auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  settings.import = *import_with;
  settings.draw = o.request;
  settings.load = loader_of(o);
  return check_standard_input(o.models, o.input_format);
}

/// Returns a callback for MeasureSettings::progress that updates `line`. `line` must outlive it.
std::function<bool(const std::string&, double)> progress_on(ProgressLine& line) {
  return [&line](const std::string& what, double done) {
    line.show(what, done);
    return true;
  };
}

/// Wipes the progress line, then prints warnings and, with --verbose, the device.
void print_measured(const MeasureOptions& o, const std::vector<std::string>& warnings, const Device& device,
                    ProgressLine& line) {
  line.wipe();
  for (const std::string& warning : warnings) print_warning(warning);
  if (o.verbose) fmt::print(stderr, "{}\n", device.description());
}

/// Shortens a setting to the width of its table column.
std::string shown_setting(const std::string& setting) {
  constexpr std::size_t kMaxWidth = 27;
  if (setting.empty()) return "(look defaults)";
  return setting.size() <= kMaxWidth ? setting : setting.substr(0, kMaxWidth - 2) + "..";
}

/// Prints one line per technique and setting: means over all pictures of one size. `divided`: with the parts of errors.
void print_table(const Comparison& comparison, Quantity quantity, std::pair<int, int> size, bool divided) {
  fmt::print("{}, {}x{}, means over all scenes and cameras{}\n{:<11} {:<27} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7}{}\n",
             kQuantityNames[int(quantity)], size.first, size.second,
             quantity != Quantity::kOcclusion ? "; rmse, bias and p99 as fractions of the mean light" : "", "technique",
             "setting", "ms", "rmse", "bias", "ssim", "p99", "flip", divided ? "    view     own" : "");
  std::vector<std::pair<std::string, std::string>> shown;
  for (const Score& first : comparison.scores) {
    if (first.quantity != quantity) continue;
    const std::pair key(first.technique, first.setting);
    if (contains(shown, key)) continue;
    shown.push_back(key);
    double ms = 0.0, rmse = 0.0, bias = 0.0, ssim = 0.0, p99 = 0.0, flip = 0.0, view = 0.0, own = 0.0;
    int count = 0;
    for (const Score& score : comparison.scores) {
      if (score.quantity != quantity || std::pair(score.technique, score.setting) != key ||
          std::pair(score.width, score.height) != size)
        continue;
      ++count;
      ms += score.ms;
      rmse += score.card.covered.rmse;
      bias += score.card.covered.bias;
      ssim += score.card.covered.ssim;
      p99 += score.card.covered.p99;
      flip += score.card.covered.flip;
      if (score.budget) view += score.budget->view, own += score.budget->own;
    }
    if (count == 0) continue;
    fmt::print("{:<11} {:<27} {:9.1f} {:7.4f} {:7.4f} {:7.4f} {:7.4f} {:7.4f}{}\n", first.technique,
               shown_setting(first.setting), ms / count, rmse / count, bias / count, ssim / count, p99 / count,
               flip / count, first.budget ? fmt::format(" {:7.4f} {:7.4f}", view / count, own / count) : "");
  }
}

/// Prints one line per row of sequences of one size: means over all scenes.
void print_table(const SequenceComparison& comparison, std::pair<int, int> size) {
  fmt::print(
      "flicker, {}x{}, means over all scenes; light as a fraction of its mean; open parts in 1/255\n{:<10} {:<20} "
      "{:<8} {:>6} {:>7} {:>7} {:>6} {:>7} {:>7} {:>7} {:>7} {:>6} {:>6} {:>6} {:>6}\n",
      size.first, size.second, "motion", "look, technique", "plane", "joined", "flicker", "truth", "ratio", "over 3",
      "truth", "own", "rmse", "rms", "p99", "flip", "truth");
  std::vector<std::string> shown;
  for (const FlickerRow& first : comparison.rows) {
    const auto key_of = [](const FlickerRow& row) {
      return fmt::format("{:<10} {:<20} {:<8} {:>6}", row.motion, row.look + ", " + row.technique, row.quantity,
                         row.reach);
    };
    const std::string key = key_of(first);
    if (contains(shown, key)) continue;
    shown.push_back(key);
    Flicker mean{.far = 0.0};
    const auto is_same = [&](const FlickerRow& row) {
      return key_of(row) == key && std::pair(row.width, row.height) == size;
    };
    const double count = double(std::count_if(comparison.rows.begin(), comparison.rows.end(), is_same));
    for (const FlickerRow& row : comparison.rows)
      for (const auto& [name, field] : kFlickerFields)
        if (is_same(row)) mean.*field += row.flicker.*field / count;
    if (count == 0.0) continue;
    const std::string ratio = std::isfinite(mean.ratio()) ? fmt::format("{:.2f}", mean.ratio()) : "-";
    fmt::print("{} {:7.4f} {:7.4f} {:>6} {:7.4f} {:7.4f} {:7.4f} {:7.4f} {:6.2f} {:6.2f} {:6.4f} {:6.4f}\n", key,
               mean.next, mean.truth_next, ratio, mean.far, mean.truth_far, mean.own, mean.error, 255.0 * mean.open_rms,
               255.0 * mean.open_p99, mean.flip, mean.truth_flip);
  }
}

/// Prints what a comparison measured.
void print_comparison(const Comparison& comparison, const CompareSettings& settings) {
  for (int q = 0; q < (settings.light ? kQuantities : 1); ++q)
    for (const auto& size : settings.sizes)
      print_table(comparison, Quantity(q), size, settings.budget && Quantity(q) == Quantity::kOcclusion);
  fmt::print(
      "ground truth: mean {:.4f} over all surfaces, {} rays per pixel within {}, standard error of a pixel {:.4f}\n",
      comparison.mean, comparison.terms.samples, comparison.terms.radius, comparison.noise);
  if (settings.light)
    fmt::print("ground truth of light: one bounce within {}, standard error of a pixel {:.4f} of the mean light\n",
               comparison.terms.radius, comparison.light_noise);
}
void print_comparison(const SequenceComparison& comparison, const SequenceSettings& settings) {
  for (const auto& size : settings.sizes) print_table(comparison, size);
}

/// Measures, and writes the report. `check` and `measure` are those of the settings.
template <class Settings, class Check, class Measure>
Result<void> compare_with(const CompareOptions& o, Settings& settings, const Check& check_settings,
                          const Measure& measure) {
  if (auto status = check_settings(settings); !status) return status;
  nlohmann::json baseline;
  if (!o.baseline.empty()) {
    auto read = read_baseline(o.baseline);
    if (!read) return with_field(read.error(), "--baseline");
    baseline = std::move(*read);
    if (auto same = check_terms(baseline, terms_of(settings), o.baseline); !same)
      return with_field(same.error(), "--baseline");
  }
  auto device = device_of(o);
  if (!device) return device.error();
  const fs::path folder(o.output);
  if (auto writable = check_folder(folder, {"index.html", "scores.json"}); !writable) return writable;

  ProgressLine line;
  settings.progress = progress_on(line);
  const auto comparison = measure(**device, settings);
  if (!comparison) return comparison.error();
  print_measured(o, comparison->warnings, **device, line);
  line.show("writing the page");
  const nlohmann::json scores = scores_json(*comparison);
  const auto page = report_page(*comparison, command_line, **device);
  if (!page) return page.error();
  line.wipe();
  if (auto made = make_folder(folder); !made) return made;
  if (auto written = write_text(folder / "scores.json", scores_text(scores)); !written) return written;
  if (auto written = write_text(folder / "index.html", *page); !written) return written;

  print_comparison(*comparison, settings);
  fmt::print("the report is {}; the numbers are in {}\n", (folder / "index.html").string(),
             (folder / "scores.json").string());
  if (o.baseline.empty()) return {};
  const auto check = check_baseline(baseline, scores, o.baseline);
  if (!check) return with_field(check.error(), "--baseline");
  for (const std::string& sentence : check->worse) fmt::print(stderr, "worse: {}\n", sentence);
  if (check->missing > 0)
    print_warning(fmt::format("{} scores of {} were not measured in this run", check->missing, o.baseline));
  if (!check->worse.empty())
    return Error{ErrorKind::kInternal, fmt::format("{} scores got worse than in {}", check->worse.size(), o.baseline)};
  fmt::print("no score is worse than in {}: {} records compared\n", o.baseline, check->compared);
  return {};
}

}  // namespace

Result<void> run_compare(const CompareOptions& o) {
  SequenceSettings settings;
  settings.light = o.light;
  settings.budget = o.budget;
  settings.filter = o.filter;
  settings.sizes.clear();
  std::vector<std::string> sizes = o.sizes;
  if (sizes.empty())
    sizes = o.sequence ? std::vector<std::string>{"384,384"} : std::vector<std::string>{"960,540", "480,270"};
  for (const std::string& text : sizes) {
    const auto size = parse_size("width", text, kMaxPixels);
    if (!size) return size.error();
    settings.sizes.push_back(*size);
  }
  // The page shows the pictures of the first size.
  std::stable_sort(settings.sizes.begin(), settings.sizes.end(), [](const auto& a, const auto& b) {
    const long area_a = long(a.first) * a.second, area_b = long(b.first) * b.second;
    return area_a != area_b ? area_a > area_b : a > b;
  });
  settings.sizes.erase(std::unique(settings.sizes.begin(), settings.sizes.end()), settings.sizes.end());
  if (!o.techniques.empty()) settings.techniques = split(o.techniques);
  if (auto status = apply_measure_options(o, settings); !status) return status;
  if (settings.models.empty()) {
    if (!o.sequence) return field_error("MODEL", "", "{} is missing: name a model or a built-in scene");
    settings.models = {"scene:solids", "scene:tank", "scene:atrium"};
  }
  if (!o.sequence) return compare_with(o, static_cast<CompareSettings&>(settings), check_compare, compare);
  if (o.cameras != MeasureOptions().cameras || o.runs != MeasureOptions().runs)
    print_warning(
        "--cameras and --runs do not apply to --sequence: it draws one view of each scene and measures no times");
  if (!o.looks.empty()) settings.looks = split(o.looks);
  if (!o.motions.empty()) settings.motions = split(o.motions);
  return compare_with(o, settings, check_sequences, compare_sequences);
}

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
