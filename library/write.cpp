// Writing of images and strokes to files.
#include <bit>

#include "io/image_file.h"
#include "io/svg.h"
#include "library/object.h"
#include "library/shared.h"
#include "renderer/options.h"
#include "renderer/passes.h"
#include "renderer/shared_gbuffer.h"

namespace umbrage {
namespace {

/// Returns the channel suffixes of a pass. Those of an unknown pass follow from the number of channels.
std::vector<std::string> channels_to_write(const std::string& pass, int channels) {
  auto names = channels_of(pass);
  if (int(names.size()) == channels) return names;
  if (channels == 1) return {""};
  names = {".r", ".g", ".b", ".a"};
  names.resize(std::size_t(std::clamp(channels, 0, 4)));
  return names;
}

bool is_opaque(const Plane& alpha) {
  for (int y = 0; y < alpha.height; ++y)
    for (int x = 0; x < alpha.width; ++x)
      if (alpha.at(x, y) < 1.0f) return false;
  return true;
}

/// Adds an image to the planes of a file. Errors: kUsage.
Result<void> add_image(const std::string& name, const SharedImage& from, Image& image, WriteSettings& settings) {
  if (from.width != image.width || from.height != image.height)
    return usage_error("the image '{}' has {} x {} pixels: the first image has {} x {}", name, from.width, from.height,
                       image.width, image.height);
  const auto channels = channels_to_write(name, from.channels);
  if (int(channels.size()) != from.channels)
    return usage_error("the image '{}' cannot have {} channels: it takes 1 to 4", name, from.channels);
  if (from.type == PixelType::kUint32 && !is_id(name))
    return usage_error("the image '{}' cannot hold 32-bit integers: only ids can", name);
  if (name == "color" && from.channels < 3)
    return usage_error("the image 'color' cannot have {} channels: it takes 3 or 4", from.channels);
  const bool are_integers = is_id(name) && is_whole(from.type);
  if (are_integers) settings.integer_planes.push_back(name);
  for (int c = 0; c < from.channels; ++c) {
    const std::string plane_name = name + channels[std::size_t(c)];
    if (image.find(plane_name)) return usage_error("there are two images '{}'", name);
    Plane& plane = image.add(plane_name) = Plane(image.width, image.height);
    if (are_integers)
      read_ids(from, [&](int x, int y, std::uint32_t id) { plane.at(x, y) = std::bit_cast<float>(id); });
    else
      read_channel(from, c, plane);
  }
  if (name == "color" && from.channels == 4 && is_opaque(image.plane("color.a"))) {
    image.names.pop_back();
    image.planes.pop_back();
  }
  return {};
}

Result<void> write_images(const std::string& file, std::span<const std::pair<std::string, SharedImage>> images,
                          WriteSettings settings) {
  Request ignored;  // set_option only checks the value, since a Request has no field for `bits`
  if (auto fine = set_option(option_of("bits"), fmt::format("{}", settings.bits), ignored); !fine) return fine;
  const auto format = format_of(file);
  if (!format) return Error{ErrorKind::kUsage, format.error().message};
  if (images.empty()) return usage_error("there is no picture to write to '{}'", file);
  if (auto writable = check_writable(file); !writable) return writable;
  Image image(images[0].second.width, images[0].second.height);
  const bool supports_passes = (*format)->extension == "exr";
  if (supports_passes) {
    for (const auto& [name, from] : images)
      if (auto added = add_image(name, from, image, settings); !added) return added;
  } else {
    const auto& [name, from] = images[0];
    if (images.size() != 1 || (name != "color" && from.channels != 1 && from.channels != 3))
      return usage_error("'{}' takes 'color' or one pass of 1 or 3 channels; write {} to a .exr file", file,
                         images.size() == 1 ? "'" + name + "'" : fmt::format("{} images", images.size()));
    if (auto added = add_image(from.channels == 1 ? name : "color", from, image, settings); !added) return added;
  }
  return write_image(file, image, settings);
}

Result<void> write_strokes(const std::string& file, int width, int height, std::span<const UmbStroke> strokes,
                           const float rgb[3], float opacity) {
  if (!is_svg(file)) return usage_error("strokes cannot be written to '{}': they take a .svg file", file);
  if (!(opacity > 0.0f)) return usage_error("there are no strokes to write to '{}': their opacity is 0", file);
  if (width < 1 || height < 1) return usage_error("there is no picture to write to '{}'", file);
  if (auto writable = check_writable(file); !writable) return writable;
  Lines lines{width, height, {}};
  for (const UmbStroke& stroke : strokes) {
    Line& line = lines.lines.emplace_back();
    if (stroke.kind < UMB_STROKE_OUTLINE || stroke.kind > UMB_STROKE_CREASE)
      return usage_error("stroke {} cannot be of kind {}: see UmbStrokeKind", &stroke - strokes.data(), stroke.kind);
    if (!stroke.points && stroke.point_count)
      return usage_error("stroke {} has {} points, but `points` is NULL", &stroke - strokes.data(), stroke.point_count);
    line.kind = LineKind(stroke.kind);
    line.object = int(stroke.object_id);
    line.closed = stroke.closed != 0;
    for (std::size_t k = 0; k < stroke.point_count; ++k)
      line.points.push_back({stroke.points[k].x, stroke.points[k].y, stroke.points[k].width});
  }
  return write_svg(file, lines, {.color = {rgb[0], rgb[1], rgb[2]}, .opacity = opacity});
}

}  // namespace
}  // namespace umbrage

using namespace umbrage;  // for the C functions below

UmbError umbWriteImages(const char* file, const char* const* names, const UmbImage* images, int count, int bits,
                        bool half) {
  return call_without_object("umbWriteImages", [&]() -> Result<void> {
    if (!file || !names || !images || count < 1)
      return usage_error("umbWriteImages: an argument is NULL, or `count` is below 1");
    std::vector<std::pair<std::string, SharedImage>> all;
    for (int k = 0; k < count; ++k) {
      auto image = shared_image("the image '" + text_of(names[k]) + "'", images[k]);
      if (!image) return image.error();
      if (!image->data) return usage_error("the image '{}' has no pixels", text_of(names[k]));
      all.emplace_back(text_of(names[k]), *image);
    }
    return write_images(file, all, {.bits = bits, .half = half});
  });
}

UmbError umbWriteStrokes(const char* file, int width, int height, const UmbStroke* strokes, size_t count,
                         const float rgb[3], float opacity) {
  return call_without_object("umbWriteStrokes", [&]() -> Result<void> {
    if (!file || (!strokes && count > 0) || !rgb) return usage_error("umbWriteStrokes: an argument is NULL");
    return write_strokes(file, width, height, {strokes, count}, rgb, opacity);
  });
}
