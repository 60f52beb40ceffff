#include "gbuffers/normal_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/lists.h"

namespace umbrage {
namespace {

/// Returns "x right, y up, z to the camera" for a matrix of axis directions.
std::string axes_text(const glm::dmat3& view_from_stored) {
  constexpr std::string_view kDirections[3][2] = {{"left", "right"}, {"down", "up"}, {"away", "to the camera"}};
  std::string text;
  for (int stored = 0; stored < 3; ++stored)
    for (int axis = 0; axis < 3; ++axis)
      if (const double v = view_from_stored[stored][axis]; v != 0.0)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", "xyz"[stored], kDirections[axis][v > 0.0]);
  return text;
}

/// Returns the 48 matrices that exchange and mirror axes, the usual ones first: x is right, and y up or down, and z to
/// the camera (OpenGL) or away (OpenCV, Direct3D).
std::vector<glm::dmat3> axis_matrices() {
  std::vector<glm::dmat3> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 m(0.0);
      for (int axis = 0; axis < 3; ++axis) m[axis][order[std::size_t(axis)]] = (signs >> axis) & 1 ? -1.0 : 1.0;
      all.push_back(m);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  std::stable_partition(all.begin(), all.end(), [](const glm::dmat3& m) { return m[0][0] == 1.0; });
  return all;
}

NormalChoice choice_of(const RebuiltNormals& rebuilt, const DirectionFit& fit, bool is_world, std::string meaning) {
  NormalChoice choice{fit.matrix, is_world, std::move(meaning), 0.0, {}};
  if (rebuilt.pairs.size() == 0) return choice;
  choice.score_deg = fit.score_deg;
  choice.median_deg = fit.median_deg;
  return choice;
}

NormalChoice rated(const RebuiltNormals& rebuilt, const glm::dmat3& matrix, bool is_world, std::string meaning) {
  return choice_of(rebuilt, rate_directions(rebuilt.pairs, matrix), is_world, std::move(meaning));
}

/// Returns the choice of axis directions: camera space if the third axis is along the view, else a world whose axes are
/// those of the camera.
NormalChoice axis_choice(const RebuiltNormals& rebuilt, const glm::dmat3& matrix) {
  const bool is_world = matrix[2][2] == 0.0;
  return rated(rebuilt, matrix, is_world, (is_world ? "world space, " : "camera space, ") + axes_text(matrix));
}

/// The stored normals of the samples.
class StoredNormals {
 public:
  StoredNormals(const Samples& samples, double max_integer) : unit_(max_integer > 0.0 ? 1.0 / max_integer : 1.0) {
    for (std::size_t c = 0; c < 3; ++c) stored_[c] = &(*samples.find(Role::kNormal, c))[kCenter];
  }
  NormalConvention convention(bool is_unsigned) const {
    return is_unsigned ? NormalConvention{2.0 * unit_, -1.0, glm::dmat3(1.0)}
                       : NormalConvention{unit_, 0.0, glm::dmat3(1.0)};
  }
  glm::dvec3 decoded(const NormalConvention& c, std::size_t k) const {
    return c.decoded({at(0, k), at(1, k), at(2, k)});
  }
  bool is_empty(std::size_t k) const { return at(0, k) == 0.0 && at(1, k) == 0.0 && at(2, k) == 0.0; }
  /// Returns the finite ones of value(k) for the normals of surfaces.
  template <class Value>
  std::vector<double> values(const std::vector<char>& has_surface, const Value& value) const {
    std::vector<double> all;
    for (std::size_t k = 0; k < has_surface.size(); ++k)
      if (has_surface[k] && !is_empty(k)) all.push_back(value(k));
    std::erase_if(all, [](double v) { return !std::isfinite(v); });
    return all;
  }
  double at(std::size_t c, std::size_t k) const { return double((*stored_[c])[k]); }

 private:
  double unit_;
  std::array<const std::vector<float>*, 3> stored_{};
};

}  // namespace

EncodingGuess guess_encoding(const Samples& samples, const std::vector<char>& has_surface,
                             const GBufferSettings& settings, double max_integer) {
  const StoredNormals stored(samples, max_integer);
  // Averaging shortens normals at edges, so that the median is compared.
  const auto deviation = [&](bool is_unsigned, double fraction) {
    const NormalConvention c = stored.convention(is_unsigned);
    const auto off = [&](std::size_t k) { return std::abs(glm::length(stored.decoded(c, k)) - 1.0); };
    return quantile(stored.values(has_surface, off), fraction);
  };
  const auto channel = [&](std::size_t c, double fraction) {
    return quantile(stored.values(has_surface, [&](std::size_t k) { return stored.at(c, k); }), fraction);
  };
  const bool is_given = settings.normal_encoding != "auto", given = settings.normal_encoding == "unsigned";
  constexpr double kFew = 0.02, kMost = 1.0 - kFew, kEdges = 0.05, kOff = 0.1;  // of the surfaces; of lengths
  const double x = channel(0, kFew), y = channel(1, kFew);
  if (channel(2, kFew) == channel(2, kMost) && x < channel(0, kMost) && y < channel(1, kMost) &&
      std::min(deviation(true, 1.0 - kEdges), deviation(false, 1.0 - kEdges)) > kOff)
    return {is_given ? given : std::min(x, y) >= 0.0, true, true};
  if (is_given) return {given, true};
  const double as_unsigned = deviation(true, 0.5), as_signed = deviation(false, 0.5);
  const double better = std::min(as_unsigned, as_signed), worse = std::max(as_unsigned, as_signed);
  constexpr double kUnit = 0.05, kFactor = 0.25;  // of lengths that are 1, and that are nearer to 1 than others
  return {as_unsigned < as_signed, better < kUnit && better < kFactor * worse};
}

std::vector<glm::dvec3> decode_normals(const Samples& samples, const std::vector<char>& has_surface, double max_integer,
                                       const EncodingGuess& guess, NormalConvention& convention) {
  const StoredNormals stored(samples, max_integer);
  convention = stored.convention(guess.is_unsigned);
  convention.lacks_z = guess.lacks_z;
  const double usual = quantile(
      stored.values(has_surface, [&](std::size_t k) { return glm::length(stored.decoded(convention, k)); }), 0.5);
  std::vector<glm::dvec3> normals(samples.size(), glm::dvec3(0.0));
  // Of the usual length. Shorter: nothing, or an average of opposite directions; longer: a background, such as white.
  constexpr double kMinLength = 0.3, kMaxLength = 1.5;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (stored.is_empty(k)) continue;
    const glm::dvec3 n = stored.decoded(convention, k);
    const double length = glm::length(n);
    if (length > kMinLength * usual && length < kMaxLength * usual) normals[k] = n / length;
  }
  return normals;
}

NormalChoice choose_rotation(const GBufferSettings& settings, const RebuiltNormals& rebuilt,
                             const std::vector<KnownRotation>& known, double slack_deg) {
  if (const auto& given = settings.view_from_normal; !given.empty()) {
    glm::dmat3 matrix;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) matrix[column][row] = given[std::size_t(3 * row + column)];
    return rated(rebuilt, matrix, false, "rotated by option");
  }
  const bool may_camera = settings.normal_space != "world", may_world = settings.normal_space != "camera";
  std::vector<NormalChoice> choices;
  for (const KnownRotation& rotation : known)
    if (may_world && !rotation.is_camera_space && (!may_camera || !rebuilt.pairs.from.empty()))
      choices.push_back(rated(rebuilt, rotation.view_from_stored, true, "world space, " + rotation.source));
  const auto known_count = std::ptrdiff_t(choices.size());
  if (may_camera)
    for (const glm::dmat3& matrix : axis_matrices()) choices.push_back(axis_choice(rebuilt, matrix));
  if (may_world)
    choices.push_back(
        choice_of(rebuilt, fit_directions(rebuilt.pairs, true), true, "world space, rotation fitted to depth"));
  double best = 180.0;
  for (const NormalChoice& choice : choices) best = std::min(best, choice.score_deg);
  // Fitted rotations have more freedom than others, so that they must be better. One direction they always fit.
  constexpr double kSlack = 0.15, kOneDirection_deg = 10.0;
  const bool is_open = rebuilt.have_one_direction();
  if (is_open) slack_deg = std::max(slack_deg, kOneDirection_deg);
  const auto found = std::find_if(choices.begin(), choices.end(), [&](const NormalChoice& choice) {
    return choice.score_deg <= best * (1.0 + kSlack) + slack_deg;
  });
  NormalChoice chosen = found == choices.end() ? choices.front() : *found;
  chosen.is_open = is_open && settings.normal_space == "auto" && found >= choices.begin() + known_count;
  return chosen;
}

NormalCheck check_normals(const Samples& samples, const Camera& camera, const GBufferSettings& settings) {
  constexpr double kMaxSigned = 2.0, kMaxByte = 255.0, kMaxShort = 65535.0;
  constexpr std::size_t kCells = 2000, kTooFew = 20;
  constexpr int kMinDirections = 3, kMinSide = 100;  // fewer fit several rotations; fewer pixels show no normals
  constexpr double kBetter = 0.5, kClearMismatch_deg = 30.0, kRounding_deg = 0.02;
  const TapValues& depth = *samples.find(Role::kDepth, 0);
  std::vector<char> surfaces;
  for (const float v : depth[kCenter]) surfaces.push_back(std::isfinite(v));
  double max = 0.0;
  for (const TapValues* channel : samples.find_three(Role::kNormal))
    for (const float v : (*channel)[kCenter]) max = std::max(max, double(v));
  const double one = max <= kMaxSigned ? 1.0 : max <= kMaxByte ? kMaxByte : kMaxShort;
  const EncodingGuess guess = guess_encoding(samples, surfaces, settings, one);
  NormalCheck check;
  if (guess.is_unsigned && guess.is_clear && !guess.lacks_z) check.unsigned_max = one;
  NormalConvention unused;
  const auto normals = decode_normals(samples, surfaces, one, {check.unsigned_max.has_value()}, unused);
  Cells cells{samples.width, samples.height, samples.reach, {}, true};
  for (std::size_t k = 0; k < normals.size(); ++k) {
    Cell cell{samples.x[k], samples.y[k], {}, normals[k]};
    bool is_whole = normals[k] != glm::dvec3(0.0) && samples.reach > 0;
    for (std::size_t tap = 0; tap < kTaps; ++tap) {
      cell.stored[tap] = double(depth[tap][k]);
      is_whole = is_whole && std::isfinite(cell.stored[tap]);
    }
    if (is_whole) cells.cells.push_back(cell);
  }
  DepthModel model;
  model.orthographic = camera.projection == Projection::kOrthographic;
  const RebuiltNormals rebuilt = rebuild_normals(cells.balanced(kCells), model, camera);
  if (rebuilt.pairs.size() < kTooFew) return check;
  GBufferSettings trial = settings;
  if (trial.view_from_normal.empty()) trial.view_from_normal = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double median_deg = *choose_rotation(trial, rebuilt, {}, kRounding_deg).median_deg;
  if (median_deg <= kNormalMismatch_deg) return check;
  trial.view_from_normal.clear();
  const NormalChoice found = choose_rotation(trial, rebuilt, {}, kRounding_deg);
  // Coarse depth, too, is far from normals, but no rotation fits it.
  const bool fits = *found.median_deg < std::min(kNormalMismatch_deg, kBetter * median_deg);
  if (!fits && (median_deg < kClearMismatch_deg || std::min(samples.width, samples.height) < kMinSide)) return check;
  check.mismatch = fmt::format("normals and depth do not fit, by {:.0f} deg in the median: ", median_deg);
  Cells seen{.cells = {}, .have_normals = true};
  for (const glm::dvec3& normal : rebuilt.pairs.to) seen.cells.push_back({.normal = normal});
  if (!fits || seen.directions() < kMinDirections) {
    check.mismatch += "`depth_kind`, the angle of view, `view_from_normal` or `normal_encoding` may be wrong";
    return check;
  }
  check.mismatch += fmt::format("these normals are in {}, which `view_from_normal` ", found.meaning);
  for (int k = 0; k < 9; ++k)
    check.mismatch += fmt::format("{}{:.4g}", k > 0 ? "," : "", found.view_from_stored[k % 3][k / 3] + 0.0);
  check.mismatch += " converts";
  return check;
}

}  // namespace umbrage
