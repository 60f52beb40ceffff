#include "effects/toon/toon.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/effect.h"
#include "core/light_rig.h"
#include "core/parameters.h"
#include "kernels/toon.h"
#include "kernels/toon_across.h"
#include "kernels/toon_down.h"
#include "kernels/toon_light.h"

namespace umbrage {
namespace {

constexpr double kMaxFactor = 100.0;
constexpr double kPaperSteps = 4.0, kPaperAmbient = 0.1, kPaperExtra = 0.2;  // listing 2
// Min width of an edge between tone steps, as a change of intensity. It is fifty times the change that rounding causes
// across a flat face, so that a face whose intensity is at an edge has one colour instead of speckles. Surfaces that
// are visibly curved have larger changes.
constexpr float kMinChange = 5e-5f;
// Percent of the height. It removes the bumps of scans, and keeps the folds of cloth.
constexpr double kSmoothness = 1.5;
constexpr double kMaxSmoothness = 200.0;  // pixels
constexpr int kShadowFraction = 2;        // of that distance, over which shadows are smoothed

const std::vector<Parameter> kToonTable = {
    choice_row("mode", &ToonParams::mode, 0, {"ramp", "paper"},
               "a given number of tone steps in a ramp of colours, or the paper's steps of the object's colour"),
    renamed_from("bands", int_row("steps", &ToonParams::steps, {.initial = kPaperSteps, .min = 1, .max = 256},
                                  "number of tone steps; in mode paper per unit of intensity")),
    real_row("ambient", &ToonParams::ambient, {.initial = kPaperAmbient, .max = kMaxFactor},
             "intensity of the ambient light that occlusion darkens; the key light's is 1"),
    real_row("extra", &ToonParams::extra, {.initial = kPaperExtra, .max = kMaxFactor},
             "intensity of the ambient light that occlusion does not darken"),
    choice_row("rig", &ToonParams::rig, 0, {"scene", "head", "key"},
               "the scene's lights; or one light without shadow, at the camera or parallel from above and to the left "
               "of the camera"),
    real_row("shadow", &ToonParams::shadow, {.initial = 1, .max = 1, .factor = "shadow_strength"},
             "darkness of the key light's shadow"),
    length_row("smoothness", &ToonParams::smoothness,
               {.initial_percent = kSmoothness, .max = kMaxSmoothness, .unit = "px"},
               "distance along the surface over which light is smoothed before the steps, in pixels or in percent of "
               "the picture's height; 0: not at all, and the edges of shadows are jagged (ramp)"),
    real_row("softness", &ToonParams::softness, {.max = 1},
             "min width of the edge between two tone steps, in steps; 0: antialiased, about a pixel; 1: a smooth ramp "
             "(ramp)"),
    real_row("specular", &ToonParams::specular, {.initial = 1, .max = kMaxFactor}, "factor for highlights"),
    real_row("highlight_size", &ToonParams::highlight_size, {.initial = 1, .min = 0.01, .max = 10},
             "factor for the diameter of highlights (ramp)"),
    real_row("shadow_r", &ToonParams::shadow_r, {.initial = 0.18, .max = 1},
             "red of the darkest step on white, linear (ramp)"),
    real_row("shadow_g", &ToonParams::shadow_g, {.initial = 0.16, .max = 1},
             "green of the darkest step on white, linear (ramp)"),
    real_row("shadow_b", &ToonParams::shadow_b, {.initial = 0.30, .max = 1},
             "blue of the darkest step on white, linear (ramp)"),
    real_row("light_r", &ToonParams::light_r, {.initial = 1, .max = 1},
             "red of the brightest step on white, and of highlights, linear (ramp)"),
    real_row("light_g", &ToonParams::light_g, {.initial = 1, .max = 1},
             "green of the brightest step on white, and of highlights, linear (ramp)"),
    real_row("light_b", &ToonParams::light_b, {.initial = 1, .max = 1},
             "blue of the brightest step on white, and of highlights, linear (ramp)"),
    choice_row(
        "albedo", &ToonParams::albedo, 0, {"texture", "display", "clay"},
        "the object's colour: its albedo, its albedo as a display shows it (for output.transfer=none), or white"),
    real_row("occlusion", &ToonParams::occlusion, {.initial = 1, .max = 10, .factor = "occlusion_strength"},
             "factor for the occlusion, 1 - ao, of any technique; `occlusion_strength` multiplies it"),
};

int smooth_px(const ToonParams& params, const PictureInfo& info) {
  const float length = absolute_length(params.smoothness, float(info.inner_height()));
  return int(std::clamp(std::round(length), 1.0f, float(kMaxSmoothness)));
}

float luminance(const glm::vec3& color) { return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

/// Returns the direction from which most ambient light comes, by its first harmonics; 0 if there is none.
glm::vec3 brightest_direction(const AmbientShape& shape) {
  glm::vec3 sum(0.0f);
  for (int axis = 0; axis < 3; ++axis)
    sum[axis] = luminance({shape.by_color[0][axis][3], shape.by_color[1][axis][3], shape.by_color[2][axis][3]});
  return glm::length(sum) > 0.0f ? glm::normalize(sum) : glm::vec3(0.0f);
}

void fill_lights(const ToonParams& params, const PictureInfo& info, ToonConstants& c) {
  const LightRig rig = light_rig(Rig(params.rig), info);
  if (!rig.shadows) c.shadow = 0.0f;
  // The paper has one light, without falloff.
  const bool paper = params.mode == kToonPaper;
  static_assert(kToonMaxLights == kMaxRigLights);
  c.light_count = std::min(int(rig.lights.size()), paper ? 1 : kToonMaxLights);
  if (rig.lights.empty() && !rig.ambient_shape.even()) {
    // For a sky without a sun, a light comes from the direction of most of the sky's light.
    c.light_count = 1;
    c.shadow = 0.0f;
    c.fraction[0] = 1.0f;
    const glm::vec3 max = brightest_direction(rig.ambient_shape);
    c.x[0] = max.x;
    c.y[0] = max.y;
    c.z[0] = max.z;
    return;
  }
  const float key = rig.lights.empty() ? 0.0f : luminance(rig.lights[0].color);
  for (int k = 0; k < c.light_count; ++k) {
    const RigLight& light = rig.lights[k];
    set_place(light, k, c);
    c.fraction[k] = k == 0 ? 1.0f : key > 0.0f ? luminance(light.color) / key : 0.0f;
    c.reach_squared[k] = paper ? 0.0f : light.reach_squared;
  }
}

void fill_toon(const ToonParams& params, const PictureInfo& info, ToonConstants& c) {
  c.mode = params.mode;
  c.albedo = params.albedo;
  c.steps = float(params.steps);
  c.ambient = params.ambient;
  c.extra = params.extra;
  c.shadow = params.shadow;
  c.specular = params.specular;
  c.occlusion = params.occlusion;
  // An unoccluded surface that faces the key light is at the end of the ramp. Neither this intensity nor that of a
  // surface that faces away is at an edge between tone steps.
  c.steps_per_intensity = c.steps / (1.0f + params.ambient + params.extra);
  c.inverse_steps = 1.0f / c.steps;
  c.min_width = std::min(kMinChange * c.steps_per_intensity, 1.0f);
  c.softness = params.softness;
  c.smooth_px = smooth_px(params, info);
  c.shadow_px = std::max(c.smooth_px / kShadowFraction, 1);
  c.sharpness = 1.0f / (params.highlight_size * params.highlight_size);
  const bool flat = params.steps == 1;
  const float steps = std::max(c.steps - 1.0f, 1.0f);
  c.light_r = params.light_r;
  c.light_g = params.light_g;
  c.light_b = params.light_b;
  c.shadow_r = flat ? params.light_r : params.shadow_r;
  c.shadow_g = flat ? params.light_g : params.shadow_g;
  c.shadow_b = flat ? params.light_b : params.shadow_b;
  c.step_r = (params.light_r - c.shadow_r) / steps;
  c.step_g = (params.light_g - c.shadow_g) / steps;
  c.step_b = (params.light_b - c.shadow_b) / steps;
  fill_lights(params, info, c);
}

bool is_smoothed(const ParameterBytes& bytes) {
  const auto& params = as<ToonParams>(bytes);
  return params.mode == kToonRamp && params.smoothness.value > 0.0f;
}

/// Returns the number of rounds of smoothing, in which the distance halves, and the last of which repeats that of 1.
int toon_rounds(const ParameterBytes& bytes, const PictureInfo& info) {
  return is_smoothed(bytes) ? int(std::bit_width(unsigned(smooth_px(as<ToonParams>(bytes), info)))) + 1 : 1;
}

/// These return the number of rows that the dispatches read above and below a pixel.
int smooth_reach(const void* constants, int round) {
  return std::max(static_cast<const ToonConstants*>(constants)->smooth_px >> round, 1);
}
int steps_reach(const void*, int) { return 1; }

}  // namespace

Effect effect_toon() {
  return shading_effect<fill_toon>(
      kToonTable,
      {.name = "toon",
       .summary = "light in tone steps, with antialiased edges, coloured shadows and round highlights",
       .source = "Lajzer and Nottingham",
       .variants = {"", "mode=paper"},
       .quantum = 1.0 / kPaperSteps,
       .dispatches = {{.name = "light",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "specular", "shininess", "shadow", "ao"},
                       .outputs = {"toon_key", "toon_rest", "toon_visible", "toon_highlight"},
                       .kernel = toon_light_kernel(),
                       .reach = own_pixel,
                       .first_round_only = true},
                      {.name = "across",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "toon_key", "toon_rest", "toon_visible"},
                       .outputs = {"toon_row_key", "toon_row_rest", "toon_row_visible"},
                       .kernel = toon_across_kernel(),
                       .needed = is_smoothed,
                       .reach = own_row},
                      {.name = "down",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "toon_row_key", "toon_row_rest",
                                  "toon_row_visible"},
                       .outputs = {"toon_key", "toon_rest", "toon_visible"},
                       .kernel = toon_down_kernel(),
                       .needed = is_smoothed,
                       .reach = smooth_reach},
                      {.name = "steps",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "toon_key", "toon_rest", "toon_visible",
                                  "toon_highlight", "albedo.r", "albedo.g", "albedo.b", "specular"},
                       .outputs = {"lit.r", "lit.g", "lit.b"},
                       .kernel = toon_kernel(),
                       .reach = steps_reach,
                       .last_round_only = true}},
       .rounds = toon_rounds});
}

}  // namespace umbrage
