#include "gbuffers/motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/lists.h"
#include "core/rows.h"
#include "gbuffers/deciding.h"

namespace umbrage {
namespace {

/// Words of `motion_kind`: one of each group is right.
constexpr std::array<std::string_view, 3> kUnits = {"px", "ndc", "uv"};
constexpr std::array<std::string_view, 2> kFrames = {"previous", "next"}, kAxes = {"down", "up"},
                                          kSenses = {"to", "from"};

using Words = std::vector<std::string>;

/// Returns whether this one of a group is allowed: the first words that have any of the group have it.
bool allow(std::span<const Words> all, std::string_view word, std::span<const std::string_view> group) {
  for (const Words& words : all)
    if (std::any_of(group.begin(), group.end(), [&](std::string_view other) { return contains(words, other); }))
      return contains(words, word);
  return true;
}

/// The values that a pair of channels has.
struct MotionRange {
  double zero = 0.0, max = 0.0;  ///< of no motion; greatest deviation from it, but for a few pixels
};

MotionRange range_of(const Samples& samples, std::size_t pair, double max_integer) {
  constexpr double kNearlyAll = 0.999, kCentered = 0.2;
  MotionRange range{max_integer / 2.0};
  std::vector<double> values, deviations;
  for (const std::size_t c : {2 * pair, 2 * pair + 1})
    for (const float v : (*samples.find(Role::kMotion, c))[kCenter])
      if (std::isfinite(v)) values.push_back(v);
  const auto [min, max] = std::minmax_element(values.begin(), values.end());
  if (max_integer == 0.0 && !values.empty() && *min >= 0.0 && *max <= 1.0 && *max > 0.0)
    if (const double median = quantile(values, 0.5); std::abs(median - 0.5) < kCentered) range.zero = 0.5;
  for (const double v : values) deviations.push_back(std::abs(v - range.zero));
  if (!deviations.empty()) range.max = quantile(std::move(deviations), kNearlyAll);
  return range;
}

/// Returns the meanings that words allow, of values of this range.
MotionMeanings meanings_of(std::span<const Words> words, const MotionRange& range, double max_integer,
                           glm::dvec2 size) {
  MotionMeanings all;
  for (const std::string_view unit : kUnits)
    for (const std::string_view frame : kFrames)
      for (const std::string_view axis : kAxes)
        for (const std::string_view sense : kSenses) {
          if (!allow(words, unit, kUnits) || !allow(words, frame, kFrames) || !allow(words, axis, kAxes) ||
              !allow(words, sense, kSenses))
            continue;
          // The widest motion is across the picture. Values around 1/2 are fractions of it.
          const double widest = unit == "px" ? std::max(size.x, size.y) : unit == "ndc" ? 2.0 : 1.0;
          const bool is_open =
              std::none_of(words.begin(), words.end(), [&](const Words& w) { return contains(w, unit); });
          if (is_open && (range.max > widest || (range.zero != 0.0 && unit == "px"))) continue;
          glm::dvec2 scale = unit == "px" ? glm::dvec2(1.0) : unit == "ndc" ? 0.5 * size : size;
          if (max_integer > 0.0) scale /= max_integer;
          if (axis == "up") scale.y = -scale.y;
          if (sense == "from") scale = -scale;
          all.push_back(
              {frame == "next", scale, range.zero, fmt::format("{} {} the {} frame, y {}", unit, sense, frame, axis)});
        }
  return all;
}

std::string text_of(const std::vector<MotionMeanings>& pairs) {
  std::vector<std::string> texts;
  for (const MotionMeanings& meanings : pairs)
    if (!meanings.empty()) texts.push_back(meanings.front().meaning);
  return fmt::format("{}", fmt::join(texts, ", and "));
}

/// Returns the value of a plane between its pixels; NaN outside.
float between(const Plane& plane, double x, double y) {
  if (!(x >= 0.0 && y >= 0.0 && x <= plane.width - 1 && y <= plane.height - 1))
    return std::numeric_limits<float>::quiet_NaN();
  const int column = std::min(int(x), std::max(plane.width - 2, 0)),
            row = std::min(int(y), std::max(plane.height - 2, 0));
  const int right = std::min(column + 1, plane.width - 1), below = std::min(row + 1, plane.height - 1);
  const auto fx = float(x - column), fy = float(y - row);
  return (1.0f - fy) * ((1.0f - fx) * plane.at(column, row) + fx * plane.at(right, row)) +
         fy * ((1.0f - fx) * plane.at(column, below) + fx * plane.at(right, below));
}

/// Returns how much surfaces differ from those to which a meaning leads, 0 to 1: the mean, weighted by motion.
double difference(const MotionFrame& from, const MotionFrame& to, std::size_t pair, const MotionConvention& meaning) {
  constexpr double kFew = 0.3, kSamples = 20000.0, kDepth = 0.05, kOthers = 0.1;  // differences that count fully
  const Plane &depth = from.planes.plane("depth"), &right = from.stored.planes[2 * pair],
              &down = from.stored.planes[2 * pair + 1];
  const int step = std::max(1, int(std::sqrt(double(depth.width) * depth.height / kSamples)));
  double sum = 0.0, inside = 0.0, all = 0.0;
  for (int row = step / 2; row < depth.height; row += step)
    for (int column = step / 2; column < depth.width; column += step) {
      const glm::dvec2 v = glm::dvec2(right.at(column, row), down.at(column, row)) - meaning.zero;
      const glm::dvec2 there = glm::dvec2(column, row) + v * meaning.scale;
      const double size = glm::length(v);
      if (!std::isfinite(depth.at(column, row)) || !std::isfinite(size)) continue;
      all += size;
      if (std::isnan(between(right, there.x, there.y))) continue;
      inside += size;
      double parts = 0.0, differences = 0.0;
      for (std::size_t k = 0; k < from.planes.planes.size(); ++k) {
        const std::string& name = from.planes.names[k];
        const Plane* other = to.planes.find(name);
        const bool is_depth = name == "depth";
        if (!other || (!is_depth && name.find('.') == name.npos)) continue;  // ids may differ from frame to frame
        const double own = from.planes.planes[k].at(column, row), found = between(*other, there.x, there.y);
        const double apart = std::abs(found - own) / (is_depth ? kDepth * own : kOthers * std::max(1.0, std::abs(own)));
        const double weight = is_depth ? 3.0 : 1.0;  // as that of the three components of a normal
        differences += weight * (apart < 1.0 ? apart : 1.0);
        parts += weight;
      }
      sum += size * differences / parts;
    }
  return all == 0.0 ? 0.0 : inside > kFew * all ? sum / inside : 1.0;
}

}  // namespace

std::vector<bool> narrow_meanings(const MotionFrame& here, const MotionFrame& next,
                                  std::vector<MotionMeanings>& pairs) {
  constexpr double kFits = 0.35, kAsGood = 1.2, kNoise = 0.003;
  std::vector<bool> fits;
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    MotionMeanings& meanings = pairs[pair];
    std::vector<double> differences;
    for (const MotionConvention& meaning : meanings)
      differences.push_back(meaning.is_next ? difference(here, next, pair, meaning)
                                            : difference(next, here, pair, meaning));
    const double best = meanings.empty() ? 1.0 : *std::min_element(differences.begin(), differences.end());
    fits.push_back(best < kFits);
    if (!fits.back()) continue;
    MotionMeanings left;
    for (std::size_t k = 0; k < meanings.size(); ++k)
      if (differences[k] <= kAsGood * best + kNoise) left.push_back(meanings[k]);
    meanings = std::move(left);
  }
  return fits;
}

Image motion_planes(const Image& stored, std::span<const MotionMeanings> pairs) {
  Image out(stored.width, stored.height);
  for (std::size_t pair = 0; pair < pairs.size() && 2 * pair + 1 < stored.planes.size(); ++pair) {
    if (pairs[pair].empty()) continue;
    const MotionConvention& meaning = pairs[pair].front();
    for (const int axis : {0, 1}) {
      const Plane& from = stored.planes[2 * pair + std::size_t(axis)];
      Plane& to = out.add(std::string(meaning.is_next ? "after" : "before") + (axis == 0 ? ".x" : ".y")) =
          Plane(out.width, out.height);
      const auto zero = float(meaning.zero), scale = float(meaning.scale[axis]);
      for_rows(0, out.height, [&](int y) {
        for (int x = 0; x < out.width; ++x) {
          const float v = (from.at(x, y) - zero) * scale;
          to.at(x, y) = std::isfinite(v) ? v : std::numeric_limits<float>::quiet_NaN();
        }
      });
    }
  }
  return out;
}

void decide_motion(Deciding& d) {
  if (!d.has(Role::kMotion)) return;
  const std::string& name = d.roles[Role::kMotion].name;
  const double max_integer = d.channel_of(Role::kMotion).max_integer;
  std::vector<MotionMeanings>& pairs = d.out.motion;
  if (d.first) pairs = d.first->motion;
  for (std::size_t pair = pairs.size(); pair < d.roles.motion_words.size(); ++pair) {
    Words said = d.settings.motion_kind;
    // Of two pairs the second one is about the other frame.
    for (std::string& word : said)
      if (pair == 1 && contains(kFrames, word)) word = word == kFrames[0] ? kFrames[1] : kFrames[0];
    pairs.push_back(meanings_of(std::vector{said, d.roles.motion_words[pair]}, range_of(d.samples, pair, max_integer),
                                max_integer, {d.samples.width, d.samples.height}));
  }
  const bool is_open =
      std::any_of(pairs.begin(), pairs.end(), [](const MotionMeanings& all) { return all.size() > 1; });
  const bool is_lost = std::any_of(pairs.begin(), pairs.end(), [](const MotionMeanings& all) { return all.empty(); });
  if (is_lost) {
    d.warn(
        fmt::format("the motion vectors {} have values that no meaning allows, and are not used: `motion_kind` sets "
                    "their meaning",
                    name));
    pairs.clear();
    return;
  }
  d.fact(fmt::format("motion: {}, {}", name, is_open ? "its meaning is decided by the frames beside" : text_of(pairs)));
}

}  // namespace umbrage
