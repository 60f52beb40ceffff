// umbrage thumbnails: draws a small picture of each of many models. Models are read and drawn at the same time, each by
// one thread; a model that cannot be read or drawn does not stop the others.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>

#include "apps/cli/commands.h"
#include "apps/cli/picture_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/render_options.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "io/image_file.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "scene/readers/import.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

struct ThumbnailOptions : RenderOptions {
  int size = 256;
  std::string format = "png";
};

/// A model, and the file that its picture is written to.
struct Thumbnail {
  std::string model;
  fs::path file;
};

bool is_model(const fs::path& file) {
  const auto& formats = import_formats();
  return !file.filename().string().starts_with('.') && contains(formats, import_format(file));
}

/// Returns the models in a folder and its subfolders, sorted. Errors: kFile if there are none.
Result<std::vector<fs::path>> models_in(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && is_model(entry->path())) models.push_back(entry->path());
  }
  if (error) return file_error("the folder '{}' cannot be read: {}", folder.string(), error.message());
  if (models.empty()) return file_error("the folder '{}' contains no model; see umbrage list formats", folder.string());
  std::sort(models.begin(), models.end());
  return models;
}

/// Returns the name of a model's picture: "bunny.obj.png", or "claw.png" for "scene:claw?detail=100".
fs::path picture_name(const ThumbnailOptions& o, const std::string& model) {
  constexpr std::string_view kBuiltIn = "scene:";
  if (model.starts_with(kBuiltIn))
    return model.substr(kBuiltIn.size(), model.find('?') - kBuiltIn.size()) + "." + o.format;
  return fs::path(model).filename().string() + "." + o.format;
}

/// Returns whether a path names a picture that can be made, and no folder that exists.
bool is_picture(const fs::path& path) {
  std::error_code ignored;
  const auto extension = extension_of(path.string());
  return extension && holds_display_values(*extension) && !fs::is_directory(path, ignored);
}

/// Returns the pictures to make: one for each model that is named, or in a folder that is named. Errors: kFile; kUsage
/// for two pictures of one name.
Result<std::vector<Thumbnail>> thumbnails_of(const ThumbnailOptions& o) {
  std::vector<Thumbnail> all;
  std::error_code ignored;
  const fs::path output = o.output;
  const bool is_file = o.models.size() == 1 && is_picture(output) && !fs::is_directory(o.models[0], ignored);
  if (is_file) return std::vector<Thumbnail>{{o.models[0], output}};
  if (is_picture(output))
    return usage_error("'{}' would be a folder: several models need --output FOLDER", output.string());
  for (const std::string& model : o.models) {
    if (!fs::is_directory(model, ignored)) {
      all.push_back({model, output / picture_name(o, model)});
      continue;
    }
    const auto models = models_in(model);
    if (!models && o.models.size() == 1) return models.error();
    if (!models) {  // reported like a model that cannot be read
      all.push_back({model, output / picture_name(o, model)});
      continue;
    }
    for (const fs::path& file : *models)
      all.push_back({file.string(), output / file.lexically_relative(model).parent_path() / picture_name(o, file)});
  }
  std::map<fs::path, std::string> models;
  for (const Thumbnail& one : all)
    if (const auto [other, is_new] = models.emplace(one.file, one.model); !is_new)
      return usage_error("'{}' and '{}' would both be written to '{}'", other->second, one.model, one.file.string());
  if (auto status = check_folder(output, {}); !status) return status.error();
  return all;
}

/// Reads, draws and writes one model. `drawing` is locked while the device is used.
Result<void> make(const Thumbnail& one, const ThumbnailOptions& o, const Recipe& recipe,
                  const ImportSettings& import_with, Device& device, std::mutex& drawing) {
  auto scene = load_scene(one.model, import_with);
  if (!scene) return scene.error();
  if (auto done = complete_scene(*scene, recipe); !done) return done.error();
  if (auto made = make_folder(one.file.parent_path()); !made) return made;
  const std::lock_guard lock(drawing);
  const ScopedPlanePool kept(device.pool());
  if (auto ready = device.prepare(*scene); !ready) return ready;
  const auto plan = make_plan(recipe, *scene, device.threads());
  if (!plan) return plan.error();
  StageTimes times;
  const auto picture = draw(device, *scene, *plan, times);
  if (!picture) return picture.error();
  const Destination destination{one.file.string(), nullptr, picture->frame.info};
  const auto names = picture_planes(o, destination);
  const auto image = device.download(picture->frame, names);
  if (!image) return image.error();
  return write_picture(destination, convert_for_file(o, destination, *image, names, recipe.settings, {}),
                       {.bits = o.bits(), .quality = o.picture_quality, .threads = 1});
}

Result<void> thumbnails(const ThumbnailOptions& given) {
  ThumbnailOptions o = given;
  o.request.width = o.request.height = o.size;
  o.request.values = values_for(o, "png");
  if (!o.is_given("anti-aliasing") && !o.is_given("quality")) o.request.anti_aliasing = 4;
  const auto recipe = make_recipe(o.request);
  if (!recipe) return recipe.error();
  auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  import_with->fitted_px = fitted_px(o.request);
  const auto all = thumbnails_of(o);
  if (!all) return all.error();
  for (const Thumbnail& one : *all)
    if (auto status = check_format(o, *extension_of(one.file.string())); !status) return status;
  if (auto made = make_folder(all->front().file.parent_path()); !made) return made;
  auto devices = worker_devices(o, all->size());
  if (!devices) return devices.error();

  ProgressLine line;
  std::mutex reporting;
  std::vector<std::mutex> drawing(devices->size());
  std::atomic<std::size_t> next = 0, done = 0, failed = 0;
  std::optional<Error> last;  // guarded by `reporting`
  const auto work = [&](std::size_t worker) {
    const std::size_t own = worker % devices->size();
    for (std::size_t k = next++; k < all->size(); k = next++) {
      const Thumbnail& one = (*all)[k];
      const auto made = guarded([&] { return one.model; },
                                [&] { return make(one, o, *recipe, *import_with, *(*devices)[own], drawing[own]); });
      line.show("drawing " + one.model, double(++done) / double(all->size()));
      if (made) continue;
      ++failed;
      const std::lock_guard lock(reporting);
      last = made.error();
      if (all->size() == 1) continue;
      line.wipe();
      std::fputs(("umbrage: " + with_option_names(last->message) + "\n").c_str(), stderr);
    }
  };
  std::vector<std::jthread> workers;
  const unsigned threads = o.request.threads > 0 ? unsigned(o.request.threads) : std::thread::hardware_concurrency();
  const std::size_t count = std::min(all->size(), std::size_t(std::max(1u, threads)));
  for (std::size_t worker = 1; worker < count; ++worker) workers.emplace_back(work, worker);
  work(0);
  workers.clear();
  line.wipe();
  if (failed == 0) return {};
  if (all->size() == 1) return *last;
  return file_error("{} of {} models have no picture: see above", failed.load(), all->size());
}

}  // namespace

void add_thumbnails(CLI::App& app, std::function<Result<void>()>& run) {
  CLI::App* command = app.add_subcommand("thumbnails", "draw a small picture of each model, also of whole folders");
  auto options = std::make_shared<ThumbnailOptions>();
  command->add_option("MODEL", options->models, "model files, folders of model files, or scene:NAME")->required();
  command
      ->add_option(
          "-o,--output", options->output,
          "folder for the pictures, NAME.png for the model NAME; for a single model also a .png, .jpg or .webp file")
      ->type_name("DIR")
      ->required();
  CLI::Option* format =
      command->add_option("--format", options->format, "format of pictures in a folder: png, jpg or webp [png]");
  format->type_name("NAME");
  add_check(*format, [](const std::string& text) -> Result<void> {
    if (holds_display_values(text)) return {};
    return field_error("--format", text, "{} cannot be '{}': it takes png, jpg or webp");
  });
  add_number(*command, "--picture-quality", options->picture_quality, {1, 100, NumberKind::kInteger},
             "quality of a .jpg or .webp (of a .webp, 100 is lossless)");
  add_number(*command, "--size", options->size, {1, 4096, NumberKind::kInteger}, "width and height, pixels");
  for (const char* field : {"look", "quality", "anti_aliasing", "transparent", "up"})
    add_one(*command, *options, field, "", "", std::string_view(field) == "anti_aliasing" ? "4" : "");
  add_device_options(*command, *options, kRender);
  command->callback([options, &run] { run = with_options(options, thumbnails); });
}

}  // namespace umbrage::cli
