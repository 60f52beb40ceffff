#include "gbuffers/depth_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace umbrage {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Returns the extreme value of sorted depths if it means no surface: it occurs often, and is far from all others.
/// `at_end`: the max, else the min.
std::optional<double> separate_extreme(const std::vector<double>& sorted, bool at_end) {
  constexpr double kFrequent = 0.002;  // fraction of the pixels
  constexpr double kGap = 0.5;         // fraction of the range of all other values
  if (sorted.size() < 2) return std::nullopt;
  const double extreme = at_end ? sorted.back() : sorted.front();
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), extreme);
  const auto last = std::upper_bound(sorted.begin(), sorted.end(), extreme);
  const auto count = double(last - first);
  if (count < 2.0 || count < kFrequent * double(sorted.size()) || last - first == long(sorted.size()))
    return std::nullopt;
  const double next = at_end ? *(first - 1) : *last, other = at_end ? sorted.front() : sorted.back();
  // A range of nearly zero, as of a wall that the camera faces, is measured by the distance.
  const double range = std::max(std::abs(other - next), 0.1 * std::abs(next));
  return std::abs(extreme - next) > kGap * range ? std::optional(extreme) : std::nullopt;
}

std::vector<double> sorted_centers(const std::vector<std::array<double, kTaps>>& taps) {
  std::vector<double> centers;
  for (const auto& tap : taps)
    if (std::isfinite(tap[kCenter])) centers.push_back(tap[kCenter]);
  std::sort(centers.begin(), centers.end());
  return centers;
}

/// Returns whether pixels of this depth show surfaces, by their normals.
bool has_faces(const std::vector<std::array<double, kTaps>>& taps, const std::vector<char>& faces, double value) {
  std::size_t all = 0, facing = 0;
  for (std::size_t k = 0; k < faces.size(); ++k)
    if (taps[k][kCenter] == value) ++all, facing += std::size_t(faces[k]);
  return !faces.empty() && facing * 2 > all;
}

void remove(std::vector<std::array<double, kTaps>>& taps, double value) {
  for (auto& tap : taps)
    for (double& v : tap)
      if (v == value) v = kNan;
}

}  // namespace

bool is_never_depth(double stored) {
  // 1e10: Cycles; 65504: infinity in a half float that may not be infinite; 1e20 and more: other renderers' infinity.
  constexpr double kCycles = 1e10, kMaxHalf = 65504.0, kInfinite = 1e20;
  const double size = std::abs(stored);
  return !(size < kInfinite) || size == kCycles || size == kMaxHalf;
}

double stored_depth(const DepthConvention& depth, const std::array<double, 3>& channels) {
  double v = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    if (depth.weights[c] != 0.0) v += depth.weights[c] * channels[c];
  if (is_never_depth(v)) return kNan;
  for (const double background : depth.background)
    if (v == background) return kNan;
  return v;
}

DepthValues depth_values(const Samples& samples, const LayeredFile& header, bool may_be_low,
                         const std::vector<char>& faces, DepthConvention& depth) {
  DepthValues out;
  out.max_integer = header.max_integer;
  out.taps.resize(samples.size());
  const auto channels = samples.find_three(Role::kDepth);
  for (std::size_t k = 0; k < samples.size(); ++k)
    for (std::size_t tap = 0; tap < kTaps; ++tap) {
      std::array<double, 3> stored{};
      for (std::size_t c = 0; c < 3; ++c)
        if (channels[c]) stored[c] = (*channels[c])[tap][k];
      out.taps[k][tap] = stored_depth(depth, stored);
    }
  std::vector<double> sorted = sorted_centers(out.taps);
  for (const double v : sorted) {
    out.at_low += v == 0.0 ? 1.0 / double(sorted.size()) : 0.0;
    out.at_high += v == out.max_integer ? 1.0 / double(sorted.size()) : 0.0;
  }
  const auto below_zero = std::size_t(std::lower_bound(sorted.begin(), sorted.end(), 0.0) - sorted.begin());
  constexpr double kNearlyAll = 0.95;
  out.is_negative = !sorted.empty() && double(below_zero) > kNearlyAll * double(sorted.size());
  // A value of 0 is no surface in any kind of length, and lengths have one sign.
  if (!may_be_low)
    for (auto& tap : out.taps)
      for (double& v : tap)
        if (out.is_negative ? v >= 0.0 : v <= 0.0) v = kNan;
  for (const bool at_end : {true, false}) {
    if (!at_end && !may_be_low) continue;
    sorted = sorted_centers(out.taps);
    const auto extreme = separate_extreme(sorted, at_end);
    if (!extreme || has_faces(out.taps, faces, *extreme)) continue;
    depth.background.push_back(*extreme);
    remove(out.taps, *extreme);
  }
  sorted = sorted_centers(out.taps);
  out.surfaces = sorted.size();
  if (sorted.empty()) return out;
  out.min = sorted.front();
  out.max = sorted.back();
  std::set<double> seen;
  for (const double v : sorted)
    if (int(seen.size()) < DepthValues::kManyValues) seen.insert(v);
  out.distinct = int(seen.size());
  return out;
}

}  // namespace umbrage
