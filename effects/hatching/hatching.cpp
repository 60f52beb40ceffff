// The parameter table, kernel constants and dispatches of `hatching`.
#include "effects/hatching/hatching.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>

#include "core/color.h"
#include "core/effect.h"
#include "core/parameters.h"
#include "effects/hatching/hatching_strokes.h"
#include "effects/outline/outline_draw.h"
#include "kernels/hatching_across.h"
#include "kernels/hatching_break.h"
#include "kernels/hatching_down.h"
#include "kernels/hatching_field.h"
#include "kernels/hatching_tone.h"

namespace umbrage {
namespace {

constexpr double kMaxSpacing = 64.0, kMaxSmoothness = 200.0;  // pixels
constexpr int kTaps = 12;  // of the filter on each side; see hatching_filter.kernel.h

const std::vector<Parameter> kHatchingTable = {
    length_row("spacing", &HatchingParams::spacing,
               {.initial_percent = 0.45, .min = 2, .max = kMaxSpacing, .unit = "px"},
               "distance between lines where all of them are drawn, in pixels or in percent of the picture's height"),
    length_row("width", &HatchingParams::width, {.initial_percent = 0.12, .min = 0.2, .max = 16, .unit = "px"},
               "width of a line; where all lines are drawn, they are wider the darker the tone"),
    real_row("exposure", &HatchingParams::exposure, {.min = -20, .max = 20, .unit = "stops"},
             "brightness of the light that lines show; at 0, light of 1 leaves the paper blank"),
    real_row("contrast", &HatchingParams::contrast, {.initial = 1, .min = 0.1, .max = 10},
             "exponent of the tone, a display value: above 1 lines show darker tones"),
    real_row(
        "material", &HatchingParams::material, {.max = 1},
        "how much darker the tone of dark materials is; 1: in proportion to their albedo, a display value, if `lit` is "
        "the light on white clay"),
    real_row("cross", &HatchingParams::cross, {.initial = 0.4, .max = 1},
             "fraction of the area covered by ink from which on a second set of lines crosses the first; 1: never"),
    choice_row("direction", &HatchingParams::direction, kHatchingCurvature, {"curvature", "fixed"},
               "direction of lines: around the surface where it is curved, or in parallel planes"),
    real_row("tilt", &HatchingParams::tilt_deg, {.initial = 25, .min = -90, .max = 90, .unit = "deg"},
             "angle of the fixed direction, also of that on flat surfaces and spheres: 0 are horizontal planes"),
    length_row("smoothness", &HatchingParams::smoothness, {.initial_percent = 4.5, .max = kMaxSmoothness, .unit = "px"},
               "radius over which directions are averaged, in pixels or in percent of the picture's height"),
    choice_row("strokes", &HatchingParams::strokes, kHatchingShade, {"shade", "light"},
               "what lines draw: shade, with dark ink on light paper, or light, with light ink on dark paper, as in "
               "the styles dark and blueprint"),
    real_row("paper_r", &HatchingParams::paper_r, {.initial = 1, .max = 1},
             "red of surfaces without ink, display value"),
    real_row("paper_g", &HatchingParams::paper_g, {.initial = 1, .max = 1}, "green, likewise"),
    real_row("paper_b", &HatchingParams::paper_b, {.initial = 1, .max = 1}, "blue, likewise"),
    choice_row("parts", &HatchingParams::parts, kHatchingAll, {"all", "tone", "lines"},
               "all, or only the tone of the paper, or the lines after that; set for averaged pictures"),
};

void fill_hatching(const HatchingParams& params, const PictureInfo& info, HatchingConstants& c) {
  constexpr float kDistinctRadius = 0.7f;  // radius of a distinct curvature, in heights of the picture
  constexpr float kThinSpacings = 2.5f;
  const auto height = float(info.inner_height());
  const float tilt = glm::radians(params.tilt_deg);
  glm::vec3 axis = glm::mat3(info.camera.view_from_world) *
                   glm::normalize(glm::vec3(std::sin(tilt), std::cos(tilt), 0.5f * std::sin(tilt)));
  // Where shapes have no direction of their own, as spheres, planes that contain the direction of view have their poles
  // on the silhouette, where no line turns around them.
  if (params.direction == kHatchingCurvature) {
    axis.z = 0.0f;
    axis = glm::length(axis) > 0.1f ? glm::normalize(axis) : glm::vec3(0.0f, 1.0f, 0.0f);
  }
  const float spacing = std::clamp(absolute_length(params.spacing, height), 2.0f, float(kMaxSpacing));
  const int thin_px = int(std::ceil(kThinSpacings * spacing));
  c = {.spacing_px = spacing,
       .width_px = std::max(absolute_length(params.width, height), 0.2f),
       .gain = std::exp2(params.exposure),
       .contrast = params.contrast,
       .material = params.material,
       .cross = params.cross,
       .curvature = params.direction == kHatchingCurvature ? 1 : 0,
       .axis_x = axis.x,
       .axis_y = axis.y,
       .axis_z = axis.z,
       .curvature_unit = 1.0f / (kDistinctRadius * height),
       .detail_px = 1.5f * spacing,
       .thin_px = thin_px,
       .inverse_thin = 1.0f / float(thin_px),
       .tap_px = std::min(absolute_length(params.smoothness, height), float(kMaxSmoothness)) / float(kTaps),
       .strokes = params.strokes,
       .paper_r = linear_from_srgb(params.paper_r),
       .paper_g = linear_from_srgb(params.paper_g),
       .paper_b = linear_from_srgb(params.paper_b)};
}

bool has_tone(const ParameterBytes& bytes) { return as<HatchingParams>(bytes).parts != kHatchingLines; }
bool has_lines(const ParameterBytes& bytes) { return as<HatchingParams>(bytes).parts != kHatchingTone; }

/// These return the number of rows that the dispatches read above and below a pixel.
int break_reach(const void*, int) { return 1; }
int field_reach(const void* constants, int) { return static_cast<const HatchingConstants*>(constants)->thin_px + 1; }
int filter_reach(const void* constants, int) {
  return int(std::ceil(static_cast<const HatchingConstants*>(constants)->tap_px * float(kTaps))) + 1;
}

}  // namespace

Effect effect_hatching() {
  return shading_effect<fill_hatching>(
      kHatchingTable,
      {.name = "hatching",
       .summary = "lines along the surface that show its light, as drawn with a pen",
       .source = "Jobard and Lefer 1997",
       .without_lines = {"hatching.parts=tone"},
       .lines_alone = {"hatching.parts=lines"},
       .variants = {"", "direction=fixed"},
       .quantum = 1.0,
       .neutral = {{"hatching_ink", 0.0f}},
       .dispatches = {{.name = "hatching_tone",
                       .inputs = {"depth", "albedo.r", "albedo.g", "albedo.b", "emission.r", "emission.g", "emission.b",
                                  "lit.r", "lit.g", "lit.b"},
                       .outputs = {"lit.r", "lit.g", "lit.b", "hatching_ink"},
                       .kernel = hatching_tone_kernel(),
                       .needed = has_tone,
                       .reach = own_pixel},
                      {.name = "hatching_break",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "object_id"},
                       .outputs = {"hatching_break"},
                       .kernel = hatching_break_kernel(),
                       .needed = has_lines,
                       .reach = break_reach},
                      {.name = "hatching_field",
                       .inputs = {"depth", "normal.x", "normal.y", "normal.z", "hatching_break"},
                       .outputs = {"hatching_raw_x", "hatching_raw_y"},
                       .kernel = hatching_field_kernel(),
                       .needed = has_lines,
                       .reach = field_reach},
                      {.name = "hatching_across",
                       .inputs = {"hatching_raw_x", "hatching_raw_y", "depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"hatching_row_x", "hatching_row_y"},
                       .kernel = hatching_across_kernel(),
                       .needed = has_lines,
                       .reach = own_row},
                      {.name = "hatching_down",
                       .inputs = {"hatching_row_x", "hatching_row_y", "depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"hatching_x", "hatching_y", "hatching_cross_x", "hatching_cross_y"},
                       .kernel = hatching_down_kernel(),
                       .needed = has_lines,
                       .reach = filter_reach},
                      {.name = "hatching_strokes",
                       .inputs = {"hatching_x", "hatching_y", "hatching_cross_x", "hatching_cross_y", "hatching_ink",
                                  "hatching_break", "depth", "object_id", "outline"},
                       .outputs = {"outline"},
                       .host = add_traced<hatching_lines>,
                       .trace = hatching_lines,
                       .keys = {hatching_key, hatching_join},
                       .needed = has_lines}}});
}

}  // namespace umbrage
