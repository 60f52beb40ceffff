// umbrage compare: measures each technique against ray-traced ground truth; writes scores and an HTML page.
#include "apps/lab/commands.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/progress.h"
#include "apps/compare/compare.h"
#include "apps/compare/report.h"
#include "core/lists.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

Result<void> run_compare(const CompareOptions& o) {
  CompareSettings settings;
  settings.light = o.light;
  settings.budget = o.budget;
  settings.filter = o.filter;
  settings.sizes.clear();
  for (const std::string& text : o.sizes) {
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
  if (o.techniques != "all") settings.techniques = split(o.techniques);
  if (auto status = apply_measure_options(o, settings); !status) return status;
  if (auto status = check_compare(settings); !status) return status;
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
  const auto comparison = compare(**device, settings);
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

  for (int q = 0; q < (o.light ? kQuantities : 1); ++q)
    for (const auto& size : settings.sizes)
      print_table(*comparison, Quantity(q), size, o.budget && Quantity(q) == Quantity::kOcclusion);
  fmt::print(
      "ground truth: mean {:.4f} over all surfaces, {} rays per pixel within {}, standard error of a pixel {:.4f}\n",
      comparison->mean, comparison->terms.samples, comparison->terms.radius, comparison->noise);
  if (o.light)
    fmt::print("ground truth of light: one bounce within {}, standard error of a pixel {:.4f} of the mean light\n",
               comparison->terms.radius, comparison->light_noise);
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

}  // namespace umbrage::cli
