#include "renderer/hdri.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "core/check.h"
#include "core/color.h"
#include "core/reflection_map.h"
#include "io/format.h"
#include "scene/readers/import_in_child_process.h"
#include "scene/readers/texture_file.h"

namespace umbrage {
namespace {

const Panorama& panorama_of(const Hdri& hdri) {
  if (!hdri.panorama) fail_check("the environment image has not been read");
  return *hdri.panorama;
}

/// Returns whether a reader of io/ recognises the first bytes of the file. Errors: kFile if it cannot be opened.
Result<bool> is_io_format(const std::filesystem::path& file) {
  std::int64_t size = 0;
  const auto stream = open_to_read(file, size);
  if (!stream) return stream.error();
  if (size == 0) return file_error("'{}' is empty: it is not an image", file.string());
  char first_bytes[8] = {};
  const std::size_t byte_count = std::fread(first_bytes, 1, sizeof first_bytes, stream->get());
  for (const ImageFormat& format : image_formats())
    if (format.read && format.recognises(std::string_view(first_bytes, byte_count))) return true;
  return false;
}

Result<Panorama> read_io_format(const std::filesystem::path& file) {
  const auto image = read_image(file);
  if (!image) return image.error();
  std::array<const Plane*, 3> planes = {image->find("color.r"), image->find("color.g"), image->find("color.b")};
  if (image->planes.size() == 1) planes.fill(&image->planes[0]);
  for (const Plane* plane : planes)
    if (!plane) return file_error("'{}' has no channels R, G and B: it cannot light a scene", file.string());
  if (std::int64_t(image->width) * image->height > kMaxPanoramaPixels)
    return file_error("'{}' has {} x {} pixels: an environment image takes at most {}", file.string(), image->width,
                      image->height, kMaxPanoramaPixels);
  std::int64_t size = 0;
  char first_bytes[8] = {};
  if (const auto stream = open_to_read(file, size))
    static_cast<void>(std::fread(first_bytes, 1, sizeof first_bytes, stream->get()));
  const bool is_srgb = kPng.recognises(std::string_view(first_bytes, sizeof first_bytes));
  Panorama panorama{file.string(), image->width, image->height, {}};
  panorama.rgb.reserve(std::size_t(image->width) * std::size_t(image->height) * 3);
  for (int y = 0; y < image->height; ++y)
    for (int x = 0; x < image->width; ++x)
      for (const Plane* plane : planes) {
        const float v = plane->at(x, y);
        panorama.rgb.push_back(is_srgb ? linear_from_srgb(v) : v);
      }
  return panorama;
}

Result<Panorama> read_file(const std::string& file, const ProgressMonitor& monitor) {
  if (file == "sky:") return sky_panorama();
  const auto is_io = is_io_format(file);
  if (!is_io) return is_io.error();
  if (*is_io) return read_io_format(file);
  Poll poll(monitor);
  return read_panorama_in_child_process(file, &poll);
}

}  // namespace

Result<std::vector<std::string>> read_hdri(Hdri& hdri, const ProgressMonitor& monitor) {
  std::vector<std::string> warnings;
  if (hdri.file.empty()) return warnings;
  auto read = read_file(hdri.file, monitor);
  if (!read) return with_field(read.error(), "hdri_file", hdri.file);
  if (const std::size_t changed = clean_panorama(*read); changed > 0)
    warnings.push_back(fmt::format(
        "'{}': {} of its pixels have values that are not finite, or are below 0: they become 0, or 65504 if infinite",
        hdri.file, changed));
  if (read->width != 2 * read->height)
    warnings.push_back(
        fmt::format("'{}' is {} x {} pixels; an environment image is twice as wide as it is high: "
                    "this one is stretched to that",
                    hdri.file, read->width, read->height));
  Panorama panorama = reduced_panorama(*read, kMaxPanoramaWidth, kMaxPanoramaHeight);
  if (hdri.ambient && std::all_of(panorama.rgb.begin(), panorama.rgb.end(), [](float v) { return v == 0.0f; }))
    warnings.push_back(fmt::format("'{}' is all black, and gives no light", hdri.file));
  hdri.panorama = std::make_shared<const Panorama>(std::move(panorama));
  return warnings;
}

Lighting image_lighting(const Hdri& hdri, glm::vec3 up, bool reflects) {
  const EnvironmentLight light = environment_light(panorama_of(hdri));
  const glm::mat3 axes = panorama_axes(up, hdri.rotation_deg);
  Lighting lighting;
  lighting.lights = light.lights;
  for (Light& each : lighting.lights) {
    each.direction = glm::normalize(axes * each.direction);
    // A light's disc that extended below the horizon would darken the ground from the ground's edge inwards.
    const float height = std::asin(std::clamp(glm::dot(each.direction, glm::normalize(up)), -1.0f, 1.0f));
    if (height > 0.0f) each.angle_deg = std::min(each.angle_deg, 2.0f * glm::degrees(height));
    each.color *= hdri.intensity;
  }
  lighting.ambient = light.ambient * hdri.intensity;
  lighting.ambient_shape = turned(light.shape, axes);
  for (glm::mat4& matrix : lighting.ambient_shape.by_color) matrix *= hdri.intensity;
  if (reflects)
    lighting.reflections = std::make_shared<const ReflectionMap>(reflection_map([&](glm::vec3 direction) {
      return panorama_radiance(light.rest, glm::transpose(axes) * direction) * hdri.intensity;
    }));
  lighting.lit_white_luminance = light.brightest > 0.0f ? light.brightest : 1.0f;
  return lighting;
}

Image sky_planes(const Hdri& hdri, glm::vec3 up, float gain, const PictureInfo& info, const Rows& rows) {
  const Panorama& panorama = panorama_of(hdri);
  const Camera& camera = info.camera;
  const glm::mat3 panorama_from_view =
      glm::transpose(glm::mat3(camera.view_from_world) * panorama_axes(up, hdri.rotation_deg));
  Image image(info.width, rows.count());
  Plane* planes[3] = {};
  image.planes.reserve(3);
  for (int c = 0; c < 3; ++c) planes[c] = &image.add(std::string("sky.") + "rgb"[c]);
  tbb::parallel_for(tbb::blocked_range<int>(rows.begin, rows.end), [&](const tbb::blocked_range<int>& range) {
    for (int y = range.begin(); y < range.end(); ++y)
      for (int x = 0; x < info.width; ++x) {
        glm::vec3 ray(0.0f, 0.0f, -1.0f);
        if (camera.projection == Projection::kPerspective) {
          ray.x = camera.left + (float(x) + 0.5f) / float(info.width) * (camera.right - camera.left);
          ray.y = camera.top - (float(y) + 0.5f) / float(info.height) * (camera.top - camera.bottom);
        }
        const glm::vec3 radiance = gain * panorama_radiance(panorama, panorama_from_view * ray);
        for (int c = 0; c < 3; ++c) planes[c]->at(x, y - rows.begin) = radiance[c];
      }
  });
  return image;
}

}  // namespace umbrage
