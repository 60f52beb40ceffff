// The parameter table, kernel constants and dispatches of `steady`.
#include "effects/steady/steady.h"

#include <cmath>
#include <glm/gtc/matrix_access.hpp>
#include <numbers>

#include "core/effect.h"
#include "kernels/steady_ao.h"
#include "kernels/steady_ao_rays.h"
#include "kernels/steady_change.h"
#include "kernels/steady_light.h"
#include "kernels/steady_light_rays.h"
#include "kernels/steady_there.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kSteadyTable = {
    choice_row("weight", &SteadyParams::weight, kSteadyEqual, {"equal", "rays"},
               "weights of the frames: equal, or by their numbers of rays"),
    bool_row("light", &SteadyParams::light, false, "join indirect light as well as occlusion"),
    bool_row("begin", &SteadyParams::begin, true, "this is the first frame that is joined"),
    choice_row("motion", &SteadyParams::motion, kMotionOfCamera, {"camera", "planes"},
               "what tells where a surface point is in the other frame: the cameras, or the planes there"),
    real_row("distance", &SteadyParams::distance, {.initial = 1, .min = 0.01, .max = 100, .unit = "px"},
             "max distance of a pixel from another's plane at which both show one surface"),
    real_row("angle", &SteadyParams::angle, {.initial = 25, .min = 1, .max = 180, .unit = "deg"},
             "max angle between normals at which pixels of two frames fit fully"),
    real_row("change", &SteadyParams::change, {.initial = 0.02, .min = 0.001, .max = 1},
             "max change of occlusion around a pixel with which a frame counts fully, if planes tell the motion"),
};

void fill_steady(const SteadyParams& params, const PictureInfo& info, SteadyConstants& c) {
  c.begin = params.begin;
  c.distance = params.distance;
  c.turn = float(1.0 / (1.0 - std::cos(params.angle * std::numbers::pi / 180.0)));
  c.less_above = params.motion == kMotionOfPlanes ? 1.0f / params.change : 0.0f;
  PictureInfo other = info;
  if (info.other_camera) other.camera = *info.other_camera;
  c.usable = other.camera.projection == info.camera.projection;
  // In double precision, since scenes may be far from the origin.
  const glm::dmat4 there =
      glm::dmat4(other.camera.view_from_world) * glm::inverse(glm::dmat4(info.camera.view_from_world));
  for (int k = 0; k < 4; ++k) {
    c.x[k] = float(glm::row(there, 0)[k]);
    c.y[k] = float(glm::row(there, 1)[k]);
    c.z[k] = float(glm::row(there, 2)[k]);
  }
  c.ray_scale_x = other.pixel_width();
  c.ray_offset_x = other.camera.left;
  c.ray_scale_y = -other.pixel_height();
  c.ray_offset_y = other.camera.top;
}

bool scene_moves(const ParameterBytes& bytes) { return as<SteadyParams>(bytes).motion == kMotionOfPlanes; }

bool only_camera_moves(const ParameterBytes& bytes) { return as<SteadyParams>(bytes).motion == kMotionOfCamera; }

template <bool light, bool rays>
bool joins(const ParameterBytes& bytes) {
  const auto& params = as<SteadyParams>(bytes);
  return (params.light != 0) == light && (params.weight == kSteadyRays) == rays;
}

/// Returns the dispatch that joins occlusion, indirect light if `light`, and weighs by rays if `rays`.
template <bool light, bool rays>
Dispatch join_dispatch(std::string_view name, const Kernel& kernel) {
  std::vector<std::string_view> outputs = {"ao", "steady_weight"};
  std::vector<std::string_view> inputs = {
      "depth",          "normal.x", "normal.y", "normal.z", "other_depth", "other_normal.x", "other_normal.y",
      "other_normal.z", "other_ao", "there.x",  "there.y",  "there.z",     "steady_change"};
  if (light) outputs.insert(outputs.end(), {"indirect.r", "indirect.g", "indirect.b"});
  if (light) inputs.insert(inputs.end(), {"other_indirect.r", "other_indirect.g", "other_indirect.b"});
  if (rays) outputs.emplace_back("traced_confidence"), inputs.emplace_back("other_traced_confidence");
  inputs.insert(inputs.end(), outputs.begin(), outputs.end());
  return {.name = name, .inputs = inputs, .outputs = outputs, .kernel = kernel, .needed = joins<light, rays>};
}

}  // namespace

Effect effect_steady() {
  return shading_effect<fill_steady>(
      kSteadyTable,
      {.name = "steady",
       .summary = "join the occlusion and indirect light of neighbouring frames of a sequence, along surfaces",
       .variants = {"", "light=on", "weight=rays"},
       .neutral = {{"other_depth", 0.0f},
                   {"steady_weight", 1.0f},
                   {"there", 0.0f},
                   {"steady_change", 0.0f},
                   {"traced_confidence", 0.5f}},
       .dispatches = {{.name = "there",
                       .inputs = {"depth"},
                       .outputs = {"there.x", "there.y", "there.z"},
                       .kernel = steady_there_kernel(),
                       .needed = only_camera_moves},
                      {.name = "change",
                       .inputs = {"depth", "ao", "other_ao", "there.x", "there.y", "there.z"},
                       .outputs = {"steady_change"},
                       .kernel = steady_change_kernel(),
                       .needed = scene_moves},
                      join_dispatch<false, false>("ao", steady_ao_kernel()),
                      join_dispatch<true, false>("light", steady_light_kernel()),
                      join_dispatch<false, true>("ao_rays", steady_ao_rays_kernel()),
                      join_dispatch<true, true>("light_rays", steady_light_rays_kernel())}});
}

}  // namespace umbrage
