// Facts and warnings about the depth of a G-buffer.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/lists.h"
#include "gbuffers/deciding.h"

namespace umbrage {
namespace {

std::string background_text(const DepthConvention& depth) {
  if (depth.background.empty()) return "";
  std::vector<std::string> values;
  for (const double v : depth.background) values.push_back(number_text(v));
  return fmt::format(", background {}", fmt::join(values, " and "));
}

/// Prepares the warning of steps that show as terraces.
void warn_of_steps(Deciding& d) {
  constexpr int kFewLevels = 256;
  const DepthValues& v = d.values;
  const bool is_byte = v.max_integer == 255.0 && d.settings.depth_packing == "none";
  constexpr std::size_t kEnough = 2000;  // samples, below which few values are no sign
  // Before a level camera each row of a floor has one depth, as a float, which are no steps.
  const auto steps = std::count_if(v.taps.begin(), v.taps.end(), [](const auto& t) {
    return (t[kLeft] == t[kCenter] || t[kRight] == t[kCenter]) && (t[kAbove] == t[kCenter] || t[kBelow] == t[kCenter]);
  });
  constexpr double kSome = 0.02;  // of the surfaces
  const bool few = v.distinct <= kFewLevels && v.surfaces > kEnough &&
                   (v.max_integer > 0.0 || double(steps) > kSome * double(v.surfaces));
  constexpr int kMinLevels = 3;  // fewer are no steps of a slope
  if ((!is_byte && !few) || v.distinct < kMinLevels || !(v.max > v.min)) return;
  d.out.step_warning = fmt::format("the depth {} has only {} different values, steps of {} ({:.2g} % of its range)",
                                   d.roles[Role::kDepth].name, v.distinct, number_text(v.step),
                                   100.0 * v.step / std::max(v.max - v.min, 1e-30));
  d.out.step_cure = is_byte ? "16 bits or floats are needed" : "floats, or a finer unit, are needed";
}

/// Warns of points without neighbours, as those of a laser scanner that were projected into a picture.
void warn_of_points(Deciding& d) {
  constexpr double kIsolated = 0.5;  // fraction of neighbours with a surface, below which there are no surfaces
  std::size_t all = 0, beside = 0;
  for (const auto& taps : d.values.taps) {
    if (!std::isfinite(taps[kCenter])) continue;
    all += kTaps - 1;
    for (const Tap tap : {kLeft, kRight, kAbove, kBelow}) beside += std::size_t(std::isfinite(taps[tap]));
  }
  if (double(beside) < kIsolated * double(all))
    d.warn(
        fmt::format("the depth {} is isolated points, {:.0f} % of the pixels: shading needs surfaces, so fill it "
                    "first",
                    d.roles[Role::kDepth].name, 100.0 * double(d.values.surfaces) / double(d.samples.size())));
}

void warn_of_no_surface(Deciding& d) {
  const std::vector<double>& background = d.out.depth.background;
  const bool any = std::any_of(d.values.taps.begin(), d.values.taps.end(), [&](const auto& taps) {
    const double v = taps[kCenter];
    return std::isfinite(view_depth(d.guess.trial.model, v, 1.0)) && !contains(background, v);
  });
  std::string values = "all its values mean background";
  if (d.values.surfaces > 0)
    values = fmt::format(
        "as {} all its values, {} to {}, mean background; `depth_kind`, `depth_scale`, `depth_offset` "
        "and `depth_range` say otherwise",
        d.guess.meaning, number_text(d.values.min), number_text(d.values.max));
  if (!any) d.warn(fmt::format("the depth {} shows no surface: {}", d.roles[Role::kDepth].name, values));
}

/// Warns of lengths with one max at many pixels without normals: a sky that is as far as surfaces, or clipped.
void warn_of_wall(Deciding& d) {
  constexpr double kMany = 0.05;  // fraction of the samples
  const DepthValues& v = d.values;
  std::size_t count = 0;
  for (std::size_t k = 0; k < v.taps.size(); ++k)
    count += v.taps[k][kCenter] == v.max && (d.normals.empty() || d.normals[k] == glm::dvec3(0.0));
  if (v.distinct >= DepthValues::kManyValues && double(count) > kMany * double(v.taps.size()))
    d.warn(fmt::format("the depth {} is {} at {:.0f} % of the pixels, its max: `depth_background` {} if it is the sky",
                       d.roles[Role::kDepth].name, number_text(v.max), 100.0 * double(count) / double(v.taps.size()),
                       number_text(v.max)));
}

}  // namespace

void report_depth(Deciding& d) {
  const DepthModel& model = d.guess.trial.model;
  std::string line = fmt::format("depth: {}, {}, {}", d.roles[Role::kDepth].name, d.guess.meaning, d.guess.reason);
  if (d.values.is_negative && model.scale < 0.0) line += ", stored as negative numbers";
  line += background_text(d.out.depth);
  const bool is_length = model.meaning == DepthMeaning::kPlanar || model.meaning == DepthMeaning::kDistance;
  if (is_length && d.values.surfaces > 0 && !d.guess.is_relative && d.values.max_integer > 0.0 &&
      !d.settings.depth_scale && d.settings.depth_range.empty())
    line += ", integers as they are stored: `depth_scale` 0.001 for metres from millimetres";
  d.fact(line);
  if (d.guess.is_relative && d.values.surfaces > 0) {
    const double a = view_depth(model, d.values.min, 1.0), b = view_depth(model, d.values.max, 1.0);
    d.warn(fmt::format(
        "the depth {} has no scale: it is read as {}, far about {:.2g} times as far as near; `depth_range` NEAR,FAR, "
        "`depth_kind` and `depth_invert` say otherwise",
        d.roles[Role::kDepth].name, d.guess.meaning, std::max(a, b) / std::min(a, b)));
  }
  const std::string& name = d.roles[Role::kDepth].name;
  if (d.guess.assumes_planes)
    d.warn(
        fmt::format("the depth {} is a depth buffer of unknown planes: near {} and far at infinity are assumed; "
                    "`near_plane` and `far_plane` set them",
                    name, number_text(model.near_plane)));
  if (d.guess.may_be_length)
    d.warn(
        fmt::format("the depth {} is read as {}, since planes are given, and may be a length: `depth_kind` says which",
                    name, d.guess.meaning));
  if (d.guess.may_be_buffer)
    d.warn(fmt::format("the depth {} has values from 0 to 1, as a depth buffer: `depth_kind` {} if it is one", name,
                       d.values.has_low_end ? "reversed" : "window"));
  warn_of_steps(d);
  warn_of_points(d);
  warn_of_no_surface(d);
  if (is_length && !d.guess.is_relative) warn_of_wall(d);
}

void warn_of_flip(Deciding& d) {
  constexpr double kMuch = 0.3, kLittle = 0.02;  // fractions of the lower and the upper third
  std::size_t all[3] = {}, empty[3] = {};
  for (std::size_t k = 0; k < d.samples.size(); ++k) {
    const int third = std::min(2, 3 * d.samples.y[k] / std::max(d.samples.height, 1));
    ++all[third];
    const double v = stored_depth(d.out.depth, double((*d.samples.find(Role::kDepth, 0))[kCenter][k]));
    empty[third] += std::size_t(!std::isfinite(view_depth(d.guess.trial.model, v, 1.0)));
  }
  if (double(empty[2]) > kMuch * double(all[2]) && double(empty[0]) < kLittle * double(all[0]))
    d.warn("the background is at the bottom of the picture: `flip` if it is upside down");
}

}  // namespace umbrage
