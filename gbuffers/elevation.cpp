#include "gbuffers/elevation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "core/lists.h"
#include "gbuffers/fit.h"

namespace umbrage {
namespace {

// The values that surveys and their programs write for cells without data.
constexpr std::array kNoData = {-9999.0, -32767.0, -32768.0, -99999.0, double(std::numeric_limits<float>::lowest())};

/// Returns the value of kNoData that is meant; NaN if none is. The min float is written with few digits, too.
double no_data_of(double value) {
  constexpr double kNearly = 0.99;
  if (value <= kNearly * kNoData.back()) return std::isinf(value) ? std::numeric_limits<double>::quiet_NaN() : value;
  return contains(kNoData, value) ? value : std::numeric_limits<double>::quiet_NaN();
}

/// Returns whether these values are many, and not just a few that mean no surface.
bool are_many(const std::vector<double>& values, std::size_t all) {
  constexpr double kFraction = 0.001;  // of the samples: fewer may be noise
  constexpr std::size_t kDifferent = 8;
  if (double(values.size()) < kFraction * double(all)) return false;
  std::set<double> different;
  for (const double v : values) {
    different.insert(v);
    if (different.size() >= kDifferent) return true;
  }
  return false;
}

}  // namespace

std::string ElevationSigns::reason() const {
  std::string text = has_both_signs ? "by values below zero" : "by";
  if (has_both_signs && !no_data.empty()) text += " and";
  for (std::size_t k = 0; k < no_data.size(); ++k)
    text += fmt::format("{} nodata {}", k > 0 ? " and" : "", number_text(no_data[k]));
  return text;
}

ElevationSigns elevation_signs(const Samples& samples) {
  ElevationSigns signs;
  const auto* channel = samples.find(Role::kDepth, 0);
  if (!channel) return signs;
  std::set<double> no_data;
  std::vector<double> below, above;
  for (const float stored : (*channel)[kCenter]) {
    const double v = stored;
    if (const double marker = no_data_of(v); std::isfinite(marker))
      no_data.insert(marker);
    else if (!is_never_depth(v) && v != 0.0)
      (v < 0.0 ? below : above).push_back(v);
  }
  const std::size_t all = below.size() + above.size();
  signs.has_both_signs = are_many(below, all) && are_many(above, all);
  constexpr double kNear = 0.1;  // a marker is far from all other values: a deep sea has some of -9999
  for (const double marker : no_data) {
    const bool is_value = std::any_of(below.begin(), below.end(),
                                      [&](double v) { return std::abs(v - marker) < kNear * std::abs(marker); });
    // Renderers that look along -z write the min float for the background.
    const bool is_background = is_never_depth(marker) && !are_many(above, all);
    if (!is_value && !is_background && all > 0) signs.no_data.push_back(marker);
  }
  return signs;
}

double assumed_cell_size(const DepthValues& elevations, int reach) {
  constexpr double kSlope_deg = 20.0;  // of hills
  std::vector<double> rises;           // per cell
  for (const auto& tap : elevations.taps) {
    const double rise = std::hypot(tap[kRight] - tap[kLeft], tap[kBelow] - tap[kAbove]) / (2.0 * std::max(reach, 1));
    if (rise > 0.0 && std::isfinite(rise)) rises.push_back(rise);
  }
  if (rises.empty()) return 1.0;
  const double cell = quantile(std::move(rises), 0.5) / std::tan(kSlope_deg * 3.14159265358979323846 / 180.0);
  const double digits = std::pow(10.0, std::floor(std::log10(cell)) - 1.0);  // two, as one would write it
  return std::round(cell / digits) * digits;
}

}  // namespace umbrage
