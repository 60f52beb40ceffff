// The parameter table, kernel constants and dispatches of `traced`.
#include "effects/traced/traced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "core/parameters.h"
#include "kernels/traced_across.h"
#include "kernels/traced_down.h"
#include "kernels/traced_joints.h"
#include "kernels/traced_light_across.h"
#include "kernels/traced_light_down.h"
#include "kernels/traced_rays.h"

namespace umbrage {
namespace {

constexpr double kMaxRays = 64;
constexpr int kFurtherRays = 1 << 28;                   // above all other indices of rays
constexpr float kDistancePx = 1.0f, kAngleDeg = 25.0f;  // as in `denoise`

const std::vector<Parameter> kTracedTable = {
    real_row("rays", &TracedParams::rays, {.initial = 1, .min = 0.0625, .max = kMaxRays},
             "rays per pixel on an open surface; below 1, a part of the pixels gets one"),
    int_row("max_rays", &TracedParams::max_rays, {.initial = 8, .min = 1, .max = kMaxRays},
            "max rays of a pixel whose surface few neighbours show, as on edges and leaves; at least `rays`"),
    radius_row("radius", &TracedParams::radius,
               "max distance of an occluder, in scene units or in percent of the bounding-sphere radius; 200% is the "
               "whole scene; `occlusion_radius` sets it"),
    choice_row("falloff", &TracedParams::falloff, 0, {"none", "linear", "smooth"},
               "weight of an occluder within the radius: 1, or falling with distance"),
    choice_row("normal", &TracedParams::normal, kTracedTriangle, {"triangle", "shading"},
               "normal of the hemisphere: that of the triangle, or the interpolated one, with which rays below the "
               "triangle count as blocked"),
    bool_row("filter", &TracedParams::filtered, true, "average the rays of neighbours on the same surface"),
    bool_row("bent", &TracedParams::bent, false,
             "also write the mean direction of unblocked rays, in view space, planes bent.x .y .z"),
    real_row("bleeding", &TracedParams::bleeding, {.max = 100, .zero_means = "off"},
             "factor for the indirect light from occluders"),
    real_row("ambient_bounce", &TracedParams::ambient_bounce, {.initial = 1, .max = 10},
             "factor for the ambient light that surfaces reflect"),
    real_row("directional", &TracedParams::directional, {.max = 10, .zero_means = "off"},
             "factor for the direction of ambient light: open directions take the light that comes from there; as the "
             "factor of ambient light, lighting.ambient"),
    int_row("joined", &TracedParams::joined, {.max = 17, .zero_means = "the rays are traced"},
            "number of frames whose rays are there already and are only filtered; `steady` sets it"),
    int_row("sample_index", &TracedParams::sample_index, {.max = 1e6}, "index of the noise"),
};

/// One round of the filter, along rows and then columns.
struct Level {
  int power;                      // as in TracedConstants
  float deviations;               // as in TracedConstants
  float near_weight, far_weight;  // relative to that of the pixel itself
  bool light_only = false;        // as in TracedConstants; left out without light
};
constexpr Level kFirst{0, 0.0f, 1.0f, 0.5f};  // a box of 4 convolved with a box of 2
constexpr float kNear = 4.0f / 6.0f, kFar = 1.0f / 6.0f;
// Light needs a wider round than visibility: few rays find a small bright surface. It does not depend on the
// visibility: its deviation is larger where much light arrives, so that these pixels would take from darker ones more
// than they give.
constexpr Level kLight8{3, 0.0f, kNear, 0.0f, true};

/// Returns the rounds for a number of rays: the fewer, the wider the filter. Rounds with steps of 2 and 4 pixels do not
/// mix odd and even pixels; the round with step 1 after them does.
std::array<Level, kTracedMaxRounds> levels_for(float rays) {
  if (rays < 0.75f) return {kFirst, kLight8, {2, 6.0f, kNear, kFar}, {1, 6.0f, kNear, kFar}, {0, 6.0f, kNear, 0.0f}};
  if (rays < 1.5f) return {kFirst, {1, 4.0f, kNear, kFar}, {2, 3.0f, kNear, kFar}, kLight8, {0, 4.0f, kNear, 0.0f}};
  return {Level{0, 4.0f, kNear, kFar}, {1, 3.0f, kNear, kFar}, {2, 2.0f, kNear, kFar}, kLight8, {0, 3.0f, kNear, 0.0f}};
}

/// Returns the max number of rays of a pixel: every pixel has `rays`.
int max_rays_of(const TracedParams& params) { return std::max(params.max_rays, int(std::ceil(params.rays))); }

bool traces_light(const TracedParams& params) { return params.bleeding > 0.0f || params.directional > 0.0f; }

void fill_traced(const TracedParams& params, const PictureInfo&, TracedConstants& c) {
  c.rays = params.rays;
  c.max_rays = float(max_rays_of(params));
  c.normal = params.normal;
  // Further samples continue the sequence of a pixel, so that no ray is repeated. Rays beyond own_rays, which
  // only some pixels have, continue at kFurtherRays.
  c.own_rays = int(std::ceil(params.rays));
  const int before = params.sample_index - 1;  // samples after the first one and before this one
  c.first_ray = before < 0 ? 0 : max_rays_of(params) + before * c.own_rays;
  c.first_further_ray = before < 0 ? 0 : kFurtherRays + before * (max_rays_of(params) - c.own_rays);
  c.dither = float(std::fmod(0.6180339887498949 * params.sample_index, 1.0));
  c.distance = kDistancePx;
  c.turn = float(1.0 / (1.0 - std::cos(kAngleDeg * std::numbers::pi / 180.0)));
  const auto levels = levels_for(params.rays * float(std::max(params.joined, 1)));
  for (const Level& level : levels) {
    if (level.light_only && !traces_light(params)) continue;
    const int k = c.rounds++;
    c.power[k] = level.power;
    c.deviations[k] = level.deviations;
    c.near_weight[k] = level.near_weight;
    c.far_weight[k] = level.far_weight;
    c.light_only[k] = level.light_only ? 1 : 0;
  }
}

RaySettings ray_settings(const ParameterBytes& bytes, const PictureInfo& info) {
  const auto& params = as<TracedParams>(bytes);
  return {.max_rays = max_rays_of(params),
          .radius = absolute_length(params.radius, info.scene_radius),
          .falloff = Falloff(params.falloff),
          .light = params.bleeding,
          .ambient_bounce = params.ambient_bounce,
          .seed = std::uint32_t(params.sample_index),
          .directional = info.ambient_shape.even() ? 0.0f : params.directional,
          .sky = sky_factors(info.ambient_shape)};
}

bool is_filtered(const ParameterBytes& bytes) { return as<TracedParams>(bytes).filtered != 0; }
bool traces_light(const ParameterBytes& bytes) { return traces_light(as<TracedParams>(bytes)); }
bool filters_light(const ParameterBytes& bytes) { return is_filtered(bytes) && traces_light(bytes); }
bool filters_no_light(const ParameterBytes& bytes) { return is_filtered(bytes) && !traces_light(bytes); }
bool makes_joints(const ParameterBytes& bytes) { return as<TracedParams>(bytes).joined == 0; }
template <bool bent, bool light>
bool traces(const ParameterBytes& bytes) {
  return makes_joints(bytes) && (as<TracedParams>(bytes).bent != 0) == bent && traces_light(bytes) == light;
}

int traced_rounds(const ParameterBytes& bytes, const PictureInfo& info) {
  if (!is_filtered(bytes)) return 1;
  TracedConstants constants{};
  fill_traced(as<TracedParams>(bytes), info, constants);
  return constants.rounds;
}

// Dispatch::reach of the filter along columns, the joint weights and the rays.
int filter_reach(const void* constants, int round) {
  const auto& c = *static_cast<const TracedConstants*>(constants);
  return (c.far_weight[round] > 0.0f ? 2 : 1) << c.power[round];
}
int joints_reach(const void*, int) { return 1 << (kJointPowers - 1); }
int rays_reach(const void*, int) { return 2; }

Dispatch rays_dispatch(std::string_view name, bool (*needed)(const ParameterBytes&),
                       const std::vector<std::string_view>& more_outputs = {}) {
  std::vector<std::string_view> outputs = {"ao", "traced_confidence"};
  outputs.insert(outputs.end(), more_outputs.begin(), more_outputs.end());
  return {.name = name,
          .inputs = {"depth", "traced_joints", "ray_offset.x", "ray_offset.y", "ray_offset.z", "normal.x", "normal.y",
                     "normal.z"},
          .outputs = outputs,
          .kernel = traced_rays_kernel(),
          .rays = ray_settings,
          .needed = needed,
          .reach = rays_reach,
          .columns = rays_reach,
          .first_round_only = true};
}

Dispatch filter_dispatch(std::string_view name, const Kernel& kernel, bool (*needed)(const ParameterBytes&),
                         const std::vector<std::string_view>& from, const std::vector<std::string_view>& to,
                         int (*reach)(const void*, int), int (*columns)(const void*, int)) {
  std::vector<std::string_view> inputs = from;
  inputs.push_back("traced_joints");
  return {.name = name,
          .inputs = inputs,
          .outputs = to,
          .kernel = kernel,
          .needed = needed,
          .reach = reach,
          .columns = columns};
}

}  // namespace

Effect effect_traced() {
  return occlusion_effect<fill_traced>(
      kTracedTable,
      {.name = "traced",
       .summary = "few rays in the scene, more of them at edges, and a filter that counts them",
       .set_radius = set_radius_of<&TracedParams::radius>,
       .noise = "sample_index",
       .filters_itself = true,
       .filter_switch = "filter",
       .joined_frames = "joined",
       .tunable = {"rays"},
       .variants = {"", "rays=0.125", "rays=0.25", "rays=0.5", "rays=2", "rays=6 max_rays=32", "bleeding=1"},
       .quantum = 1.0,
       .dispatches = {{.name = "joints",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"traced_joints"},
                       .kernel = traced_joints_kernel(),
                       .needed = makes_joints,
                       .reach = joints_reach,
                       .columns = joints_reach,
                       .first_round_only = true},
                      rays_dispatch("rays", traces<false, false>),
                      rays_dispatch("rays_bent", traces<true, false>, {"bent.x", "bent.y", "bent.z"}),
                      rays_dispatch("rays_light", traces<false, true>, {"indirect.r", "indirect.g", "indirect.b"}),
                      rays_dispatch("rays_light_bent", traces<true, true>,
                                    {"indirect.r", "indirect.g", "indirect.b", "bent.x", "bent.y", "bent.z"}),
                      filter_dispatch("across", traced_across_kernel(), filters_no_light, {"ao", "traced_confidence"},
                                      {"traced_across", "traced_across_confidence"}, own_row, filter_reach),
                      filter_dispatch("down", traced_down_kernel(), filters_no_light,
                                      {"traced_across", "traced_across_confidence"}, {"ao", "traced_confidence"},
                                      filter_reach, own_column),
                      filter_dispatch("light_across", traced_light_across_kernel(), filters_light,
                                      {"ao", "traced_confidence", "indirect.r", "indirect.g", "indirect.b"},
                                      {"traced_across", "traced_across_confidence", "traced_light.r", "traced_light.g",
                                       "traced_light.b"},
                                      own_row, filter_reach),
                      filter_dispatch("light_down", traced_light_down_kernel(), filters_light,
                                      {"traced_across", "traced_across_confidence", "traced_light.r", "traced_light.g",
                                       "traced_light.b"},
                                      {"ao", "traced_confidence", "indirect.r", "indirect.g", "indirect.b"},
                                      filter_reach, own_column)},
       .rounds = traced_rounds});
}

}  // namespace umbrage
