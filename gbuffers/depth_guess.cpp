#include "gbuffers/depth_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/lists.h"

namespace umbrage {
namespace {

/// Far over near of a relative depth whose offset nothing tells.
constexpr double kFarOverNear = 10.0;

struct Candidate {
  DepthModel model;
  std::string meaning;
  bool is_relative = false;
  bool is_inverse = false, is_dark_high = false;  // of a relative one
  double offset = 0.0;
  bool has_free_offset = false;  ///< normals may choose it
};

std::string_view word_of(DepthMeaning meaning) {
  constexpr std::string_view kWords[] = {
      "planar", "distance along the ray", "window depth", "reversed window depth", "disparity", "elevation"};
  return kWords[std::size_t(meaning)];
}

Candidate plain(DepthMeaning meaning, const DepthModel& base) {
  Candidate out;
  out.model = base;
  out.meaning = word_of(meaning);
  out.model.meaning = meaning;
  return out;
}

/// Returns a depth buffer whose planes are not known: inverse depth is offset + t, t being 0 at the far plane and 1 at
/// the near one.
Candidate buffer(DepthMeaning meaning, double offset, const DepthModel& base) {
  Candidate out = plain(meaning, base);
  out.offset = offset;
  out.has_free_offset = true;
  if (offset > 0.0) out.model.far_plane = out.model.near_plane * (1.0 + 1.0 / offset);
  return out;
}

/// Returns depth, or inverse depth, that grows linearly with the brightness t from 0 to 1 (or 1 to 0, `is_dark_high`):
/// offset + t. The unit is such that the nearest depth is 1.
Candidate relative(bool is_inverse, bool is_dark_high, double offset, const DepthValues& values) {
  const double low = values.range_min(), span = std::max(values.range_max() - low, 1e-30);
  const double near_value = is_inverse ? offset + 1.0 : std::max(offset, 1e-3);
  Candidate out;
  out.is_relative = out.has_free_offset = true;
  out.is_inverse = is_inverse;
  out.is_dark_high = is_dark_high;
  out.offset = offset;
  out.model.meaning = is_inverse ? DepthMeaning::kDisparity : DepthMeaning::kPlanar;
  const double slope = (is_dark_high ? -1.0 : 1.0) / span;
  out.model.scale = slope / near_value;
  out.model.offset = (offset - slope * (is_dark_high ? low + span : low)) / near_value;
  out.meaning = fmt::format("{} of unknown scale, {} is near", is_inverse ? "disparity" : "depth",
                            is_inverse != is_dark_high ? "bright" : "dark");
  return out;
}

/// Returns the candidate with another offset.
Candidate with_offset(const Candidate& candidate, double offset, const DepthValues& values) {
  if (candidate.is_relative) return relative(candidate.is_inverse, candidate.is_dark_high, offset, values);
  return buffer(candidate.model.meaning, offset, candidate.model);
}

/// Returns the offset of a relative depth without evidence.
double default_offset(const DepthValues& values) {
  constexpr double kStartsAtZero = 0.02;  // fraction of the max below which the min counts as 0
  // Values that start well above 0 are taken for true lengths or disparities.
  return values.range_min() == 0.0 && values.min > kStartsAtZero * values.max && !values.is_full_range()
             ? 0.0
             : 1.0 / (kFarOverNear - 1.0);
}

bool is_window(const DepthEvidence& e) {
  const std::string& kind = e.settings.depth_kind;
  return kind == "window" || kind == "reversed" ||
         (kind == "auto" && (e.hint == DepthHint::kWindow || e.hint == DepthHint::kReversed));
}

/// Returns the map from stored to real values that the options give, and whether they give one. Errors: kUsage.
Result<bool> map_of_options(const DepthEvidence& e, bool is_disparity, DepthModel& model) {
  const GBufferSettings& s = e.settings;
  const double low = e.values.range_min(), high = e.values.range_max();
  double scale = 1.0, offset = 0.0;
  if (s.depth_invert) scale = -1.0, offset = low + high;
  if (!s.depth_range.empty()) {
    double a = s.depth_range[0], b = s.depth_range[1];
    if (is_disparity) {
      if (!(a > 0.0 && b > 0.0))
        return field_error("depth_range", fmt::format("{:g},{:g}", a, b),
                           "`{}` of disparities must be above 0, not {}");
      const double far_inverse = 1.0 / std::max(a, b), near_inverse = 1.0 / std::min(a, b);
      a = far_inverse;
      b = near_inverse;
    }
    const double slope = (b - a) / std::max(high - low, 1e-30);
    offset = a + slope * (offset - low);
    scale *= slope;
  }
  // A depth buffer's integers stand for 0 to 1.
  const bool is_unit = is_window(e) && e.values.max_integer > 0.0 && s.depth_range.empty();
  const double factor = s.depth_scale ? double(*s.depth_scale) : is_unit ? 1.0 / e.values.max_integer : 1.0;
  model.scale = factor * scale;
  model.offset = s.depth_offset.value_or(0.0f) + factor * offset;
  if (e.values.is_negative && !s.depth_scale && s.depth_range.empty() && !s.depth_invert) model.scale = -model.scale;
  model.near_plane = s.near_plane;
  model.far_plane = s.far_plane > 0.0f ? double(s.far_plane) : kNoDepth;
  return s.depth_scale || s.depth_offset || !s.depth_range.empty();
}

/// Offsets of a relative depth or a depth buffer that are tried against normals.
constexpr double kOffsets[] = {0.0, 0.02, 0.05, 1.0 / 9.0, 0.25, 0.5, 1.0, 2.0};

/// Adds a candidate, and, where normals can tell, one for each offset.
void add_with_offsets(const DepthEvidence& e, const Candidate& candidate, std::vector<Candidate>& list) {
  list.push_back(candidate);
  if (!e.cells.have_normals) return;
  for (const double offset : kOffsets) list.push_back(with_offset(candidate, offset, e.values));
}

void add_relative(const DepthEvidence& e, bool is_inverse, bool is_dark_high, std::vector<Candidate>& list) {
  add_with_offsets(e, relative(is_inverse, is_dark_high, default_offset(e.values), e.values), list);
}

/// Returns whether the options give planes, and the values may be those of a depth buffer.
bool has_planes(const DepthEvidence& e) {
  return gives_planes(e.settings) && (e.values.is_unit() || e.values.max_integer > 0.0);
}

/// Adds a depth buffer; with other planes than the assumed ones if the options leave them open.
void add_buffer(const DepthEvidence& e, DepthMeaning meaning, const DepthModel& base, std::vector<Candidate>& list) {
  if (has_planes(e))
    list.push_back(plain(meaning, base));
  else
    add_with_offsets(e, buffer(meaning, 0.0, base), list);
}

/// Returns whether the lower part of the picture is brighter than the upper part.
bool is_bright_below(const Cells& cells) {
  std::vector<double> upper, lower;
  for (const Cell& cell : cells.cells) {
    if (cell.y * 3 < cells.height) upper.push_back(cell.stored[kCenter]);
    if (cell.y * 3 > 2 * cells.height) lower.push_back(cell.stored[kCenter]);
  }
  return quantile(std::move(lower), 0.5) >= quantile(std::move(upper), 0.5);
}

/// Returns the candidates for a depth that the options do not explain, the likeliest first.
std::vector<Candidate> candidates_for(const DepthEvidence& e, const DepthModel& base) {
  const Candidate planar = plain(DepthMeaning::kPlanar, base), distance = plain(DepthMeaning::kDistance, base);
  std::vector<Candidate> list;
  const auto add_all_relative = [&](bool inverse_first, bool dark_high) {
    for (const bool is_inverse : {inverse_first, !inverse_first})
      for (const bool is_other : {false, true}) {
        if (is_other && !e.cells.have_normals) continue;
        add_relative(e, is_inverse, (is_inverse == inverse_first) == (dark_high != is_other), list);
      }
  };
  switch (e.hint) {
    case DepthHint::kPlanar:
      return {planar, distance};
    case DepthHint::kDistance:
      return {distance, planar};
    case DepthHint::kWindow:
      add_buffer(e, DepthMeaning::kWindow, base, list);
      return list;
    case DepthHint::kReversed:
      add_buffer(e, DepthMeaning::kReversed, base, list);
      return list;
    case DepthHint::kHeight:
      return {plain(DepthMeaning::kHeight, base)};
    case DepthHint::kDisparity:
      add_relative(e, true, false, list);
      if (e.cells.have_normals) add_relative(e, true, true, list);
      return list;
    case DepthHint::kGrey:
      if (!e.values.is_unit() && e.values.max_integer == 0.0) return {planar, distance};
      add_all_relative(false, is_bright_below(e.cells));
      return list;
    case DepthHint::kNone:
      break;
  }
  constexpr double kMaxByte = 255.0;
  if (!has_planes(e) && (e.values.is_full_range() || e.values.max_integer == kMaxByte)) {
    // Networks write near as bright and games near as dark; what is below in a picture is nearer.
    const bool near_is_bright = is_bright_below(e.cells);
    add_all_relative(near_is_bright, false);
    return list;
  }
  list = {planar};
  if (!has_planes(e)) list.push_back(distance);
  // The background of a depth buffer is exactly at the far end of its range.
  constexpr double kMinReversed = 0.5;  // fraction of the range: lower integers are lengths
  const bool is_wide = e.values.is_unit() || e.values.max > kMinReversed * e.values.max_integer;
  if (has_planes(e) || ((e.values.is_unit() || e.values.has_high_end) && is_wide)) {
    DepthModel unit = base;
    unit.scale = 1.0 / e.values.range_max();
    // Either makes the same surfaces flat: what is below in a picture is nearer.
    const bool is_reversed = !e.values.has_high_end && is_bright_below(e.cells);
    for (const bool reversed : {is_reversed, !is_reversed})
      if (!(reversed && e.values.has_high_end))
        add_buffer(e, reversed ? DepthMeaning::kReversed : DepthMeaning::kWindow, unit, list);
    if (has_planes(e)) std::rotate(list.begin(), list.begin() + 1, list.end());
  } else if (e.cells.have_normals) {
    list.push_back(plain(DepthMeaning::kDisparity, base));
  }
  return list;
}

/// Tries a candidate: with the known camera, else with all cameras where the samples can tell. An orthographic one
/// must fit much better than any perspective, unless the options name it; flat surfaces do not tell its height.
Trial try_candidate(const DepthEvidence& e, const Cells& cells, const DepthModel& model, bool& is_clear) {
  is_clear = false;
  if (e.camera) return try_depth(cells, model, *e.camera);
  const bool by_option = e.settings.orthographic;
  Trial best = try_depth(cells, model, assumed_camera(by_option, e.aspect));
  const auto try_projection = [&](Projection projection) {
    bool is_found = false;
    const Trial trial = try_cameras(cells, model, e.aspect, projection, is_found);
    const bool competes = is_clear || (projection == Projection::kOrthographic && !by_option);
    if (!is_found || (competes && !is_much_better(cells, trial, best))) return;
    best = trial;
    is_clear = true;
  };
  if (!by_option && (cells.have_normals || model.meaning == DepthMeaning::kDistance))
    try_projection(Projection::kPerspective);
  if (cells.have_normals && (by_option || model.meaning == DepthMeaning::kPlanar))
    try_projection(Projection::kOrthographic);
  return best;
}

/// Improves the offset of a relative depth by the normals.
void refine_offset(const DepthEvidence& e, const Cells& cells, Candidate& candidate, DepthGuess& guess) {
  constexpr double kMinOffset = 1e-3;
  for (const double factor : {1.5, 1.2, 1.1, 1.05, 1.02, 1.01, 1.005, 1.002})
    for (const double by : {factor, 1.0 / factor}) {
      const Candidate other = with_offset(candidate, std::max(candidate.offset, kMinOffset) * by, e.values);
      bool is_clear = false;
      const Trial trial = try_candidate(e, cells, other.model, is_clear);
      if (!(trial.normals.squares < guess.trial.normals.squares)) continue;
      candidate = other;
      guess.trial = trial;
      guess.fitted_fov = is_clear;
    }
}

/// Tells whether the planes of a depth buffer are assumed, and whether a length may as well be a depth buffer, or the
/// opposite. A fitted camera makes curved surfaces flat, so that distances are never clear.
void compare_with_buffers(const DepthEvidence& e, const Cells& cells, const std::vector<Candidate>& candidates,
                          std::size_t chosen, DepthGuess& guess) {
  if (cells.have_normals) return;
  const DepthMeaning meaning = candidates[chosen].model.meaning;
  const bool is_length = meaning == DepthMeaning::kPlanar || meaning == DepthMeaning::kDistance;
  for (const Candidate& candidate : candidates) {
    bool ignored = false;
    if (has_planes(e) && !is_length && candidate.model.meaning == DepthMeaning::kPlanar)
      guess.may_be_length = !is_much_better(cells, guess.trial, try_candidate(e, cells, candidate.model, ignored));
    if (candidate.is_relative || !candidate.has_free_offset) continue;
    if (!is_length)
      guess.assumes_planes = true;
    else if (e.values.has_low_end || e.values.has_high_end)
      guess.may_be_buffer = guess.may_be_buffer || meaning == DepthMeaning::kDistance ||
                            !is_much_better(cells, guess.trial, try_candidate(e, cells, candidate.model, ignored));
  }
}

std::string reason_for(const DepthEvidence& e, bool is_prior) {
  if (is_prior && e.hint != DepthHint::kNone) return "by its name";
  if (e.cells.have_normals && !e.cells.cells.empty()) return "agrees best with the normals";
  if (is_prior) return has_planes(e) ? "since planes are given" : "assumed";
  return "makes flat surfaces flat";
}

}  // namespace

bool gives_planes(const GBufferSettings& settings) {
  const GBufferSettings initial;
  return settings.near_plane != initial.near_plane || settings.far_plane != initial.far_plane;
}

Camera assumed_camera(bool is_orthographic, double aspect) {
  constexpr double kAngle_deg = 55.0;
  return is_orthographic ? symmetric_camera(1.0, aspect, Projection::kOrthographic)
                         : symmetric_camera(std::tan(kAngle_deg * std::numbers::pi / 360.0), aspect);
}

Result<DepthGuess> guess_depth(const DepthEvidence& e) {
  const bool by_option = e.settings.depth_kind != "auto";
  constexpr std::string_view kKinds[] = {"planar", "distance", "window", "reversed", "disparity", "height"};
  const auto kind = std::find(std::begin(kKinds), std::end(kKinds), e.settings.depth_kind) - std::begin(kKinds);
  DepthModel base;
  const bool is_disparity = by_option ? kKinds[kind] == "disparity" : e.hint == DepthHint::kDisparity;
  const auto is_mapped = map_of_options(e, is_disparity, base);
  if (!is_mapped) return is_mapped.error();
  std::vector<Candidate> candidates;
  if (is_disparity && !*is_mapped) {
    add_relative(e, true, e.settings.depth_invert, candidates);
  } else if (by_option) {
    if (is_window(e))
      add_buffer(e, DepthMeaning(kind), base, candidates);
    else
      candidates = {plain(DepthMeaning(kind), base)};
  } else if (*is_mapped) {
    candidates = {plain(is_disparity ? DepthMeaning::kDisparity : DepthMeaning::kPlanar, base)};
    if (!is_disparity) candidates.push_back(plain(DepthMeaning::kDistance, base));
  } else if (e.settings.depth_invert) {
    add_relative(e, false, true, candidates);
  } else {
    candidates = candidates_for(e, base);
  }
  constexpr std::size_t kTrialCells = 1000;
  const Cells cells = e.cells.balanced(kTrialCells);
  DepthGuess guess;
  std::size_t chosen = 0;
  double first_flatness = 0.0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    bool is_clear = false;
    const Trial trial = try_candidate(e, cells, candidates[k].model, is_clear);
    // Candidates that differ in their offset only compete without a bonus for the first.
    const bool same_kind =
        k > 0 && candidates[k].has_free_offset && candidates[k].meaning == candidates[chosen].meaning;
    const bool better =
        same_kind ? trial.normals.score_deg < guess.trial.normals.score_deg : is_much_better(cells, trial, guess.trial);
    if (k == 0) first_flatness = trial.flatness;
    if (k > 0 && !better) continue;
    guess.trial = trial;
    guess.fitted_fov = is_clear;
    chosen = k;
  }
  // Normals that fit nothing well are no reason to bend surfaces that are flat as lengths.
  constexpr double kDoubtful_deg = 5.0;
  if (cells.have_normals && chosen > 0 && !candidates[0].is_relative && first_flatness <= guess.trial.flatness &&
      guess.trial.normals.median_deg > kDoubtful_deg) {
    DepthEvidence without = e;
    without.cells.have_normals = false;
    return guess_depth(without);
  }
  if (candidates[chosen].has_free_offset && cells.have_normals) refine_offset(e, cells, candidates[chosen], guess);
  compare_with_buffers(e, cells, candidates, chosen, guess);
  guess.meaning = candidates[chosen].meaning;
  guess.is_relative = candidates[chosen].is_relative;
  guess.reason = by_option ? "by option" : reason_for(e, chosen == 0);
  return guess;
}

// ---- depth computed from positions

namespace {

constexpr double kNoDepth = std::numeric_limits<double>::quiet_NaN();

/// The values of the positions, by axis.
using Axes = std::array<const TapValues*, 3>;

double depth_of(const Axes& axes, const PositionConvention& position, std::size_t tap, std::size_t k) {
  const glm::dvec3 p((*axes[0])[tap][k], (*axes[1])[tap][k], (*axes[2])[tap][k]);
  if (p == glm::dvec3(0.0)) return kNoDepth;
  const double depth = glm::dot(position.forward, p - position.eye);
  return depth > 0.0 && !is_never_depth(depth) ? depth : kNoDepth;
}

/// Returns the fraction of positions that are in front of the camera.
double fraction_in_front(const Samples& samples, const PositionConvention& position) {
  const Axes axes = samples.find_three(Role::kPosition);
  std::size_t front = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) front += std::size_t(depth_of(axes, position, kCenter, k) > 0.0);
  return samples.size() == 0 ? 0.0 : double(front) / double(samples.size());
}

}  // namespace

void use_positions(const Samples& samples, const std::optional<ProjectionFit>& fit, const KnownCamera& known,
                   PositionConvention& position, DepthValues& values, DepthModel& model) {
  if (fit) {
    position = {fit->forward, fit->eye};
  } else {
    std::vector<PositionConvention> choices;
    if (known.has_view) {
      const glm::dmat4 view(known.camera.view_from_world);
      choices.push_back({-glm::dvec3(view[0][2], view[1][2], view[2][2]), glm::dvec3(known.camera.eye())});
    }
    choices.push_back({{0.0, 0.0, -1.0}, {}});
    choices.push_back({{0.0, 0.0, 1.0}, {}});
    position = *std::max_element(choices.begin(), choices.end(), [&](const auto& a, const auto& b) {
      return fraction_in_front(samples, a) < fraction_in_front(samples, b);
    });
  }
  model = DepthModel{};
  values.max_integer = 0.0;
  values.taps.assign(samples.size(), {});
  const Axes axes = samples.find_three(Role::kPosition);
  std::vector<double> depths;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (std::size_t tap = 0; tap < kTaps; ++tap) values.taps[k][tap] = depth_of(axes, position, tap, k);
    if (std::isfinite(values.taps[k][kCenter])) depths.push_back(values.taps[k][kCenter]);
  }
  values.surfaces = depths.size();
  if (depths.empty()) return;
  values.min = *std::min_element(depths.begin(), depths.end());
  values.max = *std::max_element(depths.begin(), depths.end());
}

}  // namespace umbrage
