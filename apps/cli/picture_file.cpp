#include "apps/cli/picture_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/srgb.h"
#include "effects/effects.h"
#include "effects/outline/outline.h"
#include "io/svg.h"

namespace umbrage::cli {
namespace {

/// Converts one pass to a picture: vectors map from [-1, 1] to [0, 1], depth from white (near) to black (far).
Image picture_of_pass(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info) {
  Image out(frame.width, frame.height);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b", "color.a"};
  // Min depth range, relative to the max depth. Avoids 0 / 0 for a scene that is one plane facing the camera.
  constexpr float kMinDepthRange = 1e-4f;
  const float span = std::max(info.depth_max - info.depth_min, kMinDepthRange * info.depth_max);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Plane& in = frame.plane(names[k]);
    Plane& plane = out.add(names.size() == 1 ? names[0] : kChannels[std::min(k, kChannels.size() - 1)]);
    const bool vector = names[k].ends_with(".x") || names[k].ends_with(".y") || names[k].ends_with(".z");
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float v = in.at(x, y);
        if (vector) v = 0.5f * v + 0.5f;
        if (names[k] == "depth" || names[k].ends_with(".depth"))
          v = std::isfinite(v) ? 1.0f - (v - info.depth_min) / span : 0.0f;
        plane.at(x, y) = v;
      }
  }
  return out;
}

/// Returns the lines alone, in their colour, with alpha.
Image picture_of_lines(const Plane& cover, const EffectSettings& settings) {
  const auto& line = as<OutlineParams>(params_of(settings, "outline"));
  const Parameter& transfer = *find_parameter(*find_effect("output"), "transfer");
  const bool srgb = parameter_text(transfer, params_of(settings, "output")) == "srgb";
  Image out(cover.width, cover.height);
  for (const auto& [name, value] : {std::pair{"color.r", line.r}, {"color.g", line.g}, {"color.b", line.b}})
    out.add(name) = Plane(cover.width, cover.height, srgb ? srgb_from_linear(value) : value);
  out.add("color.a") = cover;
  return out;
}

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
  if (!format) return usage_error("{}; or .svg, for lines", format.error().message);
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
    return usage_error("`width` is too large for a .webp, which has at most {} pixels per side", kMaxWebpSide);
  if (extension != "jpg" && extension != "jpeg") return {};
  if (o.request.transparent)
    return usage_error("`transparent` is for .png, .webp and .exr: a .{} has no transparency", extension);
  if (o.writes_only("outline"))
    return usage_error("lines alone are drawn on transparency, which a .{} does not have: write .png, .webp or .svg",
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

bool is_scene_linear(const RenderOptions& o, std::string_view extension) {
  return extension == "exr" && std::none_of(o.request.settings.begin(), o.request.settings.end(),
                                            [](const std::string& s) { return s.starts_with("output.transfer="); });
}

std::vector<std::string> picture_planes(const RenderOptions& o, const Destination& destination) {
  const std::string pass = o.request.scene_linear ? "beauty" : "color";
  std::vector<std::string> names = {pass + ".r", pass + ".g", pass + ".b"};
  if (o.request.transparent || destination.extension() == "exr") names.push_back(pass + ".a");
  return names;
}

Image convert_for_file(const RenderOptions& o, const Destination& destination, const Image& drawn,
                       const std::vector<std::string>& names, const EffectSettings& settings, const PictureInfo& info) {
  const bool display = holds_display_values(destination.extension());
  if (o.writes_only("outline") && display) return picture_of_lines(drawn.plane("outline"), settings);
  if (o.writes_passes() && display) return picture_of_pass(drawn, names, info);
  Image picture(drawn.width, drawn.height);
  const bool premultiplied = destination.extension() == "exr" && !o.request.scene_linear;
  for (const std::string& name : names) {
    const Plane& plane = drawn.plane(name);
    picture.add(o.request.scene_linear ? color_of_beauty(name) : name) =
        premultiplied ? Plane(plane) : Plane::view(plane);
  }
  if (premultiplied) premultiply(picture);
  return picture;
}

}  // namespace umbrage::cli
