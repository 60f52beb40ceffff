#include "gbuffers/camera_guess.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "core/lists.h"
#include "core/numbers.h"
#include "gbuffers/depth_trial.h"

namespace umbrage {
namespace {

/// Sets the window of a pinhole with these focal lengths and this centre, in pixels from the upper left corner.
void set_window(Camera& camera, glm::dvec2 focal, glm::dvec2 center, int width, int height) {
  camera.left = float(-center.x / focal.x);
  camera.right = float((width - center.x) / focal.x);
  camera.top = float(center.y / focal.y);
  camera.bottom = float((center.y - height) / focal.y);
}

/// Returns the pixel width over the pixel height of the first file that states one.
double pixel_aspect(std::span<const LayeredFile> headers) {
  for (const LayeredFile& header : headers)
    if (header.pixel_aspect != 1.0 && header.pixel_aspect > 0.0 && std::isfinite(header.pixel_aspect))
      return header.pixel_aspect;
  return 1.0;
}

/// Returns the camera that options describe; `source` is empty if they do not. Errors: kUsage.
Result<KnownCamera> camera_of_options(const GBufferSettings& s, double aspect, int width, int height) {
  KnownCamera known;
  const int given = int(!s.window.empty()) + int(s.fov_deg.has_value()) + int(!s.focal_length_px.empty()) +
                    int(s.focal_length_mm.has_value());
  const auto excluded = [](Error error) {
    for (const char* field : {"fov_deg", "focal_length_px", "focal_length_mm", "window", "orthographic"})
      error = with_field(std::move(error), field);
    return error;
  };
  if (given > 1)
    return excluded(
        usage_error("`window`, `fov_deg`, `focal_length_px` and `focal_length_mm` exclude each other: give one"));
  if (s.orthographic) {
    if (given > int(!s.window.empty()))
      return excluded(usage_error("an orthographic camera has no angle of view or focal length: give its `window`"));
    known.camera.projection = Projection::kOrthographic;
  }
  if (!s.window.empty()) {
    known.camera.left = s.window[0];
    known.camera.right = s.window[1];
    known.camera.bottom = s.window[2];
    known.camera.top = s.window[3];
    if (!(known.camera.right > known.camera.left && known.camera.top > known.camera.bottom))
      return field_error("window", fmt::format("{}", fmt::join(s.window, ",")),
                         "`{}` {} is not valid: right must be above left, and top above bottom");
    known.source = s.orthographic ? "orthographic, by option" : "by option";
  }
  if (s.fov_deg) {
    known.camera = symmetric_camera(std::tan(double(*s.fov_deg) * std::numbers::pi / 360.0), aspect);
    known.source = "by option";
  }
  if (s.focal_length_mm) {
    const double half_width = double(s.sensor_width_mm) / (2.0 * double(*s.focal_length_mm));
    known.camera = symmetric_camera(half_width / aspect, aspect);
    known.source = fmt::format("{:g} mm on {:g} mm, by option", *s.focal_length_mm, s.sensor_width_mm);
  }
  if (!s.focal_length_px.empty()) {
    const auto& f = s.focal_length_px;
    // Centres are given, as by cameras' calibrations, with (0, 0) at the centre of the first pixel.
    const glm::dvec2 focal(f[0], f.size() == 4 ? f[1] : f[0]);
    const glm::dvec2 center = f.size() == 4 ? glm::dvec2(f[2] + 0.5, f[3] + 0.5) : glm::dvec2(width, height) / 2.0;
    if (!(focal.x > 0.0 && focal.y > 0.0)) return field_error("focal_length_px", focal.x, "`{}` {} must be above 0");
    set_window(known.camera, focal, center, width, height);
    known.source = "focal length in pixels by option";
  }
  return known;
}

/// Returns the horizontal angle of view that V-Ray writes, in degrees.
std::optional<double> vray_angle(std::span<const LayeredFile> headers) {
  for (const LayeredFile& header : headers)
    if (const std::string* text = header.attribute("cameraFov"))
      if (const auto angle = parse_number(*text, {.min = 0.1, .max = 179.0})) return angle;
  return std::nullopt;
}

}  // namespace

glm::dmat3 view_rotation(const ProjectionFit& fit) {
  return glm::transpose(glm::dmat3(fit.right, fit.up, -fit.forward));
}

double angle_of(const Camera& camera) {
  if (camera.projection == Projection::kOrthographic) return 0.0;
  return (std::atan(double(camera.top)) - std::atan(double(camera.bottom))) * 180.0 / std::numbers::pi;
}

bool is_camera_space(const ProjectionFit& fit) {
  constexpr double kTolerance = 1e-3;
  double off_axis = 0.0;
  for (const glm::dvec3& axis : {fit.right, fit.up, fit.forward})
    off_axis = std::max(off_axis, 1.0 - std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)}));
  return off_axis < kTolerance * kTolerance && glm::length(fit.eye) < kTolerance;
}

std::optional<ProjectionFit> position_camera(const Samples& samples) {
  constexpr std::size_t kMaxPoints = 8000;  // more do not improve the fit
  constexpr double kMaxCoordinate = 1e9, kMaxDistance_px = 0.5;
  const auto [x, y, z] = samples.find_three(Role::kPosition);
  if (!x || !y || !z) return std::nullopt;
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec2> pixels;
  const std::size_t step = samples.size() / kMaxPoints + 1;
  for (std::size_t k = 0; k < samples.size(); k += step) {
    const glm::dvec3 p((*x)[kCenter][k], (*y)[kCenter][k], (*z)[kCenter][k]);
    const double size = glm::length(p);
    if (!(size > 0.0 && size < kMaxCoordinate)) continue;
    points.push_back(p);
    pixels.emplace_back(samples.x[k] + 0.5, samples.y[k] + 0.5);
  }
  auto fit = fit_projection(points, pixels, samples.width, samples.height);
  if (!fit || !(fit->median_px < kMaxDistance_px)) return std::nullopt;
  // An eye that is as near to the origin as the fit is precise is at the origin.
  std::vector<double> distances;
  for (const glm::dvec3& p : points) distances.push_back(glm::length(p - fit->eye));
  constexpr double kAtOrigin = 1e-4;
  if (!fit->orthographic && glm::length(fit->eye) < kAtOrigin * quantile(std::move(distances), 0.5))
    fit->eye = glm::dvec3(0.0);
  // Lenses are rarely shifted by less than this, and pixels rarely less than this from square.
  constexpr double kCentered_px = 0.05, kSquare = 1e-3;
  const glm::dvec2 middle(samples.width / 2.0, samples.height / 2.0);
  if (!fit->orthographic && glm::length(fit->center - middle) < kCentered_px) fit->center = middle;
  if (std::abs(fit->focal.x / fit->focal.y - 1.0) < kSquare) fit->focal = glm::dvec2((fit->focal.x + fit->focal.y) / 2);
  if (!fit->orthographic) return fit;
  // A parallel camera has no place along its axis: behind it are none of the points.
  double nearest = 1e300, farthest = -1e300;
  for (const glm::dvec3& p : points) {
    const double d = glm::dot(fit->forward, p - fit->eye);
    nearest = std::min(nearest, d);
    farthest = std::max(farthest, d);
  }
  fit->eye += fit->forward * (nearest - std::max(farthest - nearest, 1e-6));
  return fit;
}

Result<KnownCamera> known_camera(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                 const std::optional<ProjectionFit>& position, int width, int height) {
  const double aspect = pixel_aspect(headers) * width / height;
  auto known = camera_of_options(settings, aspect, width, height);
  if (!known) return known;
  const Camera* header_camera = nullptr;
  for (const LayeredFile& header : headers)
    if (header.camera && !header_camera) header_camera = &*header.camera;
  // A perspective in the file is none of an orthographic camera.
  const auto may_be = [&](bool is_orthographic) {
    return !known->has_window() && (is_orthographic || !settings.orthographic);
  };
  if (header_camera) {
    if (may_be(header_camera->projection == Projection::kOrthographic)) {
      known->camera = *header_camera;
      known->source = "worldToNDC of the file";
    }
    known->camera.view_from_world = header_camera->view_from_world;
    known->has_view = true;
  }
  if (position && may_be(position->orthographic)) {
    set_window(known->camera, position->focal, position->center, width, height);
    known->camera.projection = position->orthographic ? Projection::kOrthographic : Projection::kPerspective;
    known->source = fmt::format("fitted to positions within {:.1g} pixels", std::max(position->median_px, 1e-4));
  }
  const bool world = position && settings.position_space != "camera" &&
                     (settings.position_space == "world" || !is_camera_space(*position));
  if (world && !known->has_view) {
    glm::dmat3 rotation = view_rotation(*position);
    // World coordinates of a left-handed renderer: their z is mirrored.
    glm::dvec3 eye = position->eye;
    if (glm::determinant(rotation) < 0.0) rotation[2] = -rotation[2], eye.z = -eye.z;
    known->camera.view_from_world = glm::mat4(glm::dmat4(rotation));
    known->camera.view_from_world[3] = glm::vec4(glm::vec3(-(rotation * eye)), 1.0f);
    known->has_view = true;
  }
  if (!may_be(false)) return known;
  if (const auto angle = vray_angle(headers)) {
    const glm::mat4 view = known->camera.view_from_world;
    known->camera = symmetric_camera(std::tan(*angle * std::numbers::pi / 360.0) / aspect, aspect);
    known->camera.view_from_world = view;
    known->source = "cameraFov of the file";
  }
  return known;
}

}  // namespace umbrage
