#include "renderer/job.h"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#include <thread>

#include "core/check.h"
#include "core/suggest.h"
#include "devices/cpu/cpu_device.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "effects/output/output.h"
#include "generators/builtin.h"
#include "looks/quality.h"
#include "rays/interior_lights.h"
#include "reference/reference.h"
#include "renderer/drawing.h"
#include "renderer/hdri.h"
#include "renderer/isa_setting.h"
#include "scene/ground.h"

namespace umbrage {

void StageTimes::done(std::string_view name) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = std::chrono::duration<double, std::milli>(now - last).count();
  last = now;
  for (Stage& stage : stages)
    if (stage.name == name) {
      stage.ms += ms;
      return;
    }
  stages.push_back({std::string(name), ms});
}

double StageTimes::total() const {
  double sum = 0.0;
  for (const Stage& stage : stages) sum += stage.ms;
  return sum;
}

Result<Scene> load_scene(const std::string& model, const ImportSettings& settings) {
  if (model.empty()) return usage_error("the name of a model is empty");
  if (!model.starts_with("scene:")) return import_scene(model, settings);
  if (auto fine = check_scene_index(settings, model, 1); !fine) return fine.error();
  auto scene = make_builtin_scene(model);
  if (scene && settings.up != glm::vec3(0.0f)) scene->up = settings.up;
  return scene;
}

Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings) {
  auto all = load_scene(models.at(0), settings);
  for (std::size_t m = 1; all && m < models.size(); ++m) {
    auto next = load_scene(models[m], settings);
    if (!next) return next;
    const int materials = int(all->materials.size()), textures = int(all->textures.size());
    int objects = 0;
    for (const Mesh& mesh : all->meshes) objects = std::max(objects, mesh.object + 1);
    for (Material& material : next->materials) {
      for (int* texture : {&material.texture, &material.emission_texture})
        if (*texture != kNoTexture) *texture += textures;
      all->materials.push_back(std::move(material));
    }
    for (Texture& texture : next->textures) all->textures.push_back(std::move(texture));
    for (Mesh& mesh : next->meshes) {
      mesh.material += materials;
      mesh.object += objects;
      all->meshes.push_back(std::move(mesh));
    }
    for (std::string& warning : next->warnings) all->warnings.push_back(std::move(warning));
    all->bounds_min = glm::min(all->bounds_min, next->bounds_min);
    all->bounds_max = glm::max(all->bounds_max, next->bounds_max);
    all->views.clear();
    all->scene_names.clear();
    all->cameras.insert(all->cameras.end(), next->cameras.begin(), next->cameras.end());
    all->name += " + " + next->name;
  }
  return all;
}

Result<void> use_camera(int index, Scene& scene) {
  const std::vector<View>& cameras = scene.cameras.empty() ? scene.views : scene.cameras;
  if (index < 0 || std::size_t(index) >= cameras.size())
    return usage_error("--camera-index cannot be '{}': {} has {}", index, scene.name,
                       cameras.empty()       ? "no cameras"
                       : cameras.size() == 1 ? "one camera, 0"
                                             : fmt::format("cameras 0 to {}", cameras.size() - 1));
  View view = cameras[std::size_t(index)];
  // It turns around what is in the middle of the scene, as far as it looks there.
  const glm::vec3 along = glm::normalize(view.target - view.eye);
  const float distance = glm::dot(scene.center() - view.eye, along);
  if (!scene.cameras.empty())
    view.target = view.eye + along * (distance > 0.0f ? distance : std::max(scene.radius(), 1e-6f));
  scene.views = {view};
  return {};
}

namespace {

/// Who captures for a Vulkan device, and how: UMBRAGE_VULKAN_CAPTURE; else the device decides.
Result<VulkanCapture> vulkan_capture() {
  const char* wish = std::getenv("UMBRAGE_VULKAN_CAPTURE");
  if (!wish || *wish == '\0') return VulkanCapture::kAuto;
  if (wish == std::string_view("cpu")) return VulkanCapture::kCpu;
  if (wish == std::string_view("rays")) return VulkanCapture::kRays;
  if (wish == std::string_view("raster") || wish == std::string_view("gpu")) return VulkanCapture::kRaster;
  return usage_error("UMBRAGE_VULKAN_CAPTURE cannot be '{}': it takes raster, rays, gpu or cpu", wish);
}

}  // namespace

Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads) {
  if (auto valid = check_isa_setting(); !valid) return valid.error();
  const auto cpu = [&] { return make_cpu_device({.threads = threads}); };
  if (name == "cpu") return cpu();
  const auto capture = vulkan_capture();
  if (!capture) return capture.error();
  if (name == "auto") {
    auto gpu = make_vulkan_device({.real = true, .capture = *capture}, cpu());
    return gpu ? std::move(gpu) : cpu();
  }
  if (name == "vulkan") return make_vulkan_device({.capture = *capture}, cpu());
  if (const std::string prefix = "vulkan:"; name.starts_with(prefix)) {
    const char* end = name.data() + name.size();
    int index = -1;
    const auto [stop, failed] = std::from_chars(name.data() + prefix.size(), end, index);
    if (failed == std::errc() && stop == end && index >= 0)
      return make_vulkan_device({.index = index, .capture = *capture}, cpu());
    return usage_error("there is no device '{}': a number follows vulkan:, such as vulkan:0", name);
  }
  constexpr std::string_view kNames[] = {"cpu", "vulkan", "auto"};
  return usage_error("there is no device '{}'{}", name, suggestion(name, kNames));
}

std::span<const Effect* const> handed_in() {
  static const Effect* const all[] = {&reference_effect()};
  return all;
}

std::vector<const Effect*> every_effect() {
  std::vector<const Effect*> all(effects().begin(), effects().end());
  all.insert(all.end(), handed_in().begin(), handed_in().end());
  return all;
}

Result<EffectSettings> effect_settings(std::span<const std::string> assignments) {
  EffectSettings settings;
  for (const Effect* effect : every_effect())
    settings[std::string(effect->name)] = initial_parameters(effect->parameters, effect->params_size);
  for (const std::string& assignment : assignments)
    if (auto done = apply_setting(settings, assignment, handed_in()); !done) return done.error();
  return settings;
}

Result<Length> parse_radius(std::string_view option, const std::string& text) {
  const bool share = text.ends_with('%');
  const std::string_view digits = std::string_view(text).substr(0, text.size() - (share ? 1 : 0));
  float value = 0.0f;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !(value > 0.0f) || !std::isfinite(value))
    return usage_error("{} cannot be '{}': it takes a length above 0 in scene units, or a share such as 5%", option,
                       text);
  return Length{value, share ? 1 : 0};
}

Result<int> parse_scale(std::string_view option, std::string_view text) {
  constexpr std::string_view kNames[] = {"full", "half", "quarter"};
  for (int k = 0; k < 3; ++k)
    if (kNames[k] == text) return 1 << k;
  return usage_error("{} cannot be '{}': it takes full, half or quarter", option, text);
}

Result<void> apply_variant(EffectSettings& settings, const Effect& effect, std::string_view variant) {
  for (std::size_t start = 0; start < variant.size();) {
    const std::size_t end = std::min(variant.find(' ', start), variant.size());
    const std::string setting = fmt::format("{}.{}", effect.name, variant.substr(start, end - start));
    if (auto set = apply_setting(settings, setting, handed_in()); !set) return set;
    start = end + 1;
  }
  return {};
}

namespace {

/// The quality that the user or else the look names, or null.
const Quality* quality_of(const DrawSettings& draw, const Look& look) {
  return find_quality(draw.quality.empty() ? look.quality : std::string_view(draw.quality));
}

}  // namespace

Result<CaptureSettings> capture_settings(const DrawSettings& draw, const Look& look, int shadows, long most) {
  const int guard = int(std::ceil(draw.guard_percent / 100.0f * float(std::max(draw.width, draw.height))));
  const long width = draw.width + 2L * guard, height = draw.height + 2L * guard;
  const Quality* quality = quality_of(draw, look);
  int shadow_rays = quality ? quality->shadow_rays : look.shadow_rays;
  // Lights that are given a size show it.
  const bool of_hdri =
      draw.hdri.lights() && std::find(look.effects.begin(), look.effects.end(), "lighting") != look.effects.end();
  if (of_hdri || draw.light_size_deg.value_or(0.0f) > 0.0f) shadow_rays = std::max(shadow_rays, 1);
  CaptureSettings settings{.width = draw.width,
                           .height = draw.height,
                           .shadows = shadows,
                           .layers = draw.layers.value_or(std::max(look.layers, quality ? quality->layers : 1)),
                           .back_sides = look.back_sides,
                           .extra_views = draw.extra_views.value_or(look.extra_views),
                           .guard = guard,
                           .shadow_rays = shadow_rays};
  // A quality wants no more layers than there is room for.
  while (!draw.layers && settings.layers > look.layers && !layer_count(settings)) --settings.layers;
  const auto layers = layer_count(settings);
  if (!layers) return layers.error();
  if (width * height * *layers > most)
    return usage_error("{} of {} x {} pixels {} too many: together at most {} pixels",
                       *layers == 1 ? "one layer" : fmt::format("{} layers", *layers), width, height,
                       *layers == 1 ? "is" : "are", most);
  return settings;
}

namespace {

/// Whether an effect sees by the scene's lights, or brings its own.
bool by_scene_lights(const Effect& effect, const EffectSettings& settings) {
  const Parameter* rig = find_parameter(effect, "rig");
  return rig && parameter_text(*rig, settings.find(effect.name)->second) == "scene";
}

/// The shadows that effects of the look read and do not leave out, as so many of the first lights: others are not
/// traced.
int wanted_shadows(const Recipe& recipe) {
  int wanted = 0;
  for (const std::string_view name : recipe.look->effects) {
    const Effect* effect = find_effect(name == "occlusion" ? std::string_view(recipe.occlusion) : name);
    if (!effect) continue;
    const Parameter* strength = find_parameter(*effect, "shadow");
    if (strength && parameter_text(*strength, recipe.settings.find(effect->name)->second) == "0") continue;
    if (find_parameter(*effect, "rig") && !by_scene_lights(*effect, recipe.settings)) continue;
    for (const Pass& pass : effect->passes)
      for (int light = wanted; light < kMostShadows; ++light)
        if (std::find(pass.inputs.begin(), pass.inputs.end(), shadow_plane(light)) != pass.inputs.end())
          wanted = light + 1;
  }
  return wanted;
}

/// Applies --ao-radius to every technique that has one.
Result<void> apply_radius(const DrawSettings& draw, const PictureInfo& info, EffectSettings& settings) {
  if (draw.radius.empty()) return {};
  const auto length = parse_radius("--ao-radius", draw.radius);
  if (!length) return length.error();
  const auto radius = radius_in_scene("--ao-radius", *length, info);
  if (!radius) return radius.error();
  for (const Effect* effect : every_effect())
    if (effect->set_radius) effect->set_radius(*radius, info, settings.find(effect->name)->second);
  // What --set says of a technique holds whatever the radius.
  for (const std::string& setting : draw.settings)
    if (!setting.starts_with("output.") && !setting.starts_with("outline."))
      if (auto done = apply_setting(settings, setting, handed_in()); !done) return done;
  return {};
}

/// The shade on an unseen ground that is written with alpha is mixed by who shows it, in the file's values.
void blend_as_written(EffectSettings& settings) {
  const auto& finish = as<OutputParams>(settings.find("output")->second);
  if (!finish.transparent || finish.transfer != 0) return;
  if (auto done = apply_setting(settings, "ground.blend=display", handed_in()); !done) fail_check(done.error().message);
}

/// Gives lights to a scene that has none.
Result<void> add_lights(Scene& scene, const Camera& camera, const DrawSettings& settings, const Recipe& recipe,
                        int threads) {
  // In a court or a hall little of the sky is seen, and what is seen lies in light that others send on.
  constexpr glm::vec3 kAmbientInside(0.46f, 0.50f, 0.56f);
  if (recipe.look->studio_lights) {
    scene.lights = studio_lights(camera);
    scene.ambient = glm::vec3(kStudioAmbient);
  } else {
    scene.lights = default_lights(scene, camera);
  }
  const glm::vec3 eye = camera.eye();
  const bool inside =
      glm::all(glm::greaterThan(eye, scene.bounds_min)) && glm::all(glm::lessThan(eye, scene.bounds_max));
  bool seen = recipe.occlusion == reference_effect().name;
  for (const std::string_view name : recipe.look->effects) {
    const Effect* effect = find_effect(name);
    seen = seen || (effect && by_scene_lights(*effect, recipe.settings));
  }
  if (!inside || !seen) return {};
  const auto traced = trace_ready(scene, threads);
  if (!traced) return traced.error();
  const PictureInfo info{.width = settings.width, .height = settings.height, .camera = camera};
  std::vector<Light> lights = interior_lights(**traced, info, scene.lights);
  if (lights.empty()) return {};
  scene.lights = std::move(lights);
  scene.ambient = kAmbientInside;
  return {};
}

/// Whether the look's own technique gathers light that surfaces send each other.
bool gathers_light(const Look& look, const EffectSettings& settings) {
  const Effect* technique = find_effect(look.occlusion);
  if (!technique) return false;
  const ParameterBytes& params = settings.find(technique->name)->second;
  return std::any_of(technique->passes.begin(), technique->passes.end(), [&](const Pass& pass) {
    const bool runs = !pass.needed || pass.needed(params);
    return runs && std::find(pass.outputs.begin(), pass.outputs.end(), "indirect.r") != pass.outputs.end();
  });
}

/// Applies a setting that is right whatever the user says.
void set_own(EffectSettings& settings, std::string_view setting) {
  if (auto done = apply_setting(settings, setting, handed_in()); !done) fail_check(done.error().message);
}

/// Whether the look shows how bright the scene's lights are.
bool shows_light(const Look& look, const EffectSettings& settings) {
  const bool has = std::find(look.effects.begin(), look.effects.end(), "lighting") != look.effects.end();
  return has && by_scene_lights(*find_effect("lighting"), settings);
}

/// What an image around the scene changes in a look: one that it lights takes its light as it is, and is exposed for
/// it.
void use_hdri(const DrawSettings& draw, Recipe& recipe) {
  if (draw.hdri.shown()) set_own(recipe.settings, "output.sky=on");
  if (!draw.hdri.lights() || !shows_light(*recipe.look, recipe.settings)) return;
  set_own(recipe.settings, "lighting.ambient=1");
  if (as<OutputParams>(recipe.settings.find("output")->second).metering != kMeteringNone) return;
  set_own(recipe.settings, "output.metering=light");
  set_own(recipe.settings, "output.exposure=0");
}

/// Whether the camera stands inside the scene.
bool stands_inside(const Camera& camera, const Scene& scene) {
  const glm::vec3 eye = camera.eye();
  return glm::all(glm::greaterThan(eye, scene.bounds_min)) && glm::all(glm::lessThan(eye, scene.bounds_max));
}

/// In a court or a hall little of an image's light arrives: there a look that was to be exposed for the light, unless
/// the user has said so, is exposed by the picture.
void meter_inside(const DrawSettings& draw, const Camera& camera, const Scene& scene, Recipe& recipe) {
  const auto said = [](const std::string& setting) { return setting.starts_with("output.metering="); };
  if (!draw.hdri.lights() || !stands_inside(camera, scene)) return;
  if (std::any_of(draw.settings.begin(), draw.settings.end(), said)) return;
  if (as<OutputParams>(recipe.settings.find("output")->second).metering == kMeteringLight)
    set_own(recipe.settings, "output.metering=picture");
}

/// The key light's disc or ball, as wide as that many degrees of what the scene's middle sees.
void widen_key_light(float angle_deg, Scene& scene) {
  if (scene.lights.empty()) return;
  Light& key = scene.lights[0];
  key.angle_deg = angle_deg;
  key.radius = glm::distance(key.position, scene.center()) * std::tan(glm::radians(0.5f * angle_deg));
}

}  // namespace

void furnish(Scene& scene, const DrawSettings& settings) {
  if (settings.hdri.lights()) light_by(settings.hdri, scene);
  const Look* look = find_look(settings.look);
  if (!look || !look->ground || settings.ground == Ground::kOff) return;  // make_recipe says what is wrong
  const Camera camera = frame_scene(scene, settings.framing, settings.width, settings.height);
  const glm::vec3 eye = camera.eye();
  const bool inside = stands_inside(camera, scene);
  // From below a ground would hide the model.
  const glm::vec3 looks_along = -glm::vec3(glm::transpose(camera.view_from_world)[2]);
  const glm::vec3 lowest = scene.center() - glm::normalize(scene.up) * scene.radius();
  const bool below = camera.projection == Projection::kOrthographic
                         ? glm::dot(looks_along, scene.up) > 0.0f
                         : glm::dot(eye - lowest, scene.up) < 0.0f || (glm::dot(looks_along, scene.up) > 0.0f &&
                                                                       glm::dot(eye - scene.center(), scene.up) < 0.0f);
  if (settings.ground == Ground::kOn || (!inside && !below && lacks_ground(scene)))
    add_ground(scene, settings.hdri.lights() ? lowest_light_deg(scene) : std::nullopt);
}

Result<Recipe> make_recipe(const DrawSettings& draw) {
  Recipe recipe;
  recipe.look = find_look(draw.look);
  if (!recipe.look) {
    std::vector<std::string_view> names;
    for (const Look* look : looks()) names.push_back(look->name);
    return usage_error("there is no look '{}'{}", draw.look, suggestion(draw.look, names));
  }
  recipe.occlusion = draw.occlusion.empty() ? std::string(recipe.look->occlusion) : draw.occlusion;
  const auto techniques = occlusion_names(handed_in());
  if (std::find(techniques.begin(), techniques.end(), recipe.occlusion) == techniques.end())
    return usage_error("there is no occlusion technique '{}'{}", recipe.occlusion,
                       suggestion(recipe.occlusion, techniques));
  const bool traced = find_effect(recipe.occlusion) == nullptr;  // or none at all
  if (draw.ground == Ground::kOn && !recipe.look->ground)
    return usage_error("--ground on is for looks that show the shade alone, such as studio, not '{}'", draw.look);
  const Quality* quality = quality_of(draw, *recipe.look);
  if (!quality && !draw.quality.empty()) {
    std::vector<std::string_view> names;
    for (const Quality& each : qualities()) names.push_back(each.name);
    return usage_error("--quality cannot be '{}'{}", draw.quality, suggestion(draw.quality, names));
  }
  recipe.frames = draw.frames.value_or(quality ? quality->frames : recipe.look->frames);
  recipe.occlusion_every = quality ? quality->occlusion_every : recipe.look->occlusion_every;
  if (traced) recipe.occlusion_every = 1;
  if (!draw.occlusion_scale.empty()) {
    const auto every = parse_scale("--ao-scale", draw.occlusion_scale);
    if (!every) return every.error();
    if (traced && *every > 1)
      return usage_error("--ao-scale cannot be '{}' with --ao {}: it takes full, or another technique",
                         draw.occlusion_scale, recipe.occlusion);
    recipe.occlusion_every = *every;
  }
  if (!draw.radius.empty())
    if (const auto radius = parse_radius("--ao-radius", draw.radius); !radius) return radius.error();
  recipe.settings = look_settings(*recipe.look, handed_in());
  if (quality)
    for (const std::string_view setting : recipe.frames > 1 ? quality->settings_of_frames : quality->settings)
      if (auto done = apply_setting(recipe.settings, setting, handed_in()); !done) fail_check(done.error().message);
  use_hdri(draw, recipe);
  for (const std::string& setting : draw.settings)
    if (setting.starts_with("upsample.factor=") || setting.starts_with("upsample.indirect="))
      return usage_error("--set {}: {} follows from --ao-scale", setting, setting.substr(0, setting.find('=')));
  // A look whose own technique gathers light gets it from the reference too, unless --set says otherwise.
  if (recipe.occlusion == reference_effect().name && gathers_light(*recipe.look, recipe.settings))
    if (auto set = apply_setting(recipe.settings, "reference.light=bounce", handed_in()); !set) return set.error();
  for (const std::string& setting : draw.settings)
    if (auto done = apply_setting(recipe.settings, setting, handed_in()); !done) return done.error();
  return recipe;
}

namespace {

/// The parameter by which a technique gets other noise in each frame, "hemisphere.seed", and what it is in the first;
/// empty where it has none.
struct FrameNoise {
  std::string parameter;
  int first = 0;
};

FrameNoise frame_noise(const Recipe& recipe) {
  for (const Effect* effect : every_effect())
    if (effect->name == recipe.occlusion)
      for (const char* name : {"frame", "seed"})
        if (const Parameter* row = find_parameter(*effect, name))
          return {fmt::format("{}.{}", effect->name, name),
                  std::atoi(parameter_text(*row, recipe.settings.find(effect->name)->second).c_str())};
  return {};
}

/// Applies a setting of ours.
void must_apply(Recipe& recipe, const std::string& setting) {
  if (auto done = apply_setting(recipe.settings, setting, handed_in()); !done) fail_check(done.error().message);
}

/// The reference tells whoever traces; this tells the thread that made it alone, and not more often than people see.
std::function<bool(double)> own_thread_only(const std::function<bool(double)>& go_on) {
  using Clock = std::chrono::steady_clock;
  return [&go_on, own = std::this_thread::get_id(), last = Clock::time_point()](double done) mutable {
    constexpr std::chrono::milliseconds kOften(40);
    if (std::this_thread::get_id() != own || Clock::now() - last < kOften) return true;
    last = Clock::now();
    return go_on(done);
  };
}

/// What a device's share of one step is of the whole drawing. It listens to the device as long as it lives.
class DrawProgress {
 public:
  /// A frame has a step for its capture and one for each effect; others that come between are part of the next one's.
  DrawProgress(Device& device, const std::function<bool(double)>& progress, int effects, int frames)
      : device_(device), progress_(progress), steps_(1 + effects), frames_(frames) {
    device_.go_on = [this](double share) { return tell(share); };
  }
  ~DrawProgress() { device_.go_on = nullptr; }
  DrawProgress(const DrawProgress&) = delete;

  void step_done() { ++step_; }
  void frame_done() {
    ++frame_;
    step_ = 0;
  }
  /// Errors: kInterrupted.
  Result<void> end() {
    if (progress_(1.0)) return {};
    return Error{ErrorKind::kInterrupted, "interrupted"};
  }

 private:
  bool tell(double share) {
    const double of_frame = std::min((step_ + share) / steps_, 1.0);
    // An effect of several passes, or on several layers, begins again with each: what was told stays.
    told_ = std::max(told_, std::min((frame_ + of_frame) / frames_, 1.0));
    return progress_(told_);
  }

  Device& device_;
  const std::function<bool(double)>& progress_;
  const int steps_, frames_;
  int step_ = 0, frame_ = 0;
  double told_ = 0.0;
};

/// The recipe's look, whose effects are told to `times` and `progress` as they are done. Effects that are handed in
/// have nobody yet who runs them.
LookRun look_run(const Recipe& recipe, StageTimes& times, DrawProgress& progress) {
  return {.look = recipe.look,
          .occlusion = recipe.occlusion,
          .occlusion_every = recipe.occlusion_every,
          .settings = &recipe.settings,
          .after =
              [&times, &progress](std::string_view name) {
                times.done(name);
                progress.step_done();
              },
          .stops = {},
          .meter = metered_stops,
          .handed_in = handed_in(),
          .run_handed_in = {}};
}

}  // namespace

Result<Drawing> begin_drawing(Device& device, Scene& scene, const DrawSettings& settings, long most_pixels) {
  auto recipe = make_recipe(settings);
  if (!recipe) return recipe.error();
  Drawing drawing;
  drawing.recipe = std::move(*recipe);
  drawing.camera = frame_scene(scene, settings.framing, settings.width, settings.height);
  if (scene.lights.empty() && !settings.hdri.lights())
    if (auto added = add_lights(scene, drawing.camera, settings, drawing.recipe, device.threads()); !added)
      return added.error();
  meter_inside(settings, drawing.camera, scene, drawing.recipe);
  if (settings.light_size_deg) widen_key_light(*settings.light_size_deg, scene);
  const auto capture_with = capture_settings(settings, *drawing.recipe.look,
                                             std::max(settings.shadows, wanted_shadows(drawing.recipe)), most_pixels);
  if (!capture_with) return capture_with.error();
  drawing.capture = *capture_with;
  blend_as_written(drawing.recipe.settings);
  drawing.output = drawing.recipe.settings.find("output")->second;
  if (drawing.averages()) {
    // Light with alpha, so that edges mix with the background as light does, or for the eye.
    must_apply(drawing.recipe, "output.transfer=none");
    if (!settings.hdri.shown()) must_apply(drawing.recipe, "output.transparent=on");
    keep_lines(drawing);
  }
  const FrameNoise noise = frame_noise(drawing.recipe);
  drawing.noise = noise.parameter;
  drawing.first_noise = noise.first;
  return drawing;
}

Camera begin_frame(Drawing& drawing, int frame, const DrawSettings& settings) {
  drawing.capture.sample = frame;
  if (drawing.averages() && !drawing.noise.empty())
    must_apply(drawing.recipe, fmt::format("{}={}", drawing.noise, (drawing.first_noise + frame) % kMostFrames));
  return shifted_camera(drawing.camera, frame_offset(frame, drawing.recipe.frames), settings.width, settings.height);
}

Result<void> add_sky(Device& device, const Scene& scene, const Drawing& drawing, const DrawSettings& settings,
                     Frame& frame) {
  if (!settings.hdri.shown()) return {};
  // Looks that do not show how bright lights are show a sky as if white lay in it.
  const float gain = shows_light(*drawing.recipe.look, drawing.recipe.settings) || !(scene.usual_light > 0.0f)
                         ? settings.hdri.intensity
                         : settings.hdri.intensity / scene.usual_light;
  const int height = frame.info.height;
  const Rows rows = drawing.capture.band ? held_rows(*drawing.capture.band, height) : Rows{0, height};
  return device.add(sky_planes(settings.hdri, scene.up, gain, frame.info, rows), frame);
}

Result<void> know_picture(Drawing& drawing, const PictureInfo& info, const DrawSettings& settings) {
  if (drawing.radius_known) return {};
  drawing.radius_known = true;
  return apply_radius(settings, info, drawing.recipe.settings);
}

Result<Frame> draw(Device& device, Scene& scene, const DrawSettings& settings, StageTimes& times) {
  const KeptPlanes kept;
  auto drawing = begin_drawing(device, scene, settings, kMostPixels);
  if (!drawing) return drawing.error();
  const Recipe& recipe = drawing->recipe;
  DrawProgress progress(device, settings.progress, int(recipe.look->effects.size()), recipe.frames);
  TracedScenePtr hierarchy;  // of the reference, for all frames
  const auto run_reference = [&](const Effect&, const ParameterBytes& params, Frame& on) -> Result<void> {
    if (!hierarchy) {
      auto traced = trace_ready(scene, device.threads());
      if (!traced) return traced.error();
      hierarchy = std::move(*traced);
    }
    const auto planes = trace_reference(*hierarchy, on.info, params, {device.threads(), own_thread_only(device.go_on)});
    return planes ? device.add(*planes, on) : planes.error();
  };
  LookRun run = look_run(recipe, times, progress);
  if (settings.stops) run.stops = *settings.stops;
  run.run_handed_in = run_reference;
  PictureSum total{.for_eye = recipe.look->averages_for_eye};
  // The last frame stays.
  for (int k = recipe.frames - 1;; --k) {
    const Camera camera = begin_frame(*drawing, k, settings);
    auto frame = device.capture(camera, drawing->capture);
    if (!frame) return frame;
    times.done("capture");
    progress.step_done();
    if (auto added = add_sky(device, scene, *drawing, settings, *frame); !added) return added.error();
    if (settings.hdri.shown()) times.done("sky");
    if (auto done = know_picture(*drawing, frame->info, settings); !done) return done.error();
    const auto stops = run_look(run, device, *frame);
    if (!stops) return stops.error();
    run.stops = *stops;  // one exposure for all
    if (settings.stops) *settings.stops = *stops;
    if (!drawing->averages()) {
      if (auto done = progress.end(); !done) return done.error();
      return frame;
    }
    const auto picture = device.download(*frame, averaged_planes(settings, *drawing));
    if (!picture) return picture.error();
    add_picture(total, *picture);
    times.done("average");
    if (auto done = draw_lines(device, *drawing, *frame, times); !done) return done.error();
    progress.frame_done();
    if (k > 0) continue;
    if (auto done = finish_average(device, total, *drawing, also_averaged(settings, *drawing), *frame); !done)
      return done.error();
    times.done("average");
    if (auto done = progress.end(); !done) return done.error();
    return frame;
  }
}

namespace {

/// Uploads a G-buffer and makes the normals that it may lack.
Result<Frame> uploaded(Device& device, const GBuffer& gbuffer, const EffectSettings& settings) {
  auto frame = device.upload(gbuffer);
  if (!frame) return frame;
  const Effect& normals = *find_effect("normals");
  for (std::size_t layer = 0; layer < gbuffer.layers.size(); ++layer)
    if (!gbuffer.layers[layer].find("normal.x"))
      if (auto done = device.run(normals, settings.find(normals.name)->second, *frame, int(layer)); !done)
        return done.error();
  return frame;
}

Result<Frame> shade_with_effects(Device& device, const GBuffer& gbuffer, const DrawSettings& draw,
                                 std::span<const std::string> names, StageTimes& times) {
  std::vector<const Effect*> wanted;
  for (const std::string& name : names) {
    if (find_effect(name)) {
      wanted.push_back(find_effect(name));
      continue;
    }
    std::vector<std::string_view> all;
    for (const Effect* effect : effects()) all.push_back(effect->name);
    return usage_error("there is no effect '{}'{}", name, suggestion(name, all));
  }
  const auto initial = effect_settings(draw.settings);
  if (!initial) return initial.error();
  EffectSettings settings = *initial;
  DrawProgress progress(device, draw.progress, int(wanted.size()), 1);
  auto frame = uploaded(device, gbuffer, settings);
  if (!frame) return frame;
  progress.step_done();
  times.done("upload");
  if (auto done = apply_radius(draw, frame->info, settings); !done) return done.error();
  for (const Effect* effect : wanted) {
    if (auto done = device.run(*effect, settings.find(effect->name)->second, *frame); !done) return done.error();
    progress.step_done();
    times.done(effect->name);
  }
  if (auto done = progress.end(); !done) return done.error();
  return frame;
}

}  // namespace

Result<Frame> shade_planes(Device& device, GBuffer gbuffer, const DrawSettings& draw,
                           std::span<const std::string> effects, StageTimes& times) {
  if (!effects.empty()) return shade_with_effects(device, gbuffer, draw, effects, times);
  DrawSettings single = draw;
  single.frames = 1;  // the camera that would be moved is another's
  auto recipe = make_recipe(single);
  if (!recipe) return recipe.error();
  if (!find_effect(recipe->occlusion) && recipe->occlusion != kNoOcclusion)
    return usage_error("--ao {} needs the model: it cannot shade a G-buffer", recipe->occlusion);
  blend_as_written(recipe->settings);
  DrawProgress progress(device, draw.progress, int(recipe->look->effects.size()), 1);
  if (gbuffer.info.lights.empty()) {
    // View space is the camera's own: what is above and to the left of it does not depend on where it stands.
    Camera at_origin = gbuffer.info.camera;
    at_origin.view_from_world = glm::mat4(1.0f);
    gbuffer.info.lights = recipe->look->studio_lights ? studio_lights(at_origin) : default_lights({}, at_origin);
    if (recipe->look->studio_lights) gbuffer.info.ambient = glm::vec3(kStudioAmbient);
  }
  auto frame = uploaded(device, gbuffer, recipe->settings);
  if (!frame) return frame;
  progress.step_done();
  times.done("upload");
  if (auto done = apply_radius(single, frame->info, recipe->settings); !done) return done.error();
  const LookRun run = look_run(*recipe, times, progress);
  if (const auto stops = run_look(run, device, *frame); !stops) return stops.error();
  if (auto done = progress.end(); !done) return done.error();
  return frame;
}

}  // namespace umbrage
