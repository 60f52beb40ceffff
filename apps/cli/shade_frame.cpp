#include "apps/cli/shade_frame.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <limits>

#include "apps/cli/output.h"
#include "apps/cli/page.h"
#include "apps/cli/picture_file.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "gbuffers/conventions.h"
#include "gbuffers/roles.h"
#include "io/format.h"
#include "io/layers.h"
#include "renderer/passes.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

/// A pass that a picture can have.
struct Available {
  std::string name;
  bool is_made = false;  ///< by an effect; false: it is in the files
};

/// Returns the passes that users can name: those of the files, and those that the effects of the recipe make.
std::vector<Available> available_passes(const Recipe& recipe, const GBufferFile& file) {
  std::vector<Available> all;
  const auto add = [&](std::string_view plane, bool is_made) {
    const std::string name = pass_of(plane);
    if (channels_of(name).empty()) return;
    if (std::none_of(all.begin(), all.end(), [&](const Available& known) { return known.name == name; }))
      all.push_back({name, is_made});
  };
  for (const std::string& plane : file.plane_names()) add(plane, false);
  add("normal.x", false);  // reconstructed from depth if the files have none
  std::vector<PassEntry> listed;
  if (!recipe.effects_look) listed = passes_of_look(*recipe.look);
  for (const Effect* effect : steps_of(look_run(recipe)))
    for (const Dispatch& dispatch : effect->dispatches)
      for (const std::string_view plane : dispatch.outputs) {
        if (!dispatch.for_all || !runs(dispatch, params_of(recipe.settings, effect->name))) continue;
        // The other planes of a look are for its effects alone.
        if (recipe.effects_look || std::any_of(listed.begin(), listed.end(),
                                               [&](const PassEntry& entry) { return entry.name == pass_of(plane); }))
          add(plane, true);
      }
  return all;
}

/// The planes to write, and the passes that they belong to.
struct Chosen {
  std::vector<std::string> passes, planes;
};

/// Returns the requested passes; without any, those that effects make. Errors: kUsage for a pass that the picture does
/// not have.
Result<Chosen> chosen_passes(const ShadeOptions& o, const Recipe& recipe, const GBufferFile& file) {
  const auto available = available_passes(recipe, file);
  std::vector<std::string> words = o.request.passes;
  const bool all = words.size() == 1 && words[0] == "all";
  if (all || words.empty()) {
    words.clear();
    for (const Available& pass : available)
      if ((all || pass.is_made) && (!is_scene_linear(o) || pass.name != "beauty")) words.push_back(pass.name);
  }
  Chosen chosen;
  for (const std::string& word : words) {
    if (std::none_of(available.begin(), available.end(), [&](const Available& each) { return each.name == word; })) {
      std::vector<std::string> names;
      for (const Available& each : available) names.push_back(each.name);
      return field_error("passes", word, "there is no pass '{1}' in this picture{2}", suggestion(word, names));
    }
    if (contains(chosen.passes, word)) continue;
    chosen.passes.push_back(word);
    const std::string name = is_scene_linear(o) && word == "color" ? "beauty" : word;
    for (const std::string& channel : channels_of(name)) chosen.planes.push_back(name + channel);
  }
  return chosen;
}

/// Checks that effects that replace the look make the picture, unless the files have it. Errors: kUsage.
Result<void> check_picture(const Recipe& recipe, const GBufferFile& file, const std::vector<std::string>& planes) {
  if (!recipe.effects_look) return {};
  const auto available = available_passes(recipe, file);
  const std::string picture = pass_of(planes.front());
  if (std::any_of(available.begin(), available.end(), [&](const Available& pass) { return pass.name == picture; }))
    return {};
  const auto made =
      std::find_if(available.begin(), available.end(), [](const Available& pass) { return pass.is_made; });
  return field_error("effects", "", "these `{0}` make no picture: add the effect output{2}",
                     made == available.end() ? "" : fmt::format(", or write what they make: `passes` {}", made->name));
}

/// Returns the name of a plane as a layer of the merged file: "umbrage.ao", "umbrage.color.R".
std::string merged_name(std::string plane) {
  if (plane.size() > 2 && plane[plane.size() - 2] == '.') plane.back() = char(std::toupper(plane.back()));
  return "umbrage." + plane;
}

/// Returns whether the finished picture of another renderer has alpha, which its format can hold.
bool keeps_alpha(const Recipe& recipe, const GBufferFile& file, const Destination& destination) {
  const auto formats = image_formats();
  return recipe.look->needs_beauty && file.has_plane("beauty.a") && !destination.video &&
         std::any_of(formats.begin(), formats.end(), [&](const ImageFormat& format) {
           return format.extension == destination.extension() && format.alpha;
         });
}

/// What is written, and how.
struct Writing {
  const ShadeOptions& o;
  const GBufferFile& file;
  const Recipe& recipe;
  Destination destination;
  std::vector<std::string> planes;
};

/// Shades rows and passes them to `take`, converted for the file.
using ShadeRows = std::function<Result<void>(const TakeImageRows& take)>;

/// Shades all rows and returns them as one picture. Errors: those of `shade`.
Result<Image> whole_picture(const ShadeRows& shade, int height) {
  Image whole;
  int filled = 0;
  auto shaded = shade([&](const Image& rows) -> Result<void> {
    if (filled == 0) whole = Image(rows.width, height);
    for (std::size_t k = 0; k < rows.planes.size(); ++k) {
      if (filled == 0) whole.add(rows.names[k]) = Plane(rows.width, height);
      for (int y = 0; y < rows.height; ++y)
        std::copy_n(rows.planes[k].row(y), rows.width, whole.planes[k].row(filled + y));
    }
    filled += rows.height;
    return {};
  });
  return shaded ? Result<Image>(std::move(whole)) : shaded.error();
}

/// Adds the planes to a copy of the input.
Result<void> write_as_layers(const Writing& writing, const ShadeRows& shade) {
  const std::string base = writing.file.merge_base();
  if (base.empty())
    return field_error("--merge", true, "{} adds layers to a copy of an .exr file, and the input is none");
  const auto header = read_header(base);
  if (!header) return header.error();
  if (writing.o.request.gbuffer.reduction > 1)
    return field_error("reduction", "", "--merge needs a picture of the size of the input: leave out `{}`");
  auto layers = whole_picture(shade, writing.file.info().height);
  if (!layers) return layers.error();
  for (std::string& name : layers->names) name = merged_name(name);
  return write_merged(*header, *layers, writing.o.half, writing.destination.file);
}

/// Writes the planes to a file of their own.
Result<void> write_as_picture(const Writing& writing, const ShadeRows& shade, int threads) {
  const ShadeOptions& o = writing.o;
  const PictureInfo& info = writing.file.info();
  const int reduction = o.request.gbuffer.reduction;
  if (Video* video = writing.destination.video) {
    const auto picture = whole_picture(shade, info.height / reduction);
    return picture ? video->add(*picture) : picture.error();
  }
  // The conversion of a picture of one pixel yields the names of the planes in the file.
  Image pixel(1, 1);
  for (const std::string& name : writing.planes) pixel.add(name) = Plane(1, 1, 0.0f);
  const ImageShape shape{
      info.width / reduction, info.height / reduction,
      convert_for_file(o, writing.destination, pixel, writing.planes, writing.recipe.settings, info).names};
  const WriteSettings settings{.bits = o.bits(),
                               .half = o.half,
                               .quality = o.picture_quality,
                               .threads = threads,
                               .camera = &info.camera,
                               .view_from_world = nullptr};
  return write_rows(writing.destination, shape, settings, shade);
}

/// Returns whether a file name stands for several files, by frame.
bool is_pattern(const std::string& name) {
  std::error_code ignored;
  return !fs::exists(name, ignored) && has_frame_number(path_of(name));
}

/// Returns the names of a pattern "FILE" or "FILE:LAYER" without the layer. Errors: kUsage.
Result<FrameNames> names_of_pattern(const std::string& name) { return frame_names(path_of(name), "the input"); }

}  // namespace

std::string scratch_folder(const std::string& output) {
  std::error_code ignored;
  if (output.empty() || output == kStandardOutput) return fs::temp_directory_path(ignored).string();
  const fs::path folder = fs::path(output).parent_path();
  return folder.empty() ? "." : folder.string();
}

bool is_sequence(const GBufferSettings& settings) {
  return std::any_of(kFileFields.begin(), kFileFields.end(),
                     [&](auto field) { return std::ranges::any_of(component_files(settings.*field), is_pattern); });
}

GBufferSettings settings_of_frame(const GBufferSettings& settings, int frame) {
  GBufferSettings own = settings;
  for (const auto field : kFileFields) {
    std::vector<std::string> names = component_files(own.*field);
    for (std::string& name : names)
      if (is_pattern(name)) name = names_of_pattern(name)->of(frame) + name.substr(path_of(name).size());
    own.*field = fmt::format("{}", fmt::join(names, ","));
  }
  return own;
}

Result<SequenceFiles> input_files(const GBufferSettings& settings) {
  SequenceFiles files;
  for (const auto field : kFileFields) {
    for (const std::string& name : component_files(settings.*field)) {
      if (name.empty()) continue;
      if (!is_pattern(name)) {
        files.shared.emplace_back(path_of(name));
        continue;
      }
      auto names = names_of_pattern(name);
      if (!names) return names.error();
      files.inputs.push_back(std::move(*names));
    }
  }
  return files;
}

std::string path_of(const std::string& name) {
  std::error_code ignored;
  const std::size_t colon = name.rfind(':');
  return colon == std::string::npos || fs::exists(name, ignored) ? name : name.substr(0, colon);
}

Result<void> prepare_shading(ShadeOptions& o, const std::string& output) {
  const bool piped = output == kStandardOutput, video = is_video(output);
  if (piped)
    if (auto status = check_piped(o); !status) return status;
  if (video)
    if (auto status = check_video(output, video_settings(o, 0, 0)); !status) return status;
  if (is_page(output))
    return field_error("--output", output,
                       "umbrage shade writes no .svg, .pdf or .dxf: '{1}' must be a picture, such as .png");
  if (!piped)
    if (auto writable = check_writable(output); !writable) return with_field(writable.error(), "--output");
  const auto extension = piped   ? Result<std::string>("png")
                         : video ? Result<std::string>(lowercase_extension(output))
                                 : extension_of(output);
  if (!extension) return extension.error();
  if (o.merge && *extension != "exr")
    return field_error("--merge", true, "{0} writes an .exr file, not .{2}", *extension);
  o.request.values = values_for(o, video ? "png" : *extension);
  if (auto status = check_output(o, *extension); !status) return status;
  // Names of looks, techniques and settings do not depend on the files.
  const auto recipe = make_shading_recipe(o.request);
  return recipe ? Result<void>() : recipe.error();
}

Result<double> shading_bytes(const Device& device, const GBufferFile& file, const Recipe& recipe) {
  const auto plan = plan_file_strips(device, file, recipe, std::numeric_limits<double>::infinity());
  if (!plan) return plan.error();
  const PictureInfo& info = file.info();
  constexpr double kCopies = 2.0;  // planes as stored and as converted
  return plan->bytes + kCopies * sizeof(float) * double(file.plane_names().size()) * info.width * info.height;
}

Result<SequenceStart> shade_frame(const ShadeOptions& given, const ShadeFrame& frame, Device& device,
                                  StageTimes& times) {
  const auto file = GBufferFile::open(frame.gbuffer, frame.memory, scratch_folder(frame.output),
                                      frame.start ? frame.start->conventions.get() : nullptr);
  if (!file) return file.error();
  ShadeOptions o = given;
  o.request.gbuffer = frame.gbuffer;
  o.request.width = file->info().width;
  o.request.height = file->info().height;
  const auto made = make_file_recipe(o.request, *file);
  if (!made) return made.error();
  Recipe recipe = *made;
  times.done("read");
  if (frame.opened) frame.opened(*file, recipe);
  times.last = std::chrono::steady_clock::now();  // opened() may wait
  const Destination destination{frame.output, frame.video, {}};
  const bool writes = !frame.output.empty();
  Writing writing{o, *file, recipe, destination, {}};
  if (o.writes_passes() || o.merge) {
    const auto chosen = chosen_passes(o, recipe, *file);
    if (!chosen) return chosen.error();
    writing.planes = chosen->planes;
    recipe.passes = chosen->passes;
  } else if (writes) {
    writing.planes = picture_planes(o, destination);
    if (auto status = check_picture(recipe, *file, writing.planes); !status) return status.error();
    if (keeps_alpha(recipe, *file, destination) && !contains(writing.planes, "color.a") && !is_scene_linear(o))
      writing.planes.emplace_back("color.a");
  }
  SequenceStart used;
  const ShadeRows shade = [&](const TakeImageRows& take) {
    const auto take_rows = [&](const PictureInfo& info, const Image& rows, int) {
      if (!writes) return Result<void>();
      auto taken = take(convert_for_file(o, destination, rows, writing.planes, recipe.settings, info));
      times.done("write");
      return taken;
    };
    // Shading has its own guard, so that its exceptions are not reported as failures to write the file.
    return guarded(
        [&] { return fmt::format("{} x {} pixels; try a smaller --memory", o.request.width, o.request.height); },
        [&]() -> Result<void> {
          auto shaded =
              frame.steady
                  ? frame.steady->shade(frame.number, *file, recipe, writing.planes, take_rows,
                                        frame.start ? frame.start->stops : std::nullopt, times, frame.monitor)
                  : shade_file(device, *file, recipe, writing.planes, take_rows, frame.start, times, frame.monitor);
          if (!shaded) return shaded.error();
          used = *shaded;
          used.conventions = std::make_shared<Conventions>(file->conventions());
          return {};
        });
  };
  if (writes && destination.extension() != "exr")
    if (auto status = check_format(o, destination.extension()); !status) return status.error();
  auto written = !writes   ? shade([](const Image&) { return Result<void>(); })
                 : o.merge ? write_as_layers(writing, shade)
                           : write_as_picture(writing, shade, device.threads());
  times.done("write");
  if (!written) return written.error();
  return used;
}

}  // namespace umbrage::cli
