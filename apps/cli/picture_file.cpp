#include "apps/cli/picture_file.h"

#include <algorithm>
#include <cstdio>

#include "io/svg.h"
#include "renderer/written_passes.h"

namespace umbrage::cli {
namespace {

/// Returns `color.r` for `beauty.r`, and other names as they are.
std::string color_of_beauty(const std::string& plane) {
  constexpr std::string_view kBeauty = "beauty.";
  return plane.starts_with(kBeauty) ? "color." + plane.substr(kBeauty.size()) : plane;
}

/// Multiplies colour by alpha, if the picture has both.
void premultiply(Image& picture) {
  const Plane* alpha = picture.find("color.a");
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    if (!alpha || !picture.find(name)) return;
    Plane& plane = picture.plane(name);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.row(y)[x] *= alpha->row(y)[x];
  }
}

}  // namespace

Result<std::string> extension_of(const std::string& file) {
  if (is_svg(file)) return std::string("svg");
  const auto format = format_of(file);
  if (!format) return field_error("--output", file, "{2}; or .svg, for lines", format.error().message);
  return std::string((*format)->extension);
}

bool holds_display_values(std::string_view extension) {
  for (const ImageFormat& format : image_formats())
    if (format.extension == extension) return format.display;
  return false;
}

Result<void> check_format(const RenderOptions& o, const std::string& extension) {
  constexpr int kMaxWebpSide = 16383;  // of the format
  if (extension == "webp" && std::max(o.request.width, o.request.height) > kMaxWebpSide)
    return field_error("width", "", "`{0}` is too large for a .webp, which has at most {2} pixels per side",
                       kMaxWebpSide);
  if (extension != "jpg" && extension != "jpeg") return {};
  if (o.request.transparent)
    return field_error("transparent", true, "`{0}` is for .png, .webp and .exr: a .{2} has no transparency", extension);
  if (o.writes_only("outline"))
    return field_error("passes", "outline",
                       "lines alone are drawn on transparency, which a .{2} does not have: write .png, .webp or .svg",
                       extension);
  return {};
}

Result<void> write_rows(const Destination& destination, const ImageShape& shape, const WriteSettings& settings,
                        const MakeImageRows& make) {
  if (destination.file != kStandardOutput) return write_image_rows(destination.file, shape, settings, make);
  const auto bytes = encode_png_rows("standard output", shape, settings, make);
  if (!bytes) return bytes.error();
  if (std::fwrite(bytes->data(), 1, bytes->size(), stdout) != bytes->size() || std::fflush(stdout) != 0)
    return file_error("standard output cannot be written");
  return {};
}

Result<void> write_picture(const Destination& destination, const Image& image, const WriteSettings& settings) {
  if (destination.video) return destination.video->add(image);
  return write_rows(destination, {image.width, image.height, image.names}, settings,
                    [&](const TakeImageRows& take) { return take(image); });
}

PictureValues values_for(const RenderOptions& o, std::string_view extension) {
  if (extension == "exr" && std::none_of(o.request.settings.begin(), o.request.settings.end(),
                                         [](const std::string& s) { return s.starts_with("output.transfer="); }))
    return PictureValues::kSceneLinear;
  return holds_display_values(extension) && o.bits() == 8 ? PictureValues::kDisplay8 : PictureValues::kDisplay;
}

bool is_scene_linear(const RenderOptions& o) { return o.request.values == PictureValues::kSceneLinear; }

std::vector<std::string> picture_planes(const RenderOptions& o, const Destination& destination) {
  const std::string pass = is_scene_linear(o) ? "beauty" : "color";
  std::vector<std::string> names = {pass + ".r", pass + ".g", pass + ".b"};
  if (o.request.transparent || destination.extension() == "exr") names.push_back(pass + ".a");
  return names;
}

Image convert_for_file(const RenderOptions& o, const Destination& destination, const Image& drawn,
                       const std::vector<std::string>& names, const EffectSettings& settings, const PictureInfo& info) {
  const bool display = holds_display_values(destination.extension());
  if (o.writes_only("outline") && display) return picture_of_lines(drawn.plane("outline"), settings);
  if (o.writes_passes() && display) return picture_of_passes(drawn, names, info);
  Image picture(drawn.width, drawn.height);
  const bool premultiplied = destination.extension() == "exr" && !is_scene_linear(o);
  for (const std::string& name : names) {
    const Plane& plane = drawn.plane(name);
    picture.add(is_scene_linear(o) ? color_of_beauty(name) : name) = premultiplied ? Plane(plane) : Plane::view(plane);
  }
  if (premultiplied) premultiply(picture);
  return picture;
}

}  // namespace umbrage::cli
