#include "apps/cli/picture_file.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "apps/cli/page.h"
#include "core/lists.h"
#include "renderer/passes.h"
#include "renderer/written_passes.h"
#include "scene/readers/whole_file.h"

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

constexpr std::string_view kStem = "{stem}";

/// Returns the name of a model without folder and endings: "bunny" for "scans/bunny.obj.gz", "claw" for
/// "scene:claw?detail=100".
std::string stem_of(const std::string& model) {
  constexpr std::string_view kBuiltIn = "scene:";
  if (model.starts_with(kBuiltIn)) return model.substr(kBuiltIn.size(), model.find('?') - kBuiltIn.size());
  return without_gz(model).stem().string();
}

/// Returns a pattern with the name of a model in place of each {stem}.
std::string with_stem(std::string pattern, const std::string& model) {
  const std::string stem = stem_of(model);
  for (std::size_t at = pattern.find(kStem); at != std::string::npos; at = pattern.find(kStem, at + stem.size()))
    pattern.replace(at, kStem.size(), stem);
  return pattern;
}

}  // namespace

Result<std::vector<RenderOptions>> options_by_model(const RenderOptions& o) {
  const auto has_stem = [](const std::string& file) { return file.find(kStem) != std::string::npos; };
  if (!o.same_view && (has_stem(o.output) || has_stem(o.svg)))
    return field_error("--output", o.output, "{0} '{1}': {2} names the picture of each model, for --same-view", kStem);
  if (!o.same_view) return std::vector<RenderOptions>{o};
  if (contains(o.models, "-"))
    return field_error("--same-view", true, "{} reads each model twice, and standard input can be read once");
  std::vector<RenderOptions> all;
  std::map<std::string, std::string> models;  // by output
  for (const std::string& model : o.models) {
    RenderOptions& one = all.emplace_back(o);
    one.models = {model};
    for (std::string* file : {&one.output, &one.svg, &one.figure.legend_file}) {
      if (!file->empty() && !has_stem(*file))
        return field_error(
            file == &one.svg      ? "--svg"
            : file == &one.output ? "--output"
                                  : "--legend",
            *file, "{0} '{1}' is one name for the pictures of all models: give a name such as 'out/{2}.png'", kStem);
      *file = with_stem(*file, model);
    }
    if (const auto [other, is_new] = models.emplace(one.output, model); !is_new)
      return field_error("--output", one.output, "'{2}' and '{3}' would both be written to '{1}'", other->second,
                         model);
  }
  return all;
}

VideoSettings video_settings(const RenderOptions& o, int width, int height) {
  return {.width = width,
          .height = height,
          .frame_rate = o.frame_rate,
          .alpha = o.writes_passes() ? o.writes_only("outline") : o.request.transparent};
}

Result<std::string> extension_of(const std::string& file) {
  if (is_page(file)) return page_extension(file);
  const auto format = format_of(file);
  if (!format)
    return field_error("--output", file,
                       "{2}; or .svg, .pdf or .dxf, for lines and figures; or .mp4, .webm or .gif, for several frames",
                       format.error().message);
  return std::string((*format)->extension);
}

std::string Destination::extension() const {
  return video || file == kStandardOutput || is_page(file) ? "png" : *extension_of(file);
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

Result<std::vector<std::string>> pass_planes_of(const RenderOptions& o, std::span<const std::string> available,
                                                const PictureInfo& info) {
  std::vector<std::string> words = o.request.passes;
  if (is_scene_linear(o)) std::replace(words.begin(), words.end(), std::string("color"), std::string("beauty"));
  const auto chosen = chosen_planes(words, available, info);
  if (!chosen) return chosen.error();
  std::vector<std::string> names;
  for (const PassPlanes& pass : *chosen)
    if (!is_scene_linear(o) || pass.name != "color") names.insert(names.end(), pass.planes.begin(), pass.planes.end());
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
