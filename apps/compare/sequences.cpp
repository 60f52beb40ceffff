// The sequences of `umbrage compare --sequence`: what moves in them, and how their frames are drawn.
#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <utility>

#include "apps/compare/flicker.h"
#include "apps/compare/pictures.h"
#include "core/color.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "reference/reference.h"
#include "renderer/draw.h"
#include "renderer/moving.h"
#include "renderer/steady.h"
#include "scene/framing.h"

namespace umbrage {
namespace {

constexpr float kTurntableDeg = 0.5f;  // of the turntable
constexpr float kStep = 0.005f;        // of the walk and the object, of the bounding-sphere radius
constexpr float kLookDeg = 0.25f;      // of the walk, to the side
constexpr float kPanPixels = 3.0f;     // to the right
constexpr float kObjectDeg = 1.0f;     // about its centre
constexpr float kLightDeg = 1.0f;      // about the vertical axis
constexpr int kTruthSeeds[] = {500009, 700001};
constexpr int kStripFrameWidth = 192;  // max width of a frame of a strip, pixels

const std::vector<std::string> kSurfacePlanes = {"depth", "normal.x", "normal.y", "normal.z", "object_id"};
const std::vector<std::vector<std::string>> kPlanes = {
    {"ao"}, {"shadow"}, {"indirect.r", "indirect.g", "indirect.b"}, {"color.r", "color.g", "color.b"}};

glm::vec3 up_of(const Scene& scene) { return glm::normalize(scene.up); }

Plan turned_model(const Plan& first, const Scene& scene, float frame) {
  return turned(first, scene, kTurntableDeg * frame);
}

/// Walks ahead and looks to the side.
Plan walked(const Plan& first, const Scene& scene, float frame) {
  const glm::mat3 axes(glm::transpose(glm::mat3(first.camera.view_from_world)));
  const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::radians(kLookDeg * frame), up_of(scene)));
  const glm::dvec3 eye = first.camera.eye() - kStep * frame * scene.radius() * axes[2];
  Framing framing = first.recipe.framing;
  framing.position = eye + scene.origin;
  framing.focal_point = eye + scene.origin - glm::dvec3(scene.radius() * (turn * axes[2]));
  framing.view_up = axes[1];
  framing.view_angle_deg = glm::degrees(2.0f * std::atan(0.5f * (first.camera.top - first.camera.bottom)));
  return seen_from(first, scene, framing);
}

Plan panned(const Plan& first, const Scene&, float frame) {
  Plan plan = first;
  const float pixel = (plan.camera.right - plan.camera.left) / float(plan.recipe.width);
  const glm::mat4 move = glm::translate(glm::mat4(1.0f), {-kPanPixels * pixel * frame, 0.0f, 0.0f});
  plan.camera.view_from_world = move * plan.camera.view_from_world;
  return plan;
}

Plan still(const Plan& first, const Scene&, float) { return first; }

/// Turns the key light about the vertical axis.
Plan relit(const Plan& first, const Scene& scene, float frame) {
  Plan plan = first;
  const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::radians(kLightDeg * frame), up_of(scene)));
  if (plan.lighting().lights.empty()) return plan;
  Light& key = plan.lighting().lights[0];
  key.direction = turn * key.direction;
  key.position = scene.center() + turn * (key.position - scene.center());
  return plan;
}

/// What moves from frame to frame of a sequence. Poses are exact for any frame, from frame 0, the scene's own picture.
struct Motion {
  std::string_view name;
  Plan (*pose)(const Plan& first, const Scene& scene, float frame);
  bool parallel = false;  // the camera is orthographic
  bool object = false;    // an object of the scene moves
};
constexpr Motion kMotions[] = {{"turntable", turned_model},
                               {"walk", walked},
                               {"pan", panned, true},
                               {"object", still, false, true},
                               {"light", relit}};

/// A sequence of a scene.
struct Sequence {
  const Motion& motion;
  const Scene& scene;  // completed for the look
  int frames = 0;
  int moving_object = -1;
  glm::vec3 object_center{0.0f}, object_step{0.0f};

  glm::dmat4 object_pose(int frame) const {
    const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), glm::dvec3(object_center + object_step * float(frame)));
    const glm::dmat4 turned =
        glm::rotate(moved, glm::radians(double(kObjectDeg * float(frame))), glm::dvec3(up_of(scene)));
    return moving_object >= 0 ? glm::translate(turned, -glm::dvec3(object_center)) : glm::dmat4(1.0);
  }

  /// Returns the scene of a frame.
  Scene scene_of(int frame) const {
    Scene moved = scene;
    const glm::mat4 pose(object_pose(frame));
    for (Mesh& mesh : moved.meshes) {
      if (mesh.object != moving_object) continue;
      for (glm::vec3& position : mesh.positions) position = glm::vec3(pose * glm::vec4(position, 1.0f));
      for (std::vector<glm::vec3>* directions : {&mesh.normals, &mesh.bends})
        for (glm::vec3& direction : *directions) direction = glm::mat3(pose) * direction;
    }
    moved.shape_facts = std::make_shared<ShapeFacts>();
    return moved;
  }
};

/// Chooses the object that moves: of those at most half as large as the scene, the one with the most pixels. It moves
/// to the right.
Result<void> choose_object(Device& device, const Plan& plan, Sequence& sequence) {
  StageTimes times;
  const auto frame = capture(device, plan, times);
  if (!frame) return frame.error();
  const auto shown = device.download(*frame, {"object_id"});
  if (!shown) return shown.error();
  std::map<int, std::pair<glm::vec3, glm::vec3>> boxes;
  for (const Mesh& mesh : sequence.scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      auto& [low, high] = boxes.try_emplace(mesh.object, p, p).first->second;
      low = glm::min(low, p), high = glm::max(high, p);
    }
  std::map<int, long> pixels;
  for (int y = 0; y < shown->height; ++y)
    for (int x = 0; x < shown->width; ++x) ++pixels[int(std::lround(shown->planes[0].at(x, y)))];
  long most = 0;
  for (const auto& [object, box] : boxes) {
    if (object == sequence.scene.ground_object || glm::length(box.second - box.first) > sequence.scene.radius())
      continue;
    if (pixels[object] <= most) continue;
    most = pixels[object];
    sequence.moving_object = object;
    sequence.object_center = 0.5f * (box.first + box.second);
  }
  const glm::mat3 axes(glm::transpose(glm::mat3(plan.camera.view_from_world)));
  sequence.object_step = kStep * sequence.scene.radius() * axes[0];
  return {};
}

/// The drawn frames of a sequence.
struct DrawnFrames {
  std::vector<FrameSurfaces> surfaces;
  std::map<std::string, SequencePlanes> planes;  // by pass, such as `ao`
  std::string view;
};

/// Draws the frames of a sequence, as the command line draws them. `stops`: exposure of all; set by the first frame.
Result<DrawnFrames> draw_frames(Device& device, const Sequence& sequence, Plan first, int reach,
                                std::optional<float>& stops, const std::function<bool(double)>& progress) {
  DrawnFrames result;
  const bool moves = sequence.moving_object >= 0;
  first.recipe.is_steady = reach > 0 && !moves;  // see frames_of_moving_scene
  const auto plans = plans_of_sequence(first, first.recipe.frames, [&](const Plan& plan, int frame) {
    return sequence.motion.pose(plan, sequence.scene, float(frame - reach));
  });
  std::optional<SteadySequence> steady;
  if (reach > 0) {
    const auto moving_frame = [&](int frame) -> Result<MovingFrame> {
      return MovingFrame{std::make_shared<const Scene>(sequence.scene_of(frame - reach)), plans(frame)};
    };
    SteadyFrames frames = moves ? frames_of_moving_scene(device, first.recipe, reach, moving_frame)
                                : frames_of_still_scene(device, sequence.scene, plans);
    frames.reach = reach;
    frames.count = sequence.frames + 2 * reach;
    steady.emplace(device, std::move(frames));
  }
  for (int k = 0; k < sequence.frames; ++k) {
    if (!progress(double(k) / sequence.frames)) return interrupted();
    StageTimes times;
    Scene moved;
    if (moves && !steady) {
      moved = sequence.scene_of(k);
      if (auto ready = device.prepare(moved); !ready) return ready.error();
    }
    const Plan plan = plans(k + reach);
    auto drawn = steady ? steady->draw(k + reach, times, {}, stops, {})
                        : draw(device, moves ? moved : sequence.scene, plan, times, {}, stops);
    if (!drawn) return drawn.error();
    if (!stops) stops = drawn->stops;
    auto surfaces = device.download(drawn->frame, kSurfacePlanes);
    if (!surfaces) return surfaces.error();
    result.surfaces.push_back(
        {{inner_info(drawn->frame.info), {std::move(*surfaces)}}, sequence.moving_object, sequence.object_pose(k)});
    const std::vector<std::string> names = planes_of_frame(plan);
    for (const auto& planes : kPlanes) {
      const bool unused = is_shadow_plane(planes[0]) && first.capture.shadows == 0;  // the look shows no shadow
      if (unused || !contains(names, planes[0])) continue;
      auto image = device.download(drawn->frame, planes);
      if (!image) return image.error();
      if (image->find("ao")) clamp_occlusion(*image);
      result.planes[pass_of(planes[0])].push_back(std::move(*image));
    }
    if (moves && !steady) device.release_scene();
  }
  result.view = view_text(result.surfaces[0].gbuffer.info.camera);
  return result;
}

/// Returns the recipe of the truth of a recipe: rays within the same radius, without a filter.
Result<Recipe> truth_of(Request draw, const Recipe& recipe, int samples) {
  const Effect* technique = find_effect(recipe.occlusion);
  if (!technique) return recipe;
  const Parameter* radius = find_parameter(*technique, "radius");
  if (draw.occlusion_radius.empty() && radius)
    draw.occlusion_radius = parameter_text(*radius, params_of(recipe.settings, technique->name));
  draw.occlusion = reference_effect().name;
  auto truth = make_recipe(draw);
  if (!truth) return truth;
  auto look = std::make_shared<Look>(*truth->look);
  std::erase_if(look->effects, [](std::string_view name) {
    const Effect* effect = find_effect(name);
    return effect && effect->kind == EffectKind::kFilter;
  });
  truth->effects_look = look;
  truth->look = look.get();
  auto& reference = as<ReferenceParams>(params_of(truth->settings, truth->occlusion));
  reference.samples = samples;
  reference.bounce_from = kReferenceFromRadius;
  if (reference.light == kReferenceOcclusion && truth->capture.shadows > 0) reference.light = kReferenceDirect;
  return truth;
}

/// Returns the frames side by side, reduced, as linear light or grey values.
Image strip_of(const SequencePlanes& frames, const std::function<float(float)>& shown) {
  const int factor = (frames[0].width + kStripFrameWidth - 1) / kStripFrameWidth;
  const int width = frames[0].width / factor, height = frames[0].height / factor;
  Image strip(width * int(frames.size()), height);
  for (std::size_t p = 0; p < frames[0].planes.size(); ++p) {
    Plane& plane = strip.add(frames[0].names[p]) = Plane(strip.width, height);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const Image small = downsample(frames[k], factor);
      for (int y = 0; y < height; ++y)
        std::transform(small.planes[p].row(y), small.planes[p].row(y) + width, plane.row(y) + k * width, shown);
    }
  }
  return strip;
}

/// Returns how FLIP and the page show the values of a pass: light, whose mean is 1, as middle grey.
std::function<float(float)> shown_as(std::string_view pass) {
  if (pass == "color") return [](float value) { return linear_from_srgb(std::clamp(value, 0.0f, 1.0f)); };
  if (pass == "indirect") return [](float value) { return float(kMiddleGrey) * value; };
  return [](float value) { return value; };
}

/// Draws and measures a motion of a scene in one look, with its technique or `technique`.
struct SequenceRun {
  Device& device;
  const SequenceSettings& settings;
  SequenceComparison& result;
  // Start and length of the present sequence, as fractions of the whole work; what to add to `start` before the next
  // one.
  double start = 0.0, span = 1.0, ahead = 0.0;

  Result<void> compare(const Scene& model_scene, const std::string& model, std::pair<int, int> size,
                       const std::string& look, const std::string& technique, const Motion& motion) {
    start += std::exchange(ahead, span);
    Request draw = request(look, technique, motion);
    std::tie(draw.width, draw.height) = size;
    const auto recipe = make_recipe(draw);
    if (!recipe) return recipe.error();
    const auto of_truth = truth_of(draw, *recipe, settings.samples / 2);
    if (!of_truth) return of_truth.error();
    Scene scene = model_scene;
    if (auto done = complete_scene(scene, *recipe); !done) return done.error();
    if (auto ready = device.prepare(scene); !ready) return ready;
    auto plan = make_plan(*recipe, scene, device.threads()), truth_plan = make_plan(*of_truth, scene, device.threads());
    if (!plan) return plan.error();
    if (!truth_plan) return truth_plan.error();
    Sequence sequence{motion, scene, settings.frames};
    if (motion.object) {
      if (auto chosen = choose_object(device, *plan, sequence); !chosen) return chosen;
      if (sequence.moving_object < 0) {
        result.warnings.push_back(
            fmt::format("'{}' shows no object that is at most half as large as the scene: the "
                        "sequence '{}' is left out",
                        model, motion.name));
        return {};
      }
    }
    const std::string what = fmt::format("{}, {}, look {}", model, motion.name, look);
    std::optional<float> stops;
    std::vector<DrawnFrames> truth;
    const auto progress = [&](double part) {
      return [&, part](double done) { return settings.progress(what, start + span * 0.25 * (part + done)); };
    };
    for (const int seed : kTruthSeeds) {
      if (find_effect(recipe->occlusion)) truth_plan->first_noise = seed;
      auto drawn = draw_frames(device, sequence, *truth_plan, 0, stops, progress(double(truth.size())));
      if (!drawn) return drawn.error();
      truth.push_back(std::move(*drawn));
    }
    const std::vector<FrameSurfaces>& surfaces = truth[0].surfaces;
    const Warps warps(surfaces);
    for (const int reach : {0, settings.reach}) {
      if (reach > 0 && !can_be_steady(*recipe)) continue;
      auto drawn = draw_frames(device, sequence, *plan, reach, stops, progress(reach > 0 ? 3.0 : 2.0));
      if (!drawn) return drawn.error();
      for (auto& [pass, frames] : drawn->planes) {
        if (!truth[0].planes.contains(pass)) continue;
        std::array halves = {truth[0].planes.at(pass), truth[1].planes.at(pass)};
        if (pass == "indirect") {
          const double mean = mean_of(halves[0][0], classify(surfaces[0].gbuffer));
          if (!(mean > 0.0)) continue;
          for (SequencePlanes* of : {&frames, &halves[0], &halves[1]}) scale(*of, float(1.0 / mean));
        }
        FlickerRow row{model, std::string(motion.name),   look,        recipe->occlusion, pass,
                       reach, std::string(device.name()), drawn->view, size.first,        size.second};
        const auto shown = shown_as(pass);
        Plane* map = settings.pictures ? &(row.map = Image(size.first, size.second)).add("grey") : nullptr;
        row.flicker = measure_flicker(warps, frames, halves, surfaces, shown, map);
        if (map) row.strip = strip_of(frames, shown), row.truth_strip = strip_of(halves[0], shown);
        result.rows.push_back(std::move(row));
      }
    }
    return {};
  }

  Request request(const std::string& look, const std::string& technique, const Motion& motion) const {
    Request draw = settings.draw;
    draw.look = look;
    draw.occlusion = technique;
    draw.anti_aliasing = 1;  // pixels as they are
    draw.passes = {"depth", "normal", "object_id"};
    draw.camera.orthographic |= motion.parallel;
    return draw;
  }

  static void scale(SequencePlanes& frames, float factor) {
    for (Image& frame : frames)
      for (Plane& plane : frame.planes)
        for (int y = 0; y < plane.height; ++y)
          for (int x = 0; x < plane.width; ++x) plane.at(x, y) *= factor;
  }
};

/// Returns the motions of the settings. Errors: kUsage.
Result<std::vector<const Motion*>> motions_of(const SequenceSettings& settings) {
  std::vector<const Motion*> motions;
  for (const std::string& name : settings.motions)
    if (!contains(motion_names(), name))
      return with_field(unknown_name("motion", name, motion_names()), "--motion", name);
  for (const Motion& motion : kMotions)
    if (settings.motions.empty() || contains(settings.motions, motion.name)) motions.push_back(&motion);
  return motions;
}

/// Returns the techniques of the settings, without the reference; one empty name: that of each look.
std::vector<std::string> technique_names(const SequenceSettings& settings) {
  std::vector<std::string> names;
  if (settings.techniques.empty()) return {""};
  const auto techniques = techniques_of(settings);
  for (const Effect* effect : *techniques)
    if (effect != &reference_effect()) names.emplace_back(effect->name);
  return names;
}

}  // namespace

std::vector<std::string_view> motion_names() {
  std::vector<std::string_view> names;
  for (const Motion& motion : kMotions) names.push_back(motion.name);
  return names;
}

Result<void> check_sequences(const SequenceSettings& settings) {
  if (auto status = check_compare(settings); !status) return status;
  if (auto motions = motions_of(settings); !motions) return motions.error();
  if (technique_names(settings).empty())
    return field_error("occlusion", reference_effect().name, "`{}` {} is the truth of sequences: name a technique");
  for (const std::string& look : settings.looks)
    for (const std::string& technique : technique_names(settings)) {
      Request draw = settings.draw;
      draw.look = look;
      draw.occlusion = technique;
      if (auto recipe = make_recipe(draw); !recipe) return recipe.error();
    }
  return {};
}

Terms terms_of(const SequenceSettings& settings) {
  Terms terms = terms_of(static_cast<const CompareSettings&>(settings));
  if (settings.draw.occlusion_radius.empty()) terms.radius = "of the look";
  return terms;
}

Result<SequenceComparison> compare_sequences(Device& device, const SequenceSettings& settings) {
  if (auto status = check_sequences(settings); !status) return status.error();
  const auto motions = *motions_of(settings);
  const auto techniques = technique_names(settings);
  SequenceComparison result;
  result.terms = terms_of(settings);
  SequenceRun run{device, settings, result};
  run.span = 1.0 / double(settings.models.size() * settings.sizes.size() * settings.looks.size() * techniques.size() *
                          motions.size());
  for (const std::string& model : settings.models) {
    const auto scene = read_model(settings, model, run.start, result.warnings);
    if (!scene) return scene.error();
    for (const auto& size : settings.sizes)
      for (const std::string& look : settings.looks)
        for (const std::string& technique : techniques)
          for (const Motion* motion : motions)
            if (auto done = run.compare(*scene, model, size, look, technique, *motion); !done) return done.error();
  }
  return result;
}

}  // namespace umbrage
