// umbrage render: draws a model to a picture, a turntable or a video.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "apps/cli/commands.h"
#include "apps/cli/frame_names.h"
#include "apps/cli/hints.h"
#include "apps/cli/line_file.h"
#include "apps/cli/output.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_frames.h"
#include "apps/cli/render_options.h"
#include "apps/cli/render_time.h"
#include "apps/cli/sheet.h"
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
#include "scene/scene.h"

namespace umbrage::cli {
namespace {

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
                               .dpi = o.figure.dpi,
                               .quality = o.picture_quality,
                               .threads = device.threads(),
                               .camera = &plan.camera,
                               .view_from_world = &view};
  const auto monitor = [&](double done) {
    line.show("drawing", done);
    return true;
  };
  const auto legends = make_legends(o, scene, plan.camera, recipe);
  if (!legends) return legends.error();
  const auto make = [&](const TakeImageRows& take) -> Result<void> {
    const auto take_rows = [&](const PictureInfo& info, const Image& rows, int first) {
      statistics.add(rows.plane("depth"), rows.find("ao"));
      auto taken = take(
          drawn_over(convert_for_file(o, destination, rows, names, recipe.settings, info), legends->pixels, first));
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
  if (written && lines) written = write_lines(lines, traced, plan.camera, *legends);
  if (written) written = write_legends(o, *legends, recipe);
  line.wipe();
  if (written) print_hints(recipe, statistics, scene);
  return written;
}

/// Sets what follows from the format of the file: a scene-linear picture in .exr, and the passes of the preset
/// `beauty`. Errors: kUsage.
Result<void> choose_picture(RenderOptions& o) {
  const auto extension = is_video(o.output) || o.output == kStandardOutput || is_page(o.output)
                             ? Result<std::string>("png")
                             : extension_of(o.output);
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

/// Warns if --steady on the command line does nothing. Errors: kUsage if the picture is no sequence.
Result<void> check_steady(const RenderOptions& o, const Output& output, const Recipe& recipe) {
  if (o.steady == 0 || o.sequence.command->count("--steady") == 0) return {};
  if (!output.is_moving())
    return field_error("--steady", o.steady, "{} {} is for --turntable, --camera-path or --animate");
  if (!recipe.is_steady)
    print_warning(fmt::format("--steady {} joins no occlusion: {}", o.steady,
                              !find_effect(recipe.occlusion)
                                  ? "the picture has none"
                                  : fmt::format("the technique {} has no noise, or is averaged over several samples of "
                                                "a pixel",
                                                recipe.occlusion)));
  return {};
}

/// Checks the options. Errors: kUsage; kFile for a file that cannot be written.
Result<RenderJob> make_job(const RenderOptions& o) {
  RenderJob job;
  const auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  job.model_import = *import_with;
  if (o.animates && !job.model_import.animation_index) job.model_import.animation_index = 0;
  auto output = output_of(o, job.model_import);
  if (!output) return output.error();
  if (!output->is_moving()) job.model_import.fitted_px = fitted_px(o.request);
  auto lines = line_file_of(o, output->is_moving() ? output->count : 0);
  if (!lines) return lines.error();
  job.lines = std::move(*lines);
  const auto memory = parse_memory(o.memory);
  if (!memory) return memory.error();
  job.memory = *memory;
  constexpr double kBytes = 4.0;  // of a pixel of legends, and of the notes of a sheet
  if (!is_page(o.output) && (o.figure.legend.any() || !o.views.empty()))
    job.memory -= kBytes * o.request.width * o.request.height;
  auto recipe = make_recipe(o.request, kMaxStripPixels);
  if (!recipe) return recipe.error();
  recipe->is_steady = output->is_moving() && o.steady > 0 && can_be_steady(*recipe);
  if (auto checked = check_steady(o, *output, *recipe); !checked) return checked.error();
  job.steady = o.steady;
  if (o.figure.legend_file.empty())
    recipe->framing.free_space = legend_space(o.figure.legend, o.request.width, o.request.height);
  job.requested = job.recipe = std::move(*recipe);
  const std::string extension = output->is_video ? std::filesystem::path(o.output).extension().string().substr(1)
                                : o.output == kStandardOutput ? "png"
                                                              : *extension_of(o.output);
  if (auto status = check_output(o, extension); !status) return status.error();
  if (job.lines)
    if (auto taken = set_line_parameters(o, job.requested, job.lines); !taken) return taken.error();
  if (job.lines.alone) {
    Request of_lines = o.request;
    disable_unused_effects(job.lines, of_lines);
    auto alone = make_recipe(of_lines, kMaxStripPixels);
    if (!alone) return alone.error();
    alone->framing.free_space = job.recipe.framing.free_space;
    alone->lines_apart = job.lines.fill.has_value();
    job.recipe = std::move(*alone);
  }
  const bool has_passes = !job.recipe.passes.empty();
  const auto hints = has_passes ? std::vector<std::string>() : hint_planes(job.recipe);
  std::vector<std::string_view> besides(hints.begin(), hints.end());
  const auto edges = edge_planes(job.lines.params, *layer_count(job.recipe.capture));
  besides.insert(besides.end(), edges.begin(), edges.end());
  const auto fills = fill_planes(job.lines);
  besides.insert(besides.end(), fills.begin(), fills.end());
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
  job.output = std::move(*output);
  if (job.output.path) job.output.path->set_camera(0.0, job.recipe.framing);
  if (!job.output.is_sequence()) return job;
  SequenceFiles files;
  files.shared.assign(o.models.begin(), o.models.end());
  files.shared.emplace_back(o.request.hdri_file);
  files.shared.emplace_back(o.camera_path);
  if (!job.lines.alone) files.outputs.push_back(job.output.names);
  if (job.lines) files.outputs.push_back(job.lines.names);
  auto sequence = plan_sequence(o.sequence, files, job.output.frames);
  if (!sequence) return sequence.error();
  job.output.sequence = std::move(*sequence);
  return job;
}

/// Returns the strips that keep the picture within --memory. Switches to the CPU if `device` cannot draw strips and
/// --device is auto. Errors: kUsage for a picture that needs strips but cannot be drawn in strips.
Result<StripSizes> planned_strips(const RenderOptions& o, RenderJob& job, const Plan& plan,
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
  if (strips && strips->rows == 0 && job.recipe.is_steady) {
    while (job.steady > 0 && strips->bytes + steady_memory(plan, job.steady) > job.memory) --job.steady;
    if (job.steady < o.steady)
      print_warning(
          fmt::format("--steady {} of {} x {} pixels needs about {:.2g} GB, more than --memory {}: --steady {} is used",
                      o.steady, o.request.width, o.request.height,
                      (strips->bytes + steady_memory(plan, o.steady)) * 1e-9, o.memory, job.steady));
    if (o.verbose && job.steady > 0)
      fmt::print(stderr, "{} frames are joined, in about {:.0f} MB\n", 2 * job.steady + 1,
                 steady_memory(plan, job.steady) * 1e-6);
  }
  if (!strips || strips->rows == 0) return strips;
  const auto too_large = [&](std::string_view option, std::string_view value, std::string_view advice) {
    return with_field(field_error(option, value, "{}{} of {} x {} pixels needs more than --memory {}: {}",
                                  o.request.width, o.request.height, o.memory, advice),
                      "--memory", o.memory);
  };
  if (job.lines.fill) return too_large("--areas", " " + o.figure.fill, "raise --memory, or lower --resolution");
  if (o.writes_only("all")) return too_large("--passes", " all", "name the passes, or raise --memory");
  if (is_page(o.output) && !job.lines.alone)
    return too_large("--output", fmt::format(" '{}'", o.output),
                     "raise --memory, or write a .png, which can be drawn in strips");
  if (o.time_s > 0.0) return too_large("--time", "", "raise --memory, or lower --resolution");
  if (job.output.is_moving()) return too_large(job.output.option(), "", "raise --memory, or lower --resolution");
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
  int objects = 0;  // of the model; those of caps follow
  for (const Mesh& mesh : scene->meshes) objects = std::max(objects, mesh.object + 1);
  const std::size_t printed = scene->warnings.size();
  if (auto done = complete_scene(*scene, job.recipe); !done) return done;
  for (std::size_t k = printed; k < scene->warnings.size(); ++k) {
    line->wipe();
    print_warning(scene->warnings[k]);
  }
  if (scene->ground_object == objects) ++objects;
  for (const Mesh& mesh : scene->meshes)
    if (mesh.object >= objects && mesh.object != scene->ground_object)
      job.lines.style.caps[mesh.object] = (mesh.object - objects) / 2;  // a cap has two
  if (!o.views.empty()) {
    if (auto ready = device->prepare(*scene); !ready) return ready;
    line.reset();
    times.done("prepare");
    return draw_sheet(o, job, *device, *scene, times);
  }
  const auto plan = make_plan(job.recipe, *scene, device->threads());
  if (!plan) return plan.error();
  const auto strips = planned_strips(o, job, *plan, device);
  if (!strips) return strips.error();
  if (auto ready = device->prepare(*scene); !ready) return ready;
  line.reset();
  print_line_notes(job.lines, plan->camera);
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
    if (auto applied = apply_figure_options(each); !applied) return applied;
    if (auto applied = apply_sheet_options(each); !applied) return applied;
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
    auto loaded = load_same_view(o.models, jobs[0].model_import, o.turntable > 0 ? &jobs[0].recipe.framing : nullptr,
                                 jobs[0].recipe.values ? &*jobs[0].recipe.values : nullptr);
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
  for (const char* group : {"Values", "Sections", "Technique", "Picture", "Light"})
    add_group(*command, *options, kRender, group);
  constexpr double kMinTime_s = 0.001, kMaxTime_s = 7.0 * 24.0 * 3600.0;
  add_number(*command, "--time", options->time_s, {kMinTime_s, kMaxTime_s},
             "seconds for drawing: adds pictures to the average while they fit", "none")
      ->group("Picture");
  const auto output = "Output";
  command
      ->add_option(
          "-o,--output", options->output,
          "file to write: .png, .jpg, .webp, .exr or .pfm; .svg, .pdf or .dxf for only the lines, by default those of "
          "the look cartoon, or .svg or .pdf for a picture without lines or with --color-by; - for a PNG on standard "
          "output; with --turntable, --camera-path or --animate also .mp4, .webm or .gif")
      ->type_name("FILE")
      ->required()
      ->group(output);
  command
      ->add_option("--svg,--drawing", options->svg,
                   "also write the look's lines as curves to this .svg, .pdf or .dxf file")
      ->type_name("FILE")
      ->group(output);
  add_frame_options(*command, *options);
  command
      ->add_flag("--same-view", options->same_view,
                 "draw each model alone, with one camera, ground and exposure, to --output 'out/{stem}.png', where "
                 "{stem} is the name of the model")
      ->group(output);
  add_frame_rate(*command, options->frame_rate);
  add_output_options(*command, *options,
                     "approximate memory limit, such as 6G or 500M; a picture that needs more is drawn in strips");
  add_figure_options(*command, options->figure);
  add_sheet_options(*command, *options);
  add_device_options(*command, *options, kRender);
}

}  // namespace umbrage::cli
