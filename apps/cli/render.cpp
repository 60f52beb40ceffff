// umbrage render: draws a model to a picture, a turntable or a video.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <mutex>
#include <numeric>

#include "apps/cli/commands.h"
#include "apps/cli/frame_names.h"
#include "apps/cli/hints.h"
#include "apps/cli/line_file.h"
#include "apps/cli/output.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_options.h"
#include "apps/cli/render_time.h"
#include "apps/cli/standard_input.h"
#include "apps/cli/video.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "renderer/draw.h"
#include "renderer/passes.h"
#include "renderer/recipe.h"
#include "renderer/steady.h"
#include "renderer/strips.h"
#include "renderer/strokes.h"
#include "renderer/written_passes.h"
#include "scene/scene.h"

namespace umbrage::cli {
namespace {

/// The files to write and the number of frames, checked before the model is read.
struct Output {
  int frames = 1;
  bool is_turntable = false, is_video = false;  ///< a video is a turntable, too
  FrameNames names;                             ///< file names of a turntable that is not a video
  Sequence sequence;                            ///< frames of a turntable that is not a video

  bool is_sequence() const { return is_turntable && !is_video; }
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

/// Draws the picture in strips directly into its file. Shows progress on `line`.
Result<void> draw_into_file(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                            const Plan& plan, int strip_rows, ProgressLine& line, StageTimes& times) {
  const Recipe& recipe = job.recipe;
  const LineFile& lines = job.lines;
  const Destination destination{o.output, nullptr, {}};
  auto names = lines.alone ? std::vector<std::string>() : picture_planes(o, destination);
  if (o.writes_passes()) {
    auto planes = pass_planes_of(o, planes_of_frame(plan), plan.info);
    if (!planes) return planes.error();
    names = std::move(*planes);
  }
  std::vector<std::string> wanted = names;
  for (const std::string& name : hint_planes(recipe))
    if (!contains(names, name)) wanted.push_back(name);
  // The conversion of a picture of one pixel yields the names of the planes in the file.
  Image pixel(1, 1);
  for (const std::string& name : wanted) pixel.add(name) = Plane(1, 1, 0.0f);
  const ImageShape shape{recipe.width, recipe.height,
                         convert_for_file(o, destination, pixel, names, recipe.settings, {}).names};
  HintStatistics statistics;
  Strokes traced;
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
          auto strokes = draw_strips(device, plan, strip_rows, wanted, bool(lines), take_rows, times, monitor);
          if (!strokes) return strokes.error();
          traced = std::move(*strokes);
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

Result<Output> output_of(const RenderOptions& o) {
  Output output;
  const bool piped = o.output == kStandardOutput;
  if (piped)
    if (auto status = check_piped(o); !status) return status.error();
  if ((o.turntable == 0 || is_video(o.output)) && (!o.sequence.shard.empty() || o.sequence.overwrite))
    return field_error(o.sequence.overwrite ? "--overwrite" : "--shard", "",
                       "{} is for the numbered pictures of --turntable");
  if (o.turntable == 0) {
    if (is_video(o.output) && !format_of(o.output))
      return field_error("--output", o.output,
                         "'{1}' is a video, which needs several frames: give --turntable, such as --turntable 120");
    if (piped) return output;
    if (has_frame_number(o.output))
      print_warning(
          fmt::format("'{}' is one picture of this name: numbers in names are for frames of --turntable", o.output));
    if (auto writable = check_writable(o.output); !writable) return with_field(writable.error(), "--output");
    if (const auto known = extension_of(o.output); !known) return known.error();
    return output;
  }
  output.frames = o.turntable;
  output.is_turntable = true;
  output.is_video = is_video(o.output);
  if (output.is_video) return output;
  if (piped)
    return field_error("--turntable", o.turntable,
                       "{} {} writes several pictures, and -o - takes one: name a file, such as turn.png");
  auto names = frame_names(o.output, "--output");
  if (!names) return with_field(names.error(), "--output");
  output.names = *names;
  for (const int frame : {0, output.frames - 1})
    if (auto writable = check_writable(names->of(frame)); !writable) return with_field(writable.error(), "--output");
  if (const auto known = extension_of(names->of(0)); !known) return known.error();
  return output;
}

/// What all frames of a model need.
struct Drawing {
  const RenderOptions& o;
  const RenderJob& job;
  Device& device;
  const Scene& scene;
  const Plan& plan;
  SteadyFrames frames;
  SteadySequence sequence;
  Destination destination;          ///< of the first frame
  std::optional<float> stops = {};  ///< exposure of the first frame, used for all
  bool is_first = true;
  std::mutex mutex = {};  ///< guards the device and the members above it
};

/// Returns the frames of a turntable.
SteadyFrames frames_of(const RenderOptions& o, const RenderJob& job, const Scene& scene, const Plan& first) {
  SteadyFrames frames{.reach = o.steady, .end = job.output.frames, .is_closed = true};
  frames.plan = [&, count = job.output.frames](int frame) {
    constexpr float kWholeTurnDeg = 360.0f;
    Plan plan = turned(first, scene, kWholeTurnDeg * float(frame) / float(count));
    if (plan.recipe.is_steady) plan.first_noise += frame * plan.recipe.frames;  // noise moves, so that it averages out
    return plan;
  };
  return frames;
}

/// Draws a frame.
Result<Drawn> draw_of_frame(Drawing& all, const FrameTask& task, StageTimes& times, TimedSamples& timed) {
  const ProgressMonitor monitor = timed.monitor();
  if (all.plan.recipe.is_steady && task.writes)
    return all.sequence.draw(task.frame, times, monitor, all.stops, timed.continuation());
  return draw(all.device, all.scene, all.frames.plan(task.frame), times, monitor, all.stops, timed.continuation());
}

/// Draws a frame and writes its files. While one thread writes, another can draw.
Result<void> draw_frame(Drawing& all, const FrameTask& task, StageTimes& times) {
  const RenderOptions& o = all.o;
  const RenderJob& job = all.job;
  std::unique_lock lock(all.mutex);
  times.last = std::chrono::steady_clock::now();
  const ScopedPlanePool kept(all.device.pool());
  TimedSamples timed(o.time_s, task.monitor);
  const auto picture = draw_of_frame(all, task, times, timed);
  if (!picture) return picture.error();
  if (o.time_s > 0.0 && o.verbose) {
    task.wipe_progress();
    fmt::print(stderr, "{}\n", timed.summary(all.plan));
  }
  const Frame& frame = picture->frame;
  all.stops = picture->stops;
  if (all.is_first) {
    const auto planes = all.device.view(frame, hint_planes(job.recipe));
    if (!planes) return planes.error();
    HintStatistics statistics;
    statistics.add(planes->plane("depth"), planes->find("ao"));
    task.wipe_progress();
    print_hints(job.recipe, statistics, all.scene);
    all.destination.first_info = frame.info;
    all.is_first = false;
  }
  if (!task.writes) return {};
  if (job.lines) {
    if (auto written = write_lines(job.lines, task.frame, all.device, frame); !written) return written;
    times.done("lines");
  }
  if (job.lines.alone) return {};
  Destination destination = all.destination;
  if (job.output.is_sequence()) destination.file = job.output.names.of(task.frame);
  const auto names = o.writes_passes() ? pass_planes_of(o, all.device.plane_names(frame), frame.info)
                                       : Result<std::vector<std::string>>(picture_planes(o, destination));
  if (!names) return names.error();
  const auto image = download_passes(all.device, frame, *names);
  if (!image) return image.error();
  lock.unlock();
  const Camera camera = inner_camera(frame.info);
  const glm::dmat4 view = view_from_file(camera.view_from_world, all.scene.origin);
  const WriteSettings settings{.bits = o.bits(),
                               .half = o.half,
                               .quality = o.picture_quality,
                               .threads = all.device.threads(),
                               .camera = &camera,
                               .view_from_world = &view};
  auto written = write_picture(
      destination, convert_for_file(o, destination, *image, *names, job.recipe.settings, destination.first_info),
      settings);
  times.done("write");
  return written;
}

/// Draws a picture, or the frames of a video one after the other.
Result<void> draw_in_order(Drawing& all, Video* video, StageTimes& times) {
  ProgressLine line;
  const int frames = all.job.output.frames;
  all.destination.video = video;
  for (int frame = 0; frame < frames; ++frame) {
    const auto monitor = [&](double done) {
      line.show(frames == 1 ? "drawing" : fmt::format("drawing frame {} of {}", frame + 1, frames),
                (frame + done) / frames);
      return true;
    };
    const FrameTask task{.frame = frame, .monitor = monitor, .wipe_progress = [&] { line.wipe(); }};
    if (auto status = draw_frame(all, task, times); !status) return status;
  }
  if (!video) return {};
  line.show("finishing " + all.o.output);
  if (auto written = video->finish(); !written) return written;
  times.done("write");
  return {};
}

/// Draws and writes all frames.
Result<void> draw_frames(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                         const Plan& plan, StageTimes& times) {
  const ScopedPlanePool kept(device.pool());
  const SteadyFrames frames = frames_of(o, job, scene, plan);
  Drawing all{o, job, device, scene, plan, frames, {device, scene, frames}, {o.output, nullptr, {}}};
  if (!job.output.is_turntable) return draw_in_order(all, nullptr, times);
  if (job.output.is_video) {
    auto video = Video::begin(o.output, video_settings(o, o.request.width, o.request.height));
    return video ? draw_in_order(all, video->get(), times) : Result<void>(video.error());
  }
  constexpr int kWorkers = 3;  // one draws with all threads while the others write
  std::vector<StageTimes> times_of(kWorkers);
  const auto make = [&](const FrameTask& task) { return draw_frame(all, task, times_of[std::size_t(task.worker)]); };
  auto made = make_sequence(job.output.sequence,
                            {.activity = "drawing", .verbose = o.verbose, .make = make, .start_workers = [] {
                               return Result<int>(kWorkers);
                             }});
  for (const StageTimes& worker : times_of) add_times(times, worker);
  return made;
}

/// Sets what follows from the format of the file: a scene-linear picture in .exr, and the passes of the preset
/// `beauty`. Errors: kUsage.
Result<void> choose_picture(RenderOptions& o) {
  const auto extension =
      is_video(o.output) || o.output == kStandardOutput ? Result<std::string>("png") : extension_of(o.output);
  if (extension) o.request.values = values_for(o, *extension);
  auto& passes = o.request.passes;
  const auto preset = std::find(passes.begin(), passes.end(), "beauty");
  if (preset == passes.end()) return {};
  const auto of_preset = beauty_passes(o.request);
  if (!of_preset) return of_preset.error();
  std::vector<std::string> all = *of_preset;
  for (const std::string& word : passes)
    if (word != "beauty" && !contains(*of_preset, word)) all.push_back(word);
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
  const auto memory = parse_memory(o.memory);
  if (!memory) return memory.error();
  job.memory = *memory;
  auto recipe = make_recipe(o.request, kMaxStripPixels);
  if (!recipe) return recipe.error();
  const Effect* technique = find_effect(recipe->occlusion);  // the others have no noise that could flicker
  recipe->is_steady = output->is_turntable && o.steady > 0 && technique && !technique->noise.empty();
  job.requested = job.recipe = std::move(*recipe);
  const std::string extension = output->is_video ? std::filesystem::path(o.output).extension().string().substr(1)
                                : o.output == kStandardOutput ? "png"
                                                              : *extension_of(o.output);
  if (auto status = check_output(o, extension); !status) return status.error();
  if (job.lines)
    if (auto taken = set_line_parameters(o, job.requested, job.lines); !taken) return taken.error();
  if (job.lines.alone) {
    Request of_lines = o.request;
    disable_unused_effects(job.lines.params, of_lines);
    auto alone = make_recipe(of_lines, kMaxStripPixels);
    if (!alone) return alone.error();
    job.recipe = std::move(*alone);
  }
  const bool has_passes = !job.recipe.passes.empty();
  const auto hints = has_passes ? std::vector<std::string>() : hint_planes(job.recipe);
  std::vector<std::string_view> besides(hints.begin(), hints.end());
  const auto edges = edge_planes(job.lines.params, *layer_count(job.recipe.capture));
  besides.insert(besides.end(), edges.begin(), edges.end());
  if (job.lines.alone && !has_passes)
    reduce_to_planes(job.recipe, {besides.begin(), besides.end()});
  else
    reduce_to_passes(job.recipe, besides);
  if (o.time_s > 0.0 && (job.lines.alone || job.recipe.frames == 1))
    return field_error("--time", o.time_s, "{0} averages several pictures, but {2} are not averaged: leave out --time",
                       job.lines.alone ? "lines" : "these --passes");
  if (output->is_video)
    if (auto status = check_video(o.output, video_settings(o, o.request.width, o.request.height)); !status)
      return status.error();
  const auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  job.model_import = *import_with;
  if (!output->is_sequence()) return job;
  SequenceFiles files;
  files.shared.assign(o.models.begin(), o.models.end());
  files.shared.emplace_back(o.request.hdri_file);
  if (!job.lines.alone) files.outputs.push_back(output->names);
  if (job.lines) files.outputs.push_back(job.lines.names);
  std::vector<int> range(std::size_t(output->frames));
  std::iota(range.begin(), range.end(), 0);
  auto sequence = plan_sequence(o.sequence, files, std::move(range));
  if (!sequence) return sequence.error();
  job.output.sequence = std::move(*sequence);
  return job;
}

/// Returns the strips that keep the picture within --memory. Switches to the CPU if `device` cannot draw strips and
/// --device is auto. Errors: kUsage for a picture that needs strips but cannot be drawn in strips.
Result<StripSizes> planned_strips(const RenderOptions& o, const RenderJob& job, const Plan& plan,
                                  std::unique_ptr<Device>& device) {
  auto strips = plan_strips(*device, plan, job.memory);
  if (!strips && o.request.device == "auto" && !device->draws_strips()) {
    RenderOptions on_cpu = o;
    on_cpu.request.device = "cpu";
    auto other = device_of(on_cpu);
    if (!other) return other.error();
    device = std::move(*other);
    strips = plan_strips(*device, plan, job.memory);
  }
  if (!strips || strips->rows == 0) return strips;
  const auto too_large = [&](std::string_view option, std::string_view value, std::string_view advice) {
    return with_field(field_error(option, value, "{}{} of {} x {} pixels needs more than --memory {}: {}",
                                  o.request.width, o.request.height, o.memory, advice),
                      "--memory", o.memory);
  };
  if (o.writes_only("all")) return too_large("--passes", " all", "name the passes, or raise --memory");
  if (o.time_s > 0.0) return too_large("--time", "", "raise --memory, or lower --resolution");
  if (job.output.is_turntable) return too_large("--turntable", "", "raise --memory, or lower --resolution");
  return strips;
}

/// Reads the environment map and the model. Prints their warnings and those about unused settings. `same_view`: see
/// load_same_view; null: the model has its own view.
Result<Scene> read_scene(const RenderOptions& o, RenderJob& job, const std::shared_ptr<const Scene>& same_view,
                         ProgressLine& line) {
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
  if (same_view) set_same_view(same_view, *scene);
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

/// Draws the model or models of one command line, and writes the picture or pictures.
Result<void> render_scene(const RenderOptions& o, RenderJob& job, const std::shared_ptr<const Scene>& same_view,
                          std::unique_ptr<Device>& device, StageTimes& times) {
  std::optional<ProgressLine> line(std::in_place);
  auto scene = read_scene(o, job, same_view, *line);
  if (!scene) return scene.error();
  times.done("load");
  const std::size_t meshes = scene->meshes.size();
  const std::string size = size_text(*scene);
  line->show("preparing " + scene->name);
  complete_scene(*scene, job.recipe);
  const auto plan = make_plan(job.recipe, *scene, device->threads());
  if (!plan) return plan.error();
  const auto strips = planned_strips(o, job, *plan, device);
  if (!strips) return strips.error();
  if (auto ready = device->prepare(*scene); !ready) return ready;
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
  if (o.verbose)
    for (const OperationText& each : described(program_of(*plan)))
      fmt::print(stderr, "  {}: {}\n", each.name, each.summary);
  ProgressLine drawing;
  if (auto status = strips->rows > 0 ? draw_into_file(o, job, *device, *scene, *plan, strips->rows, drawing, times)
                                     : draw_frames(o, job, *device, *scene, *plan, times);
      !status)
    return status;
  drawing.wipe();
  if (o.verbose) fmt::print(stderr, "{}: {} in {} meshes\n{}\n", scene->name, size, meshes, device->description());
  return {};
}

Result<void> render(const RenderOptions& o) {
  auto all = options_by_model(o);
  if (!all) return all.error();
  StageTimes times;
  std::vector<RenderJob> jobs;
  for (RenderOptions& each : *all) {
    choose_line_look(each);
    if (auto chosen = choose_picture(each); !chosen) return chosen;
    if (auto chosen = choose_samples(each); !chosen) return chosen;
    auto job = make_job(each);
    if (!job) return job.error();
    jobs.push_back(std::move(*job));
  }
  const auto is_done = [](const RenderJob& job) { return job.output.is_sequence() && job.output.sequence.own.empty(); };
  for (const RenderJob& job : jobs)
    if (is_done(job)) print_kept(job.output.sequence);
  if (std::all_of(jobs.begin(), jobs.end(), is_done)) return {};
  auto device = device_of(o);
  if (!device) return device.error();
  std::shared_ptr<const Scene> same_view;
  if (o.same_view) {
    auto loaded = load_same_view(o.models, jobs[0].model_import, o.turntable > 0 ? &jobs[0].recipe.framing : nullptr);
    if (!loaded) return loaded.error();
    same_view = std::move(*loaded);
    for (const std::string& warning : same_view->warnings) print_warning(warning);
    times.done("load");
  }
  for (std::size_t k = 0; k < jobs.size(); ++k)
    if (!is_done(jobs[k]))
      if (auto drawn = render_scene((*all)[k], jobs[k], same_view, *device, times); !drawn) return drawn;
  const auto dispatches = (*device)->finish();
  if (!dispatches) return dispatches.error();
  if (o.verbose || o.json) print_times(times, times_by_dispatch(*dispatches), o.json);
  return {};
}

}  // namespace

void add_render(CLI::App& app, std::function<Result<void>()>& run) {
  const auto [command, options] = add_model_command(app, run, "render", "draw a model to a file", kRender, render);
  for (const char* group : {"Technique", "Picture", "Light"}) add_group(*command, *options, kRender, group);
  constexpr double kMinTime_s = 0.001, kMaxTime_s = 7.0 * 24.0 * 3600.0;
  add_number(*command, "--time", options->time_s, {kMinTime_s, kMaxTime_s},
             "seconds for drawing: adds pictures to the average while they fit", "none")
      ->group("Picture");
  const auto output = "Output";
  command
      ->add_option("-o,--output", options->output,
                   "file to write: .png, .jpg, .webp, .exr or .pfm; .svg for only the lines, by default those of the "
                   "look cartoon; - for a PNG on standard output; with --turntable also .mp4, .webm or .gif")
      ->type_name("FILE")
      ->required()
      ->group(output);
  command->add_option("--svg", options->svg, "also write the look's lines as curves to this .svg file")
      ->type_name("FILE")
      ->group(output);
  add_number(*command, "--turntable", options->turntable, {1, 100000, NumberKind::kInteger},
             "number of frames for one turn of the model, written as turn_0000.png and so on, or as a video",
             "one picture")
      ->group(output);
  add_number(*command, "--steady", options->steady, {0, 8, NumberKind::kInteger},
             "frames before and after each frame of a turntable whose occlusion and indirect light it shares, so that "
             "their noise does not flicker; 0: none",
             "3")
      ->group(output);
  command
      ->add_flag("--same-view", options->same_view,
                 "draw each model alone, with one camera, ground and exposure, to --output 'out/{stem}.png', where "
                 "{stem} is the name of the model")
      ->group(output);
  add_sequence_options(*command, options->sequence, false);
  add_frame_rate(*command, options->frame_rate);
  add_output_options(*command, *options,
                     "approximate memory limit, such as 6G or 500M; a picture that needs more is drawn in strips");
  add_device_options(*command, *options, kRender);
}

}  // namespace umbrage::cli
