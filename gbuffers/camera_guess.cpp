#include "gbuffers/camera_guess.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "core/lists.h"
#include "core/lowercase.h"
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
    const auto camera = camera_of_intrinsics(s.focal_length_px, width, height);
    if (!camera) return field_error("focal_length_px", s.focal_length_px[0], "`{}` {} must be above 0");
    known.camera = *camera;
    known.source = "focal length in pixels by option";
  }
  return known;
}

/// A camera that a header describes by numbers.
struct DescribedCamera {
  Camera camera;
  std::string attribute;
};

/// Returns the numbers of a text with commas between them; none if it is another text.
std::vector<float> numbers_of(const std::string& text) {
  std::vector<float> numbers;
  std::string_view rest = text;
  while (const auto number = take_number(rest)) {
    numbers.push_back(float(*number));
    if (rest.starts_with(',')) rest.remove_prefix(1);
  }
  return rest.empty() ? numbers : std::vector<float>();
}

/// Returns the camera that numbers of a header describe: the horizontal angle of view of V-Ray and Unreal, in degrees;
/// intrinsics or an angle whose name has its axis beside the arrays of an NPZ.
std::optional<DescribedCamera> described_camera(std::span<const LayeredFile> headers, double aspect) {
  constexpr std::string_view kIntrinsics[] = {
      "intrinsics", "intrinsic", "k", "cam_k", "camera_matrix", "focallength_px", "focal_length", "focal_length_px"};
  constexpr std::string_view kUp[] = {"fov_y", "fovy", "vfov", "fov_deg"}, kAcross[] = {"fov_x", "fovx", "hfov"};
  constexpr double kRadians = 3.15;  // an angle up to here may be in radians
  for (const LayeredFile& header : headers)
    for (const auto& [name, text] : header.attributes) {
      const std::string key = header.format == "NPZ" ? lowercase(name) : "";
      const bool is_up = contains(kUp, key);
      if (is_up || contains(kAcross, key) || name == "cameraFov" ||
          (name.starts_with("unreal/camera/") && name.ends_with("/fov")))
        if (const auto angle = parse_number(text, {.min = key.empty() ? 0.1 : kRadians, .max = 179.0}))
          return DescribedCamera{
              symmetric_camera(std::tan(*angle * std::numbers::pi / 360.0) / (is_up ? 1.0 : aspect), aspect), name};
      if (contains(kIntrinsics, key))
        if (const auto camera = camera_of_intrinsics(numbers_of(text), header.width, header.height))
          return DescribedCamera{*camera, name};
    }
  return std::nullopt;
}

}  // namespace

std::optional<Camera> camera_of_intrinsics(const std::vector<float>& n, int width, int height) {
  const glm::dvec2 size(width, height);
  glm::dvec2 focal(0.0), center = size / 2.0;
  if (n.size() == 1) focal = glm::dvec2(n[0]);
  if (n.size() == 4) focal = {n[0], n[1]}, center = {n[2], n[3]};
  if (n.size() == 9) focal = {n[0], n[4]}, center = {n[2], n[5]};
  if (n.size() == 16) focal = {n[0], n[5]}, center = {n[2], n[6]};
  if (!(focal.x > 0.0 && focal.y > 0.0)) return std::nullopt;
  if (center.x > 0.0 && center.x < 1.0 && center.y > 0.0 && center.y < 1.0) focal *= size, center *= size;
  if (center != size / 2.0) center += 0.5;
  Camera camera;
  set_window(camera, focal, center, width, height);
  return camera;
}

std::string center_warning(const Camera& camera, int width, int height) {
  constexpr double kFar = 0.25, kBothFar = 0.1;  // from the middle, fractions of the picture
  const glm::dvec2 center(-camera.left / (double(camera.right) - camera.left),
                          camera.top / (double(camera.top) - camera.bottom));
  const glm::dvec2 off = glm::abs(center - 0.5), pixel = center * glm::dvec2(width, height) - 0.5;
  if (std::max(off.x, off.y) <= kFar && std::min(off.x, off.y) <= kBothFar) return "";
  return fmt::format(
      "the centre of the intrinsics, ({:.4g}, {:.4g}), is far from the middle of {} x {} pixels: those of a picture of "
      "another size must be scaled, fx and cx with the width, fy and cy with the height",
      pixel.x, pixel.y, width, height);
}

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

std::optional<ProjectionFit> position_camera(const Samples& samples, double max_px) {
  constexpr std::size_t kMaxPoints = 8000;  // more do not improve the fit
  constexpr double kMaxCoordinate = 1e9;
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
  if (!fit || !(fit->median_px < max_px)) return std::nullopt;
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
  known->aspect = aspect;
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
  if (const auto described = described_camera(headers, aspect)) {
    const glm::mat4 view = known->camera.view_from_world;
    known->camera = described->camera;
    known->camera.view_from_world = view;
    known->source = described->attribute + " of the file";
  }
  return known;
}

}  // namespace umbrage
