#include "apps/cli/render_frames.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>

#include "apps/cli/frame_range.h"
#include "apps/cli/hints.h"
#include "apps/cli/output.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_time.h"
#include "apps/cli/standard_input.h"
#include "core/lists.h"
#include "io/image_file.h"
#include "renderer/key_lines.h"
#include "renderer/moving.h"
#include "renderer/passes.h"
#include "renderer/steady.h"
#include "renderer/written_passes.h"
#include "scene/scene.h"

namespace umbrage::cli {
namespace {

constexpr int kMaxFramesOfMotion = 100000;

/// Sets the name and the length of the motion. Errors: kUsage; kFile.
Result<void> set_motion_of(const RenderOptions& o, const ImportSettings& settings, Output& output) {
  output.motion = o.turntable > 0          ? Motion::kTurntable
                  : !o.camera_path.empty() ? Motion::kPath
                  : o.animates             ? Motion::kAnimation
                                           : Motion::kNone;
  double duration_s = 0.0;
  if (!o.camera_path.empty()) {
    const CameraSettings& camera = o.request.camera;
    if (camera.position || camera.focal_point || camera.direction || camera.index)
      return field_error("--camera-path", "",
                         "{} gives position and focal point: leave out --camera-position, "
                         "--camera-focal-point, --camera-direction and --camera-index");
    auto path = CameraPath::read(o.camera_path);
    if (!path) return with_field(path.error(), "--camera-path", o.camera_path);
    duration_s = path->duration_s();
    output.path = std::move(*path);
  }
  if (o.animates) {
    if (contains(o.models, "-"))
      return field_error("--animate", "", "{} reads the model again for each frame: give a file in place of -");
    if (o.models.size() > 1)
      return field_error("--animate", "", "{0} draws the animation of one model, and {2} are given", o.models.size());
    if (o.same_view) return field_error("--animate", "", "{} excludes --same-view");
    if (o.request.animation_time) return field_error("--animate", "", "{} draws all times: leave out --animation-time");
    ImportSettings any = settings;
    any.animation_index = o.request.animation_index;
    const auto scene = load_models(o.models, o.input_format, any);
    if (!scene) return scene.error();
    if (scene->animation_durations_s.empty())
      return field_error("--animate", "", "{0} needs an animation, and '{2}' has none", scene->name);
    const auto index = std::size_t(settings.animation_index.value_or(0));
    output.duration_s = scene->animation_durations_s.at(index);
    duration_s = output.duration_s;
    if (!(duration_s > 0.0))
      return field_error("--animate", "", "{0} needs an animation, and '{2}' has no length",
                         scene->animation_names.at(index));
  }
  // A frame at the end, too, if it falls on one, whatever the rounding.
  const double count = o.turntable > 0 ? o.turntable : std::floor(duration_s * o.frame_rate + 1e-6) + 1.0;
  if (count > kMaxFramesOfMotion)
    return field_error("--frame-rate", o.frame_rate,
                       "{0} {1} makes {2:.0f} frames of {3:g} s; at most {4} can be drawn", count, duration_s,
                       kMaxFramesOfMotion);
  output.count = int(count);
  return {};
}

/// Checks a single picture's name. Errors: kUsage; kFile if it cannot be written.
Result<void> check_picture_name(const RenderOptions& o) {
  if (is_video(o.output) && !format_of(o.output))
    return field_error("--output", o.output,
                       "'{1}' is a video, which needs several frames: give --turntable, such as --turntable 120, "
                       "--camera-path or --animate");
  if (o.output == kStandardOutput) return {};
  if (has_frame_number(o.output))
    print_warning(fmt::format(
        "'{}' is one picture of this name: numbers in names are for frames of --turntable, --camera-path or --animate",
        o.output));
  if (auto writable = check_writable(o.output); !writable) return with_field(writable.error(), "--output");
  const auto known = extension_of(o.output);
  return known ? Result<void>() : known.error();
}

/// Sets the frames to draw: those of --frames, or all. Errors: kUsage.
Result<void> set_frames(const RenderOptions& o, Output& output) {
  output.frames.resize(std::size_t(output.count));
  std::iota(output.frames.begin(), output.frames.end(), 0);
  if (o.sequence.frames.empty()) return {};
  auto frames = parse_frames(o.sequence.frames);
  if (!frames) return frames.error();
  if (frames->back() >= output.count)
    return field_error("--frames", o.sequence.frames, "{0} {1}: {2} makes the frames 0 to {3}", output.option(),
                       output.count - 1);
  output.frames = std::move(*frames);
  return {};
}

/// What all frames of a model need.
struct FrameDrawing {
  const RenderOptions& o;
  const RenderJob& job;
  Device& device;
  const Scene& scene;
  const Plan& plan;
  Destination destination;                    ///< of the first frame
  std::function<Plan(int pose)> pose = {};    ///< of a turntable or camera path
  std::vector<int> pose_of_frame = {};        ///< of a camera path
  std::optional<KeyLines> key_lines = {};     ///< of the poses, if frames are steady
  std::optional<SteadySequence> steady = {};  ///< of the poses or the animation, if frames are joined
  std::shared_ptr<const Scene> moved = {};    ///< of the frame of an animation, if they are not
  std::optional<float> stops = {};            ///< exposure of the first frame, used for all
  bool is_first = true;
  std::mutex mutex = {};  ///< guards the device and the members above it
};

/// Returns the seconds after the start of the motion.
double time_of(const RenderOptions& o, int frame) { return double(frame) / o.frame_rate; }

/// Sets the framing of each pose of a camera path. Returns the pose of each frame: while the camera stands still,
/// frames have one.
std::vector<int> find_poses(const RenderOptions& o, const Output& output, const Framing& framing,
                            std::vector<Framing>& poses) {
  std::vector<int> pose_of_frame;
  for (int frame = 0; frame < output.count; ++frame) {
    Framing pose = framing;
    output.path->set_camera(time_of(o, frame), pose);
    const bool stands = !poses.empty() && pose.position == poses.back().position &&
                        pose.focal_point == poses.back().focal_point && pose.view_up == poses.back().view_up &&
                        pose.view_angle_deg == poses.back().view_angle_deg;
    if (!stands) poses.push_back(std::move(pose));
    pose_of_frame.push_back(int(poses.size()) - 1);
  }
  return pose_of_frame;
}

/// Returns what returns the plan of a pose of a turntable or camera path. `first`: the plan of pose 0.
std::function<Plan(int pose)> poses_of(const RenderOptions& o, const RenderJob& job, const Scene& scene, Plan first,
                                       std::vector<Framing> path) {
  const bool turns = job.output.motion == Motion::kTurntable;
  const auto pose_of = [=, &scene, count = job.output.count, path = std::move(path)](const Plan& plan, int pose) {
    constexpr float kWholeTurnDeg = 360.0f;
    return turns ? turned(plan, scene, kWholeTurnDeg * float(pose) / float(count))
                 : seen_from(plan, scene, path[std::size_t(pose)]);
  };
  // No frame repeats the noise of another.
  const int stride = o.time_s > 0.0 ? kMaxProgressiveSamples : first.recipe.frames;
  return plans_of_sequence(std::move(first), stride, pose_of);
}

/// Returns a frame of an animation, for which it reads the model again. `lighting`: for models without lights.
Result<MovingFrame> animated_frame(const RenderOptions& o, const RenderJob& job, const Lighting& lighting, int threads,
                                   int frame) {
  ImportSettings settings = job.model_import;
  settings.animation_time = std::min(float(time_of(o, frame)), job.output.duration_s);
  auto loaded = load_models(o.models, o.input_format, settings);
  if (!loaded) return loaded.error();
  if (job.recipe.camera_index)
    if (auto used = use_camera(*job.recipe.camera_index, *loaded); !used) return used.error();
  Recipe recipe = job.recipe;
  if (loaded->lights.empty()) recipe.capture.lighting = lighting;
  if (auto done = complete_scene(*loaded, recipe); !done) return done.error();
  const auto scene = std::make_shared<const Scene>(std::move(*loaded));
  auto plan = make_plan(recipe, *scene, threads);
  if (!plan) return plan.error();
  return MovingFrame{scene, std::move(*plan)};
}

/// Draws a frame of an animation by itself.
Result<Drawn> draw_animated(FrameDrawing& all, int frame, StageTimes& times, TimedSamples& timed) {
  auto moved = animated_frame(all.o, all.job, *all.plan.capture.lighting, all.device.threads(), frame);
  if (!moved) return moved.error();
  all.device.release_scene();
  all.moved = std::move(moved->scene);
  if (auto ready = all.device.prepare(*all.moved, timed.monitor()); !ready) return ready.error();
  times.done("prepare");
  return draw(all.device, *all.moved, moved->plan, times, timed.monitor(), all.stops, timed.continuation());
}

/// Returns the plan of a pose, with lines that stay on surfaces.
Result<Plan> plan_with_lines(FrameDrawing& all, int pose, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = all.pose(pose);
  const auto still = [&](double) { return !monitor || monitor(0.0); };
  if (all.key_lines)
    if (auto done = all.key_lines->complete(pose, plan, times, still); !done) return done.error();
  return plan;
}

/// Draws a frame.
Result<Drawn> draw_of_frame(FrameDrawing& all, const FrameTask& task, StageTimes& times, TimedSamples& timed) {
  const ProgressMonitor monitor = timed.monitor();
  if (!all.job.output.is_moving())
    return draw(all.device, all.scene, all.plan, times, monitor, all.stops, timed.continuation());
  const int pose = all.pose_of_frame.empty() ? task.frame : all.pose_of_frame[std::size_t(task.frame)];
  if (all.steady && task.writes) return all.steady->draw(pose, times, monitor, all.stops, timed.continuation());
  if (all.job.output.motion == Motion::kAnimation) return draw_animated(all, task.frame, times, timed);
  const auto plan = task.writes ? plan_with_lines(all, pose, times, monitor) : Result<Plan>(all.pose(pose));
  if (!plan) return plan.error();
  return draw(all.device, all.scene, *plan, times, monitor, all.stops, timed.continuation());
}

/// Draws a frame and writes its files. While one thread writes, another can draw.
Result<void> draw_frame(FrameDrawing& all, const FrameTask& task, StageTimes& times) {
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
  const Camera camera = inner_camera(frame.info);
  const auto legends = make_legends(o, all.scene, camera, job.recipe);
  if (!legends) return legends.error();
  if (job.lines) {
    if (auto written = write_lines(job.lines, task.frame, all.device, frame, *legends); !written) return written;
    times.done("lines");
  }
  if (job.lines.alone) return write_legends(o, *legends, job.recipe);
  Destination destination = all.destination;
  if (job.output.is_sequence()) destination.file = job.output.names.of(task.frame);
  const auto names = o.writes_passes() ? pass_planes_of(o, all.device.plane_names(frame), frame.info)
                                       : Result<std::vector<std::string>>(picture_planes(o, destination));
  if (!names) return names.error();
  const auto image = download_passes(all.device, frame, *names);
  if (!image) return image.error();
  lock.unlock();
  const glm::dmat4 view = view_from_file(camera.view_from_world, all.scene.origin);
  const WriteSettings settings{.bits = o.bits(),
                               .half = o.half,
                               .dpi = o.figure.dpi,
                               .quality = o.picture_quality,
                               .threads = all.device.threads(),
                               .camera = &camera,
                               .view_from_world = &view};
  Image shown = convert_for_file(o, destination, *image, *names, job.recipe.settings, destination.first_info);
  auto written = is_page(destination.file)
                     ? write_page(destination.file, legends->page_of(shown, o.figure.mm_per_pixel()))
                     : write_picture(destination, drawn_over(std::move(shown), legends->pixels, 0), settings);
  if (written && task.frame == job.output.frames.front()) written = write_legends(o, *legends, job.recipe);
  times.done("write");
  return written;
}

/// Draws a picture, or the frames of a video one after the other.
Result<void> draw_in_order(FrameDrawing& all, Video* video, StageTimes& times) {
  ProgressLine line;
  const std::size_t count = all.job.output.frames.size();
  all.destination.video = video;
  for (std::size_t k = 0; k < count; ++k) {
    const int frame = all.job.output.frames[k];
    const auto monitor = [&](double done) {
      line.show(count == 1 ? "drawing" : fmt::format("drawing frame {} of {}", k + 1, count),
                (double(k) + done) / double(count));
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

}  // namespace

void add_frame_options(CLI::App& command, RenderOptions& options) {
  const auto output = "Output";
  CLI::Option* turntable =
      add_number(command, "--turntable", options.turntable, {1, kMaxFramesOfMotion, NumberKind::kInteger},
                 "number of frames for one turn of the model, written as turn_0000.png and so on, or as a video",
                 "one picture")
          ->group(output);
  CLI::Option* path =
      command
          .add_option("--camera-path", options.camera_path,
                      "move the camera through the key cameras of this .csv or .json file: columns position_x, _y, _z, "
                      "focal_point_x, _y, _z, and if wanted time (seconds), up_x, _y, _z, view_angle")
          ->type_name("FILE")
          ->group(output)
          ->excludes(turntable);
  command
      .add_flag("--animate", options.animates,
                "draw the animation of the file, the first one unless --animation-index is given")
      ->group(output)
      ->excludes(turntable)
      ->excludes(path);
  add_number(command, "--steady", options.steady, {0, 8, NumberKind::kInteger},
             "frames before and after each frame of a sequence whose occlusion, indirect light and soft shadows it "
             "shares, so that their noise does not flicker; 0: none, and each frame has lines of its own",
             "3")
      ->group(output);
  add_sequence_options(command, options.sequence, true);
}

Result<Output> output_of(const RenderOptions& o, const ImportSettings& settings) {
  Output output;
  const bool piped = o.output == kStandardOutput;
  if (piped)
    if (auto status = check_piped(o); !status) return status.error();
  if (auto found = set_motion_of(o, settings, output); !found) return found.error();
  output.is_video = output.is_moving() && is_video(o.output);
  for (const auto& [option, is_given] : {std::pair("--shard", !o.sequence.shard.empty()),
                                         {"--overwrite", o.sequence.overwrite},
                                         {"--frames", !o.sequence.frames.empty() && !output.is_moving()}})
    if (is_given && !output.is_sequence() && !(output.is_video && option == std::string_view("--frames")))
      return field_error(option, "", "{} is for the numbered pictures of --turntable, --camera-path or --animate");
  if (!output.is_moving()) {
    const auto status = check_picture_name(o);
    return status ? Result<Output>(std::move(output)) : status.error();
  }
  if (auto status = set_frames(o, output); !status) return status.error();
  if (output.is_video) return output;
  if (piped)
    return field_error(output.option(), "",
                       "{} writes several pictures, and -o - takes one: name a file, such as turn.png");
  auto names = frame_names(o.output, "--output");
  if (!names) return with_field(names.error(), "--output");
  output.names = *names;
  for (const int frame : {output.frames.front(), output.frames.back()})
    if (auto writable = check_writable(names->of(frame)); !writable) return with_field(writable.error(), "--output");
  if (const auto known = extension_of(names->of(0)); !known) return known.error();
  return output;
}

Result<void> draw_frames(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                         const Plan& plan, StageTimes& times) {
  const ScopedPlanePool kept(device.pool());
  FrameDrawing all{o, job, device, scene, plan, {o.output, nullptr, {}}};
  if (job.output.motion == Motion::kTurntable || job.output.path) {
    std::vector<Framing> path;
    if (job.output.path) all.pose_of_frame = find_poses(o, job.output, job.recipe.framing, path);
    const int count = job.output.path ? int(path.size()) : job.output.count;
    all.pose = poses_of(o, job, scene, plan, std::move(path));
    if (o.steady > 0) all.key_lines.emplace(device, all.pose, count, !job.output.path);
    if (job.recipe.is_steady) {
      SteadyFrames frames = frames_of_still_scene(device, scene, all.pose);
      frames.draw_rest = [&all](int pose, const Frame& technique, StageTimes& used, const ProgressMonitor& monitor,
                                std::optional<float> stops, const Continuation& more) -> Result<Drawn> {
        const auto of_frame = plan_with_lines(all, pose, used, monitor);
        if (!of_frame) return of_frame.error();
        return draw_after_technique(all.device, all.scene, *of_frame, technique, used, monitor, stops, more);
      };
      frames.reach = job.steady;
      frames.count = count;
      frames.is_closed = !job.output.path;
      all.steady.emplace(device, std::move(frames));
    }
  }
  if (job.output.motion == Motion::kAnimation && job.recipe.is_steady) {
    SteadyFrames frames = frames_of_moving_scene(device, plan.recipe, job.steady,
                                                 [&o, &job, lighting = *plan.capture.lighting, &device](int frame) {
                                                   return animated_frame(o, job, lighting, device.threads(), frame);
                                                 });
    frames.count = job.output.count;
    all.steady.emplace(device, std::move(frames));
  }
  if (!job.output.is_moving()) return draw_in_order(all, nullptr, times);
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

}  // namespace umbrage::cli
