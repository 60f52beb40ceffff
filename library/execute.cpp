// Execution of a job, from its parameters to its outputs, with the data kept for the next execution.

#include <algorithm>
#include <limits>

#include "chains/trace.h"
#include "core/lists.h"
#include "effects/output/output.h"
#include "gbuffers/conventions.h"
#include "library/job.h"
#include "library/shared.h"
#include "renderer/passes.h"
#include "renderer/recipe.h"
#include "renderer/shade_file.h"
#include "renderer/strips.h"
#include "renderer/written_passes.h"

namespace umbrage {
namespace {

const std::vector<std::string> kColor = {"color.r", "color.g", "color.b", "color.a"};

/// Returns the passes that an effect writes, without intermediate planes that its own dispatches read.
std::vector<std::string> passes_of_effect(const Effect& effect, const ParameterBytes& params) {
  std::vector<std::string> planes;
  for (const Dispatch& dispatch : effect.dispatches) {
    if (!runs(dispatch, params)) continue;
    for (const std::string_view input : dispatch.inputs) std::erase(planes, input);
    for (const std::string_view plane : dispatch.outputs)
      if (layer_of_plane(plane) == 0 && pass_of(plane) != "color") planes.emplace_back(plane);
  }
  std::vector<std::string> names;
  for (const PassPlanes& group : grouped_planes(planes)) names.push_back(group.name);
  return names;
}

/// Converts an id that a plane stores as a float. Values that are negative, NaN or too large give all bits set.
std::uint32_t id_of(float value) {
  constexpr float kIdLimit = 4294967296.0f;
  return value >= 0.0f && value < kIdLimit ? std::uint32_t(value) : ~std::uint32_t(0);
}

/// Checks the outputs against the size of the picture. Errors: kUsage.
Result<void> check_outputs(std::span<const Output> outputs, int width, int height) {
  for (const Output& output : outputs) {
    const SharedImage& image = output.image;
    if (!image.data) continue;
    if (image.width != width || image.height != height)
      return usage_error("the output '{}' has {} x {} pixels: the picture has {} x {}", output.pass, image.width,
                         image.height, width, height);
    if (image.type == PixelType::kUint32 && !is_id(output.pass))
      return usage_error("the output '{}' cannot hold 32-bit integers: only ids can", output.pass);
    if (output.pass == "color" ? image.channels == 3 || image.channels == 4
                               : image.channels == int(channels_of(output.pass).size()))
      continue;
    return usage_error("the output '{}' cannot have {} channels: it takes {}", output.pass, image.channels,
                       output.pass == "color" ? "3 or 4" : std::to_string(channels_of(output.pass).size()));
  }
  return {};
}

/// Marks a scene as being drawn during the lifetime of this object. The scene may be null.
class SceneInUse {
 public:
  explicit SceneInUse(SceneObject* scene) {
    if (scene) guard_.emplace(scene->use_lock, Use::kDraws);
  }
  /// Errors: kUsage if the scene is being changed.
  Result<void> check_begun() const {
    return !guard_ || *guard_
               ? Result<void>()
               : usage_error("the scene is being changed by another thread or by the call that runs this callback");
  }

 private:
  std::optional<UseGuard> guard_;
};

}  // namespace

JobObject::~JobObject() {
  deferred_release_.front() = {std::move(completed_.scene), std::move(kept_.frame)};
  device_->release_later(std::move(deferred_release_));
}

const NamedImage* JobObject::find_image(std::string_view name) const {
  const auto found =
      std::find_if(images_.begin(), images_.end(), [&](const NamedImage& named) { return named.name == name; });
  return found != images_.end() ? &*found : nullptr;
}

Request JobObject::full_request() const {
  Request request = request_;
  for (const auto& [name, value] : settings_) request.settings.push_back(name + "=" + value);
  for (const Output& output : outputs_) {
    if (output.pass == "color")
      request.values = (output.image.data ? output.image.type : output.own_type) == PixelType::kUint8
                           ? PictureValues::kDisplay8
                           : PictureValues::kDisplay;
    else
      request.passes.push_back(output.pass);
  }
  if (renders()) return request;
  if (const NamedImage* depth = find_image("depth")) {
    request.width = depth->image.width;
    request.height = depth->image.height;
  }
  return request;
}

Result<Recipe> JobObject::recipe_of(const Request& request, const GBufferFile* file) const {
  auto recipe = renders() ? make_recipe(request)
                : file    ? make_file_recipe(request, *file)
                          : make_shading_recipe(request);
  if (!recipe || outputs_.empty()) return recipe;
  const bool color = std::any_of(outputs_.begin(), outputs_.end(), [](const Output& o) { return o.pass == "color"; });
  std::vector<std::string_view> other_planes;
  if (request.strokes) other_planes = edge_planes(stroke_parameters_or_none(*recipe), *layer_count(recipe->capture));
  if (!color && renders()) reduce_to_passes(*recipe, other_planes);
  return recipe;
}

Result<JobObject::ResolvedJob> JobObject::resolve(const GBufferFile* file) const {
  Request request = full_request();
  if (reads_files() && !images_.empty())
    return usage_error("the job has the image '{}' and files: a G-buffer consists of images or of files",
                       images_[0].name);
  if (file) {
    request.width = file->info().width;
    request.height = file->info().height;
  }
  auto recipe = recipe_of(request, file);
  if (!recipe) return recipe.error();
  if (!renders()) recipe->reduction = request.gbuffer.reduction;
  const int width = request.width / recipe->reduction, height = request.height / recipe->reduction;
  if (std::min(width, height) < 1)
    return field_error("reduction", recipe->reduction, "`{}` cannot be '{}': the picture has {} x {} pixels",
                       request.width, request.height);
  auto params = request.strokes ? stroke_parameters(*recipe) : Result<StrokeParameters>(StrokeParameters());
  if (!params) return params.error();
  // A shaded picture has the size of its depth image, or of its files.
  if (renders() || find_image("depth") || file)
    if (auto status = check_outputs(outputs_, width, height); !status) return status.error();
  return ResolvedJob{std::move(request), std::move(*recipe), std::move(*params)};
}

Result<void> JobObject::check() const {
  const auto resolved = resolve();
  return resolved ? Result<void>() : resolved.error();
}

Result<void> JobObject::execute() {
  auto resolved = resolve();
  if (!resolved) return resolved.error();
  const SceneInUse in_use(scene_.get());
  const DeviceObject::ExclusiveUse exclusive_use(*device_);
  if (auto begun = exclusive_use.check_begun(); !begun) return begun;
  if (auto free = in_use.check_begun(); !free) return free;
  std::optional<GBufferFile> file;
  if (reads_files()) {
    auto opened = open_files();
    if (!opened) return opened.error();
    file = std::move(*opened);
    resolved = resolve(&*file);
    if (!resolved) return resolved.error();
  }
  const auto& [request, recipe, stroke_settings] = *resolved;
  device_->keep_memory_for(request.width, request.height);
  const ScopedPlanePool scoped_pool(device_->device->pool());
  const auto frame = renders() ? render_frame(recipe)
                     : file    ? shade_files(*file, recipe)
                               : shade_frame(request, recipe);
  if (!frame) return frame.error();
  report_setting_warnings(request, recipe);
  Strokes traced;
  if (!stroke_settings.empty()) {
    auto found = traced_strokes(*device_->device, *frame, stroke_settings);
    if (!found) return found.error();
    traced = with_dashes(*found);
    for (Stroke& stroke : traced.strokes)
      for (StrokePoint& point : stroke.points)
        for (float* value : {&point.x, &point.y, &point.width}) *value /= float(recipe.reduction);
    if (const auto ids = ids_.find("object_id"); ids != ids_.end() && !renders())
      for (Stroke& stroke : traced.strokes) stroke.object = int(caller_id(ids->second, float(stroke.object)));
  }
  if (auto status = write_outputs(*frame, recipe, outputs_.empty() ? default_outputs(recipe) : outputs_); !status)
    return status;
  strokes = std::move(traced);
  stroke_color = stroke_settings.empty() ? std::array<float, 3>() : umbrage::stroke_color(stroke_settings);
  stroke_opacity = stroke_settings.empty() ? 0.0f : umbrage::stroke_opacity(stroke_settings);
  return {};
}

Result<void> JobObject::prepare() {
  if (reads_files()) {
    auto described = describe_gbuffer(request_.gbuffer);
    if (!described) return described.error();
    facts = std::move(*described);
    for (const std::string& warning : facts.warnings) device_->report_warning(warning);
    return {};
  }
  auto recipe = recipe_of(full_request(), nullptr);
  if (!recipe || !renders()) return recipe ? Result<void>() : recipe.error();
  const SceneInUse in_use(scene_.get());
  const DeviceObject::ExclusiveUse exclusive_use(*device_);
  if (auto begun = exclusive_use.check_begun(); !begun) return begun;
  if (auto free = in_use.check_begun(); !free) return free;
  if (auto ready = prepare_scene(*recipe, preparation_progress()); !ready) return ready;
  return prepare_device(preparation_progress());
}

void JobObject::report_setting_warnings(const Request& request, const Recipe& recipe) {
  const auto all = [](std::string_view) { return true; };
  auto sentences =
      setting_warnings(request, recipe, completed_.scene.get(), all, "");  // names of settings are parameters
  if (sentences == reported_) return;
  reported_ = std::move(sentences);
  for (const std::string& sentence : reported_) device_->report_warning(sentence);
}

ProgressMonitor JobObject::preparation_progress() const {
  if (!progress) return {};
  return [this](double) { return progress(0.0); };
}

Result<Frame> JobObject::render_frame(Recipe recipe) {
  const ProgressMonitor monitor = preparation_progress();
  if (auto ready = prepare_scene(recipe, monitor); !ready) return ready.error();
  const std::string key = light_key(recipe);
  if (const auto lit = lightings_.find(key); lit != lightings_.end()) recipe.capture.lighting = lit->second;
  const auto plan = make_plan(recipe, *completed_.scene, device_->device->threads(), monitor);
  if (!plan) return plan.error();
  auto frame = draw_frame(*plan);
  if (frame) camera = plan->camera, origin = plan->origin;
  if (frame && !plan->lit_from_camera) lightings_.emplace(key, plan->lighting());
  return frame;
}

Result<void> JobObject::prepare_scene(Recipe& recipe, const ProgressMonitor& monitor) {
  const auto read = read_changed_hdri(recipe.hdri, hdri_, monitor);
  if (!read) return read.error();
  for (const std::string& warning : *read) device_->report_warning(warning);
  hdri_ = recipe.hdri;
  const auto serves = completed_.serves(recipe, scene_->version());
  if (!serves || *serves) return serves ? Result<void>() : serves.error();
  std::vector<std::string> warnings;
  auto copied = scene_->copied(warnings);
  if (!copied) return copied.error();
  for (const std::string& warning : warnings) device_->report_warning(warning);
  if (scene_->version() != completed_.version) lightings_.clear();
  std::list<DeviceObject::DeferredRelease> deferred(1);
  deferred.front() = {std::move(completed_.scene), std::move(kept_.frame)};
  device_->release_later(std::move(deferred));
  kept_.clear();
  completed_ = {};
  const std::size_t reported = copied->warnings.size();
  auto made = completed(std::move(*copied), recipe, scene_->version());
  if (!made) return made.error();
  for (std::size_t k = reported; k < made->scene->warnings.size(); ++k)
    device_->report_warning(made->scene->warnings[k]);
  completed_ = std::move(*made);
  return {};
}

Result<void> JobObject::prepare_device(const ProgressMonitor& monitor) {
  if (device_->prepared == completed_.scene.get()) return {};
  device_->prepared = nullptr;
  if (auto ready = device_->device->prepare(*completed_.scene, monitor); !ready) return ready;
  ++counters.hierarchies_built;
  device_->prepared = completed_.scene.get();
  return {};
}

Result<Frame> JobObject::draw_frame(const Plan& plan) {
  StageTimes times;
  const ProgressMonitor preparing = preparation_progress();
  const long made = kept_.made;
  auto picture = draw_keeping(
      *device_->device, *completed_.scene, plan, kept_, times, [&] { return prepare_device(preparing); }, preparing,
      progress);
  counters.captures_made += kept_.made - made;
  return picture ? Result<Frame>(std::move(picture->frame)) : picture.error();
}

Result<Frame> JobObject::shade_frame(const Request& request, const Recipe& recipe) {
  if (!request.gbuffer.sequence) start_.reset();
  for (const Output& output : outputs_)  // images are read until all outputs are written
    for (const NamedImage& named : images_)
      if (overlap(output.image, named.image))
        return usage_error("the output '{}' shares memory with the image '{}'", output.pass, named.name);
  auto shared = device_->arena.execute([&] { return gbuffer_of(request, images_); });
  if (!shared) return shared.error();
  counters.planes_copied += shared->copied;
  for (const std::string& warning : shared->warnings) device_->report_warning(warning);
  ids_ = std::move(shared->ids);
  StageTimes times;
  shared->gbuffer.info = started(shared->gbuffer.info, start_);
  auto picture = shade_planes(*device_->device, std::move(shared->gbuffer), recipe, times, progress,
                              start_ ? start_->stops : std::nullopt);
  if (!picture) return picture.error();
  if (request.gbuffer.sequence && !start_) start_ = start_of(picture->frame.info, picture->stops.value_or(0.0f));
  return std::move(picture->frame);
}

Result<GBufferFile> JobObject::open_files() {
  // Pixels of the caller are in memory, so the picture is shaded whole, too.
  constexpr double kAnyMemory = std::numeric_limits<double>::infinity();
  if (!request_.gbuffer.sequence) start_.reset();
  const Conventions* first = start_ ? start_->conventions.get() : nullptr;
  auto file = device_->arena.execute([&] { return GBufferFile::open(request_.gbuffer, kAnyMemory, "", first); });
  if (!file) return file;
  const long pixels = long(file->info().width) * file->info().height;
  if (pixels > kMaxPixels)
    return usage_error(
        "a picture of {} x {} pixels is too large: at most {} pixels; umbrage shade draws up to {}, in "
        "strips",
        file->info().width, file->info().height, kMaxPixels, kMaxStripPixels);
  facts = file->facts();
  for (const std::string& warning : facts.warnings) device_->report_warning(warning);
  return file;
}

Result<Frame> JobObject::shade_files(const GBufferFile& file, const Recipe& recipe) {
  ids_.clear();
  StageTimes times;
  auto shaded = shade_whole_file(*device_->device, file, recipe, start_, times, progress);
  if (!shaded) return shaded.error();
  if (request_.gbuffer.sequence && !start_) {
    start_ = shaded->start;
    start_->conventions = std::make_shared<Conventions>(file.conventions());
  }
  camera = shaded->frame.info.camera;
  origin = glm::dvec3(0.0);
  return std::move(shaded->frame);
}

std::vector<Output> JobObject::default_outputs(const Recipe& recipe) const {
  std::vector<std::string> passes = {"color"};
  if (recipe.effects_look) {
    const auto& effects = recipe.effects_look->effects;
    if (!contains(effects, effect_with<OutputParams>().name)) passes.clear();
    for (const std::string& name :
         passes_of_effect(*find_effect(effects.back()), params_of(recipe.settings, effects.back())))
      passes.push_back(name);
  }
  std::vector<Output> outputs;
  outputs.reserve(passes.size());
  for (const std::string& pass : passes) outputs.push_back({.pass = pass});
  return outputs;
}

Result<void> JobObject::write_outputs(const Frame& frame, const Recipe& recipe, std::vector<Output> requested) {
  Device& device = *device_->device;
  std::vector<std::string> names;
  std::vector<Output> outputs;
  for (Output& output : requested)
    if (output.pass == "color")
      outputs.push_back(std::move(output));
    else
      names.push_back(output.pass);
  std::vector<std::vector<std::string>> planes(outputs.size(), kColor);
  const std::vector<std::string> available = device.plane_names(frame);
  if (!outputs.empty() && !contains(available, "color.r"))
    return usage_error("the effects write no picture: the output 'color' requires a look or the effect 'output'");
  if (!names.empty()) {
    const auto chosen = chosen_planes(names, available, frame.info);
    if (!chosen) return chosen.error();
    for (const PassPlanes& pass : *chosen) {
      if (std::any_of(outputs.begin(), outputs.end(), [&](const Output& o) { return o.pass == pass.name; }))
        continue;  // requested by name and by "all"
      const auto set =
          std::find_if(requested.begin(), requested.end(), [&](const Output& o) { return o.pass == pass.name; });
      outputs.push_back(set != requested.end() ? std::move(*set) : Output{.pass = pass.name});
      planes.push_back(pass.planes);
    }
  }
  for (std::size_t k = 0; k < outputs.size(); ++k)
    if (outputs[k].image.data) planes[k].resize(std::size_t(outputs[k].image.channels));
  // From here on the memory of the last outputs is reused, and their contents are lost.
  std::vector<Output> last = std::move(results_);
  results_.clear();
  for (Output& output : outputs)
    for (Output& previous : last)
      if (previous.pass == output.pass) output.own = std::move(previous.own);
  for (std::size_t k = 0; k < outputs.size(); ++k)
    if (auto status = fill(frame, recipe, planes[k], outputs[k]); !status) return status;
  results_ = std::move(outputs);
  return {};
}

Result<void> JobObject::fill(const Frame& frame, const Recipe& recipe, const std::vector<std::string>& planes,
                             Output& output) {
  Device& device = *device_->device;
  SharedImage& to = output.image;
  const auto caller_ids = renders() ? ids_.end() : ids_.find(name_on_first_layer(output.pass));
  if (!to.data) {
    to = {.data = nullptr,
          .type = caller_ids != ids_.end() ? PixelType::kUint32 : output.own_type,
          .width = frame.info.inner_width() / recipe.reduction,
          .height = frame.info.inner_height() / recipe.reduction,
          .channels = int(planes.size())};
    output.own.resize(std::size_t(to.width) * std::size_t(to.height) * planes.size());
    to.data = output.own.data();
    to = with_strides(to);
  }
  const bool are_integers = to.type != PixelType::kFloat32 && to.type != PixelType::kFloat16;
  const bool ids = is_id(output.pass) && (caller_ids != ids_.end() || are_integers);
  const auto take = [&](std::size_t channel, const Plane& plane) {
    if (!ids) return device_->arena.execute([&] { write_channel(plane, int(channel), to); });
    for (int y = 0; y < to.height; ++y)
      for (int x = 0; x < to.width; ++x) {
        const float value = plane.at(x, y);
        write_id(to, x, y, caller_ids != ids_.end() ? caller_id(caller_ids->second, value) : id_of(value));
      }
  };
  if (recipe.reduction > 1) {
    // The mean colour is weighed by alpha, also if the caller takes three channels.
    const auto image = device.download(frame, output.pass == "color" ? kColor : planes);
    if (!image) return image.error();
    const auto reduce = reduced_rows(recipe.reduction, recipe, [&](const PictureInfo&, const Image& rows, int) {
      for (std::size_t k = 0; k < planes.size(); ++k) take(k, rows.planes[k]);
      return Result<void>();
    });
    return reduce(frame.info, *image, 0);
  }
  const bool as_stored = !renders() || background_planes(planes, false).empty();
  const auto image = as_stored ? device.view(frame, planes) : download_passes(device, frame, planes);
  if (!image) return image.error();
  for (std::size_t k = 0; k < planes.size(); ++k) take(k, image->planes[k]);
  return {};
}

}  // namespace umbrage
