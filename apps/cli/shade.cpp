// umbrage shade: draws pictures from the planes of another renderer, one or a sequence of them.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <list>
#include <mutex>
#include <set>

#include "apps/cli/commands.h"
#include "apps/cli/frame_range.h"
#include "apps/cli/output.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/shade_frame.h"
#include "apps/cli/standard_input.h"
#include "gbuffers/conventions.h"
#include "gbuffers/roles.h"
#include "renderer/recipe.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStandardInput = "-";

/// Checks that the output is not one of the inputs. Errors: kUsage.
Result<void> check_inputs_remain(const GBufferSettings& settings, const std::string& output) {
  for (const auto field : kFileFields)
    for (const std::string& name : component_files(settings.*field))
      if (!name.empty())
        if (auto status = check_input_remains(path_of(name), output); !status) return status;
  return {};
}

/// Prints what was understood about G-buffers: warnings, and with --verbose the facts. Of sequences, whose frames
/// differ by numbers alone, each sentence appears once.
class FactPrinter {
 public:
  explicit FactPrinter(bool verbose) : verbose_(verbose) {}
  void print(const GBufferFile& file, const std::function<void()>& wipe_progress) {
    const std::lock_guard lock(mutex_);
    for (const std::string& line : file.facts().lines) tell(line, wipe_progress);
    for (const std::string& sentence : file.facts().warnings) warn(sentence, wipe_progress);
  }
  /// Prints a fact with --verbose.
  void tell(const std::string& line, const std::function<void()>& wipe_progress) {
    if (!verbose_ || !is_new(line)) return;
    wipe_progress();
    fmt::print(stderr, "{}\n", with_option_names(line));
  }
  void warn(const std::string& sentence, const std::function<void()>& wipe_progress) {
    if (!is_new(sentence)) return;
    wipe_progress();
    print_warning(sentence);
  }

 private:
  bool is_new(std::string sentence) {
    // Sentences of several frames that differ in measured numbers are one, but not those that name a frame.
    if (!sentence.starts_with("after frame")) std::erase_if(sentence, [](char c) { return c >= '0' && c <= '9'; });
    return printed_.insert(std::move(sentence)).second;
  }

  bool verbose_;
  std::mutex mutex_;
  std::set<std::string> printed_;
};

/// Warns about settings on the command line that do nothing.
void warn_unused(const ShadeOptions& o, const Recipe& recipe, FactPrinter& printer,
                 const std::function<void()>& wipe_progress) {
  const auto is_on_command_line = [](std::string_view setting) {
    return command_line.find(setting) != std::string::npos;
  };
  Request request = o.request;
  request.layers = 1;  // that of the file
  for (const std::string& sentence : setting_warnings(request, recipe, nullptr, is_on_command_line))
    printer.warn(sentence, wipe_progress);
}

Result<void> shade_one(ShadeOptions& o, double memory) {
  if (!o.sequence.frames.empty() || !o.sequence.shard.empty())
    return field_error(!o.sequence.frames.empty() ? "--frames" : "--shard", "",
                       "{} is for a sequence: give an input such as shot.####.exr");
  if (o.sequence.command->count("--steady") > 0 && o.steady > 0)
    return field_error("--steady", o.steady, "{} {} is for a sequence: give an input such as shot.####.exr");
  if (has_frame_number(o.output))
    return field_error("--output", o.output,
                       "{} '{}' has a frame number, and the input has none: give an input such as shot.####.exr, or an "
                       "output such as out.png");
  if (is_video(o.output))
    return field_error("--output", o.output,
                       "'{1}' is a video, which needs several frames: give an input such as shot.####.exr");
  if (auto status = prepare_shading(o, o.output); !status) return status;
  if (auto status = check_inputs_remain(o.request.gbuffer, o.output); !status) return status;
  StageTimes times;
  const auto device = device_of(o);
  if (!device) return device.error();
  ProgressLine line;
  line.show("reading " + o.file);
  FactPrinter printer(o.verbose);
  const auto wipe = [&] { line.wipe(); };
  ShadeFrame frame{.gbuffer = o.request.gbuffer, .output = o.output, .memory = memory, .start = {}};
  frame.monitor = [&](double done) {
    line.show("shading", done);
    return true;
  };
  frame.opened = [&](const GBufferFile& file, const Recipe& recipe) {
    printer.print(file, wipe);
    warn_unused(o, recipe, printer, wipe);
  };
  const auto shaded = shade_frame(o, frame, **device, times);
  line.wipe();
  if (!shaded) return shaded.error();
  if (o.verbose) fmt::print(stderr, "{}\n", (*device)->description());
  const auto dispatches = (*device)->finish();
  if (!dispatches) return dispatches.error();
  if (o.verbose || o.json) print_times(times, times_by_dispatch(*dispatches), o.json);
  return {};
}

/// What the frames of a sequence share.
struct ShadeSequence {
  const ShadeOptions& o;
  FrameNames outputs;
  double memory = 0.0;       ///< of all frames together, bytes
  double frame_bytes = 0.0;  ///< of one frame
  bool in_memory = true;     ///< frames fit in memory as a whole
  int workers = 1;
  std::vector<std::unique_ptr<Device>> devices;  ///< one for each worker, or one for all
  std::vector<std::mutex> device_mutexes;
  std::list<PlanePoolLock> pools;  ///< keep the memory of one frame for the next
  std::vector<StageTimes> times;   ///< of each worker
  std::optional<SequenceStart> start;
  FactPrinter printer;
  std::unique_ptr<Video> video = nullptr;           ///< if not null, receives the frames in place of files
  std::vector<int> numbers = {};                    ///< of all frames that have files, also beside those to make
  std::vector<int> shaded = {};                     ///< of those to make
  std::unique_ptr<SteadyShading> steady = nullptr;  ///< if not null, joins frames
};

/// Decides by the first frame whether frames are joined, and begins with it. Returns what it takes. Errors: kFile;
/// kUsage.
Result<std::optional<SequenceStart>> begin_joining(ShadeSequence& all, const FrameTask& task) {
  all.steady.reset();
  std::optional<SequenceStart> none;
  int reach = all.o.steady;
  if (reach == 0) return none;
  const auto open = [&all](int number, const Conventions* first) {
    return GBufferFile::open(settings_of_frame(all.o.request.gbuffer, number), all.memory, scratch_folder(all.o.output),
                             first);
  };
  const auto file = open(task.frame, nullptr);
  if (!file) return file.error();
  const auto recipe = make_file_recipe(all.o.request, *file);
  if (!recipe) return recipe.error();
  if (!can_be_steady(*recipe)) return none;
  if (file->conventions().motion.empty() && !file->conventions().has_place) {
    const std::string why =
        "frames are not joined: the files have neither motion vectors nor the place of the camera, by which surfaces "
        "are found in the frames beside";
    if (all.o.sequence.command->count("--steady") > 0) all.printer.warn(why, task.wipe_progress);
    all.printer.tell(why, task.wipe_progress);
    return none;
  }
  const auto strips = plan_file_strips(*all.devices[0], *file, *recipe, all.memory);
  const auto bytes = shading_bytes(*all.devices[0], *file, *recipe);
  if (!strips || !bytes) return strips ? bytes.error() : strips.error();
  while (reach > 0 && (strips->rows > 0 || *bytes + window_memory(*file, reach) > all.memory)) --reach;
  if (reach < all.o.steady)
    all.printer.warn(
        fmt::format("--steady {} of {} x {} pixels needs about {:.2g} GB, more than --memory {}: --steady {} is used",
                    all.o.steady, file->info().width, file->info().height,
                    (*bytes + window_memory(*file, all.o.steady)) * 1e-9, all.o.memory, reach),
        task.wipe_progress);
  if (reach == 0) return none;
  all.printer.print(*file, task.wipe_progress);
  ShadedFrames frames{.numbers = all.numbers, .shaded = all.shaded, .open = open, .warn = {}, .reach = reach};
  frames.warn = [&all, wipe = task.wipe_progress](const std::string& sentence) { all.printer.warn(sentence, wipe); };
  all.steady = std::make_unique<SteadyShading>(*all.devices[0], std::move(frames));
  auto start = all.steady->begin(task.frame, *file);
  return start ? Result<std::optional<SequenceStart>>(std::move(*start)) : start.error();
}

Result<void> shade_task(ShadeSequence& all, const FrameTask& task) {
  std::optional<SequenceStart> begun = all.start;
  if (!begun) {
    auto joining = begin_joining(all, task);
    if (!joining) return joining.error();
    begun = std::move(*joining);
  }
  const std::size_t own = std::size_t(task.worker) % all.devices.size();
  ShadeFrame frame{.gbuffer = settings_of_frame(all.o.request.gbuffer, task.frame),
                   .output = all.video     ? all.o.output
                             : task.writes ? all.outputs.of(task.frame)
                                           : "",
                   .video = all.video.get(),
                   .memory = all.memory / all.workers,
                   .start = begun,
                   .steady = all.steady.get(),
                   .number = task.frame,
                   .monitor = task.monitor};
  std::unique_lock lock(all.device_mutexes[own], std::defer_lock);
  const ScopedPlanePool kept(all.devices[own]->pool());
  std::optional<Error> failure;
  frame.opened = [&](const GBufferFile& file, const Recipe& recipe) {
    all.printer.print(file, task.wipe_progress);
    if (!all.start) {
      warn_unused(all.o, recipe, all.printer, task.wipe_progress);
      const auto bytes = shading_bytes(*all.devices[own], file, recipe);
      if (bytes) all.frame_bytes = *bytes;
      all.in_memory = file.is_in_memory();
    }
    if (!all.steady) lock.lock();
  };
  const auto shaded = shade_frame(all.o, frame, *all.devices[own], all.times[std::size_t(task.worker)]);
  if (!shaded) return shaded.error();
  if (!all.start) all.start = *shaded;
  return {};
}

/// Returns the number of frames that are shaded at once, with a device for each of them on the CPU.
Result<int> start_workers(ShadeSequence& all) {
  constexpr int kJoining = 3;  // one shades with all threads while the others read and write
  if (all.video) return 1;     // frames are added in order
  if (all.steady) {
    all.workers = kJoining;
    all.times.resize(kJoining);
    return kJoining;
  }
  const int threads = all.devices[0]->threads();
  const double fitting = all.in_memory && all.frame_bytes > 0.0 ? all.memory / all.frame_bytes : 1.0;
  all.workers = int(std::clamp(fitting, 1.0, double(threads)));
  auto devices = worker_devices(all.o, std::size_t(all.workers));
  if (!devices) return devices.error();
  all.devices = std::move(*devices);
  all.device_mutexes = std::vector<std::mutex>(all.devices.size());
  for (const auto& device : all.devices) all.pools.emplace_back(device->pool());
  all.times.resize(std::size_t(all.workers));
  return all.workers;
}

Result<void> shade_sequence(ShadeOptions& o, double memory) {
  if (o.output == kStandardOutput)
    return usage_error("-o - takes one picture, and a sequence has several: name files, such as out.####.png");
  const auto outputs = frame_names(o.output, "--output");
  if (!outputs) return with_field(outputs.error(), "--output");
  auto files = input_files(o.request.gbuffer);
  if (!files) return files.error();
  const bool video = is_video(o.output);
  files->reach = o.steady;
  if (video && (!o.sequence.shard.empty() || o.sequence.overwrite))
    return field_error(o.sequence.overwrite ? "--overwrite" : "--shard", "", "{} is for numbered pictures");
  if (video)
    o.sequence.overwrite = true;
  else
    files->outputs = {*outputs};
  const auto sequence = plan_sequence(o.sequence, *files, {});
  if (!sequence) return sequence.error();
  if (video && !sequence->missing.empty())
    return file_error("'{}' cannot be written: these frames have no input: {}", o.output,
                      frames_text(sequence->missing));
  if (auto status = prepare_shading(o, video ? o.output : outputs->of(sequence->all.front())); !status) return status;
  auto device = device_of(o);
  if (!device) return device.error();
  ShadeSequence all{.o = o,
                    .outputs = *outputs,
                    .memory = memory,
                    .devices = {},
                    .device_mutexes = std::vector<std::mutex>(1),
                    .pools = {},
                    .times = std::vector<StageTimes>(1),
                    .start = {},
                    .printer = FactPrinter(o.verbose)};
  all.devices.push_back(std::move(*device));
  all.numbers = files->inputs.front().existing();
  std::erase_if(all.numbers, [&](int number) { return !has_inputs(*files, number); });
  all.shaded = sequence->own;
  if (video) {
    auto begun = Video::begin(o.output, video_settings(o, 0, 0));
    if (!begun) return begun.error();
    all.video = std::move(*begun);
  }
  auto made = make_sequence(*sequence, {.activity = "shading",
                                        .verbose = o.verbose,
                                        .needs_all = video,
                                        .make = [&](const FrameTask& task) { return shade_task(all, task); },
                                        .start_workers = [&] { return start_workers(all); }});
  if (made && video) made = all.video->finish();
  StageTimes times;
  for (const StageTimes& worker : all.times) add_times(times, worker);
  if (o.verbose) fmt::print(stderr, "{}, {} frames at once\n", all.devices[0]->description(), all.workers);
  if (made && (o.verbose || o.json)) print_times(times, {}, o.json);
  return made;
}

Result<void> shade(const ShadeOptions& given) {
  ShadeOptions o = given;
  o.request.gbuffer.file = o.file;
  const auto memory = parse_memory(o.memory);
  if (!memory) return memory.error();
  constexpr double kMinMemory = 16.0 * 1024 * 1024;  // bytes; the program itself takes more
  if (*memory < kMinMemory)
    print_warning(
        fmt::format("--memory {} is less than the program itself takes: as little as possible is used", o.memory));
  const GBufferSettings& files = o.request.gbuffer;
  if (std::all_of(kFileFields.begin(), kFileFields.end(), [&](auto field) { return (files.*field).empty(); }))
    return usage_error("name the file to shade, such as umbrage shade render.exr -o out.png, or give --depth FILE");
  if (o.file == kStandardInput)
    return with_image_on_standard_input([&](const std::string& file) {
      o.request.gbuffer.file = file;
      return shade_one(o, *memory);
    });
  return is_sequence(files) ? shade_sequence(o, *memory) : shade_one(o, *memory);
}

}  // namespace

void add_shade(CLI::App& app, std::function<Result<void>()>& run) {
  const auto options = std::make_shared<ShadeOptions>();
  CLI::App* command = app.add_subcommand("shade", "shade what another renderer drew: depth, normals, colours");
  command->add_option(
      "FILE", options->file,
      "image file with layers, such as .exr; - for standard input; for a sequence with the frame number as ####");
  for (const char* group : {"Files", "G-buffer", "Technique", "Picture", "Light"})
    add_group(*command, *options, kShade, group);
  const auto output = "Output";
  command
      ->add_option("-o,--output", options->output,
                   "file to write: .png, .jpg, .webp, .exr or .pfm; - for a PNG on standard output; for a sequence "
                   "with the frame number as ####, or as .mp4, .webm or .gif")
      ->type_name("FILE")
      ->required()
      ->group(output);
  command
      ->add_flag("--merge", options->merge,
                 "write a copy of the input .exr with the results, or those of --passes, as more layers: umbrage.ao")
      ->group(output);
  add_number(*command, "--steady", options->steady, {0, 8, NumberKind::kInteger},
             "frames before and after each frame of a sequence whose occlusion and indirect light it shares, along "
             "motion vectors, or by the cameras of a still scene, so that their noise does not flicker; 0: none",
             "3")
      ->group(output);
  add_sequence_options(*command, options->sequence, true);
  add_frame_rate(*command, options->frame_rate);
  add_output_options(*command, *options,
                     "approximate memory limit, such as 6G or 500M; as many frames of a sequence are shaded at once, "
                     "and a larger picture in strips");
  add_device_options(*command, *options, kShade);
  command->callback([options, &run] { run = with_options(options, shade); });
}

}  // namespace umbrage::cli
