#include "gbuffers/depth_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/lists.h"

namespace umbrage {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr double kFrequent = 0.002;  // fraction of the pixels: fewer are no background

/// Returns the extreme value of sorted depths if it means no surface: it occurs often, and is far from all others.
/// `at_end`: the max, else the min.
std::optional<double> separate_extreme(const std::vector<double>& sorted, bool at_end) {
  constexpr double kGap = 0.5;  // fraction of the range of all other values
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

/// Recognises the background of a depth buffer. `sorted`: all stored depths.
void find_ends(const std::vector<double>& sorted, const std::vector<char>& faces, bool may_be_bytes, DepthValues& out,
               DepthConvention& depth) {
  if (sorted.empty() || sorted.front() < 0.0) return;
  const auto is_frequent = [&](double value) {
    const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), value);
    return last - first >= 2 && double(last - first) >= kFrequent * double(sorted.size()) &&
           last - first < std::ptrdiff_t(sorted.size()) && !has_faces(out.taps, faces, value);
  };
  constexpr double kMaxByte = 255.0, kMinNear = 0.05;  // integers from nearly 0 on are brightnesses
  const bool is_real = out.max_integer == 0.0 && sorted.back() == 1.0;
  const bool is_far_from_0 = *std::upper_bound(sorted.begin(), sorted.end() - 1, 0.0) > kMinNear * out.max_integer;
  const bool is_integer = out.max_integer > 0.0 && sorted.back() == out.max_integer &&
                          (may_be_bytes || (out.max_integer > kMaxByte && is_far_from_0));
  out.has_low_end = is_frequent(0.0);
  out.has_high_end = (is_real || is_integer) && is_frequent(sorted.back());
  if (!out.has_high_end) return;
  depth.background.push_back(sorted.back());
  remove(out.taps, sorted.back());
}

}  // namespace

bool is_never_depth(double stored) {
  // 1e10: Cycles; 65504: infinity in a half float that may not be infinite; 1e20 and more: other renderers' infinity.
  constexpr double kCycles = 1e10, kMaxHalf = 65504.0, kInfinite = 1e20;
  const double size = std::abs(stored);
  return !(size < kInfinite) || size == kCycles || size == kMaxHalf;
}

double stored_depth(const DepthConvention& depth, double stored) {
  return is_never_depth(stored) || contains(depth.background, stored) ? kNan : stored;
}

DepthValues depth_values(const Samples& samples, double max_integer, MayBe may, const std::vector<char>& faces,
                         DepthConvention& depth) {
  DepthValues out;
  out.max_integer = max_integer;
  out.taps.resize(samples.size());
  const TapValues& stored = *samples.find(Role::kDepth, 0);
  for (std::size_t k = 0; k < samples.size(); ++k)
    for (std::size_t tap = 0; tap < kTaps; ++tap) out.taps[k][tap] = stored_depth(depth, stored[tap][k]);
  std::vector<double> sorted = sorted_centers(out.taps);
  for (const double v : sorted) {
    out.at_low += v == 0.0 ? 1.0 / double(sorted.size()) : 0.0;
    out.at_high += v == out.max_integer ? 1.0 / double(sorted.size()) : 0.0;
  }
  const auto below_zero = std::size_t(std::lower_bound(sorted.begin(), sorted.end(), 0.0) - sorted.begin());
  constexpr double kNearlyAll = 0.95;
  // 0 may be the background.
  out.is_negative = below_zero > 0 && double(below_zero) > kNearlyAll * (1.0 - out.at_low) * double(sorted.size());
  if (may.be_buffer) find_ends(sorted, faces, may.be_bytes, out, depth);
  // A value of 0 is no surface in any kind of length, and lengths have one sign.
  if (!may.be_low)
    for (auto& tap : out.taps)
      for (double& v : tap)
        if (out.is_negative ? v >= 0.0 : v <= 0.0) v = kNan;
  for (const bool at_end : {true, false}) {
    if (!at_end && !may.be_low) continue;
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
  std::vector<double> gaps;
  for (auto at = seen.begin(); std::next(at) != seen.end(); ++at) gaps.push_back(*std::next(at) - *at);
  constexpr double kRounding = 0.01;  // of the usual gap, below which a gap is a rounding error
  const double usual = quantile(gaps, 0.5);
  out.step = usual;
  for (const double gap : gaps)
    if (gap > kRounding * usual) out.step = std::min(out.step, gap);
  return out;
}

}  // namespace umbrage
