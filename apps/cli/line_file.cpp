#include "apps/cli/line_file.h"

#include "core/gbuffer.h"
#include "effects/hatching/hatching.h"
#include "effects/output/output.h"
#include "io/drawing_file.h"
#include "io/image_file.h"
#include "looks/looks.h"

namespace umbrage::cli {
namespace {

bool is_dxf(const std::string& file) { return drawing_extension(file) == "dxf"; }

Result<void> write_lines_to(const std::string& file, const LineFile& lines, Result<Drawing> drawing,
                            const Camera& camera, const Legends& legends) {
  if (!drawing) return drawing.error();
  drawing->mm_per_unit = is_dxf(file) && camera.projection == Projection::kOrthographic
                             ? (camera.top - camera.bottom) / drawing->height
                             : lines.mm_per_pixel;
  if (lines.alone && !legends.own_file)
    drawing->layers.insert(drawing->layers.end(), legends.layers.begin(), legends.layers.end());
  warn_of_pictures(file, *drawing);
  return write_page(file, *drawing);
}

/// Returns whether a file of vector graphics holds the whole picture, as an image.
bool holds_picture(const RenderOptions& o) {
  if (!is_page(o.output) || is_dxf(o.output)) return false;
  const Look* look = find_look(o.request.look);
  return !o.request.color_by.empty() || (look && !has_lines(*look));
}

}  // namespace

void choose_line_look(RenderOptions& o) {
  constexpr const char* kLineLook = "cartoon";
  if (is_page(o.output) && !o.is_given("look") && (is_dxf(o.output) || o.request.color_by.empty()))
    o.request.look = kLineLook;
}

Result<LineFile> line_file_of(const RenderOptions& o, int frames) {
  LineFile lines;
  lines.alone = is_page(o.output) && !holds_picture(o);
  lines.mm_per_pixel = o.figure.mm_per_pixel();
  if (lines.alone && !o.svg.empty())
    return field_error("--svg", o.svg,
                       "{} '{}' writes lines beside a picture, and --output '{}' has no picture: give one of them",
                       o.output);
  if (lines.alone && o.writes_passes())
    return field_error("passes", o.text_of("passes"),
                       "`{}` {} needs a file that holds planes, such as .exr, and '{}' holds lines alone", o.output);
  if (!o.svg.empty() && !is_page(o.svg))
    return field_error("--svg", o.svg, "{} cannot be '{}': it takes a file whose name ends in .svg, .pdf or .dxf");
  if (o.figure.fill != "none") lines.fill = o.figure.fill == "part" ? FillBy::kPart : FillBy::kTone;
  if (lines.fill && (!lines.alone || is_dxf(o.output)))
    return field_error("--areas", o.figure.fill,
                       "{} {} fills the lines of an --output of .svg or .pdf, with --look cartoon or technical and "
                       "without --color-by");
  const char* option = lines.alone ? "--output" : "--svg";
  lines.file = lines.alone ? o.output : o.svg;
  if (!lines) return lines;
  if (frames == 0) {
    if (auto writable = check_writable(lines.file); !writable) return with_field(writable.error(), option);
    return lines;
  }
  auto names = frame_names(lines.file, option);
  if (!names) return with_field(names.error(), option);
  lines.names = std::move(*names);
  for (const int frame : {0, frames - 1})
    if (auto writable = check_writable(lines.names.of(frame)); !writable) return with_field(writable.error(), option);
  return lines;
}

Result<void> set_line_parameters(const RenderOptions& o, const Recipe& recipe, LineFile& lines) {
  auto params = stroke_parameters(recipe);
  if (!params) return params.error();
  lines.params = std::move(*params);
  lines.style.color = stroke_color(lines.params);
  lines.style.opacity = stroke_opacity(lines.params);
  lines.style.varies = !is_dxf(lines.file);
  if (!o.request.background || o.request.transparent) return {};
  const auto& output = params_of<OutputParams>(recipe.settings);
  lines.style.background = {output.background_r, output.background_g, output.background_b};
  return {};
}

void disable_unused_effects(const LineFile& lines, Request& request) {
  request.anti_aliasing = 1;
  if (find_params<HatchingParams>(lines.params) || lines.fill == FillBy::kTone || !request.occlusion_radius.empty())
    return;
  request.occlusion = kNoOcclusion;
  request.occlusion_scale.clear();
}

std::vector<std::string_view> fill_planes(const LineFile& lines) {
  if (!lines.fill) return {};
  return {"color.r", "color.g", "color.b", "object_id"};
}

Result<Drawing> drawing_of_frame(const LineFile& lines, Device& device, const Frame& frame) {
  const auto traced = traced_strokes(device, frame, lines.params);
  if (!traced) return traced.error();
  auto drawing = drawing_of(*traced, lines.style);
  if (!drawing || !lines.fill) return drawing;
  const auto names = fill_planes(lines);
  const auto picture = device.download(frame, {names.begin(), names.end()});
  if (!picture) return picture.error();
  auto fills = filled_regions(*picture, *lines.fill);
  drawing->layers.insert(drawing->layers.begin(), std::make_move_iterator(fills.begin()),
                         std::make_move_iterator(fills.end()));
  return drawing;
}

void warn_of_pictures(const std::string& file, const Drawing& page) {
  const auto is_image = [](const DrawnShape& shape) { return std::holds_alternative<DrawnImage>(shape); };
  for (const DrawnLayer& layer : page.layers)
    if (is_dxf(file) && std::any_of(layer.shapes.begin(), layer.shapes.end(), is_image))
      print_warning(
          fmt::format("'{}' leaves out the colours of '{}': .dxf files hold lines and texts, .svg and .pdf "
                      "files also pictures",
                      file, layer.name));
}

void print_line_notes(const LineFile& lines, const Camera& camera) {
  if (is_dxf(lines.file) && camera.projection == Projection::kPerspective)
    print_warning(
        fmt::format("'{}' shows a perspective view, which has no scale: --camera-orthographic gives a drawing "
                    "in the units of the model",
                    lines.file));
}

Result<void> write_lines(const LineFile& lines, int frame_number, Device& device, const Frame& frame,
                         const Legends& legends) {
  const bool numbered = !lines.names.after.empty();
  return write_lines_to(numbered ? lines.names.of(frame_number) : lines.file, lines,
                        drawing_of_frame(lines, device, frame), inner_camera(frame.info), legends);
}

Result<void> write_lines(const LineFile& lines, const Strokes& traced, const Camera& camera, const Legends& legends) {
  return write_lines_to(lines.file, lines, drawing_of(traced, lines.style), camera, legends);
}

}  // namespace umbrage::cli
