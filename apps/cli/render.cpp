// umbrage render: a model in, a picture out.
#include <unistd.h>

#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "apps/cli/standard_input.h"
#include "apps/job/passes.h"
#include "core/srgb.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "effects/outline/outline.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

struct RenderOptions : CommonOptions {
  std::string output, camera_index;
  std::optional<std::string> passes;
  int bits = 8;
  bool half = false, json = false;
};

constexpr std::string_view kStandardOutput = "-";  // as --output

const std::vector<std::string> kColor = {"color.r", "color.g", "color.b"};

/// One pass as a picture: vectors from [-1, 1] to [0, 1], depth from white (near) to black (far).
Image picture_of_pass(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info) {
  Image out(frame.width, frame.height);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b", "color.a"};
  constexpr float kThinnest = 1e-4f;  // of the depth: a scene that is one plane facing the camera is near, not 0 / 0
  const float span = std::max(info.depth_max - info.depth_min, kThinnest * info.depth_max);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Plane& in = frame.plane(names[k]);
    Plane& plane = out.add(names.size() == 1 ? names[0] : kChannels[std::min(k, kChannels.size() - 1)]);
    const bool vector = names[k].ends_with(".x") || names[k].ends_with(".y") || names[k].ends_with(".z");
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float v = in.at(x, y);
        if (vector) v = 0.5f * v + 0.5f;
        if (names[k] == "depth" || names[k].ends_with(".depth"))
          v = std::isfinite(v) ? 1.0f - (v - info.depth_min) / span : 0.0f;
        plane.at(x, y) = v;
      }
  }
  return out;
}

/// The lines alone, in their colour, with alpha.
Image picture_of_lines(const Plane& cover, const EffectSettings& settings) {
  const auto& line = as<OutlineParams>(settings.find("outline")->second);
  const Parameter& transfer = *find_parameter(*find_effect("output"), "transfer");
  const bool srgb = parameter_text(transfer, settings.find("output")->second) == "srgb";
  Image out(cover.width, cover.height);
  for (const auto& [name, value] : {std::pair{"color.r", line.r}, {"color.g", line.g}, {"color.b", line.b}})
    out.add(name) = Plane(cover.width, cover.height, srgb ? srgb_from_linear(value) : value);
  out.add("color.a") = cover;
  return out;
}

/// Writes the file, or standard output.
Result<void> put_image(const RenderOptions& o, const Image& image, const WriteSettings& settings) {
  if (o.output != kStandardOutput) return write_image(o.output, image, settings);
  const auto bytes = encode_png(image, settings);
  if (!bytes) return bytes.error();
  if (std::fwrite(bytes->data(), 1, bytes->size(), stdout) != bytes->size() || std::fflush(stdout) != 0)
    return file_error("standard output: the picture could not be written");
  return {};
}

Result<void> write_output(const RenderOptions& o, const EffectSettings& effect_settings, Device& device,
                          const Frame& frame) {
  const Camera camera = inner_camera(frame.info);
  const WriteSettings settings{.bits = o.bits, .half = o.half, .camera = &camera};
  const std::string_view extension = o.output == kStandardOutput ? "png" : (*format_of(o.output))->extension;
  if (!o.passes) {
    auto names = kColor;
    if (o.no_background) names.push_back("color.a");
    const auto image = device.download(frame, names);
    return image ? put_image(o, *image, settings) : image.error();
  }
  const auto all = device.download(frame, {});
  if (!all) return all.error();
  const auto chosen = chosen_planes(split(*o.passes), all->names, frame.info);
  if (!chosen) return chosen.error();
  std::vector<std::string> names;
  for (const PassPlanes& pass : *chosen) names.insert(names.end(), pass.planes.begin(), pass.planes.end());
  if (extension == "png" && *o.passes == "outline")
    return put_image(o, picture_of_lines(all->plane("outline"), effect_settings), settings);
  if (extension == "png") return put_image(o, picture_of_pass(*all, names, frame.info), settings);
  const auto image = device.download(frame, names);
  return image ? put_image(o, *image, settings) : image.error();
}

/// Makes the camera of that number the scene's own view: one of the file's, or else of those that a built-in scene
/// suggests.
Result<void> use_camera(const std::string& index, Scene& scene) {
  const std::vector<View>& cameras = scene.cameras.empty() ? scene.views : scene.cameras;
  std::size_t k = 0;
  const auto [end, error] = std::from_chars(index.data(), index.data() + index.size(), k);
  const bool is_number = error == std::errc() && end == index.data() + index.size();
  if (!is_number || k >= cameras.size())
    return usage_error("--camera-index cannot be '{}': {} has {}", index, scene.name,
                       cameras.empty()       ? "no cameras"
                       : cameras.size() == 1 ? "one camera, 0"
                                             : fmt::format("cameras 0 to {}", cameras.size() - 1));
  View view = cameras[k];
  // It turns around what is in the middle of the scene, as far as it looks there.
  const glm::vec3 along = glm::normalize(view.target - view.eye);
  const float distance = glm::dot(scene.center() - view.eye, along);
  if (!scene.cameras.empty())
    view.target = view.eye + along * (distance > 0.0f ? distance : std::max(scene.radius(), 1e-6f));
  scene.views = {view};
  return {};
}

/// Whether any pixel has a surface.
bool shows_surface(Device& device, const Frame& frame) {
  const auto depth = device.download(frame, {"depth"});
  if (!depth) return true;
  const Plane& plane = depth->planes[0];
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      if (std::isfinite(plane.at(x, y))) return true;
  return false;
}

/// A sentence for each setting that this picture does not show.
std::vector<std::string> useless_settings(const RenderOptions& o, const Recipe& recipe, const Scene& scene) {
  std::vector<std::string> sentences;
  const std::string_view look = recipe.look->name;
  const auto runs = [&](std::string_view effect) {
    const auto& effects = recipe.look->effects;
    // What is not computed at reduced resolution now may be with another --quality; upsample is part of that.
    return effect == recipe.occlusion || effect == "upsample" ||
           std::find(effects.begin(), effects.end(), effect) != effects.end();
  };
  const auto techniques = occlusion_names(handed_in());
  for (const std::string& setting : o.settings) {
    const std::string effect = setting.substr(0, setting.find('.'));
    // Of a configuration file some settings are for other looks.
    if (runs(effect) || command_line.find(setting) == command_line.npos) continue;
    if (std::find(techniques.begin(), techniques.end(), effect) != techniques.end())
      sentences.push_back(fmt::format("--set {} does nothing: the occlusion of this picture is {}; try --ao {}",
                                      setting, recipe.occlusion == kNoOcclusion ? "off" : recipe.occlusion, effect));
    else
      sentences.push_back(fmt::format("--set {} does nothing: the look {} has no {}", setting, look, effect));
  }
  if (!o.radius.empty() && recipe.occlusion == kNoOcclusion)
    sentences.push_back(fmt::format("--ao-radius {} does nothing: this picture has no occlusion", o.radius));
  const bool shines = std::any_of(recipe.look->effects.begin(), recipe.look->effects.end(), [&](std::string_view name) {
    const Effect* effect = find_effect(name);
    const Parameter* rig = effect ? find_parameter(*effect, "rig") : nullptr;
    return rig && parameter_text(*rig, recipe.settings.find(effect->name)->second) == "scene";
  });
  if (!o.hdri_file.empty() && !o.hdri_skybox && (!shines || !o.hdri_ambient))
    sentences.push_back(o.hdri_ambient ? fmt::format("--hdri-file does nothing: the look {} brings its own light", look)
                                       : "--hdri-file does nothing: it is to be neither light nor background");
  if (scene.point_count() == 0) {
    const char* what = !o.point_size.empty() ? "--point-size" : o.point_shape != "auto" ? "--point-sprites" : nullptr;
    if (what) sentences.push_back(fmt::format("{} does nothing: {} has no points", what, scene.name));
  }
  return sentences;
}

/// A sentence where the radius that the user chose leaves hardly any occlusion; else nothing.
std::string radius_hint(const RenderOptions& o, const Recipe& recipe, Device& device, const Frame& frame) {
  constexpr double kHardlyAny = 1e-3;              // of the pixels that show a surface
  constexpr float kSeen = 1.0f / 255.0f;           // of an 8-bit picture
  constexpr double kTooSmall = 0.5, kUsual = 5.0;  // percent of the scene's radius
  if (o.radius.empty() || recipe.occlusion == kNoOcclusion) return "";
  const auto length = parse_radius("--ao-radius", o.radius);
  const auto image = device.download(frame, {"depth", "ao"});
  if (!length || !image) return "";
  const double percent =
      length->relative ? double(length->value) : 100.0 * double(length->value) / double(frame.info.scene_radius);
  long pixels = 0, changed = 0;
  const Plane &depth = image->planes[0], &ao = image->planes[1];
  for (int y = 0; y < image->height; ++y)
    for (int x = 0; x < image->width; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      ++pixels;
      changed += std::abs(ao.at(x, y) - 1.0f) > kSeen;
    }
  if (pixels == 0 || percent >= kTooSmall || double(changed) > kHardlyAny * double(pixels)) return "";
  return fmt::format(
      "occlusion changes {:.2g} % of the model's pixels: its radius is {:.2g} % of the scene's; try --ao-radius {:g}%",
      100.0 * double(changed) / double(pixels), percent, kUsual);
}

/// What each pass took in all, in the order of their first runs.
std::vector<PassTime> added_up(const std::vector<PassTime>& passes) {
  std::vector<PassTime> sums;
  for (const PassTime& pass : passes) {
    const auto same = std::find_if(sums.begin(), sums.end(), [&](const PassTime& sum) {
      return sum.effect == pass.effect && sum.pass == pass.pass;
    });
    if (same == sums.end())
      sums.push_back(pass);
    else
      same->ms += pass.ms;
  }
  return sums;
}

void print_times(const StageTimes& times, const std::vector<PassTime>& passes, bool json) {
  if (!json) {
    for (const auto& stage : times.stages) fmt::print(stderr, "{:<12}{:9.1f} ms\n", stage.name, stage.ms);
    fmt::print(stderr, "{:<12}{:9.1f} ms\n", "total", times.total());
    for (const PassTime& pass : passes)
      fmt::print(stderr, "{:<34}{:9.3f} ms on the GPU\n", fmt::format("{} / {}", pass.effect, pass.pass), pass.ms);
    return;
  }
  nlohmann::json records = nlohmann::json::array();
  for (const auto& stage : times.stages) records.push_back({{"stage", stage.name}, {"ms", stage.ms}});
  for (const PassTime& pass : passes)
    records.push_back({{"stage", pass.effect}, {"pass", pass.pass}, {"gpu_ms", pass.ms}});
  records.push_back({{"stage", "total"}, {"ms", times.total()}});
  fmt::print("{}\n", records.dump(2));
}

Result<void> render(const RenderOptions& o) {
  StageTimes times;
  // Everything that can be wrong without a model is found before it is read.
  const bool piped = o.output == kStandardOutput;
  if (piped && ::isatty(STDOUT_FILENO))
    return usage_error("-o - writes a PNG to standard output, which is a terminal: send it to a file or a program");
  if (piped && o.json) return usage_error("-o - and --json cannot both have standard output");
  if (!piped)
    if (auto writable = check_writable(o.output); !writable) return writable;
  if (!o.camera_index.empty() && (!o.position.empty() || !o.focal_point.empty() || !o.direction.empty()))
    return usage_error("--camera-index and --camera-{} both say where the camera is: give one of them",
                       !o.position.empty()      ? "position"
                       : !o.focal_point.empty() ? "focal-point"
                                                : "direction");
  const auto format = format_of(piped ? "-.png" : o.output);
  if (!format) return format.error();
  if (o.bits != 8 && o.bits != 16) return usage_error("--bits cannot be {}: it takes 8 or 16", o.bits);
  auto draw_with = draw_settings(o);
  if (!draw_with) return draw_with.error();
  if (o.passes) want_passes(split(*o.passes), *draw_with);
  const auto recipe = make_recipe(*draw_with);
  if (!recipe) return recipe.error();
  const auto capture_with = capture_settings(*draw_with, *recipe->look, kMostShadows);
  if (!capture_with) return capture_with.error();
  if (o.passes)
    if (auto fine = check_passes(split(*o.passes), *draw_with); !fine) return fine;
  const std::string_view extension = (*format)->extension;
  if (o.passes && extension != "exr" && (*o.passes == "all" || o.passes->find(',') != std::string::npos))
    return usage_error("--passes {} needs a file that holds layers: write to a name that ends in .exr", *o.passes);
  if (o.bits != 8 && extension != "png") return usage_error("--bits is for .png files, not .{}", extension);
  if (o.half && extension != "exr") return usage_error("--half is for .exr files, not .{}", extension);
  const auto import_with = import_settings(o);
  if (!import_with) return import_with.error();
  auto device = device_of(o);
  if (!device) return device.error();

  const auto hdri_warnings = read_hdri(draw_with->hdri);
  if (!hdri_warnings) return hdri_warnings.error();
  for (const std::string& warning : *hdri_warnings) fmt::print(stderr, "umbrage: warning: {}\n", warning);
  auto scene = load_models(o.models, o.input_format, *import_with);
  if (!scene) return scene.error();
  if (!o.camera_index.empty())
    if (auto used = use_camera(o.camera_index, *scene); !used) return used;
  for (const std::string& warning : scene->warnings) fmt::print(stderr, "umbrage: warning: {}\n", warning);
  for (const std::string& setting : useless_settings(o, *recipe, *scene))
    fmt::print(stderr, "umbrage: warning: {}\n", setting);
  times.done("load");
  const std::size_t meshes = scene->meshes.size();
  const std::string size = size_text(*scene);
  furnish(*scene, *draw_with);
  if (auto ready = (*device)->prepare(*scene); !ready) return ready;
  times.done("prepare");
  ProgressLine line;
  draw_with->progress = [&](double done) {
    line.show(fmt::format("drawing: {:.0f} %", 100.0 * done));
    return true;
  };
  const auto frame = draw(**device, *scene, *draw_with, times);
  line.wipe();
  if (!frame) return frame.error();
  if (!shows_surface(**device, *frame))
    fmt::print(stderr, "umbrage: warning: nothing of {} is in view; move the camera or leave it to be placed\n",
               scene->name);
  if (const std::string hint = radius_hint(o, *recipe, **device, *frame); !hint.empty())
    fmt::print(stderr, "umbrage: warning: {}\n", hint);
  if (auto written = write_output(o, recipe->settings, **device, *frame); !written) return written;
  times.done("write");
  if (o.verbose) fmt::print(stderr, "{}: {} in {} meshes\n{}\n", scene->name, size, meshes, (*device)->description());
  if (o.verbose || o.json) print_times(times, added_up((*device)->take_pass_times()), o.json);
  return {};
}

}  // namespace

void add_render(CLI::App& app, std::function<Result<void>()>& run) {
  CLI::App* command = app.add_subcommand("render", "draw a model to a file");
  auto options = std::make_shared<RenderOptions>();
  add_scene_options(*command, *options);
  add_technique_options(*command, *options);
  add_picture_options(*command, *options);
  add_light_options(*command, *options);
  command
      ->add_option("--camera-index", options->camera_index,
                   "a camera of the file, from 0: see umbrage info [none of them]")
      ->group("Camera");
  const auto output = "Output";
  command
      ->add_option("-o,--output", options->output, "file to write: .png, .exr or .pfm; - for a PNG on standard output")
      ->required()
      ->group(output);
  command
      ->add_option("--passes", options->passes,
                   "planes to write instead of the picture: all, or names such as depth,normal,ao")
      ->group(output);
  command->add_option("--bits", options->bits, "bits per channel of a PNG: 8 or 16 [8]")->group(output);
  command->add_flag("--half", options->half, "half floats in an EXR, where they suffice")->group(output);
  command->add_flag("--json", options->json, "print the time of each stage as JSON")->group(output);
  add_device_options(*command, *options);
  command->callback([options, &run] { run = [options] { return render(*options); }; });
}

}  // namespace umbrage::cli
