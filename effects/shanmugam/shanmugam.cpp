// The parameter table, kernel constants and dispatch of `shanmugam` [Shanmugam and Arikan 2007].
#include "effects/shanmugam/shanmugam.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "core/effect.h"
#include "core/gbuffer.h"
#include "core/parameters.h"
#include "kernels/shanmugam.h"

namespace umbrage {
namespace {

static_assert(kShanmugamMaxOccluders == kMaxOccluders);

const std::vector<Parameter> kShanmugamTable = {
    length_row("radius", &ShanmugamParams::radius,
               {.initial_percent = 50, .max = 1e12, .unit = "scene units", .above_zero = true},
               "max distance of occluders, in scene units or in percent of the bounding-sphere radius; "
               "`occlusion_radius` sets it"),
    length_row(
        "near_radius", &ShanmugamParams::near_radius, {.initial_percent = 10, .max = 1e12, .unit = "scene units"},
        "distance R up to which the pixels around occlude, and from which the coarse occluders do; at most `radius`"),
    bool_row("near", &ShanmugamParams::near, true, "occlusion by the pixels around"),
    int_row("samples", &ShanmugamParams::samples, {.initial = 32, .min = 1, .max = 4096},
            "near part: number N of samples per pixel"),
    choice_row("form", &ShanmugamParams::form, kShanmugamDisc, {"disc", "sphere"},
               "near part: what a sample is: a disc on the visible surface, or a sphere, as in the paper"),
    real_row("behind", &ShanmugamParams::behind, {.initial = 1, .max = 1},
             "near part: factor b of discs that are seen from behind: they hide as much as the unseen side of a closed "
             "body"),
    real_row("bias", &ShanmugamParams::bias, {.initial = 0.02, .max = 1},
             "near part: subtracted from the cosine between the normal and a sample"),
    bool_row("far", &ShanmugamParams::far, true, "occlusion by coarse occluders of the scene, also out of view"),
    choice_row(
        "far_form", &ShanmugamParams::far_form, kShanmugamPatch, {"patch", "sphere", "paper"},
        "far part: what an occluder is: a disc and a sphere, by how far its normals agree; a sphere; a sphere by "
        "the paper's formula, without a split at `near_radius`"),
    int_row("occluders", &ShanmugamParams::occluders, {.initial = 128, .min = 1, .max = kShanmugamMaxOccluders},
            "far part: max number of coarse occluders that are made of the scene"),
    int_row("sample_index", &ShanmugamParams::sample_index, {.max = 65535},
            "index among several pictures that are averaged; each has different noise"),
};

// One sample may be a large part of the result where few are in the picture.
constexpr double kShanmugamQuantum = 0.5;

constexpr float kMinLength = 1e-12f, kMaxLength = 1e12f;  // squares stay finite

void fill_near(const ShanmugamParams& params, const PictureInfo& info, ShanmugamConstants& c) {
  const float near_radius = absolute_length(params.near_radius, info.scene_radius);
  c.near_radius = std::min(std::clamp(near_radius, kMinLength, kMaxLength), c.radius);
  c.near_radius2 = c.near_radius * c.near_radius;
  c.near_area = std::numbers::pi_v<float> * c.near_radius2;
  c.samples = params.near != 0 && near_radius > 0.0f ? params.samples : 0;
  c.one_over_samples = 1.0f / float(params.samples);
  const float column = info.pixel_width(), row = info.pixel_height();
  c.radius_px = c.near_radius / column;
  c.rows_per_column = -column / row;
  c.sphere = params.form == kShanmugamSphere ? 1 : 0;
  c.behind = params.behind;
  c.bias = params.bias;
  // Steps of the two-dimensional golden-ratio sequence [Roberts 2018].
  c.turn = float(std::fmod(0.03125 + 0.7548776662466927 * params.sample_index, 1.0));
  c.step = float(std::fmod(0.03125 + 0.5698402909980532 * params.sample_index, 1.0));
}

void fill_far(const ShanmugamParams& params, const PictureInfo& info, ShanmugamConstants& c) {
  c.far_form = params.far_form;
  if (params.far == 0 || !info.occluders) return;
  if (params.far_form != kShanmugamPaper && c.near_radius >= c.radius) return;  // nothing is far
  const glm::mat4& view = info.camera.view_from_world;
  for (int k = 0; k < 9; ++k) c.world_axes[k] = view[k / 3][k % 3];
  const auto& set = info.occluders->occluders;
  for (std::size_t k = 0; k < std::min(set.size(), std::size_t(kShanmugamMaxOccluders)); ++k) {
    const glm::vec3 center = glm::vec3(view * glm::vec4(set[k].center, 1.0f)) * glm::mat3(view);  // by the transpose
    const glm::vec3 normal = set[k].mean_normal;
    const bool last = k + 1 == set.size() || set[k + 1].object != set[k].object;
    const float radius = set[k].radius, flat = std::min(glm::length(normal), 1.0f);
    const float area = 4.0f * radius * radius;  // of the patch, over pi
    const auto per_length = [&](float reach) { return 0.5f / std::min(2.0f * radius, reach); };
    const float numbers[kShanmugamOccluderSize] = {center.x,
                                                   center.y,
                                                   center.z,
                                                   radius * radius,
                                                   area * normal.x,
                                                   area * normal.y,
                                                   area * normal.z,
                                                   last ? 1.0f : 0.0f,
                                                   area * flat,
                                                   radius * std::sqrt(1.0f - flat),
                                                   per_length(c.near_radius),
                                                   per_length(c.radius)};
    std::copy_n(numbers, kShanmugamOccluderSize, c.set + kShanmugamOccluderSize * k);
    ++c.occluders;
  }
}

void fill_shanmugam(const ShanmugamParams& params, const PictureInfo& info, ShanmugamConstants& c) {
  c.radius = std::clamp(absolute_length(params.radius, info.scene_radius), kMinLength, kMaxLength);
  fill_near(params, info, c);
  fill_far(params, info, c);
}

int occluders(const ParameterBytes& bytes) {
  const auto& params = as<ShanmugamParams>(bytes);
  return params.far != 0 ? params.occluders : 0;
}

Dispatch dispatch() {
  Dispatch sampling = sampling_dispatch(shanmugam_kernel());
  sampling.unbounded_inputs = sampling.inputs;
  return sampling;
}

}  // namespace

Effect effect_shanmugam() {
  return occlusion_effect<fill_shanmugam>(
      kShanmugamTable, {.name = "shanmugam",
                        .summary = "near occluders from the picture, far ones from a few coarse occluders of the model",
                        .source = "Shanmugam and Arikan 2007",
                        .set_radius = set_radius_of<&ShanmugamParams::radius>,
                        .noise = "sample_index",
                        .tunable = {"samples", "near_radius", "behind", "far_form"},
                        .variants = {"", "samples=16", "near_radius=3%", "form=sphere far_form=paper near_radius=3%"},
                        .quantum = kShanmugamQuantum,
                        .occluders = occluders,
                        .dispatches = {dispatch()}});
}

}  // namespace umbrage
