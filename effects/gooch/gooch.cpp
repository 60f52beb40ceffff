// The parameter table, kernel constants and dispatch of `gooch` [Gooch et al. 1998].
#include "effects/gooch/gooch.h"

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>

#include "core/effect.h"
#include "kernels/gooch.h"

namespace umbrage {
namespace {

// Tones by default, those of the RenderMan shader k3d_gooch: a grey of 0.5 goes from (0.125, 0.125, 0.675) to (0.55,
// 0.55, 0.25).
constexpr double kBlue = 0.55, kYellow = 0.3, kAlpha = 0.25, kBeta = 0.5;
constexpr float kPaperBlue = 0.4f, kPaperYellow = 0.4f, kPaperAlpha = 0.2f, kPaperBeta = 0.6f;  // of the figures
// The light is above and to the left of the camera, like the key lights of other looks, and far enough to the side that
// what the camera sees has nearly all tones.
constexpr double kAzimuthDeg = -65.0, kElevationDeg = 45.0;
constexpr double kHighlight = 0.8, kShininess = 60.0;

const std::vector<Parameter> kGoochTable = {
    choice_row("tones", &GoochParams::tones, kGoochOwn, {"own", "paper"},
               "tones by `blue`, `yellow`, `alpha` and `beta`, or those of the paper's figures: 0.4, 0.4, 0.2, 0.6"),
    real_row("blue", &GoochParams::blue, {.initial = kBlue, .max = 1},
             "blue of the cool tone of a black surface, display value"),
    real_row("yellow", &GoochParams::yellow, {.initial = kYellow, .max = 1},
             "red and green of the warm tone of a black surface, display value"),
    real_row("alpha", &GoochParams::alpha, {.initial = kAlpha, .max = 1},
             "fraction of the surface's colour that is added to the cool tone"),
    real_row("beta", &GoochParams::beta, {.initial = kBeta, .max = 1},
             "fraction of the surface's colour that is added to the warm tone"),
    real_row(
        "hue", &GoochParams::hue, {.initial = 1, .max = 1},
        "how much saturated colours keep their hue; 0, and tones=paper: the tones of all surfaces are blue and yellow"),
    real_row("highlight", &GoochParams::highlight, {.initial = kHighlight, .max = 1, .zero_means = "off"},
             "strength of the white highlight: 1 is white in its middle"),
    real_row("shininess", &GoochParams::shininess, {.initial = kShininess, .min = 1, .max = 1000},
             "exponent of the highlight: larger values make it smaller"),
    real_row("light_azimuth", &GoochParams::light_azimuth_deg,
             {.initial = kAzimuthDeg, .min = -180, .max = 180, .unit = "deg"},
             "direction to the light, seen from the surface: this far to the right of the camera"),
    real_row("light_elevation", &GoochParams::light_elevation_deg,
             {.initial = kElevationDeg, .min = -90, .max = 90, .unit = "deg"}, "and this far above it"),
    real_row("occlusion", &GoochParams::occlusion, {.initial = 1, .max = 10, .factor = "occlusion_strength"},
             "factor for the occlusion, 1 - ao, of any technique; `occlusion_strength` multiplies it"),
    choice_row("values", &GoochParams::values, kGoochLight, {"light", "display"},
               "what `lit` holds: linear light, or display values for output.transfer=none"),
};

void fill_gooch(const GoochParams& params, const PictureInfo& info, GoochConstants& c) {
  const bool paper = params.tones == kGoochPaper;
  c.blue = paper ? kPaperBlue : params.blue;
  c.yellow = paper ? kPaperYellow : params.yellow;
  c.alpha = paper ? kPaperAlpha : params.alpha;
  c.beta = paper ? kPaperBeta : params.beta;
  c.hue = paper ? 0.0f : params.hue;
  c.highlight = params.highlight;
  c.shininess = params.shininess;
  c.occlusion = params.occlusion;
  c.values = params.values;
  const float azimuth = glm::radians(params.light_azimuth_deg), elevation = glm::radians(params.light_elevation_deg);
  // The light is fixed to the first camera, for every layer.
  const glm::vec3 light =
      glm::mat3(info.view_from_first) *
      glm::vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth));
  c.light_x = light.x;
  c.light_y = light.y;
  c.light_z = light.z;
}

}  // namespace

Effect effect_gooch() {
  return shading_effect<fill_gooch>(
      kGoochTable, {.name = "gooch",
                    .summary = "cool-to-warm shading, with the tones of technical illustrations",
                    .source = "Gooch et al. 1998",
                    .variants = {"", "tones=paper"},
                    .dispatches = {{.inputs = {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g",
                                               "albedo.b", "ao"},
                                    .outputs = {"lit.r", "lit.g", "lit.b"},
                                    .kernel = gooch_kernel(),
                                    .reach = own_pixel}}});
}

}  // namespace umbrage
