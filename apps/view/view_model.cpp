#include "apps/view/view_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <utility>

#include "core/pixel_grid.h"
#include "renderer/models.h"
#include "renderer/passes.h"
#include "renderer/shade_file.h"
#include "renderer/strips.h"
#include "renderer/written_passes.h"
#include "scene/framing.h"
#include "scene/readers/content.h"

namespace umbrage::view {
namespace {

/// Returns a number that no other call returns.
long new_number() {
  static std::atomic<long> last = 0;
  return ++last;
}

/// Returns a key of the options that change how a model is read. `is_cad`: so does the size of the picture.
std::string import_key(const Request& r, bool is_cad) {
  const auto number = [](const auto& value) { return value ? fmt::format("{}", *value) : std::string("-"); };
  const auto up = r.up.value_or(std::array<float, 3>{});
  const unsigned picture_px = is_cad ? std::bit_ceil(unsigned(std::max(r.width, r.height))) : 0;  // as import_settings
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {}", fmt::join(up, ","), number(r.scene_index),
                     number(r.animation_index), number(r.animation_time), r.lights, number(r.crease_angle_deg),
                     r.point_size, r.point_sprites, r.color_by, r.gbuffer.view, picture_px);
}

/// Returns the planes of a finished picture.
std::vector<std::string> color_planes(const Request& request) {
  std::vector<std::string> names = {"color.r", "color.g", "color.b"};
  if (request.transparent) names.emplace_back("color.a");
  return names;
}

/// Returns the names of the planes that the request shows. Errors: kUsage.
Result<std::vector<std::string>> shown_planes(const Request& request, const Device& device, const Frame& frame) {
  if (request.passes.empty()) return color_planes(request);
  const auto chosen = chosen_planes(request.passes, device.plane_names(frame), frame.info);
  if (!chosen) return chosen.error();
  std::vector<std::string> names;
  for (const PassPlanes& pass : *chosen) names.insert(names.end(), pass.planes.begin(), pass.planes.end());
  return names;
}

/// Returns the planes `names`, which the request shows, as the picture that is written to a .png.
Image picture_of(const Image& planes, const std::vector<std::string>& names, const Request& request,
                 const EffectSettings& settings, const PictureInfo& info) {
  if (request.passes.size() == 1 && request.passes[0] == "outline")
    return picture_of_lines(planes.plane("outline"), settings);
  if (!request.passes.empty()) return picture_of_passes(planes, names, info);
  Image picture(planes.width, planes.height);
  for (const std::string& name : names) picture.add(name) = planes.plane(name);
  return picture;
}

/// Returns the options of a camera of a completed scene.
ViewCamera options_of(const Camera& camera, const Scene& scene, float view_angle_deg) {
  ViewCamera view;
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(camera.view_from_world));
  const glm::dvec3 eye(camera.eye()), center(scene.center());
  view.orthographic = camera.projection == Projection::kOrthographic;
  view.view_up = world_from_view[1];
  const glm::dvec2 middle(0.5 * (camera.left + camera.right), 0.5 * (camera.bottom + camera.top));
  const double height = double(camera.top) - double(camera.bottom);
  // The options have no shifted window: the camera looks at, or moves to, the middle of it.
  const glm::dvec3 right = world_from_view[0], up = world_from_view[1], back = world_from_view[2];
  if (view.orthographic) {
    view.view_angle_deg = view_angle_deg;
    const double distance = 0.5 * height / std::tan(glm::radians(0.5 * double(view_angle_deg)));
    const double depth = glm::dot(eye - center, back);
    view.focal_point = eye - depth * back + middle.x * right + middle.y * up;
    view.position = view.focal_point + distance * back;
  } else {
    view.view_angle_deg = glm::degrees(2.0 * std::atan(0.5 * height));
    const glm::dvec3 forward = glm::normalize(middle.x * right + middle.y * up - back);
    const double depth = glm::dot(center - eye, forward);
    view.position = eye;
    view.focal_point = eye + std::max(depth, 0.1 * double(scene.radius())) * forward;
  }
  view.position += scene.origin;
  view.focal_point += scene.origin;
  return view;
}

/// Gives a camera the window of a picture whose size was rounded, so that nothing is distorted: the width of the window
/// follows from `aspect`, width / height.
void set_aspect(double aspect, Camera& camera) {
  const double height = double(camera.top) - double(camera.bottom), width = double(camera.right) - double(camera.left);
  const float factor = float(height * aspect / width);
  camera.left *= factor;
  camera.right *= factor;
}

}  // namespace

void DrawingDevice::keep_memory_for(int width, int height, bool is_full_size) {
  const bool is_same = std::exchange(sizes[is_full_size], {width, height}) == std::pair(width, height);
  if (kept && is_same) return;
  kept.reset();
  kept.emplace(device->pool());
}

ViewModel::~ViewModel() = default;

Result<std::unique_ptr<ViewModel>> ViewModel::load(const std::string& file, bool is_gbuffer, const Request& request,
                                                   const ProgressMonitor& monitor) {
  std::unique_ptr<ViewModel> model(new ViewModel);
  model->is_cad_ = !is_gbuffer && is_cad(format_of_file(file));
  model->import_key_ = import_key(request, model->is_cad_);
  model->loaded_ = new_number();
  ModelFacts& facts = model->facts_;
  if (is_gbuffer) {
    constexpr double kAnyMemory = std::numeric_limits<double>::infinity();  // the pixels are kept
    GBufferSettings settings = request.gbuffer;
    settings.file = file;
    auto opened = GBufferFile::open(settings, kAnyMemory, "");
    if (!opened) return opened.error();
    facts.width = opened->info().width;
    facts.height = opened->info().height;
    facts.warnings = opened->facts().warnings;
    facts.summary = fmt::format("{} x {} pixels", facts.width, facts.height);
    auto rows = opened->rows({0, facts.height});
    if (!rows) return rows.error();
    model->planes_ = GBuffer{.info = opened->info(), .layers = {}};
    model->planes_->layers.push_back(std::move(*rows));
    model->gbuffer_ = std::move(*opened);
    Request of_file;
    of_file.gbuffer = settings;
    // Options may be needed to shade it at all: then the looks that are offered do not matter.
    if (const auto recipe = make_file_recipe(of_file, *model->gbuffer_)) facts.look = recipe->look->name;
    return model;
  }
  const auto settings = import_settings(request);
  if (!settings) return settings.error();
  auto scene = load_scene(file, *settings, monitor);
  if (!scene) return scene.error();
  model->scene_ = std::move(*scene);
  facts.summary = size_text(model->scene_);
  facts.warnings = model->scene_.warnings;
  facts.center = model->scene_.origin + glm::dvec3(model->scene_.center());
  facts.extent = glm::dvec3(model->scene_.bounds_max - model->scene_.bounds_min);
  facts.radius = model->scene_.radius();
  facts.up = model->scene_.up;
  return model;
}

bool ViewModel::is_loaded_for(const Request& request) const { return import_key_ == import_key(request, is_cad_); }

void ViewModel::forget_captures() {
  capture_.clear();
  moving_capture_.clear();
  captured_by_ = nullptr;
  live_.reset();
}

Result<ViewCamera> ViewModel::camera(const Request& request) {
  const auto recipe = make_recipe(request);
  if (!recipe) return recipe.error();
  Scene& scene = completed_.scene ? *completed_.scene : scene_;
  const std::vector<umbrage::View> views = scene.views;
  scene.views = scene_.views;
  if (recipe->camera_index)
    if (auto used = use_camera(*recipe->camera_index, scene); !used) return used.error();
  const Camera camera = frame_scene(scene, recipe->framing, recipe->width, recipe->height);
  scene.views = views;
  return options_of(camera, scene, recipe->framing.view_angle_deg.value_or(recipe->framing.usual_view_angle_deg));
}

Result<const Scene*> ViewModel::complete(Recipe& recipe, const ProgressMonitor& monitor) {
  if (auto read = read_changed_hdri(recipe.hdri, hdri_, monitor); !read) return read.error();
  hdri_ = recipe.hdri;
  const auto serves = completed_.serves(recipe, 0);
  if (!serves) return serves.error();
  if (!*serves) {
    forget_captures();
    completed_ = {};
    auto made = completed(scene_, recipe, 0);
    if (!made) return made.error();
    completed_ = std::move(*made);
    number_ = new_number();
  }
  return completed_.scene.get();
}

Result<void> ViewModel::prepare(DrawingDevice& device, const ProgressMonitor& monitor) const {
  if (device.prepared == number_) return {};
  device.prepared = 0;
  if (auto ready = device.device->prepare(*completed_.scene, monitor); !ready) return ready;
  device.prepared = number_;
  return {};
}

Result<void> ViewModel::draw(DrawingDevice& device, const Request& request, const DrawControl& control,
                             StageTimes& times) {
  if (is_gbuffer()) return shade(device, request, control, times);
  const auto give = [&](const Recipe& recipe, const Frame& frame, int samples, bool averages) -> Result<void> {
    const auto names = shown_planes(request, *device.device, frame);
    if (!names) return names.error();
    const auto planes = download_passes(*device.device, frame, *names);
    if (!planes) return planes.error();
    const Image picture = picture_of(*planes, *names, request, recipe.settings, frame.info);
    times.done("download");
    const bool is_refined = control.max_samples > 0 && samples >= control.max_samples;
    return control.take(picture, samples, !averages || is_refined);
  };
  return draw_scene(device, request, {}, control, times, give);
}

Result<Image> ViewModel::planes(DrawingDevice& device, const Request& request, const std::vector<std::string>& names,
                                const DrawControl& control, StageTimes& times) {
  if (is_gbuffer()) return usage_error("the ray-traced reference needs a model, and this is a G-buffer");
  Image image;
  const auto give = [&](const Recipe&, const Frame& frame, int, bool) -> Result<void> {
    auto planes = download_passes(*device.device, frame, names);
    if (!planes) return planes.error();
    image = Image(planes->width, planes->height);
    for (const std::string& name : names) image.add(name) = planes->plane(name);
    return {};
  };
  const std::vector<std::string_view> besides(names.begin(), names.end());
  const auto status = draw_scene(device, request, besides, control, times, give);
  return status ? Result<Image>(std::move(image)) : status.error();
}

Result<std::optional<glm::dvec3>> ViewModel::surface_at(DrawingDevice& device, const Request& request, double x,
                                                        double y, const DrawControl& control, StageTimes& times) {
  std::optional<glm::dvec3> found;
  if (is_gbuffer()) return found;
  Request of_depth = request;
  of_depth.passes = {"depth"};
  const auto give = [&](const Recipe&, const Frame& frame, int, bool) -> Result<void> {
    const auto planes = download_passes(*device.device, frame, {"depth"});
    if (!planes) return planes.error();
    const Plane& depth = planes->plane("depth");
    const int column = std::clamp(int(x * depth.width), 0, depth.width - 1);
    const int row = std::clamp(int(y * depth.height), 0, depth.height - 1);
    const glm::dvec3 seen =
        PixelGrid(inner_camera(frame.info), depth.width, depth.height).point(column, row, depth.at(column, row));
    const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(frame.info.camera.view_from_world));
    if (std::isfinite(seen.z)) found = completed_.scene->origin + glm::dvec3(world_from_view * glm::dvec4(seen, 1.0));
    return {};
  };
  constexpr std::string_view kBesides[] = {"depth"};
  const auto status = draw_scene(device, of_depth, kBesides, control, times, give);
  return status ? Result<std::optional<glm::dvec3>>(found) : status.error();
}

Result<void> ViewModel::draw_scene(DrawingDevice& device, const Request& request,
                                   std::span<const std::string_view> besides, const DrawControl& control,
                                   StageTimes& times, const GiveFrame& give) {
  auto recipe = make_recipe(request);
  if (!recipe) return recipe.error();
  reduce_to_passes(*recipe, besides);
  const auto scene = complete(*recipe, control.monitor);
  if (!scene) return scene.error();
  auto plan = make_plan(*recipe, **scene, device.device->threads(), control.monitor);
  if (!plan) return plan.error();
  if (control.moving) simplify_moving(*plan);
  const bool is_full_size = !control.moving || control.aspect == 0.0;
  if (control.aspect > 0.0) set_aspect(control.aspect, plan->camera);
  if (captured_by_ != device.device.get()) forget_captures();
  captured_by_ = device.device.get();
  device.keep_memory_for(request.width, request.height, is_full_size);
  const ScopedPlanePool pool(device.device->pool());
  times.done("plan");
  const bool refines = plan->averages() && control.max_samples > 0;
  Continuation more;
  if (refines) {
    more.wants_mean = [&](int samples) { return samples >= control.max_samples || control.wants_mean(samples); };
    more.wants_another = [&](int samples) { return samples < control.max_samples && control.wants_another(samples); };
    more.take_mean = [&](const Frame& mean, int samples) { return give(plan->recipe, mean, samples, true); };
  }
  // While only settings change, captures are kept.
  const bool is_live =
      !is_full_size && can_be_steady(*recipe) && !plan->averages() && moving_camera_ && *moving_camera_ != plan->camera;
  if (!is_full_size) moving_camera_ = plan->camera;
  const auto picture =
      is_live ? draw_live(device, *plan, control, times)
              : draw_keeping(
                    *device.device, **scene, *plan, is_full_size ? capture_ : moving_capture_, times,
                    [&] { return prepare(device, control.monitor); }, control.monitor, control.monitor, more);
  if (!picture) return picture.error();
  if (is_full_size) live_.reset();  // the camera has come to rest
  return refines ? Result<void>() : give(plan->recipe, picture->frame, plan->recipe.frames, plan->averages());
}

Result<Drawn> ViewModel::draw_live(DrawingDevice& device, const Plan& plan, const DrawControl& control,
                                   StageTimes& times) {
  constexpr int kReach = 3;
  if (auto ready = prepare(device, control.monitor); !ready) return ready.error();
  if (!live_ || !differ_in_camera_alone(live_->plan, plan)) {
    live_.emplace(plan);
    SteadyFrames frames = frames_of_still_scene(*device.device, *completed_.scene, [this](int) { return live_->plan; });
    frames.reach = kReach;
    frames.count = std::numeric_limits<int>::max();
    frames.only_past = true;
    live_->sequence.emplace(*device.device, std::move(frames));
  }
  live_->plan = plan;
  live_->plan.first_noise += live_->count;
  auto drawn = live_->sequence->draw(live_->count++, times, control.monitor, live_->stops, {});
  if (!drawn)
    live_.reset();  // it may lack frames
  else if (plan.metered)
    live_->stops = drawn->stops;
  return drawn;
}

Result<void> ViewModel::shade(DrawingDevice& device, const Request& request, const DrawControl& control,
                              StageTimes& times) {
  auto recipe = make_file_recipe(request, *gbuffer_);
  if (!recipe) return recipe.error();
  if (recipe->occlusion == "reference")
    return usage_error("the ray-traced reference needs a model: a G-buffer shows only what the camera sees");
  recipe->passes = request.passes;
  device.keep_memory_for(facts_.width, facts_.height, true);
  const ScopedPlanePool pool(device.device->pool());
  GBuffer views{.info = planes_->info, .layers = {}};
  Image& layer = views.layers.emplace_back(facts_.width, facts_.height);
  for (std::size_t k = 0; k < planes_->layers[0].planes.size(); ++k)
    layer.add(planes_->layers[0].names[k]) = Plane::view(planes_->layers[0].planes[k]);
  const auto picture = shade_planes(*device.device, std::move(views), *recipe, times, control.monitor);
  if (!picture) return picture.error();
  const auto names = shown_planes(request, *device.device, picture->frame);
  if (!names) return names.error();
  const auto planes = device.device->download(picture->frame, *names);
  if (!planes) return planes.error();
  const auto take = [&](const PictureInfo& info, const Image& rows, int) -> Result<void> {
    return control.take(picture_of(rows, *names, request, recipe->settings, info), 1, true);
  };
  times.done("download");
  return reduced_rows(recipe->reduction, *recipe, take)(picture->frame.info, *planes, 0);
}

}  // namespace umbrage::view
