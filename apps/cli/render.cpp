// umbrage render: draws a model to a picture, a turntable or a video.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/cli/commands.h"
#include "apps/cli/frame_names.h"
#include "apps/cli/hints.h"
#include "apps/cli/line_file.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_options.h"
#include "apps/cli/standard_input.h"
#include "apps/cli/video.h"
#include "core/guarded.h"
#include "core/numbers.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "renderer/background.h"
#include "renderer/draw.h"
#include "renderer/lines.h"
#include "renderer/passes.h"
#include "renderer/setting_warnings.h"
#include "renderer/strips.h"
#include "scene/origin.h"

namespace umbrage::cli {
namespace {

/// Returns the planes of the requested passes. Errors: kUsage.
Result<std::vector<std::string>> pass_planes_of(const RenderOptions& o, const Device& device, const Frame& frame) {
  std::vector<std::string> words = o.request.passes;
  if (o.request.scene_linear) std::replace(words.begin(), words.end(), std::string("color"), std::string("beauty"));
  const auto chosen = chosen_planes(words, device.plane_names(frame), frame.info);
  if (!chosen) return chosen.error();
  std::vector<std::string> names;
  for (const PassPlanes& pass : *chosen)
    if (!o.request.scene_linear || pass.name != "color")
      names.insert(names.end(), pass.planes.begin(), pass.planes.end());
  return names;
}

/// Parses a number of bytes, such as "6G", "512M" or "100000". Errors: kUsage.
Result<double> parse_memory(std::string_view text) {
  constexpr std::string_view kUnits = "KMGT";
  const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
  const auto number = parse_number(text.substr(0, text.size() - (unit == std::string_view::npos ? 0 : 1)));
  if (!number || !(*number > 0.0))
    return usage_error(
        "--memory cannot be '{}': it takes a number of bytes, or a number followed by K, M, G or T, such as 6G", text);
  return unit == std::string_view::npos ? *number : *number * std::pow(1024.0, double(unit + 1));
}

Result<void> write_output(const RenderOptions& o, const Destination& destination, const EffectSettings& effect_settings,
                          const glm::dvec3& origin, Device& device, const Frame& frame) {
  const Camera camera = inner_camera(frame.info);
  const glm::dmat4 view = view_from_file(camera.view_from_world, origin);
  const WriteSettings settings{.bits = o.bits(),
                               .half = o.half,
                               .quality = o.picture_quality,
                               .threads = device.threads(),
                               .camera = &camera,
                               .view_from_world = &view};
  const auto names = o.writes_passes() ? pass_planes_of(o, device, frame)
                                       : Result<std::vector<std::string>>(picture_planes(o, destination));
  if (!names) return names.error();
  const auto image = download_passes(device, frame, *names);
  if (!image) return image.error();
  return write_picture(
      destination, convert_for_file(o, destination, *image, *names, effect_settings, destination.first_info), settings);
}

/// The files to write and the number of frames, checked before the model is read.
struct Output {
  int frames = 1;
  bool is_turntable = false, is_video = false;  ///< a video is a turntable, too
  FrameNames names;                             ///< file names of a turntable that is not a video
};

/// A command line whose options are checked and resolved, before the model is read.
struct RenderJob {
  Output output;
  LineFile lines;
  Recipe requested;  ///< recipe of all options, for warnings about unused settings
  Recipe recipe;     ///< recipe reduced to the planes that the output needs
  ImportSettings model_import;
  double memory = 0.0;
};

/// Returns the planes of the requested passes. Draws a small copy of the picture to find them.
Result<std::vector<std::string>> pass_planes(const RenderOptions& o, Device& device, const Scene& scene,
                                             const Plan& plan) {
  constexpr int kSmallSize = 16;  // width and height, pixels
  Request small = o.request;
  small.width = small.height = kSmallSize;
  auto recipe = make_recipe(small);
  if (!recipe) return recipe.error();
  recipe->hdri = plan.recipe.hdri;
  reduce_to_passes(*recipe);
  StageTimes times;
  const auto frame = draw(device, scene, *recipe, times);
  if (!frame) return frame.error();
  return pass_planes_of(o, device, *frame);
}

/// Draws the picture in strips directly into its file. Shows progress on `line`.
Result<void> draw_into_file(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                            const Plan& plan, int strip_rows, ProgressLine& line, StageTimes& times) {
  const Recipe& recipe = job.recipe;
  const LineFile& lines = job.lines;
  const Destination destination{o.output, nullptr, {}};
  auto names = lines.alone ? std::vector<std::string>() : picture_planes(o, destination);
  if (o.writes_passes()) {
    auto planes = pass_planes(o, device, scene, plan);
    if (!planes) return planes.error();
    names = std::move(*planes);
  }
  std::vector<std::string> wanted = names;
  for (const std::string& name : hint_planes(recipe))
    if (std::find(names.begin(), names.end(), name) == names.end()) wanted.push_back(name);
  // The conversion of a picture of one pixel yields the names of the planes in the file.
  Image pixel(1, 1);
  for (const std::string& name : wanted) pixel.add(name) = Plane(1, 1, 0.0f);
  const ImageShape shape{recipe.width, recipe.height,
                         convert_for_file(o, destination, pixel, names, recipe.settings, {}).names};
  HintStatistics statistics;
  Lines traced;
  const glm::dmat4 view = view_from_file(plan.camera.view_from_world, plan.origin);
  const WriteSettings settings{.bits = o.bits(),
                               .half = o.half,
                               .quality = o.picture_quality,
                               .threads = device.threads(),
                               .camera = &plan.camera,
                               .view_from_world = &view};
  const auto monitor = [&](double done) {
    line.show("drawing", done);
    return true;
  };
  const auto make = [&](const TakeImageRows& take) -> Result<void> {
    const auto take_rows = [&](const PictureInfo& info, const Image& rows, int) {
      statistics.add(rows.plane("depth"), rows.find("ao"));
      auto taken = take(convert_for_file(o, destination, rows, names, recipe.settings, info));
      times.done("write");
      return taken;
    };
    // The drawing has its own guard, so that its exceptions are not reported as failures to write the file.
    return guarded(
        [&] {
          return fmt::format("{} x {} pixels in strips; try a smaller --memory, --resolution or model", recipe.width,
                             recipe.height);
        },
        [&]() -> Result<void> {
          auto drawn = draw_strips(device, plan, strip_rows, wanted, bool(lines), take_rows, times, monitor);
          if (!drawn) return drawn.error();
          traced = std::move(*drawn);
          return {};
        });
  };
  auto written =
      lines.alone ? make([](const Image&) { return Result<void>(); }) : write_rows(destination, shape, settings, make);
  if (written && lines) written = write_lines(lines, traced);
  line.wipe();
  if (written) print_hints(recipe, statistics, scene);
  return written;
}

/// Returns the total time of each dispatch, sorted by the first run of each.
std::vector<DispatchTime> times_by_dispatch(const std::vector<DispatchTime>& dispatches) {
  std::vector<DispatchTime> sums;
  for (const DispatchTime& dispatch : dispatches) {
    const auto same = std::find_if(sums.begin(), sums.end(), [&](const DispatchTime& sum) {
      return sum.effect == dispatch.effect && sum.dispatch == dispatch.dispatch;
    });
    if (same == sums.end())
      sums.push_back(dispatch);
    else
      same->ms += dispatch.ms;
  }
  return sums;
}

void print_times(const StageTimes& times, const std::vector<DispatchTime>& dispatches, bool json) {
  if (!json) {
    for (const auto& stage : times.stages) fmt::print(stderr, "{:<12}{:9.1f} ms\n", stage.name, stage.ms);
    fmt::print(stderr, "{:<12}{:9.1f} ms\n", "total", times.total());
    for (const DispatchTime& dispatch : dispatches)
      fmt::print(stderr, "{:<34}{:9.3f} ms on the GPU\n", fmt::format("{} / {}", dispatch.effect, dispatch.dispatch),
                 dispatch.ms);
    return;
  }
  nlohmann::json records = nlohmann::json::array();
  for (const auto& stage : times.stages) records.push_back({{"stage", stage.name}, {"ms", stage.ms}});
  for (const DispatchTime& dispatch : dispatches)
    records.push_back({{"stage", dispatch.effect}, {"pass", dispatch.dispatch}, {"gpu_ms", dispatch.ms}});
  records.push_back({{"stage", "total"}, {"ms", times.total()}});
  fmt::print("{}\n", records.dump(2));
}

Result<Output> output_of(const RenderOptions& o) {
  Output output;
  const bool piped = o.output == kStandardOutput;
  if (piped && ::isatty(STDOUT_FILENO))
    return usage_error("-o - writes a PNG to standard output, which is a terminal: redirect it to a file or a program");
  if (piped && o.json) return usage_error("-o - and --json cannot both write to standard output");
  if (o.turntable == 0) {
    if (is_video(o.output) && !format_of(o.output))
      return usage_error("'{}' is a video, which needs several frames: give --turntable, such as --turntable 120",
                         o.output);
    if (piped) return output;
    if (auto writable = check_writable(o.output); !writable) return writable.error();
    if (const auto known = extension_of(o.output); !known) return known.error();
    return output;
  }
  output.frames = o.turntable;
  output.is_turntable = true;
  output.is_video = is_video(o.output);
  if (output.is_video) return output;
  if (piped)
    return usage_error("--turntable {} writes several pictures, and -o - takes one: name a file, such as turn.png",
                       o.turntable);
  auto names = frame_names(o.output);
  if (!names) return names.error();
  output.names = *names;
  for (const int frame : {0, output.frames - 1})
    if (auto writable = check_writable(names->of(frame)); !writable) return writable.error();
  if (const auto known = extension_of(names->of(0)); !known) return known.error();
  return output;
}

VideoSettings video_settings(const RenderOptions& o) {
  return {.width = o.request.width,
          .height = o.request.height,
          .frame_rate = o.frame_rate,
          .alpha = o.writes_passes() ? o.writes_only("outline") : o.request.transparent};
}

/// Draws and writes all frames.
Result<void> draw_frames(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                         const Plan& plan, StageTimes& times) {
  const Output& output = job.output;
  const LineFile& lines = job.lines;
  ProgressLine line;
  int frame_number = 0;
  const auto monitor = [&](double done) {
    line.show(output.frames == 1 ? "drawing" : fmt::format("drawing frame {} of {}", frame_number + 1, output.frames),
              (frame_number + done) / output.frames);
    return true;
  };
  const ScopedPlanePool kept(device.pool());
  std::unique_ptr<Video> video;
  Destination destination{o.output, nullptr, {}};
  if (output.is_video) {
    auto begun = Video::begin(o.output, video_settings(o));
    if (!begun) return begun.error();
    video = std::move(*begun);
    destination.video = video.get();
  }
  std::optional<float> stops;  // exposure of the first frame, used for all
  constexpr float kWholeTurnDeg = 360.0f;
  for (; frame_number < output.frames; ++frame_number) {
    const float angle_deg = kWholeTurnDeg * float(frame_number) / float(output.frames);
    const auto drawn = draw(device, scene, turned(plan, scene, angle_deg), times, monitor, stops);
    if (!drawn) return drawn.error();
    const Frame& frame = drawn->frame;
    stops = drawn->stops;
    if (frame_number == 0) {
      line.wipe();
      const auto planes = device.download(frame, hint_planes(job.recipe));
      if (!planes) return planes.error();
      HintStatistics statistics;
      statistics.add(planes->plane("depth"), planes->find("ao"));
      print_hints(job.recipe, statistics, scene);
      destination.first_info = frame.info;
    }
    if (output.is_turntable && !video) destination.file = output.names.of(frame_number);
    if (!lines.alone)
      if (auto written = write_output(o, destination, job.recipe.settings, scene.origin, device, frame); !written)
        return written;
    times.done("write");
    if (!lines) continue;
    if (auto written = write_lines(lines, frame_number, device, frame); !written) return written;
    times.done("lines");
  }
  if (!video) return {};
  line.show("finishing " + o.output);
  if (auto written = video->finish(); !written) return written;
  times.done("write");
  return {};
}

/// Checks that the file format supports the requested passes, bits and half floats. Errors: kUsage.
Result<void> check_output(const RenderOptions& o, const Output& output) {
  const std::string extension = output.is_video ? std::filesystem::path(o.output).extension().string().substr(1)
                                : o.output == kStandardOutput ? "png"
                                                              : *extension_of(o.output);
  if (extension != "exr" && (o.request.passes.size() > 1 || o.writes_only("all")))
    return usage_error("--passes {} needs a file that holds several passes: write to a name that ends in .exr",
                       o.text_of("passes"));
  if (o.bits() != 8 && extension != "png") return usage_error("--bits is for .png files, not .{}", extension);
  if (auto fine = check_format(o, extension); !fine) return fine;
  if (o.picture_quality != WriteSettings().quality && extension != "jpg" && extension != "jpeg" && extension != "webp")
    return usage_error("--picture-quality is for .jpg and .webp files, not .{}", extension);
  if (o.half && extension != "exr") return usage_error("--half is for .exr files, not .{}", extension);
  return {};
}

/// Sets what follows from the format of the file: a scene-linear picture in .exr, and the passes of the preset
/// `beauty`. Errors: kUsage.
Result<void> choose_picture(RenderOptions& o) {
  const auto extension =
      is_video(o.output) || o.output == kStandardOutput ? Result<std::string>("") : extension_of(o.output);
  o.request.scene_linear = extension && is_scene_linear(o, *extension);
  auto& passes = o.request.passes;
  const auto preset = std::find(passes.begin(), passes.end(), "beauty");
  if (preset == passes.end()) return {};
  const auto of_preset = beauty_passes(o.request);
  if (!of_preset) return of_preset.error();
  std::vector<std::string> all = *of_preset;
  for (const std::string& word : passes)
    if (word != "beauty" && std::find(of_preset->begin(), of_preset->end(), word) == of_preset->end())
      all.push_back(word);
  passes = std::move(all);
  return {};
}

/// Checks the options. Errors: kUsage; kFile for a file that cannot be written.
Result<RenderJob> make_job(const RenderOptions& o) {
  RenderJob job;
  const auto output = output_of(o);
  if (!output) return output.error();
  job.output = *output;
  auto lines = line_file_of(o, output->is_turntable ? output->frames : 0);
  if (!lines) return lines.error();
  job.lines = std::move(*lines);
  auto recipe = make_recipe(o.request, kMaxStripPixels);
  if (!recipe) return recipe.error();
  job.requested = job.recipe = std::move(*recipe);
  if (auto fine = check_output(o, *output); !fine) return fine.error();
  if (job.lines)
    if (auto taken = set_line_parameters(o, job.requested, job.lines); !taken) return taken.error();
  if (job.lines.alone) {
    Request of_lines = o.request;
    disable_unused_effects(of_lines);
    auto alone = make_recipe(of_lines, kMaxStripPixels);
    if (!alone) return alone.error();
    job.recipe = std::move(*alone);
    job.recipe.wanted = hint_planes(job.recipe);
    job.recipe.wanted->insert(job.recipe.wanted->end(), edge_planes().begin(), edge_planes().end());
  }
  reduce_to_passes(job.recipe, job.lines ? edge_planes() : std::span<const std::string_view>());
  if (output->is_video)
    if (auto fine = check_video(o.output, video_settings(o)); !fine) return fine.error();
  const auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  job.model_import = *import_with;
  return job;
}

/// Returns the strips that keep the picture within --memory. Switches to the CPU if `device` cannot draw strips and
/// --device is auto. Errors: kUsage for a picture that needs strips but cannot be drawn in strips.
Result<StripSizes> planned_strips(const RenderOptions& o, const RenderJob& job, std::unique_ptr<Device>& device) {
  const auto memory = parse_memory(o.memory);
  if (!memory) return memory.error();
  auto strips = plan_strips(*device, job.recipe, *memory);
  if (!strips && o.request.device == "auto" && !device->draws_strips()) {
    RenderOptions on_cpu = o;
    on_cpu.request.device = "cpu";
    auto other = device_of(on_cpu);
    if (!other) return other.error();
    device = std::move(*other);
    strips = plan_strips(*device, job.recipe, *memory);
  }
  if (!strips || strips->rows == 0) return strips;
  const auto too_large = [&](std::string_view what, std::string_view advice) {
    return usage_error("{} of {} x {} pixels needs more than --memory {}: {}", what, o.request.width, o.request.height,
                       o.memory, advice);
  };
  if (o.writes_only("all")) return too_large("--passes all", "name the passes, or raise --memory");
  if (job.output.is_turntable) return too_large("--turntable", "raise --memory, or lower --resolution");
  return strips;
}

/// Reads the environment map and the model. Prints their warnings and those about unused settings.
Result<Scene> read_scene(const RenderOptions& o, RenderJob& job, ProgressLine& line) {
  const auto warn = [&](const std::string& warning) {
    line.wipe();
    print_warning(warning);
  };
  if (!job.recipe.hdri.file.empty()) line.show("reading " + job.recipe.hdri.file);
  const auto hdri_warnings = read_hdri(job.recipe.hdri);
  if (!hdri_warnings) return hdri_warnings.error();
  for (const std::string& warning : *hdri_warnings) warn(warning);
  line.show("reading " + o.models[0]);
  auto scene = load_models(o.models, o.input_format, job.model_import);
  if (!scene) return scene;
  if (job.recipe.camera_index)
    if (auto used = use_camera(*job.recipe.camera_index, *scene); !used) return used.error();
  for (const std::string& warning : scene->warnings) warn(warning);
  // Warn only about settings on the command line: those of a configuration file may be for other looks.
  const auto is_on_command_line = [](std::string_view setting) {
    return command_line.find(setting) != std::string::npos;
  };
  for (const std::string& sentence : setting_warnings(o.request, job.requested, &*scene, is_on_command_line))
    warn(with_option_names(sentence));
  return scene;
}

Result<void> render(const RenderOptions& given) {
  RenderOptions o = given;
  choose_line_look(o);
  if (auto chosen = choose_picture(o); !chosen) return chosen;
  StageTimes times;
  auto job = make_job(o);
  if (!job) return job.error();
  auto opened = device_of(o);
  if (!opened) return opened.error();
  std::unique_ptr<Device> device = std::move(*opened);
  const auto strips = planned_strips(o, *job, device);
  if (!strips) return strips.error();

  std::optional<ProgressLine> line(std::in_place);
  auto scene = read_scene(o, *job, *line);
  if (!scene) return scene.error();
  times.done("load");
  const std::size_t meshes = scene->meshes.size();
  const std::string size = size_text(*scene);
  line->show("preparing " + scene->name);
  complete_scene(*scene, job->recipe);
  if (auto ready = device->prepare(*scene); !ready) return ready;
  const auto plan = make_plan(job->recipe, *scene, device->threads());
  if (!plan) return plan.error();
  line.reset();
  times.done("prepare");
  if (strips->exceeds)
    print_warning(fmt::format(
        "{} x {} pixels take about {:.2g} GB{}, more than --memory {}: raise it, or lower --resolution",
        o.request.width, o.request.height, strips->bytes * 1e-9, strips->rows > 0 ? ", even in strips" : "", o.memory));
  if (strips->rows > 0 && o.verbose)
    fmt::print(stderr,
               "drawn in strips of {} rows in about {:.1f} GB; the whole picture would need more than --memory {}\n",
               strips->rows, strips->bytes * 1e-9, o.memory);
  ProgressLine drawing;
  if (auto drawn = strips->rows > 0 ? draw_into_file(o, *job, *device, *scene, *plan, strips->rows, drawing, times)
                                    : draw_frames(o, *job, *device, *scene, *plan, times);
      !drawn)
    return drawn;
  drawing.wipe();
  if (o.verbose) fmt::print(stderr, "{}: {} in {} meshes\n{}\n", scene->name, size, meshes, device->description());
  if (o.verbose || o.json) print_times(times, times_by_dispatch(device->take_dispatch_times()), o.json);
  return {};
}

}  // namespace

void add_render(CLI::App& app, std::function<Result<void>()>& run) {
  const auto [command, options] = add_model_command(app, run, "render", "draw a model to a file", kRender, render);
  for (const char* group : {"Technique", "Picture", "Light"}) add_group(*command, *options, kRender, group);
  const auto output = "Output";
  command
      ->add_option("-o,--output", options->output,
                   "file to write: .png, .jpg, .webp, .exr or .pfm; .svg for only the lines, by default those of the "
                   "look cartoon; "
                   "- for a PNG on standard output; with --turntable also .mp4, .webm or .gif")
      ->required()
      ->group(output);
  command->add_option("--svg", options->svg, "also write the look's lines as curves to this .svg file")->group(output);
  add_one(*command, *options, "passes", output);
  add_number(*command, "--turntable", options->turntable, {1, 100000, NumberKind::kInteger},
             "number of frames for one turn of the model, written as turn_0000.png and so on, or as a video",
             "one picture")
      ->group(output);
  add_number(*command, "--frame-rate", options->frame_rate, {0.1, 1000}, "frames per second of a video")->group(output);
  add_one(*command, *options, "bits", output);
  add_number(*command, "--picture-quality", options->picture_quality, {1, 100, NumberKind::kInteger},
             "quality of a .jpg or .webp, 1 to 100; a .webp of 100 is lossless")
      ->group(output);
  command->add_flag("--half", options->half, "16-bit floats in an EXR, for planes for which their precision suffices")
      ->group(output);
  CLI::Option* memory = command->add_option(
      "--memory", options->memory,
      fmt::format("approximate memory limit, such as 6G or 500M; a picture that needs more is drawn in strips [{}]",
                  options->memory));
  memory->group(output);
  add_check(*memory, [](const std::string& text) -> Result<void> {
    const auto bytes = parse_memory(text);
    return bytes ? Result<void>() : bytes.error();
  });
  command->add_flag("--json", options->json, "print the time of each stage as JSON")->group(output);
  add_device_options(*command, *options, kRender);
}

}  // namespace umbrage::cli
