#include "apps/cli/figure.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "apps/cli/commands.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/render_options.h"
#include "core/lists.h"
#include "core/lowercase.h"
#include "effects/output/output.h"
#include "io/image_file.h"
#include "renderer/options.h"
#include "scene/readers/content.h"
#include "scene/readers/import.h"

namespace umbrage::cli {
namespace {

constexpr double kMmPerInch = 25.4, kPrintDpi = 300.0;
constexpr double kMaxMm = 5000.0;

/// Sets the size of the picture in pixels. Errors: kUsage.
Result<void> apply_print_size(RenderOptions& o) {
  const std::string& text = o.figure.print_size;
  if (text.empty()) return {};
  // A size in the configuration file is for pictures without a size on paper.
  if (command_line.find("--resolution") != std::string::npos)
    return field_error("--print-size", text, "{} {} gives the number of pixels at --dpi: leave out --resolution");
  const auto words = split(text);
  const Interval interval{1.0, kMaxMm};
  std::vector<double> mm;
  for (const std::string& word : words)
    if (const auto number = parse_number(word, interval)) mm.push_back(*number);
  if (mm.size() != words.size() || mm.size() != 2)
    return field_error("--print-size", text, "{} cannot be '{}': it takes width and height in mm, such as 80,60");
  if (o.figure.dpi == 0.0) o.figure.dpi = kPrintDpi;
  const auto pixels = [&](double length) { return int(std::lround(length / kMmPerInch * o.figure.dpi)); };
  const std::string size = fmt::format("{},{}", pixels(mm[0]), pixels(mm[1]));
  const auto checked = parse_size("width", size, kMaxStripPixels);
  if (!checked)
    return field_error("--print-size", text,
                       "{0} {1} at {2:g} dpi makes {3} pixels, which cannot be drawn: lower --dpi", o.figure.dpi, size);
  std::tie(o.request.width, o.request.height) = *checked;
  return {};
}

}  // namespace

float FigureOptions::mm_per_pixel() const { return dpi > 0.0 ? float(kMmPerInch / dpi) : kMmPerCssPixel; }

void add_figure_options(CLI::App& command, FigureOptions& options) {
  const std::string group = command.option_defaults()->get_group();
  command.option_defaults()->group("Figure");
  command.add_flag("--color-bar", options.legend.color_bar, "draw a bar with the colours of the values of --color-by");
  command.add_option("--color-bar-title", options.legend.title, "title of that bar [the name of the values]")
      ->type_name("TEXT");
  command.add_flag("--scale-bar", options.legend.scale_bar,
                   "draw a bar of a round length; in perspective it holds at the depth of the model's centre");
  command
      .add_option("--length-unit", options.legend.length_unit,
                  "unit of the model's lengths, such as mm, for the scale bar [that of the format, or none]")
      ->type_name("TEXT");
  command.add_flag("--axes", options.legend.axes, "draw the directions of the axes");
  command
      .add_option("--legend", options.legend_file,
                  "write bars and axes to this .png, .svg or .pdf of the picture's size, in place of the picture")
      ->type_name("FILE");
  CLI::Option* areas =
      command
          .add_option("--areas", options.fill,
                      "areas below the lines of a .svg or .pdf: none, a colour per part, or its tones [none]")
          ->type_name("NAME");
  add_check(*areas, [](const std::string& text) -> Result<void> {
    if (text == "none" || text == "part" || text == "tone") return {};
    return field_error("--areas", text, "{} cannot be '{}': it takes none, part or tone");
  });
  add_number(command, "--dpi", options.dpi, {1.0, 10000.0}, "pixels per inch on paper, written to the file", "none");
  command
      .add_option("--print-size", options.print_size,
                  "width,height on paper, mm, in place of --resolution; at --dpi, 300 if it is not given")
      ->type_name("MM,MM");
  command.option_defaults()->group(group);
}

Result<void> apply_figure_options(RenderOptions& o) {
  if (auto applied = apply_print_size(o); !applied) return applied;
  FigureOptions& figure = o.figure;
  LegendSettings& legend = figure.legend;
  constexpr double kFontPoints = 8.0, kPointsPerInch = 72.0;
  if (figure.dpi > 0.0) legend.font_size = float(kFontPoints / kPointsPerInch * figure.dpi);
  if (legend.length_unit.empty() && !o.models.empty()) legend.length_unit = units_of(import_format(o.models[0]));
  if (!legend.title.empty() && !legend.color_bar)
    return field_error("--color-bar-title", legend.title, "{} '{}' needs --color-bar");
  if (command_line.find("--length-unit") != std::string::npos && !legend.scale_bar && o.view_names.empty())
    return field_error("--length-unit", legend.length_unit, "{} '{}' needs --scale-bar or --views");
  if (!legend.any() && !figure.legend_file.empty())
    return field_error("--legend", figure.legend_file, "{} '{}' needs --color-bar, --scale-bar or --axes");
  if (legend.color_bar && o.request.color_by.empty())
    return field_error("--color-bar", true, "{} shows the values of --color-by, which is not given");
  if (legend.any() && std::min(o.request.width, o.request.height) < kMinLegendSide)
    return field_error("width", o.request.width,
                       "{2} x {3} pixels are too small for bars and axes: draw at least {4} on each side",
                       o.request.width, o.request.height, kMinLegendSide);
  if (!figure.legend_file.empty()) {
    const std::string page = page_extension(figure.legend_file);
    if (page != "svg" && page != "pdf" &&
        lowercase(std::filesystem::path(figure.legend_file).extension().string()) != ".png")
      return field_error("--legend", figure.legend_file,
                         "{} cannot be '{}': it takes a file whose name ends in .png, .svg or .pdf");
    if (auto writable = check_writable(figure.legend_file); !writable)
      return with_field(writable.error(), "--legend", figure.legend_file);
    const auto path_of = [](const std::string& file) {
      std::error_code unknown;
      return std::filesystem::absolute(file, unknown).lexically_normal();
    };
    for (const std::string& other : {o.output, o.svg})
      if (!other.empty() && path_of(figure.legend_file) == path_of(other))
        return field_error("--legend", figure.legend_file, "{} '{}' is the picture itself: give another name");
    if (legend.axes && (o.turntable > 0 || !o.camera_path.empty() || o.animates))
      return field_error("--legend", figure.legend_file,
                         "{} '{}' is one file, and --axes change with --turntable, --camera-path and --animate");
    return {};
  }
  constexpr std::string_view kWithSize[] = {"png", "jpg", "jpeg", "svg", "pdf"};
  if (const auto extension = extension_of(o.output);
      extension && figure.dpi > 0.0 && !contains(kWithSize, std::string_view(*extension))) {
    if (figure.print_size.empty())
      return field_error("--dpi", figure.dpi, "{0} is written to .png, .jpg, .svg and .pdf files, not to .{2}",
                         *extension);
    print_warning(fmt::format(
        "'{}' has the pixels of --print-size, but not the size: .png, .jpg, .svg and .pdf files hold it", o.output));
  }
  if (!legend.any()) return {};
  if (o.writes_passes())
    return field_error("passes", o.text_of("passes"),
                       "`{}` {} are values without legends: give --legend a file of its own");
  if (const auto extension = extension_of(o.output);
      extension && !holds_display_values(*extension) && !is_page(o.output))
    return field_error("--output", o.output, "{} '{}' holds light, not a picture with legends: give --legend a file");
  return {};
}

Drawing Legends::page_of(const Image& picture, float mm_per_pixel) const {
  Drawing page{.width = float(picture.width),
               .height = float(picture.height),
               .mm_per_unit = mm_per_pixel,
               .background = {},
               .layers = {{.name = "picture", .object = -1, .opacity = 1.0f, .shapes = {image_of(picture)}}}};
  if (!own_file) page.layers.insert(page.layers.end(), layers.begin(), layers.end());
  return page;
}

Result<Legends> make_legends(const RenderOptions& o, const Scene& scene, const Camera& camera, const Recipe& recipe) {
  if (!o.figure.legend.any()) return Legends();
  LegendSettings settings = o.figure.legend;
  Legends legends{.layers = {}, .own_file = !o.figure.legend_file.empty(), .pixels = {}};
  const auto& output = params_of<OutputParams>(recipe.settings);
  settings.ink = ink_on(legends.own_file || o.request.transparent
                            ? DrawnColor{1.0f, 1.0f, 1.0f}
                            : DrawnColor{output.background_r, output.background_g, output.background_b});
  auto layers = legends_of(settings, scene, camera, recipe.width, recipe.height);
  if (!layers) return layers.error();
  legends.layers = std::move(*layers);
  if (legends.own_file || is_page(o.output)) return legends;
  auto pixels = pixels_of(legends.layers, recipe.width, recipe.height);
  if (!pixels) return pixels.error();
  legends.pixels = std::move(*pixels);
  return legends;
}

Result<void> write_legends(const RenderOptions& o, const Legends& legends, const Recipe& recipe) {
  const std::filesystem::path file = o.figure.legend_file;
  if (file.empty()) return {};
  if (is_page(file))
    return write_page(file, {.width = float(recipe.width),
                             .height = float(recipe.height),
                             .mm_per_unit = o.figure.mm_per_pixel(),
                             .background = {},
                             .layers = legends.layers});
  const auto pixels = pixels_of(legends.layers, recipe.width, recipe.height);
  if (!pixels) return pixels.error();
  Image picture(recipe.width, recipe.height);
  for (const char* name : {"color.r", "color.g", "color.b", "color.a"})
    picture.add(name) = Plane(recipe.width, recipe.height, 0.0f);
  return write_image(file, drawn_over(std::move(picture), *pixels, 0), {.dpi = o.figure.dpi});
}

}  // namespace umbrage::cli
