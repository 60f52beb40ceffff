// Writing of images and strokes to files.
#include <algorithm>
#include <bit>

#include "core/color.h"
#include "io/drawing_file.h"
#include "io/drawing_of_strokes.h"
#include "io/image_file.h"
#include "library/object.h"
#include "library/shared.h"
#include "library/shared_gbuffer.h"
#include "renderer/options.h"
#include "renderer/passes.h"

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

/// Converts the colour of a picture, sRGB with straight alpha, to that of .exr: linear and premultiplied.
void make_scene_linear(Image& image) {
  const Plane* alpha = image.find("color.a");
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    Plane& plane = image.plane(name);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.at(x, y) = linear_from_srgb(plane.at(x, y)) * (alpha ? alpha->at(x, y) : 1.0f);
  }
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
  return {};
}

/// Adds the images of an .exr file. Errors: kUsage.
Result<void> add_images(std::span<const std::pair<std::string, SharedImage>> images, Image& image,
                        WriteSettings& settings) {
  const auto is_beauty = [](const auto& named) { return named.first == "beauty"; };
  const bool has_beauty = std::any_of(images.begin(), images.end(), is_beauty);
  for (const auto& [name, from] : images) {
    if (name == "color" && has_beauty) continue;
    if (name == "beauty" && from.channels < 3)
      return usage_error("the image 'beauty' cannot have {} channels: it takes 3 or 4", from.channels);
    if (auto added = add_image(name == "beauty" ? "color" : name, from, image, settings); !added) return added;
    if (name == "color") make_scene_linear(image);
  }
  return {};
}

Result<void> write_images(const std::string& file, std::span<const std::pair<std::string, SharedImage>> images,
                          WriteSettings settings) {
  Request ignored;  // set_option only checks the value, since a Request has no field for `bits`
  if (auto status = set_option(option_of("bits"), fmt::format("{}", settings.bits), ignored); !status) return status;
  const auto format = format_of(file);
  if (!format) return Error{ErrorKind::kUsage, format.error().message};
  if (images.empty()) return usage_error("there is no picture to write to '{}'", file);
  if (auto writable = check_writable(file); !writable) return writable;
  Image image(images[0].second.width, images[0].second.height);
  const bool supports_passes = (*format)->extension == "exr";
  if (supports_passes) {
    if (auto added = add_images(images, image, settings); !added) return added;
  } else {
    const auto& [name, from] = images[0];
    if (images.size() != 1 || (name != "color" && from.channels != 1 && from.channels != 3))
      return usage_error("'{}' takes 'color' or one pass of 1 or 3 channels; write {} to a .exr file", file,
                         images.size() == 1 ? "'" + name + "'" : fmt::format("{} images", images.size()));
    if (auto added = add_image(from.channels == 1 ? name : "color", from, image, settings); !added) return added;
    if (const Plane* alpha = image.find("color.a"); alpha && is_opaque(*alpha)) {
      image.names.pop_back();
      image.planes.pop_back();
    }
  }
  return write_image(file, image, settings);
}

Result<void> write_strokes(const std::string& file, int width, int height, std::span<const UmbStroke> strokes,
                           const float rgb[3], float opacity) {
  if (drawing_extension(file) != "svg")
    return usage_error("strokes cannot be written to '{}': they take a .svg file", file);
  if (!(opacity > 0.0f)) return usage_error("there are no strokes to write to '{}': their opacity is 0", file);
  if (width < 1 || height < 1) return usage_error("there is no picture to write to '{}'", file);
  if (auto writable = check_writable(file); !writable) return writable;
  Strokes all{width, height, {}};
  for (const UmbStroke& stroke : strokes) {
    Stroke& made = all.strokes.emplace_back();
    if (stroke.kind < UMB_STROKE_OUTLINE || stroke.kind > UMB_STROKE_HIDDEN)
      return usage_error("stroke {} cannot be of kind {}: see UmbStrokeKind", &stroke - strokes.data(), stroke.kind);
    if (!stroke.points && stroke.point_count)
      return usage_error("stroke {} has {} points, but `points` is NULL", &stroke - strokes.data(), stroke.point_count);
    made.kind = StrokeKind(stroke.kind);
    made.object = int(stroke.object_id);
    made.closed = stroke.closed != 0;
    for (std::size_t k = 0; k < stroke.point_count; ++k)
      made.points.push_back({stroke.points[k].x, stroke.points[k].y, stroke.points[k].width});
  }
  const auto drawing = drawing_of(all, {.color = {rgb[0], rgb[1], rgb[2]}, .opacity = opacity});
  return drawing ? write_drawing(file, *drawing) : drawing.error();
}

/// Implements umbWriteImages and umbWriteImagesOfView.
UmbError write_with_view(const char* call, const char* file, const char* const* names, const UmbImage* images,
                         int count, int bits, bool half, const UmbView* view) {
  return call_without_object(call, [&]() -> Result<void> {
    if (!file || !names || !images || count < 1)
      return usage_error("{}: an argument is NULL, or `count` is below 1", call);
    std::vector<std::pair<std::string, SharedImage>> all;
    for (int k = 0; k < count; ++k) {
      if (!names[k]) return usage_error("{}: the name of image {} is NULL", call, k);
      auto image = shared_image("the image '" + text_of(names[k]) + "'", images[k]);
      if (!image) return image.error();
      if (!image->data) return usage_error("the image '{}' has no pixels", text_of(names[k]));
      all.emplace_back(text_of(names[k]), *image);
    }
    WriteSettings settings{.bits = bits, .half = half};
    const auto camera = view ? camera_of(*view) : Result<Camera>(Camera());
    if (!camera) return camera.error();
    const glm::dmat4 view_from_world = view ? matrix_of(*view) : glm::dmat4(1.0);
    if (view) settings.camera = &*camera, settings.view_from_world = &view_from_world;
    return write_images(file, all, settings);
  });
}

}  // namespace
}  // namespace umbrage

using namespace umbrage;  // for the C functions below

UmbError umbWriteImages(const char* file, const char* const* names, const UmbImage* images, int count, int bits,
                        bool half) {
  return write_with_view("umbWriteImages", file, names, images, count, bits, half, nullptr);
}

UmbError umbWriteImagesOfView(const char* file, const char* const* names, const UmbImage* images, int count, int bits,
                              bool half, const UmbView* view) {
  return write_with_view("umbWriteImagesOfView", file, names, images, count, bits, half, view);
}

UmbError umbWriteStrokes(const char* file, int width, int height, const UmbStroke* strokes, size_t count,
                         const float rgb[3], float opacity) {
  return call_without_object("umbWriteStrokes", [&]() -> Result<void> {
    if (!file || (!strokes && count > 0) || !rgb) return usage_error("umbWriteStrokes: an argument is NULL");
    return write_strokes(file, width, height, {strokes, count}, rgb, opacity);
  });
}
