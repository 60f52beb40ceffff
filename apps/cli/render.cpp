// umbrage render: a model in, a picture out.
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "core/srgb.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "effects/outline/outline.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

struct RenderOptions : CommonOptions {
  std::string output;
  std::optional<std::string> passes;
  int bits = 8;
  bool half = false, json = false;
};

const std::vector<std::string> kColor = {"color.r", "color.g", "color.b"};

/// The word that --passes takes for a plane: `normal` for normal.x, `layer1.depth` for itself.
std::string group_of(std::string_view plane) {
  const bool channel = plane.size() > 2 && plane[plane.size() - 2] == '.';
  return std::string(channel ? plane.substr(0, plane.size() - 2) : plane);
}

/// Planes of a frame by the word that --passes takes for them.
std::map<std::string, std::vector<std::string>> groups_of(const Image& image) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const std::string& name : image.names) groups[group_of(name)].push_back(name);
  return groups;
}

/// The layers that a picture must have for a pass, where they are all that it lacks, or 0.
int layers_for(std::string_view pass, std::span<const std::string> names) {
  for (int layer = 1; layer < kMostLayers; ++layer) {
    const std::string start = layer_plane(layer, "");
    if (!pass.starts_with(start)) continue;
    return std::find(names.begin(), names.end(), pass.substr(start.size())) != names.end() ? layer + 1 : 0;
  }
  return 0;
}

/// Checks the words of --passes against what the look will make, before any work.
Result<void> check_passes(const RenderOptions& o, const DrawSettings& draw, int captured_layers) {
  if (!o.passes || *o.passes == "all") return {};
  const auto recipe = make_recipe(draw);
  if (!recipe) return recipe.error();
  std::vector<std::string> captured = {"depth",     "normal",    "albedo",      "specular",
                                       "shininess", "object_id", "material_id", "emission"};
  for (int light = 0; light < kMostShadows; ++light) captured.push_back(shadow_plane(light));
  std::vector<std::string> names;
  for (int layer = 0; layer < captured_layers; ++layer)
    for (const std::string& name : captured) names.push_back(layer_plane(layer, name));
  const auto all = every_effect();
  for (std::string_view effect : recipe->look->effects) {
    if (effect == "occlusion") effect = recipe->occlusion;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Effect* each) { return each->name == effect; });
    // What the technique and its filters make at reduced resolution stays there but for what is upsampled.
    const bool reduced = found != all.end() && recipe->occlusion_every > 1 &&
                         ((*found)->kind == EffectKind::kOcclusion || (*found)->kind == EffectKind::kFilter);
    if (found != all.end())
      for (const Pass& pass : (*found)->passes) {
        if (pass.needed && !pass.needed(recipe->settings.find((*found)->name)->second)) continue;
        for (std::string_view plane : pass.outputs) {
          if (layer_of_plane(plane) > 0) continue;  // one that was captured, or nobody's
          const std::string group = group_of(plane);
          if (reduced && group != "ao" && group != "indirect") continue;
          if (std::find(names.begin(), names.end(), group) == names.end()) names.push_back(group);
        }
      }
  }
  if (recipe->occlusion == kNoOcclusion) names.push_back("ao");  // 1 everywhere
  names.push_back("all");
  const std::vector<std::string> words = split(*o.passes);
  for (const std::string& word : words) {
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      const int layers = layers_for(word, captured);
      if (layers > 0 && (draw.extra_views.value_or(0) > 0 || recipe->look->back_sides || recipe->look->extra_views > 0))
        return usage_error("there is no pass '{}': this picture has {} layers, counted from 0", word, captured_layers);
      if (layers > 0)
        return usage_error("there is no pass '{}' with --layers {}: it takes --layers {}", word, captured_layers,
                           layers);
      // Of further layers only what is misspelt: there are too many to list.
      std::string hint = suggestion(word, names);
      if (!hint.starts_with(" (did")) {
        std::erase_if(names, [](const std::string& name) { return layer_of_plane(name) > 0; });
        hint = suggestion(word, names);
      }
      return usage_error("the look '{}' writes no pass '{}'{}", recipe->look->name, word, hint);
    }
    if (std::count(words.begin(), words.end(), word) > 1) return usage_error("--passes names '{}' twice", word);
  }
  if (words.size() > 1 && std::find(words.begin(), words.end(), "all") != words.end())
    return usage_error("--passes all stands alone: it names every pass");
  return {};
}

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

Result<void> write_output(const RenderOptions& o, const EffectSettings& effect_settings, Device& device,
                          const Frame& frame) {
  const Camera camera = inner_camera(frame.info);
  const WriteSettings settings{.bits = o.bits, .half = o.half, .camera = &camera};
  const std::string_view extension = (*format_of(o.output))->extension;
  if (!o.passes) {
    auto names = kColor;
    if (o.no_background) names.push_back("color.a");
    const auto image = device.download(frame, names);
    return image ? write_image(o.output, *image, settings) : image.error();
  }
  const auto all = device.download(frame, {});
  if (!all) return all.error();
  if (*o.passes == "all") {
    // Of layers that nobody captured there are but neutral planes.
    std::vector<std::string> names;
    for (const std::string& name : all->names)
      if (layer_of_plane(name) <= int(frame.info.more_layers.size())) names.push_back(name);
    const auto image = device.download(frame, names);
    return image ? write_image(o.output, *image, settings) : image.error();
  }
  const auto groups = groups_of(*all);
  std::vector<std::string> names;
  for (const std::string& word : split(*o.passes)) {
    const auto group = groups.find(word);
    if (group == groups.end())
      return usage_error("there is no pass '{}' in this picture: nothing in the scene makes it", word);
    names.insert(names.end(), group->second.begin(), group->second.end());
  }
  if (extension == "png" && *o.passes == "outline")
    return write_image(o.output, picture_of_lines(all->plane("outline"), effect_settings), settings);
  if (extension == "png") return write_image(o.output, picture_of_pass(*all, names, frame.info), settings);
  const auto image = device.download(frame, names);
  return image ? write_image(o.output, *image, settings) : image.error();
}

/// Of the passes asked for, those that are averaged where the picture is of several frames: light and occlusion, not
/// what a pixel shows.
std::vector<std::string> averaged_passes(const std::vector<std::string>& words) {
  std::vector<std::string> planes;
  for (const std::string& word : words) {
    if (word == "ao" || word == "outline" || word == "cover" || word.starts_with("shadow")) planes.push_back(word);
    if (word == "direct" || word == "ambient" || word == "indirect" || word == "lit")
      for (const char* channel : {".r", ".g", ".b"}) planes.push_back(word + channel);
  }
  return planes;
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
  if (auto writable = check_writable(o.output); !writable) return writable;
  const auto format = format_of(o.output);
  if (!format) return format.error();
  if (o.bits != 8 && o.bits != 16) return usage_error("--bits cannot be {}: it takes 8 or 16", o.bits);
  auto draw_with = draw_settings(o);
  if (!draw_with) return draw_with.error();
  if (o.passes) {
    const auto words = split(*o.passes);
    for (int light = 0; light < kMostShadows; ++light)
      if (std::any_of(words.begin(), words.end(), [&](const std::string& word) {
            return word == "all" || word == shadow_plane(light) || word.ends_with("." + shadow_plane(light));
          }))
        draw_with->shadows = light + 1;
  }
  if (o.passes) draw_with->averaged = averaged_passes(split(*o.passes));
  const auto recipe = make_recipe(*draw_with);
  if (!recipe) return recipe.error();
  const auto capture_with = capture_settings(*draw_with, *recipe->look, kMostShadows);
  if (!capture_with) return capture_with.error();
  if (auto fine = check_passes(o, *draw_with, *layer_count(*capture_with)); !fine) return fine;
  const std::string_view extension = (*format)->extension;
  if (o.passes && extension != "exr" && (*o.passes == "all" || o.passes->find(',') != std::string::npos))
    return usage_error("--passes {} needs a file that holds layers: write to a name that ends in .exr", *o.passes);
  if (o.bits != 8 && extension != "png") return usage_error("--bits is for .png files, not .{}", extension);
  if (o.half && extension != "exr") return usage_error("--half is for .exr files, not .{}", extension);
  const auto import_with = import_settings(o);
  if (!import_with) return import_with.error();
  auto device = device_of(o);
  if (!device) return device.error();

  auto scene = load_scenes(o.models, *import_with);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) fmt::print(stderr, "umbrage: warning: {}\n", warning);
  times.done("load");
  const std::size_t meshes = scene->meshes.size();
  const std::string size = size_text(*scene);
  furnish(*scene, *draw_with);
  if (auto ready = (*device)->prepare(*scene); !ready) return ready;
  times.done("prepare");
  ProgressLine line;
  draw_with->progress = [&](double done) {
    line.show(fmt::format("tracing rays: {:.0f} %", 100.0 * done));
    return true;
  };
  const auto frame = draw(**device, *scene, *draw_with, times);
  line.wipe();
  if (!frame) return frame.error();
  if (!shows_surface(**device, *frame))
    fmt::print(stderr, "umbrage: warning: nothing of {} is in view; move the camera or leave it to be placed\n",
               scene->name);
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
  const auto output = "Output";
  command->add_option("-o,--output", options->output, "file to write: .png, .exr or .pfm")->required()->group(output);
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
