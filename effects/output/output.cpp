#include "effects/output/output.h"

#include <cmath>

#include "core/color.h"
#include "core/effect.h"
#include "kernels/output.h"
#include "kernels/output_beauty.h"
#include "kernels/output_parts.h"

namespace umbrage {
namespace {

constexpr double kMaxStops = 20.0;
constexpr float kStepOf8Bits = 1.0f / 255.0f;

const std::vector<Parameter> kOutputTable = {
    real_row("exposure", &OutputParams::exposure, {.min = -kMaxStops, .max = kMaxStops, .unit = "stops"},
             "brightness, in stops: 1 doubles the light"),
    choice_row(
        "metering", &OutputParams::metering, 0, {"none", "picture", "light"},
        "automatic exposure, added to output.exposure: none, by the brightness of the surfaces in the usual view "
        "of the model or in that of a camera inside it, or by the brightness of the light of `hdri_file`"),
    choice_row(
        "tone", &OutputParams::tone, 0, {"none", "neutral", "hue"},
        "tone curve: none; hue, which limits the brightest channel to 1 and dims the others by the same factor; or "
        "like Khronos PBR Neutral, which compresses highlights and deepens shadows and keeps hue "
        "and saturation, with a softer toe"),
    real_row("contrast", &OutputParams::contrast, {.initial = 1, .max = 4, .factor = "contrast"},
             "contrast about `pivot`, before the tone curve: an exponent of light; `contrast` multiplies it"),
    real_row("pivot", &OutputParams::pivot, {.initial = 0.18, .min = 0.001, .max = 1},
             "light that contrast does not change: middle grey, 0.46 in looks that draw display values"),
    real_row("shoulder", &OutputParams::shoulder, {.initial = 1, .max = 1},
             "light above this value is compressed, so that nothing exceeds white; 1: off"),
    choice_row("transfer", &OutputParams::transfer, 0, {"srgb", "none"},
               "from linear light to 8-bit values: the sRGB curve, or the values as they are"),
    real_row("background_r", &OutputParams::background_r, {.initial = 1, .max = 1},
             "red where there is no surface, as written to the file"),
    real_row("background_g", &OutputParams::background_g, {.initial = 1, .max = 1},
             "green where there is no surface, as written to the file"),
    real_row("background_b", &OutputParams::background_b, {.initial = 1, .max = 1},
             "blue where there is no surface, as written to the file"),
    real_row("gradient", &OutputParams::gradient, {.max = 1, .zero_means = "off"},
             "the background darkens upwards: fraction of its light that is missing at the top; `background` sets 0"),
    bool_row("transparent", &OutputParams::transparent, false, "alpha 0 and black where there is no surface"),
    bool_row("sky", &OutputParams::sky, false,
             "show the planes `sky`, which `hdri_skybox` and `relight` write, where there is no surface"),
    bool_row("dither", &OutputParams::dither, false,
             "the gradient of the background is dithered by one step of 8 bits; the format of the file sets it"),
    choice_row("beauty", &OutputParams::beauty, kBeautyOff, {"off", "light", "display"},
               "also write `beauty`, scene-linear and premultiplied, from light, or from display values, which it "
               "decodes; the format of the file and the passes set it"),
    bool_row("parts", &OutputParams::parts, false, "with `beauty`, also write its parts; `passes` sets it"),
    choice_row(
        "blend", &OutputParams::blend, kBlendLight, {"light", "display"},
        "what `shadow_catcher` is the opacity for, as ground.blend, which `beauty` undoes; `transparent` sets it"),
};

void fill_output(const OutputParams& params, const PictureInfo& info, OutputConstants& c) {
  const float opaque = params.transparent ? 0.0f : 1.0f;
  const auto light = [&](float v) { return params.transfer == 0 ? linear_from_srgb(v) : v; };
  const auto beauty_light = [&](float v) { return params.beauty == kBeautyDisplay ? v : linear_from_srgb(v); };
  c = {.sky = params.sky,
       .gain = std::exp2(params.exposure),
       .tone = params.tone,
       .contrast = params.contrast,
       .pivot = params.pivot,
       .shoulder = params.shoulder,
       .room = params.shoulder < 1.0f ? 1.0f / (1.0f - params.shoulder) : 0.0f,
       .transfer = params.transfer,
       .dither = params.dither && params.gradient > 0.0f ? opaque * kStepOf8Bits : 0.0f,
       .background_r = params.background_r * opaque,
       .background_g = params.background_g * opaque,
       .background_b = params.background_b * opaque,
       .behind_r = light(params.background_r),
       .behind_g = light(params.background_g),
       .behind_b = light(params.background_b),
       .gradient = params.gradient,
       .one_over_height = 1.0f / float(info.whole_rows > 0 ? info.whole_rows : info.inner_height()),
       .first_row = info.guard - info.first_row,
       .background_alpha = opaque,
       .beauty_behind_r = beauty_light(params.background_r),
       .beauty_behind_g = beauty_light(params.background_g),
       .beauty_behind_b = beauty_light(params.background_b),
       .decode = params.beauty == kBeautyDisplay,
       .cover_display = params.blend == kBlendDisplay};
}

Exposure exposure_source(const ParameterBytes& params) {
  switch (as<OutputParams>(params).metering) {
    case kMeteringPicture:
      return Exposure::kPicture;
    case kMeteringLight:
      return Exposure::kLights;
    default:
      return Exposure::kAsSet;
  }
}

bool writes_beauty(const ParameterBytes& params) { return as<OutputParams>(params).beauty != kBeautyOff; }
bool writes_parts(const ParameterBytes& params) { return as<OutputParams>(params).parts != 0 && writes_beauty(params); }

void add_stops(float stops, ParameterBytes& params) { as<OutputParams>(params).exposure += stops; }

}  // namespace

Effect effect_output() {
  return output_effect<fill_output>(
      kOutputTable,
      {.name = "output",
       .summary = "light to picture: exposure, tone curve, transfer function, background",
       .source = "IEC 61966-2-1",
       .exposure_source = exposure_source,
       .add_stops = add_stops,
       .neutral = {{"cover", 0.0f}, {"cover_for_eye", 0.0f}, {"coverage", 1.0f}, {"sky", 0.0f}, {"beauty.a", 1.0f}},
       .dispatches = {
           {.inputs = {"lit.r", "lit.g", "lit.b", "depth", "outline", "line.r", "line.g", "line.b", "cover",
                       "cover_for_eye", "shadow_catcher", "sky.r", "sky.g", "sky.b", "coverage"},
            .outputs = {"color.r", "color.g", "color.b", "color.a"},
            .kernel = output_kernel(),
            .reach = own_pixel},
           {.name = "beauty",
            .inputs = {"lit.r", "lit.g", "lit.b", "depth", "outline", "line.r", "line.g", "line.b", "cover",
                       "cover_for_eye", "shadow_catcher", "sky.r", "sky.g", "sky.b", "coverage"},
            .outputs = {"beauty.r", "beauty.g", "beauty.b", "beauty.a"},
            .kernel = output_beauty_kernel(),
            .needed = writes_beauty,
            .reach = own_pixel},
           {.name = "parts",
            .inputs = {"lit.r", "lit.g", "lit.b", "lit_direct.r", "lit_direct.g", "lit_direct.b", "lit_indirect.r",
                       "lit_indirect.g", "lit_indirect.b", "depth", "cover", "shadow_catcher", "beauty.r", "beauty.g",
                       "beauty.b"},
            .outputs = {"beauty_direct.r", "beauty_direct.g", "beauty_direct.b", "beauty_ambient.r", "beauty_ambient.g",
                        "beauty_ambient.b", "beauty_indirect.r", "beauty_indirect.g", "beauty_indirect.b",
                        "beauty_background.r", "beauty_background.g", "beauty_background.b"},
            .kernel = output_parts_kernel(),
            .needed = writes_parts,
            .reach = own_pixel}}});
}

}  // namespace umbrage
