#include "apps/cli/sheet.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "core/lists.h"
#include "core/lowercase.h"
#include "effects/output/output.h"
#include "io/drawing_of_strokes.h"
#include "renderer/draw.h"
#include "renderer/options.h"
#include "renderer/passes.h"
#include "renderer/strips.h"
#include "renderer/written_passes.h"
#include "scene/front.h"

namespace umbrage::cli {
namespace {

constexpr int kPadding = 4;                   // pixels around a view, for lines on its outline
constexpr float kMargin = 2.0f, kGap = 2.2f;  // around the page and between views, in sizes of the font
constexpr float kMaxFontFraction = 0.05f;     // of the shorter side of the page
constexpr float kLabel = 1.6f;                // of the name below a view, in sizes of the font
constexpr float kNoteSpace = 2.5f;            // of the line with the scale, likewise

/// Sets the extent of the model in a view, relative to the centre of the scene.
SheetLayout::Cell extent_of(const Scene& scene, const NamedView& view) {
  const glm::vec3 up = view.up, right = glm::cross(up, view.towards_camera), center = scene.center();
  constexpr float kNone = std::numeric_limits<float>::max();
  SheetLayout::Cell cell{.left = kNone, .right = -kNone, .bottom = kNone, .top = -kNone};
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.object == scene.ground_object) continue;
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      const glm::vec3 p = mesh.positions[k] - center;
      const float radius = mesh.radii.empty() ? 0.0f : mesh.radii[k], x = glm::dot(p, right), y = glm::dot(p, up);
      cell.left = std::min(cell.left, x - radius), cell.right = std::max(cell.right, x + radius);
      cell.bottom = std::min(cell.bottom, y - radius), cell.top = std::max(cell.top, y + radius);
    }
  }
  return cell;
}

/// The columns or rows of a sheet: the extent of the largest view in each, by number.
using Tracks = std::map<int, float>;

float sum_of(const Tracks& tracks) {
  float sum = 0.0f;
  for (const auto& [number, extent] : tracks) sum += extent;
  return sum;
}

/// Returns the largest scale of ISO 5455 that is at most `max`, which is above 0, and its text.
std::pair<double, std::string> standard_scale(double max) {
  const double scale = round_length(max * (1.0 + 1e-9));  // the inverse of a round number is one, too
  return {scale, scale >= 1.0 ? fmt::format("{:g}:1", scale) : fmt::format("1:{:g}", 1.0 / scale)};
}

/// Returns the length of a unit in mm, or 0 if it is not known.
double mm_of(const std::string& unit) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 1.0},  {"cm", 10.0}, {"m", 1000.0},  {"km", 1e6},
                                                            {"um", 1e-3}, {"in", 25.4}, {"inch", 25.4}, {"ft", 304.8}};
  for (const auto& [name, mm] : kUnits)
    if (lowercase(unit) == name) return mm;
  return 0.0;
}

/// The views of the request, in its order.
std::vector<NamedView> views_of(const RenderOptions& o, const glm::vec3& up) {
  std::vector<NamedView> chosen;
  for (const std::string& name : o.views)
    for (const NamedView& view : named_views(up))
      if (view.name == name) chosen.push_back(view);
  if (o.projection == "first")
    for (NamedView& view : chosen)
      if (view.name != "back") view.column = -view.column, view.row = -view.row;
  return chosen;
}

SheetSettings settings_of(const RenderOptions& o) {
  const float side = float(std::min(o.request.width, o.request.height));
  return {.first_angle = o.projection == "first",
          .width = o.request.width,
          .height = o.request.height,
          .font = std::min(font_size_for(o.figure.legend, side), kMaxFontFraction * side),
          .mm_per_pixel = o.figure.dpi > 0.0 ? double(o.figure.mm_per_pixel()) : 0.0,
          .mm_per_unit = mm_of(o.figure.legend.length_unit)};
}

/// A page that receives the views.
struct Sheet {
  Image picture;                   ///< raster pages
  std::vector<DrawnLayer> layers;  ///< of vector graphics
};

/// Returns the pixels of a cell.
Image cropped(const Image& page, const SheetLayout::Cell& cell) {
  Image crop(cell.width, cell.height);
  for (const std::string& name : page.names) {
    const Plane& from = page.plane(name);
    Plane& to = crop.add(name) = Plane(cell.width, cell.height);
    for (int y = 0; y < cell.height; ++y) std::copy_n(from.row(cell.y + y) + cell.x, cell.width, to.row(y));
  }
  return crop;
}

/// Draws a view, in a picture of the page's size, so that widths of lines and other lengths are those of the page, and
/// adds its cell to the sheet. `stops`: exposure of the first view, for all.
Result<void> add_view(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                      const SheetLayout::Cell& cell, std::optional<float>& stops, Sheet& sheet, StageTimes& times) {
  const auto plan = make_plan(job.recipe, scene, device.threads());
  if (!plan) return plan.error();
  const auto drawn = draw(device, scene, *plan, times, {}, stops);
  if (!drawn) return drawn.error();
  stops = drawn->stops;
  if (job.lines.alone) {
    auto drawing = drawing_of_frame(job.lines, device, drawn->frame);
    if (!drawing) return drawing.error();
    std::move(drawing->layers.begin(), drawing->layers.end(), std::back_inserter(sheet.layers));
    return {};
  }
  const Destination destination{o.output, nullptr, {}};
  const auto names = picture_planes(o, destination);
  const auto image = download_passes(device, drawn->frame, names);
  if (!image) return image.error();
  const Image shown =
      cropped(convert_for_file(o, destination, *image, names, job.recipe.settings, drawn->frame.info), cell);
  if (is_page(o.output)) {
    DrawnImage pixels = image_of(shown);
    pixels.x = float(cell.x), pixels.y = float(cell.y);
    sheet.layers.push_back({.name = "picture", .object = -1, .opacity = 1.0f, .shapes = {std::move(pixels)}});
    return {};
  }
  for (std::size_t k = 0; k < shown.planes.size(); ++k)
    for (int y = 0; y < cell.height; ++y)
      std::copy_n(shown.planes[k].row(y), cell.width, sheet.picture.plane(shown.names[k]).row(cell.y + y) + cell.x);
  return {};
}

/// Returns the names of the views and the scale.
DrawnLayer notes_of(const SheetLayout& layout, const std::vector<NamedView>& views, const SheetSettings& settings,
                    const DrawnColor& ink) {
  DrawnLayer layer{.name = "notes", .object = -1, .opacity = 1.0f, .shapes = {}};
  for (std::size_t k = 0; k < views.size(); ++k) {
    const SheetLayout::Cell& cell = layout.cells[k];
    layer.shapes.emplace_back(DrawnText{.x = float(cell.x) + 0.5f * float(cell.width),
                                        .y = float(cell.y + cell.height) + 1.1f * settings.font,
                                        .size = settings.font,
                                        .anchor = TextAnchor::kMiddle,
                                        .color = ink,
                                        .text = std::string(views[k].name)});
  }
  const std::string projection = settings.first_angle ? "first-angle projection" : "third-angle projection";
  layer.shapes.emplace_back(
      DrawnText{.x = kMargin * settings.font,
                .y = float(settings.height) - kMargin * settings.font,
                .size = settings.font,
                .color = ink,
                .text = layout.scale.empty() ? projection : fmt::format("scale {}, {}", layout.scale, projection)});
  return layer;
}

/// Returns the colour of the page; none if it is transparent.
std::optional<DrawnColor> background_of(const RenderOptions& o, const Recipe& recipe) {
  if (o.request.transparent) return std::nullopt;
  const auto& output = params_of<OutputParams>(recipe.settings);
  return DrawnColor{output.background_r, output.background_g, output.background_b};
}

/// Returns a camera whose window is the page at the scale of the views, for the scale bar.
Camera page_camera(const SheetLayout& layout, const SheetSettings& settings) {
  return orthographic_camera({0.0f, 0.0f, 1.0f}, {}, {0.0f, 1.0f, 0.0f},
                             float(settings.height / layout.pixels_per_unit),
                             float(settings.width) / float(settings.height));
}

Result<void> write_sheet(const RenderOptions& o, const RenderJob& job, const SheetLayout& layout,
                         const Legends& legends, Sheet& sheet) {
  const int width = o.request.width, height = o.request.height;
  if (!is_page(o.output)) {
    const auto pixels = pixels_of(sheet.layers, width, height);
    if (!pixels) return pixels.error();
    const Destination destination{o.output, nullptr, {}};
    return write_picture(destination, drawn_over(drawn_over(std::move(sheet.picture), *pixels, 0), legends.pixels, 0),
                         {.bits = o.bits(), .dpi = o.figure.dpi, .quality = o.picture_quality});
  }
  const bool in_units = page_extension(o.output) == "dxf";
  Drawing page{.width = float(width),
               .height = float(height),
               .mm_per_unit = in_units ? float(1.0 / layout.pixels_per_unit) : o.figure.mm_per_pixel(),
               .background = background_of(o, job.recipe),
               .layers = std::move(sheet.layers)};
  if (!legends.own_file) page.layers.insert(page.layers.end(), legends.layers.begin(), legends.layers.end());
  warn_of_pictures(o.output, page);
  return write_page(o.output, page);
}

}  // namespace

std::vector<NamedView> named_views(const glm::vec3& up) {
  const glm::vec3 front = usual_front(up), right = glm::cross(up, front);
  return {{"front", front, up, 0, 0},
          {"back", -front, up, 2, 0},
          {"left", -right, up, -1, 0},
          {"right", right, up, 1, 0},
          {"top", up, -front, 0, -1},
          {"bottom", -up, front, 0, 1},
          {"iso", glm::normalize(front + right + up), glm::normalize(2.0f * up - front - right), 1, -1}};
}

Result<SheetLayout> layout_of(const Scene& scene, const std::vector<NamedView>& views, const SheetSettings& settings) {
  SheetLayout layout;
  Tracks columns, rows;
  for (const NamedView& view : views) {
    layout.cells.push_back(extent_of(scene, view));
    const SheetLayout::Cell& cell = layout.cells.back();
    float &column = columns[view.column], &row = rows[view.row];
    column = std::max(column, cell.right - cell.left), row = std::max(row, cell.top - cell.bottom);
  }
  const float margin = kMargin * settings.font, gap = kGap * settings.font;
  const float free_x =
      float(settings.width) - 2.0f * margin - gap * float(columns.size() - 1) - 2.0f * kPadding * float(columns.size());
  const float free_y = float(settings.height) - 2.0f * margin - kNoteSpace * settings.font -
                       gap * float(rows.size() - 1) - (2.0f * kPadding + kLabel * settings.font) * float(rows.size());
  const float wide = sum_of(columns), high = sum_of(rows);
  if (!(wide > 0.0f || high > 0.0f))
    return field_error("--views", "", "{0}: '{2}' has no extent in these views", scene.name);
  double scale = std::numeric_limits<double>::max();
  if (wide > 0.0f) scale = double(free_x) / double(wide);
  if (high > 0.0f) scale = std::min(scale, double(free_y) / double(high));
  if (!(free_x > 0.0f && free_y > 0.0f))
    return field_error("--views", "", "a page of {2} x {3} pixels is too small for {4} views", settings.width,
                       settings.height, views.size());
  if (settings.mm_per_pixel > 0.0 && settings.mm_per_unit > 0.0) {
    const double per_scale = settings.mm_per_unit / settings.mm_per_pixel;  // pixels per unit at 1:1
    const auto [standard, text] = standard_scale(scale / per_scale);
    scale = standard * per_scale, layout.scale = text;
  }
  layout.pixels_per_unit = scale;
  // What is left over surrounds the views.
  const float spare_x = std::max(0.0f, free_x - float(scale) * wide),
              spare_y = std::max(0.0f, free_y - float(scale) * high);
  const auto place = [&](const Tracks& tracks, float begin, float extra) {
    Tracks centers;
    for (const auto& [number, extent] : tracks) {
      const float size = float(scale) * extent + 2.0f * kPadding;
      centers[number] = begin + 0.5f * size;
      begin += size + extra + gap;
    }
    return centers;
  };
  const Tracks x = place(columns, margin + 0.5f * spare_x, 0.0f);
  const Tracks y = place(rows, margin + 0.5f * spare_y, kLabel * settings.font);
  for (std::size_t k = 0; k < views.size(); ++k) {
    SheetLayout::Cell& cell = layout.cells[k];
    const auto half = [&](float extent) { return int(std::ceil(0.5 * scale * double(extent))) + kPadding; };
    cell.width = 2 * half(cell.right - cell.left), cell.height = 2 * half(cell.top - cell.bottom);
    cell.x = int(std::lround(x.at(views[k].column))) - cell.width / 2;
    cell.y = int(std::lround(y.at(views[k].row))) - cell.height / 2;
  }
  return layout;
}

void add_sheet_options(CLI::App& command, RenderOptions& options) {
  command
      .add_option("--views", options.view_names,
                  "draw these parallel views on one page, aligned and at one scale: front, back, left, right, top, "
                  "bottom, iso")
      ->type_name("NAMES")
      ->group("Figure");
  CLI::Option* projection =
      command.add_option("--projection", options.projection, "where --views are placed: third or first angle [third]")
          ->type_name("NAME")
          ->group("Figure");
  add_check(*projection, [](const std::string& text) -> Result<void> {
    if (text == "first" || text == "third") return {};
    return field_error("--projection", text, "{} cannot be '{}': it takes first or third");
  });
}

Result<void> apply_sheet_options(RenderOptions& o) {
  if (o.view_names.empty() && o.projection != RenderOptions().projection)
    return field_error("--projection", o.projection, "{} places --views, which are not given");
  if (o.view_names.empty()) return {};
  o.views = split(o.view_names);
  std::vector<std::string_view> known;
  for (const NamedView& view : named_views({0.0f, 1.0f, 0.0f})) known.push_back(view.name);
  for (std::size_t k = 0; k < o.views.size(); ++k) {
    if (!contains(known, o.views[k]))
      return field_error("--views", o.views[k], "{} has no '{}': the views are {}", fmt::join(known, ", "));
    if (std::count(o.views.begin(), o.views.end(), o.views[k]) > 1)
      return field_error("--views", o.views[k], "{} has '{}' twice");
  }
  const CameraSettings& camera = o.request.camera;
  if (camera.position || camera.focal_point || camera.direction || camera.view_up || camera.index ||
      camera.azimuth_deg != 0.0f || camera.elevation_deg != 0.0f || camera.zoom != 1.0f || camera.view_angle_deg)
    return field_error("--views", o.view_names, "{} {} places the camera: leave out its other options");
  if (o.turntable > 0 || !o.camera_path.empty() || o.animates || is_video(o.output) || o.writes_passes() ||
      o.time_s > 0.0 || !o.svg.empty() || o.same_view)
    return field_error("--views", o.view_names,
                       "{} {} makes one picture or page of one model: leave out videos, --turntable, --camera-path, "
                       "--animate, --passes, --time, --svg and --same-view");
  if (const auto extension = extension_of(o.output);
      extension && !holds_display_values(*extension) && !is_page(o.output))
    return field_error("--output", o.output, "{} '{}' holds light, and --views makes a page: write .png, .svg or .pdf");
  if (o.figure.dpi > 0.0 && !o.figure.legend.length_unit.empty() && mm_of(o.figure.legend.length_unit) == 0.0)
    print_warning(
        fmt::format("the scale is not written: the length of --length-unit '{}' is not known, as those of mm, "
                    "cm, m, km, um, in and ft are",
                    o.figure.legend.length_unit));
  if (o.figure.legend.axes)
    return field_error("--axes", true, "{} shows the directions of one view: leave it out, or --views");
  o.request.camera.orthographic = true;
  if (!o.request.background && !o.request.transparent && o.request.style.empty())
    o.request.background = {1.0f, 1.0f, 1.0f};
  if (o.request.ground == "auto") o.request.ground = "off";
  return {};
}

Result<void> draw_sheet(const RenderOptions& o, const RenderJob& job, Device& device, Scene& scene, StageTimes& times) {
  const std::vector<NamedView> views = views_of(o, scene.up);
  const SheetSettings settings = settings_of(o);
  SheetSettings room = settings;
  if (o.figure.legend.color_bar && o.figure.legend_file.empty())
    room.width -= int(legend_space(o.figure.legend, room.width, room.height).x * float(room.width));
  const auto layout = layout_of(scene, views, room);
  if (!layout) return layout.error();
  const auto plan = make_plan(job.recipe, scene, device.threads());
  if (!plan) return plan.error();
  if (const auto strips = plan_strips(device, *plan, job.memory); !strips || strips->rows > 0)
    return field_error("--views", o.view_names, "{} of {} x {} pixels need more than --memory {}: raise it",
                       settings.width, settings.height, o.memory);
  const auto background = background_of(o, job.recipe);
  const DrawnColor paper = background.value_or(DrawnColor{1.0f, 1.0f, 1.0f});
  Sheet sheet;
  if (!is_page(o.output)) {
    sheet.picture = Image(settings.width, settings.height);
    const float alpha = background ? 1.0f : 0.0f;
    for (const std::string& name : picture_planes(o, {o.output, nullptr, {}})) {
      const std::size_t channel = name.ends_with(".r") ? 0 : name.ends_with(".g") ? 1 : 2;
      sheet.picture.add(name) =
          Plane(settings.width, settings.height, name.ends_with(".a") ? alpha : paper[channel] * alpha);
    }
  }
  std::optional<float> stops;
  ProgressLine line;
  for (std::size_t k = 0; k < views.size(); ++k) {
    line.show(fmt::format("drawing view {} of {}", k + 1, views.size()), double(k) / double(views.size()));
    const SheetLayout::Cell& cell = layout->cells[k];
    const glm::vec3 up = views[k].up, right = glm::cross(up, views[k].towards_camera);
    // What the centre of the page shows, so that the centre of the model is at that of the cell.
    const auto units = [&](float pixels) { return float(double(pixels) / layout->pixels_per_unit); };
    const float x = 0.5f * (cell.left + cell.right) +
                    units(0.5f * float(settings.width) - float(cell.x) - 0.5f * float(cell.width));
    const float y = 0.5f * (cell.bottom + cell.top) +
                    units(float(cell.y) + 0.5f * float(cell.height) - 0.5f * float(settings.height));
    const glm::vec3 target = scene.center() + x * right + y * up;
    scene.views = {View{.eye = target + 3.0f * scene.radius() * views[k].towards_camera,
                        .target = target,
                        .up = up,
                        .height = units(float(settings.height))}};
    if (auto added = add_view(o, job, device, scene, cell, stops, sheet, times); !added) return added;
  }
  line.wipe();
  const auto legends = make_legends(o, scene, page_camera(*layout, settings), job.recipe);
  if (!legends) return legends.error();
  sheet.layers.push_back(notes_of(*layout, views, settings, ink_on(paper)));
  if (auto written = write_sheet(o, job, *layout, *legends, sheet); !written) return written;
  times.done("write");
  return write_legends(o, *legends, job.recipe);
}

}  // namespace umbrage::cli
