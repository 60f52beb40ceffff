#include "renderer/plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

#include "core/check.h"
#include "core/lists.h"
#include "core/reflection_map.h"
#include "devices/shared/capture_info.h"
#include "effects/hidden/hidden.h"
#include "effects/outline/outline.h"
#include "effects/output/output.h"
#include "rays/interior_lights.h"
#include "reference/reference.h"
#include "renderer/accumulation.h"
#include "renderer/drawing.h"
#include "renderer/marked_samples.h"
#include "renderer/passes.h"
#include "scene/ground.h"

namespace umbrage {
namespace {

/// Returns whether the camera is inside the scene's bounding box.
bool is_inside_scene(const Camera& camera, const Scene& scene) {
  const glm::vec3 eye = camera.eye();
  return glm::all(glm::greaterThan(eye, scene.bounds_min)) && glm::all(glm::lessThan(eye, scene.bounds_max));
}

/// Returns the elevation of the lowest light above the horizon; empty if there is none.
std::optional<float> lowest_light_deg(const Scene& scene) {
  std::optional<float> lowest;
  for (const Light& light : scene.lights) {
    const float sine = glm::dot(light.direction, glm::normalize(scene.up));
    const float height = glm::degrees(std::asin(std::clamp(sine, -1.0f, 1.0f)));
    if (height > 0.0f) lowest = std::min(lowest.value_or(height), height);
  }
  return lowest;
}

/// Returns whether a material is a metal, which under lights alone is flat and dark.
bool has_metal(const Scene& scene) {
  constexpr float kMetal = 0.5f;
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.roughness >= 0.0f && material.metallic > kMetal; });
}

/// Adds lights for a scene that has none.
Result<void> add_lights(const Scene& scene, int threads, const ProgressMonitor& monitor, Plan& plan) {
  // In a courtyard or a hall little of the sky is visible; what is visible is lit by indirect light.
  constexpr glm::vec3 kAmbientInside(0.46f, 0.50f, 0.56f);
  const Recipe& recipe = plan.recipe;
  Lighting& lighting = plan.lighting();
  lighting =
      recipe.look->studio_lights ? studio_lighting(plan.camera, scene.up) : default_lighting(plan.camera, scene.up);
  const bool inside = is_inside_scene(plan.camera, scene);
  plan.lit_from_camera = !inside;
  if (!inside && (recipe.look->studio_lights ? has_roughness(scene) : has_metal(scene)))
    lighting.reflections = studio_reflections(scene.up);
  if (!inside || !uses_scene_lights(recipe)) return {};
  const auto traced = build_traced_scene(scene, threads, monitor);
  if (!traced) return traced.error();
  const PictureInfo info{.width = recipe.width, .height = recipe.height, .camera = plan.camera};
  std::vector<Light> lights = interior_lights(**traced, info, lighting.lights);
  if (lights.empty()) return {};
  lighting.lights = std::move(lights);
  lighting.ambient = kAmbientInside;
  lighting.ambient_shape = {};
  return {};
}

/// Inside a scene, where little of the light of an environment image arrives, a look that meters this light meters the
/// picture instead, unless the request sets `metering`.
void meter_indoors(const Scene& scene, Plan& plan) {
  if (!is_inside_scene(plan.camera, scene) || is_set<OutputParams>(plan.recipe, "metering")) return;
  auto& output = params_of<OutputParams>(plan.recipe.settings);
  if (output.metering == kMeteringLight && plan.recipe.hdri.lights()) output.metering = kMeteringPicture;
}

/// Sets the angular diameter of the key light, a disc or a sphere, as seen from the centre of the scene.
void widen_key_light(float angle_deg, const Scene& scene, Lighting& lighting) {
  if (lighting.lights.empty()) return;
  Light& key = lighting.lights[0];
  key.angle_deg = angle_deg;
  key.radius = glm::distance(key.position, scene.center()) * std::tan(glm::radians(0.5f * angle_deg));
}

/// Makes light white of the same luminance.
glm::vec3 whitened(const glm::vec3& color) {
  return glm::vec3(glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f)));  // Rec.709
}

/// Makes all light white, so that it does not change the hue of values that are shown as colours.
void whiten(Lighting& lighting) {
  for (Light& light : lighting.lights) light.color = whitened(light.color);
  lighting.ambient = whitened(lighting.ambient);
  auto& [red, green, blue] = lighting.ambient_shape.by_color;
  red = green = blue = 0.2126f * red + 0.7152f * green + 0.0722f * blue;
  lighting.reflections = nullptr;
}

/// Leaves only the alpha of a texture.
void make_white(Texture& texture) {
  for (std::size_t k = 0; k < texture.rgba.size(); k += 4) std::fill_n(&texture.rgba[k], 3, std::uint8_t(255));
}

/// Replaces the materials of all surfaces by clay. Cut-outs keep their shape.
void make_clay(const glm::vec3& albedo, Scene& scene) {
  for (Material& material : scene.materials) {
    Material clay{.name = material.name, .albedo = albedo};
    if (material.alpha_mask || material.blended) {
      clay.alpha_mask = material.alpha_mask;
      clay.alpha_cutoff = material.alpha_cutoff;
      clay.blended = material.blended;
      clay.opacity = material.opacity;
      clay.texture = material.texture;
      if (clay.texture != kNoTexture) make_white(scene.textures[std::size_t(clay.texture)]);
    }
    material = clay;
  }
  for (Mesh& mesh : scene.meshes) mesh.colors.clear();
}

/// Converts relative lengths to scene units and checks that lengths fit the scene. Errors: kUsage.
Result<void> resolve_lengths(const Scene& scene, Plan& plan) {
  Recipe& recipe = plan.recipe;
  const PictureInfo info = picture_info(scene, plan.camera, plan.capture);
  if (recipe.radius) {
    const auto radius = radius_in_scene("`occlusion_radius`", *recipe.radius, info);
    if (!radius) return with_field(radius.error(), "occlusion_radius");
    apply_radius(*radius, info, recipe);
  }
  if (recipe.occlusion != reference_effect().name) return {};
  const auto& reference = as<ReferenceParams>(params_of(recipe.settings, recipe.occlusion));
  const auto radius = radius_in_scene("reference.radius", reference.radius, info);
  return radius ? Result<void>() : radius.error();
}

/// Returns the gain of the background. Looks that ignore the brightness of lights show the sky relative to white.
float sky_gain(const Plan& plan) {
  const float intensity = plan.recipe.hdri.intensity, usual = plan.lighting().lit_white_luminance;
  return depends_on_light_brightness(plan.recipe) || !(usual > 0.0f) ? intensity : intensity / usual;
}

/// Returns the noise parameter of the technique, or null.
const Parameter* noise_of(const Recipe& recipe) {
  const Effect* technique = find_named<Effect>(effects_with_external(), recipe.occlusion);
  return technique && !technique->noise.empty() ? find_parameter(*technique, technique->noise) : nullptr;
}

/// Max number of shadow rays per pixel in sample 0 of marked samples; more do not show after the filter.
constexpr int kMaxShadowRays = 16;

/// Passes that are captured only if a material needs them, and what every material lacks where there is none.
constexpr std::pair<std::string_view, std::string_view> kPassesOfMaterials[] = {
    {"emission", "emits light"},
    {"metallic", "has a roughness"},
    {"roughness", "has a roughness"},
    {"material_ao", "has an occlusion map"}};

/// Returns the error for a pass that a capture lacks.
Error missing_pass_error(const std::string& word, std::span<const std::string> given) {
  for (const auto& [pass, reason] : kPassesOfMaterials)
    if (name_on_first_layer(word) == pass)
      return usage_error("there is no pass '{}' in this picture: no material {}; leave it out of `passes`", word,
                         reason);
  std::vector<std::string> shadows;
  for (const std::string& plane : given)
    if (is_shadow_plane(plane)) shadows.push_back(layer_plane(layer_of_plane(word), plane));
  return usage_error("there is no pass '{}' in this picture: its lights cast fewer shadows; `passes` takes {}", word,
                     fmt::join(shadows, ", "));
}

/// Checks the passes that depend on the scene. Errors: kUsage.
Result<void> check_passes(const Plan& plan) {
  const auto depends_on_scene = [](std::string_view pass) {
    return is_shadow_plane(pass) || std::any_of(std::begin(kPassesOfMaterials), std::end(kPassesOfMaterials),
                                                [&](const auto& each) { return each.first == pass; });
  };
  std::vector<std::string> produced;
  for (const std::string& plane : planes_of_frame(plan)) produced.push_back(pass_of(plane));
  for (const std::string& word : plan.recipe.passes)
    if (depends_on_scene(name_on_first_layer(word)) && !contains(produced, word))
      return missing_pass_error(word, plan.given.names);
  return {};
}

/// Sets what frames have before any effect runs.
void set_given(const Scene& scene, Plan& plan) {
  plan.info = picture_info(scene, plan.camera, plan.capture);
  plan.info.more_layers.resize(std::size_t(*layer_count(plan.capture)) - 1);
  plan.given = {};
  for (int layer = 0; layer <= int(plan.info.more_layers.size()); ++layer)
    for (const std::string& name : captured_planes(scene, plan.info, plan.capture))
      plan.given.names.push_back(layer_plane(layer, name));
  for (const int light : softened_lights(plan.info, plan.capture)) plan.given.softened.push_back(shadow_plane(light));
}

}  // namespace

Margin GivenPlanes::needed(const Margins& margins) const {
  Margin max;
  for (const auto& [name, margin] : margins) {
    if (!name.empty() && !contains(names, name)) continue;
    const int more = contains(softened, name) ? kSoftenMargin : 0;
    max = {std::max(max.rows, margin.rows + more), std::max(max.columns, margin.columns + more)};
  }
  return max;
}

bool needs_ground(const Scene& scene, const Recipe& recipe) {
  if (!recipe.look->ground || recipe.ground == Ground::kOff) return false;
  if (recipe.ground == Ground::kOn) return true;
  // An orbit around a model, and a ground that was added, change nothing.
  Framing framing = recipe.framing;
  framing.centers_shadow = false;
  if (is_fitted(scene, framing)) framing.azimuth_deg = 0.0f;
  const Camera camera = frame_scene(scene, framing, recipe.width, recipe.height);
  const glm::vec3 eye = camera.eye();
  // A ground would hide a model that is seen from below.
  const glm::vec3 looks_along = -glm::vec3(glm::transpose(camera.view_from_world)[2]);
  const glm::vec3 lowest = scene.center() - glm::normalize(scene.up) * scene.radius();
  const bool below = camera.projection == Projection::kOrthographic
                         ? glm::dot(looks_along, scene.up) > 0.0f
                         : glm::dot(eye - lowest, scene.up) < 0.0f || (glm::dot(looks_along, scene.up) > 0.0f &&
                                                                       glm::dot(eye - scene.center(), scene.up) < 0.0f);
  return !below && !is_inside_scene(camera, scene) && !shows_own_ground(scene, camera);
}

void adjust_lights(const Recipe& recipe, const Camera& camera, bool of_studio, std::vector<Light>& lights) {
  if (!lights.empty() && recipe.framing.light_deg && lights[0].kind == LightKind::kDirectional)
    lights[0].direction = light_direction(camera, *recipe.framing.light_deg);
  const std::size_t count = std::min(lights.size(), of_studio ? recipe.light_factors.size() : 1);
  for (std::size_t k = 0; k < count; ++k) lights[k].color *= recipe.light_factors[k];
}

Result<void> complete_scene(Scene& scene, const Recipe& recipe) {
  if (scene.start) {
    auto start = std::make_shared<Scene>(*scene.start);
    Recipe uncut = recipe;
    uncut.sections.planes.clear();
    if (auto completed = complete_scene(*start, uncut); !completed) return completed;
    scene.value_colors = start->value_colors;  // one range for all times
    // Those about the range, which is found for the start alone.
    const auto& known = scene.start->warnings;
    scene.warnings.insert(scene.warnings.end(), start->warnings.begin() + std::ptrdiff_t(known.size()),
                          start->warnings.end());
    scene.start = std::move(start);
  }
  if (recipe.values)
    if (auto shown = show_values(*recipe.values, scene); !shown) return shown;
  if (recipe.clay) make_clay(*recipe.clay, scene);
  if (recipe.explode > 0.0f) explode(recipe.explode, scene);
  if (recipe.hdri.lights()) set_lighting(image_lighting(recipe.hdri, scene.up, has_roughness(scene)), scene);
  if (needs_ground(scene, recipe)) add_ground(scene, recipe.hdri.lights() ? lowest_light_deg(scene) : std::nullopt);
  return cut_scene(recipe.sections, scene);
}

namespace {

/// Returns the plan of a recipe, without Plan::metered.
Result<Plan> plan_of_view(const Recipe& recipe, const Scene& scene, int threads, const ProgressMonitor& monitor) {
  Plan plan{.recipe = recipe,
            .camera = frame_scene(scene, recipe.framing, recipe.width, recipe.height),
            .capture = recipe.capture,
            .up = scene.up,
            .origin = scene.origin,
            .has_ground = scene.ground_object >= 0};
  EffectSettings& settings = plan.recipe.settings;
  // Given lights were found for a camera inside the scene.
  if (!plan.capture.lighting || !is_inside_scene(plan.camera, scene)) {
    plan.capture.lighting = lighting_of(scene);
    const bool lacks_lights = scene.lights.empty() && !recipe.hdri.lights();
    if (lacks_lights)
      if (auto added = add_lights(scene, threads, monitor, plan); !added) return added.error();
    adjust_lights(recipe, plan.camera, lacks_lights && plan.lit_from_camera && recipe.look->studio_lights,
                  plan.lighting().lights);
  }
  if (scene.value_colors) whiten(plan.lighting());
  meter_indoors(scene, plan);
  if (recipe.light_size_deg) widen_key_light(*recipe.light_size_deg, scene, plan.lighting());
  if (auto measured = resolve_lengths(scene, plan); !measured) return measured.error();
  plan.sky_gain = sky_gain(plan);
  if (const Parameter* noise = noise_of(recipe))
    plan.first_noise = int_value(*noise, params_of(settings, recipe.occlusion));
  plan.has_blended = averages_something(recipe) && has_blended(scene);
  if (plan.averages() || recipe.lines_apart) plan.lines = take_lines_over_average(recipe, settings);
  set_given(scene, plan);
  if (auto status = check_passes(plan); !status) return status.error();
  plan.output = params_of(settings, effect_with<OutputParams>().name);
  if (!plan.averages()) return plan;
  // Samples hold linear light with alpha, so that edges blend with the background as light (or as square roots of it).
  auto& output = params_of<OutputParams>(settings);
  output.transfer = kTransferNone;
  output.dither = 0;
  if (output.beauty == kBeautyDisplay) output.beauty = kBeautyLight;  // display values are decoded after the average
  if (!recipe.hdri.shown()) output.transparent = 1;
  plan.marked = !(plan.has_blended && !plan.lines.empty()) && draws_marked_samples(plan.recipe);
  // Sample 0 alone has soft shadows of its own, so it takes the rays of all samples.
  if (plan.marked)
    plan.capture.shadow_rays =
        std::max(plan.capture.shadow_rays, std::min(plan.capture.shadow_rays * recipe.frames, kMaxShadowRays));
  set_given(scene, plan);
  return plan;
}

/// Returns a request for the usual view of the whole model, in the projection of the given one.
Framing usual_view(const Framing& given) {
  Framing framing;
  framing.view_up = given.view_up;
  framing.usual_view_angle_deg = given.usual_view_angle_deg;
  framing.margin = given.margin;
  framing.centers_shadow = given.centers_shadow;
  framing.light_deg = given.light_deg;
  framing.orthographic = given.orthographic;
  return framing;
}

}  // namespace

Result<Plan> make_plan(const Recipe& recipe, const Scene& scene, int threads, const ProgressMonitor& monitor) {
  auto plan = plan_of_view(recipe, scene, threads, monitor);
  if (!plan || !meters_picture(*plan) || is_inside_scene(plan->camera, scene)) return plan;
  Recipe usual = recipe;
  usual.framing = usual_view(recipe.framing);
  usual.capture.lighting.reset();  // that of the first picture of several, with lights placed for its camera
  usual.width = usual.height = usual.capture.width = usual.capture.height = kMeteredSide;
  auto metered = plan_of_view(usual, scene, threads, monitor);
  if (!metered) return metered;
  metered->start = scene.start;
  if (!is_inside_scene(metered->camera, scene)) plan->metered = std::make_shared<Plan>(std::move(*metered));
  return plan;
}

namespace {

/// Sets what depends on the camera, for another one than that of make_plan.
void set_camera_dependent(const Scene& scene, Plan& plan) {
  plan.sky_gain = sky_gain(plan);
  if (auto measured = resolve_lengths(scene, plan); !measured) fail_check(measured.error().message);
  set_given(scene, plan);
}

}  // namespace

Plan turned(const Plan& first, const Scene& scene, float angle_deg) {
  Plan plan = first;
  if (angle_deg == 0.0f) return plan;
  Recipe& recipe = plan.recipe;
  recipe.hdri.rotation_deg += angle_deg;
  const glm::vec3 center = turn_center(scene, recipe.framing);
  plan.camera = turned_around(first.camera, center, scene.up, angle_deg);
  if (recipe.hdri.lights()) {
    plan.lighting() = image_lighting(recipe.hdri, scene.up, first.lighting().reflections != nullptr);
    if (scene.value_colors) whiten(plan.lighting());
    adjust_lights(recipe, plan.camera, false, plan.lighting().lights);
  } else if (plan.lit_from_camera) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::radians(angle_deg), glm::normalize(scene.up)));
    for (Light& light : plan.lighting().lights) {
      light.direction = glm::normalize(turn * light.direction);
      light.position = center + turn * (light.position - center);
    }
  }
  if (recipe.light_size_deg) widen_key_light(*recipe.light_size_deg, scene, plan.lighting());
  set_camera_dependent(scene, plan);
  return plan;
}

Plan seen_from(const Plan& first, const Scene& scene, const Framing& framing) {
  Plan plan = first;
  plan.recipe.framing = framing;
  plan.camera = frame_scene(scene, framing, plan.recipe.width, plan.recipe.height);
  set_camera_dependent(scene, plan);
  return plan;
}

std::function<Plan(int frame)> plans_of_sequence(Plan first, int stride,
                                                 std::function<Plan(const Plan& first, int frame)> pose) {
  if (!first.metered) first.metered = std::make_shared<Plan>(first);
  return [first = std::move(first), stride, pose = std::move(pose)](int frame) {
    Plan plan = pose(first, frame);
    if (plan.recipe.is_steady) {  // noise moves, so that it averages out
      plan.first_noise += frame * stride;
      plan.first_shadow_sample += frame * first.recipe.frames;
    }
    return plan;
  };
}

Program program_of(const Plan& plan) {
  LookRun run = look_run(plan.recipe);
  run.lines = plan.lines;
  return compile(run, 1 + int(plan.info.more_layers.size()), &plan.info);
}

std::vector<std::string> planes_of_frame(const Plan& plan) {
  std::vector<std::string> names = plan.given.names;
  for (const ProgramPlane& plane : program_of(plan).planes)
    if (plane.reduced == 1 && !contains(names, plane.name)) names.push_back(plane.name);
  return names;
}

std::vector<PictureIndex> pictures_of(const Plan& plan) {
  std::vector<PictureIndex> pictures;
  for (int sample = plan.marked ? 0 : plan.recipe.frames - 1; sample >= 0; --sample) {
    if (plan.has_blended && !plan.marked) pictures.push_back({sample, true});
    pictures.push_back({sample, false});
  }
  return pictures;
}

void advance_noise(Recipe& recipe, int samples) {
  if (const Parameter* noise = noise_of(recipe)) {
    ParameterBytes& params = params_of(recipe.settings, recipe.occlusion);
    set_int(*noise, int((int_value(*noise, params) + long(samples)) % (long(noise->max) + 1)), params);
  }
}

Camera begin_picture(Plan& plan, const PictureIndex& picture) {
  const int frame = plan.sample = picture.sample;
  plan.capture.sample = plan.first_shadow_sample + frame;
  plan.capture.blended = picture.blended;
  Recipe& recipe = plan.recipe;
  if (const Parameter* noise = noise_of(recipe))
    set_int(*noise, int((long(plan.first_noise) + frame) % (long(noise->max) + 1)),
            params_of(recipe.settings, recipe.occlusion));
  return shifted_camera(plan.camera, sample_offset(frame, recipe.frames), recipe.width, recipe.height);
}

}  // namespace umbrage
