#include "gbuffers/conventions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "core/lists.h"
#include "core/lowercase.h"
#include "gbuffers/camera_guess.h"
#include "gbuffers/deciding.h"
#include "gbuffers/depth_guess.h"
#include "gbuffers/elevation.h"
#include "gbuffers/normal_guess.h"
#include "gbuffers/packing.h"

namespace umbrage {
namespace {

Cells cells_of(const Deciding& d) {
  Cells cells;
  cells.width = d.samples.width;
  cells.height = d.samples.height;
  cells.reach = d.samples.reach;
  cells.have_normals = !d.normals.empty();
  if (d.samples.reach == 0) return cells;
  for (std::size_t k = 0; k < d.samples.size(); ++k) {
    const auto& taps = d.values.taps[k];
    const bool whole = std::all_of(taps.begin(), taps.end(), [](double v) { return std::isfinite(v); });
    if (!whole || (cells.have_normals && d.normals[k] == glm::dvec3(0.0))) continue;
    Cell cell{d.samples.x[k], d.samples.y[k], {}, {}};
    std::copy(taps.begin(), taps.end(), cell.stored);
    if (cells.have_normals) cell.normal = d.normals[k];
    cells.cells.push_back(cell);
  }
  constexpr std::size_t kTooFew = 20;  // too few to tell anything
  if (cells.cells.size() < kTooFew) cells.have_normals = false;
  return cells;
}

/// How well depth is a constant multiple of what positions say.
struct PositionMatch {
  double ratio = 1.0, spread = 1e9;  ///< depth / distance of the position, and its median relative deviation
};

PositionMatch match_position(const Deciding& d, bool along_ray) {
  const ProjectionFit& fit = *d.position;
  const auto [x, y, z] = d.samples.find_three(Role::kPosition);
  std::vector<double> ratios;
  for (std::size_t k = 0; k < d.samples.size(); ++k) {
    const glm::dvec3 p((*x)[kCenter][k], (*y)[kCenter][k], (*z)[kCenter][k]);
    const double planar = glm::dot(fit.forward, p - fit.eye);
    const double at = along_ray ? glm::length(p - fit.eye) : planar;
    const double v = d.values.taps[k][kCenter];
    if (std::isfinite(v) && std::isfinite(at) && at > 0.0) ratios.push_back(v / at);
  }
  PositionMatch match;
  if (ratios.empty()) return match;
  match.ratio = quantile(ratios, 0.5);
  for (double& r : ratios) r = std::abs(r / match.ratio - 1.0);
  match.spread = quantile(std::move(ratios), 0.5);
  return match;
}

/// Compares depth with positions; they decide between planar depth and distance. Returns whether they agree.
bool decide_by_position(Deciding& d) {
  constexpr double kAgrees = 0.01;
  if (d.position->orthographic) {
    // The place of a parallel camera along its axis is free, so that only differences of depth can be compared.
    d.guess.trial.model.meaning = DepthMeaning::kPlanar;
    return true;
  }
  const PositionMatch planar = match_position(d, false), distance = match_position(d, true);
  const bool along_ray = distance.spread < planar.spread;
  const PositionMatch& best = along_ray ? distance : planar;
  if (!(best.spread < kAgrees)) return false;
  DepthModel& model = d.guess.trial.model;
  model.meaning = along_ray ? DepthMeaning::kDistance : DepthMeaning::kPlanar;
  model.scale = std::copysign(d.settings.depth_scale.value_or(1.0f), best.ratio);
  model.offset = d.settings.depth_offset.value_or(0.0f);
  d.guess.meaning = along_ray ? "distance along the ray" : "planar";
  d.guess.reason = fmt::format("agrees with positions within {:.2g} %", 100.0 * best.spread);
  d.guess.is_relative = false;
  return true;
}

/// An elevation model: an orthographic camera above it.
void decide_height(Deciding& d) {
  const LayeredFile& header = d.header_of(Role::kDepth);
  double cell_x = 1.0, cell_y = 1.0;
  std::string source;
  if (header.geo && header.geo->has_cell) {
    cell_x = header.geo->cell_width;
    cell_y = header.geo->cell_height;
    source = fmt::format("{} x {} m, by the file", number_text(cell_x), number_text(cell_y));
  }
  if (d.settings.cell_size) {
    cell_x = cell_y = *d.settings.cell_size;
    source = fmt::format("{}, by option", number_text(cell_x));
  }
  DepthModel& model = d.guess.trial.model;
  if (source.empty()) {
    cell_x = cell_y = std::abs(model.scale) * assumed_cell_size(d.values, d.samples.reach);
    source = fmt::format("{}, assumed", number_text(cell_x));
    d.warn(
        fmt::format("the elevation {} has no cell size: {} is assumed, in units of elevation, which gives it the "
                    "slopes of hills; `cell_size` sets another",
                    d.roles[Role::kDepth].name, number_text(cell_x)));
  }
  model.orthographic = true;
  const double low = model.offset + model.scale * d.values.min, high = model.offset + model.scale * d.values.max;
  // The camera is above all cells, also above those that the sample missed.
  const double relief = std::max(std::abs(high - low), std::max(cell_x, cell_y));
  model.eye_height = d.first ? d.first->depth.model.eye_height : std::max(low, high) + relief;
  Camera& camera = d.out.camera;
  camera.projection = Projection::kOrthographic;
  camera.right = float(cell_x * d.out.width / 2.0);
  camera.left = -camera.right;
  camera.top = float(cell_y * d.out.height / 2.0);
  camera.bottom = -camera.top;
  d.fact(fmt::format("camera: orthographic, from above, cell size {}", source));
}

void decide_camera(Deciding& d, const KnownCamera& known) {
  Camera& camera = d.out.camera;
  const glm::mat4 view = known.camera.view_from_world;
  std::string source = known.source;
  camera = known.camera;
  if (source.empty()) {
    const bool is_orthographic = d.settings.orthographic;
    camera = d.guess.fitted_fov ? d.guess.trial.camera : assumed_camera(is_orthographic, known.aspect);
    source = d.guess.fitted_fov ? "fitted to depth and normals"
             : is_orthographic  ? "assumed; `window` sets another"
                                : "assumed; `fov_deg` sets another";
    if (d.guess.fitted_fov && d.normals.empty()) source = "fitted so that flat surfaces are flat";
    if (d.first) camera = d.first->camera, source = "as in the first frame";
    for (const LayeredFile& header : d.headers)
      for (const auto& [name, text] : header.attributes)
        if (const std::string key = lowercase(name);
            header.format == "NPZ" && (key.find("fov") != key.npos || key.find("focal") != key.npos))
          d.warn(
              fmt::format("{} {} is not used: vertical degrees are `fov_deg`, pixels `focal_length_px`", name, text));
    camera.view_from_world = view;
  }
  if (camera.projection == Projection::kOrthographic)
    d.fact(fmt::format("camera: orthographic, {} high, {}", number_text(double(camera.top) - camera.bottom), source));
  else
    d.fact(fmt::format("camera: {:.4g} deg high, {}", angle_of(camera), source));
}

/// Returns how much stored normals differ between neighbours without a trend, degrees; the median: noise, but not that
/// of normals that are smooth over facets.
double roughness_deg(const Deciding& d) {
  std::vector<double> angles;
  for (std::size_t k = 2; k < d.normals.size(); ++k) {
    const glm::dvec3 *n = &d.normals[k - 2], zero(0.0);
    if (d.samples.y[k] != d.samples.y[k - 2] || n[0] == zero || n[1] == zero || n[2] == zero) continue;
    angles.push_back(glm::length(n[0] - 2.0 * n[1] + n[2]) / std::sqrt(6.0) * 180.0 / std::numbers::pi);
  }
  return quantile(std::move(angles), 0.5);
}

/// Decides the rotation of normals by comparing them with normals rebuilt from depth.
void decide_normals(Deciding& d, const KnownCamera& known) {
  if (!d.has(Role::kNormal)) return;
  std::vector<KnownRotation> rotations;
  if (d.position) rotations.push_back({view_rotation(*d.position), is_camera_space(*d.position), "as positions"});
  if (known.has_view)
    rotations.push_back({glm::dmat3(glm::mat3(d.out.camera.view_from_world)), false, "by the camera of the file"});
  constexpr std::size_t kRotationCells = 6000;
  RebuiltNormals rebuilt;
  if (d.values.surfaces > 0)
    rebuilt = rebuild_normals(cells_of(d).balanced(kRotationCells), d.guess.trial.model, d.out.camera);
  const bool is_own =
      d.is_own(Role::kNormal, "normal") && d.settings.normal_space == "auto" && d.settings.view_from_normal.empty();
  if (is_own) d.settings.view_from_normal = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  // Stored normals are rounded, and a camera that is assumed tilts surfaces.
  constexpr double kRounding_deg = 0.02, kOneStep_deg = 60.0, kAssumedCamera_deg = 5.0;
  double slack_deg = kRounding_deg;
  if (const double max = d.channel_of(Role::kNormal).max_integer; max > 0.0) slack_deg += kOneStep_deg / max;
  if (known.source.empty() && d.out.camera.top == assumed_camera(d.settings.orthographic, known.aspect).top)
    slack_deg = kAssumedCamera_deg;
  NormalChoice choice = choose_rotation(d.settings, rebuilt, rotations, slack_deg);
  if (is_own) choice.meaning = "camera space, as Umbrage writes them";
  d.out.normal.view_from_stored = choice.view_from_stored;
  const char* third = d.out.normal.lacks_z ? ", z from x and y since the third channel is constant" : "";
  d.fact(fmt::format("normal: {}, {}{}, {}", d.roles[Role::kNormal].name,
                     d.out.normal.offset != 0.0 ? "0..1 encoded" : "signed", third, choice.meaning));
  if (is_own || !choice.median_deg) return;
  const double misfit_deg =
      std::max(rebuilt.bias_deg(choice.view_from_stored), std::min(*choice.median_deg, roughness_deg(d)));
  constexpr double kMismatch_deg = 7.0;  // a shift by a few pixels is less than a wrong rotation
  d.fact(
      fmt::format("check: normals against normals rebuilt from depth: median {:.2g} deg, without facets {:.2g} deg; "
                  "up to {} deg fit",
                  *choice.median_deg, misfit_deg, kMismatch_deg));
  const bool fits = misfit_deg <= kMismatch_deg;
  if (!fits && d.roles.normal_is_guess) {
    d.out.is_unusable[std::size_t(Role::kNormal)] = true;
    d.fact(fmt::format("normal: {} are no normals, and are not used", d.roles[Role::kNormal].name));
  } else if (!fits)
    d.warn(fmt::format(
        "normals and depth do not fit, by {:.0f} deg in the median{}: `depth_kind`, `fov_deg`, `orthographic`, "
        "`flip`, `normal_space` or `normal_encoding` may be needed, or one is shifted or of another picture",
        misfit_deg, third));
  else if (choice.is_open)
    d.warn(
        fmt::format("the normals {} have one direction, which fits many axes: {} is taken; `normal_space` or "
                    "`view_from_normal` sets another",
                    d.roles[Role::kNormal].name, choice.meaning));
  // A rotation that was found tells where up is in the world.
  if (choice.is_world && !known.has_view && !d.guess.trial.model.orthographic)
    d.out.camera.view_from_world = glm::mat4(
        glm::dmat4(glm::determinant(choice.view_from_stored) < 0.0
                       ? glm::dmat3(choice.view_from_stored[0], choice.view_from_stored[1], -choice.view_from_stored[2])
                       : choice.view_from_stored));
}

void decide_colors(Deciding& d) {
  for (const Role role : {Role::kAlbedo, Role::kBeauty, Role::kAlpha, Role::kIndirect, Role::kIndirectColor,
                          Role::kEmission, Role::kOwn}) {
    if (!d.has(role)) continue;
    const Channel& channel = d.channel_of(role);
    const bool is_float = channel.max_integer == 0.0;
    if (is_float && (role == Role::kAlbedo || role == Role::kBeauty))
      if (auto warning = color_warning(d.samples, role, d.roles[role].name); !warning.empty())
        d.warn(std::move(warning));
    d.out.color[std::size_t(role)] = {channel.max_integer, channel.is_srgb && role != Role::kAlpha};
  }
  const auto line = [&](std::string_view what, Role role) {
    if (d.has(role))
      d.fact(fmt::format("{}: {}{}", what, d.roles[role].name, d.out.color[std::size_t(role)].is_srgb ? ", sRGB" : ""));
  };
  line("albedo", Role::kAlbedo);
  line("beauty", Role::kBeauty);
  if (d.has(Role::kBeauty)) d.out.is_premultiplied = d.header_of(Role::kBeauty).format == "EXR";
  if (d.has(Role::kIndirect))
    d.fact(fmt::format("ambient light: {}{}", d.roles[Role::kIndirect].name,
                       d.has(Role::kIndirectColor) ? " times " + d.roles[Role::kIndirectColor].name : ""));
  line("emission", Role::kEmission);
  line("background where it is 0", Role::kMask);
  line("object ids", Role::kObjectId);
  line("material ids", Role::kMaterialId);
}

/// Fraction of the pixels at an end of brightness above which that is the sky.
constexpr double kSky = 0.01;

bool is_elevation(const Deciding& d) {
  return d.settings.depth_kind == "height" ||
         (d.settings.depth_kind == "auto" && d.roles.depth_hint == DepthHint::kHeight);
}

/// Collects the stored depths, and adds their background to `depth`. `faces`: see depth_values.
DepthValues collect_depths(const Deciding& d, bool is_height, const std::vector<char>& faces, DepthConvention& depth) {
  const Packing* packing = find_packing(d.settings.depth_packing);
  const double max_integer = packing ? packing->max_integer : d.channel_of(Role::kDepth).max_integer;
  const std::string& kind = d.settings.depth_kind;
  const DepthHint hint = d.roles.depth_hint;
  MayBe may;
  may.be_bytes = kind == "auto" && gives_planes(d.settings);
  may.be_low = is_height || (max_integer == 255.0 && !may.be_bytes) || hint == DepthHint::kDisparity ||
               hint == DepthHint::kGrey || kind == "disparity" || kind == "window";
  may.be_buffer = kind == "window" || (kind == "auto" && !is_height && hint == DepthHint::kNone);
  return depth_values(d.samples, max_integer, may, faces, depth);
}

/// Whether depth is elevation, and why.
struct Elevation {
  bool is_height = false;
  std::string reason;  ///< as guess_depth gives it if empty
};

/// Recognises elevation, whose markers of cells without data are added to the background.
Elevation decide_elevation(Deciding& d, const KnownCamera& known) {
  const LayeredFile& header = d.header_of(Role::kDepth);
  const std::string& kind = d.settings.depth_kind;
  Elevation out{is_elevation(d), ""};
  const ElevationSigns signs = elevation_signs(d.samples);
  // Nothing but values tells of a nameless layer; a camera, normals or a range belong to depth.
  const bool is_nameless = kind == "auto" && d.roles.depth_is_guess && d.roles.depth_hint == DepthHint::kNone;
  const bool has_other = d.has(Role::kNormal) || d.has(Role::kPosition) || !known.source.empty() ||
                         d.settings.orthographic || !d.settings.depth_range.empty() || d.settings.depth_invert;
  if (is_nameless && !has_other && signs.any()) out = {true, signs.reason()};
  if (!out.is_height) return out;
  if (header.geo && kind == "auto") out.reason = "by the format of the file";
  if (d.settings.depth_packing != "none" && kind == "auto") out.reason = "by its packing";
  if (header.geo && header.geo->no_data) d.out.depth.background.push_back(double(float(*header.geo->no_data)));
  for (const double marker : signs.no_data)
    if (std::count(d.out.depth.background.begin(), d.out.depth.background.end(), marker) == 0)
      d.out.depth.background.push_back(marker);
  return out;
}

Error panorama_error(const LayeredFile& header) {
  return file_error("'{}' is a panorama: only pictures of perspective and orthographic cameras are read",
                    header.path.string());
}

/// Decides what depth means, or that it comes from positions.
Result<void> decide_depth(Deciding& d, const KnownCamera& known) {
  std::vector<char> faces;
  for (const glm::dvec3& n : d.normals) faces.push_back(n != glm::dvec3(0.0));
  d.out.depth.is_own = d.is_own(Role::kDepth, "depth") && d.settings.depth_kind == "auto";
  if (d.out.depth.is_own) d.settings.depth_kind = "planar";
  const auto [is_height, reason] = decide_elevation(d, known);
  d.values = collect_depths(d, is_height, faces, d.out.depth);
  const DepthHint hint = is_height ? DepthHint::kHeight : d.roles.depth_hint;
  DepthEvidence evidence{d.settings, d.values, hint, cells_of(d), {}, known.aspect};
  if (known.has_window()) evidence.camera = known.camera;
  constexpr std::size_t kPanoramaCells = 1000;
  // One or two planes fit any meaning of depth with some rotation.
  constexpr int kMinDirections = 3;
  if (evidence.cells.directions() < kMinDirections) evidence.cells.have_normals = false;
  auto guess = guess_depth(evidence);
  if (!guess) return guess.error();
  d.guess = std::move(*guess);
  if (d.first) {
    d.out.depth.from_position = d.first->depth.from_position;
    d.out.depth.background = d.first->depth.background;
    d.guess.trial.model = d.first->depth.model;
    d.guess.is_relative = d.guess.assumes_planes = d.guess.may_be_buffer = d.guess.may_be_length = false;
    if (!d.out.depth.from_position) report_depth(d);
    return {};
  }
  if (known.source.empty() && !is_height && is_panorama(evidence.cells.balanced(kPanoramaCells), d.guess.trial))
    return panorama_error(d.header_of(Role::kDepth));
  if (d.out.depth.is_own) d.guess.reason = "as Umbrage writes it";
  if (is_height) d.guess.trial.model.meaning = DepthMeaning::kHeight;
  if (!reason.empty()) d.guess.reason = reason;
  // No depth buffer has pixels exactly at the near plane.
  if (d.guess.trial.model.meaning == DepthMeaning::kWindow && d.settings.depth_kind == "auto" && d.values.has_low_end)
    d.out.depth.background.push_back(0.0);
  // Many pixels at the far end of brightness are the sky.
  if (d.guess.is_relative && d.values.max_integer > 0.0) {
    const DepthModel& model = d.guess.trial.model;
    const bool low_is_far = view_depth(model, 0.0, 1.0) > view_depth(model, d.values.max_integer, 1.0);
    if ((low_is_far ? d.values.at_low : d.values.at_high) > kSky)
      d.out.depth.background.push_back(low_is_far ? 0.0 : d.values.max_integer);
  }
  const bool compares = d.position && d.settings.depth_kind == "auto" && !is_height && d.values.surfaces > 0 &&
                        d.settings.depth_range.empty() && !d.settings.depth_invert;
  if (compares && !decide_by_position(d)) {
    d.out.depth.from_position = true;
    d.fact(fmt::format("depth: from {}, since {} does not agree with it", d.roles[Role::kPosition].name,
                       d.roles[Role::kDepth].name));
    return {};
  }
  report_depth(d);
  if (!is_height) warn_of_flip(d);
  return {};
}

/// Returns of each sample whether depth or position shows a surface beyond doubt.
std::vector<char> surfaces_of(const Deciding& d) {
  std::vector<char> surfaces(d.samples.size(), 1);
  if (d.has(Role::kDepth)) {
    DepthConvention depth = d.out.depth;
    const DepthValues values = collect_depths(d, is_elevation(d), {}, depth);
    const auto is_end = [&](double v) {  // many pixels at an end of brightness may be the sky
      return values.max_integer > 0.0 &&
             ((v == 0.0 && values.at_low > kSky) || (v == values.max_integer && values.at_high > kSky));
    };
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      const double v = values.taps[k][kCenter];
      surfaces[k] = std::isfinite(v) && !is_end(v);
    }
    return surfaces;
  }
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = (*d.samples.find(Role::kPosition, std::size_t(axis)))[kCenter][k];
    surfaces[k] = p != glm::dvec3(0.0) && std::isfinite(glm::length(p));
  }
  return surfaces;
}

/// Decodes the normals. If their lengths leave the encoding open, agreement with depth decides.
Result<void> decide_encoding(Deciding& d, const KnownCamera& known) {
  const double max_integer = d.channel_of(Role::kNormal).max_integer;
  const std::vector<char> surfaces = surfaces_of(d);
  EncodingGuess guess = guess_encoding(d.samples, surfaces, d.settings, max_integer);
  if (!guess.is_clear && d.has(Role::kDepth)) {
    DirectionFit fits[2];  // signed, unsigned
    for (const bool tried : {false, true}) {
      GBufferFacts unused;
      Deciding trial{d.settings, d.headers, d.roles, d.samples, unused, d.out, {}, d.position, {}, {}};
      trial.normals = decode_normals(d.samples, surfaces, max_integer, {tried}, trial.out.normal);
      if (auto decided = decide_depth(trial, known); !decided) return decided;
      fits[tried] = trial.guess.trial.normals;
    }
    if (std::max(fits[0].score_deg, fits[1].score_deg) < DirectionFit().score_deg)
      guess.is_unsigned = fits[1].score_deg < fits[0].score_deg;
  }
  if (guess.lacks_z) d.settings.normal_space = "camera";
  d.normals = decode_normals(d.samples, surfaces, max_integer, guess, d.out.normal);
  return {};
}

/// Warns of a layer that has no number at many surface pixels, and gives it up if it has none at most of them.
void warn_of_nan(Deciding& d, Role role) {
  constexpr double kMany = 0.01, kMost = 0.5;  // fractions of the surface pixels
  std::size_t all = 0, missing = 0;
  for (std::size_t k = 0; k < d.samples.size(); ++k) {
    if (!std::isfinite(d.values.taps[k][kCenter])) continue;
    bool is_number = true;
    for (std::size_t c = 0; c < 3; ++c)
      if (const auto* channel = d.samples.find(role, c)) is_number = is_number && std::isfinite((*channel)[kCenter][k]);
    ++all, missing += std::size_t(!is_number);
  }
  const double fraction = all > 0 ? double(missing) / double(all) : 0.0;
  if (!(fraction > kMany)) return;
  d.out.is_unusable[std::size_t(role)] = fraction > kMost;
  d.warn(fmt::format("the layer {} is NaN or infinite at {:.2g} % of the surface pixels, {}", d.roles[role].name,
                     100.0 * fraction, fraction > kMost ? "and is not used" : "which get values from beside them"));
}

}  // namespace

std::string color_warning(const Samples& samples, Role role, std::string_view name) {
  constexpr double kMostly = 0.99, kRounded = 1.001;  // a quantile, since few bright pixels hardly show
  std::vector<float> values;
  for (const TapValues* channel : samples.find_three(role))
    for (std::size_t k = 0; channel && k < samples.size(); ++k)
      if (const float v = (*channel)[kCenter][k]; std::isfinite(v)) values.push_back(v);
  const float bright = quantile(values, kMostly);
  const bool is_light = role == Role::kBeauty;  // may be bright, but is hardly integers
  if (!(bright > kRounded) ||
      (is_light && std::any_of(values.begin(), values.end(), [](float v) { return v != std::floor(v); })))
    return "";
  return fmt::format(
      "{} has values up to {:.3g}, and takes linear ones{}: (x / 255) ** 2.2 converts colours from 0 to 255", name,
      bright, is_light ? "" : " from 0 to 1");
}

std::string number_text(double value) { return fmt::format("{:.6g}", value); }

Result<Conventions> decide_conventions(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                       const Roles& roles, const Samples& samples, GBufferFacts& facts,
                                       const Conventions* first) {
  Deciding d{settings, headers, roles, samples, facts, {}, {}, {}, {}, {}, first};
  for (const LayeredFile& header : headers)
    if (header.attribute("envmap")) return panorama_error(header);
  d.out.width = samples.width;
  d.out.height = samples.height;
  if (roles.views.size() > 1) d.fact(fmt::format("view: {} (of {})", roles.view, fmt::join(roles.views, ", ")));
  const bool has_depth = d.has(Role::kDepth);
  if (settings.depth_background) d.out.depth.background.push_back(*settings.depth_background);
  constexpr double kPredicted_px = 4.0;  // of positions that a network predicts
  d.position = position_camera(samples, kPredicted_px);
  const auto known = known_camera(settings, headers, d.position, d.out.width, d.out.height);
  if (!known) return known.error();
  d.out.has_place = known->has_view;
  if (!settings.focal_length_px.empty()) d.warn(center_warning(known->camera, d.out.width, d.out.height));
  if (d.has(Role::kNormal))
    if (auto decided = decide_encoding(d, *known); !decided) return decided.error();
  if (has_depth) {
    if (auto decided = decide_depth(d, *known); !decided) return decided.error();
  } else {
    d.out.depth.from_position = true;
    d.fact(fmt::format("depth: from positions {}", roles[Role::kPosition].name));
  }
  if (d.out.depth.from_position) {
    use_positions(d.samples, d.position, *known, d.out.position, d.values, d.guess.trial.model);
    d.guess.trial.model.orthographic = known->camera.projection == Projection::kOrthographic;
  }
  if (d.guess.trial.model.meaning == DepthMeaning::kHeight)
    decide_height(d);
  else
    decide_camera(d, *known);
  d.guess.trial.model.orthographic = d.out.camera.projection == Projection::kOrthographic;
  decide_normals(d, *known);
  const DepthModel& model = d.out.depth.model = d.guess.trial.model;
  if (d.values.max_integer > 0.0 && !d.out.depth.from_position && model.meaning == DepthMeaning::kPlanar)
    d.out.depth.unit = std::abs(model.scale);
  if (d.has(Role::kPosition) && !d.position)
    d.warn(fmt::format(
        "the positions {} are not those of a camera's picture, and {}", roles[Role::kPosition].name,
        d.out.depth.from_position ? "depth is their distance along z: `fov_deg` sets the camera" : "are not used"));
  decide_colors(d);
  decide_motion(d);
  for (const Role role : {Role::kNormal, Role::kAlbedo, Role::kBeauty})
    if (d.has(role)) warn_of_nan(d, role);
  return d.out;
}

}  // namespace umbrage
