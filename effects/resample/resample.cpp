// The parameter table, kernel constants and dispatches of `resample`.
#include "effects/resample/resample.h"

#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "kernels/resample_ao.h"
#include "kernels/resample_light.h"
#include "kernels/resample_mark.h"
#include "kernels/resample_shadow0.h"
#include "kernels/resample_shadow1.h"
#include "kernels/resample_shadow2.h"
#include "kernels/resample_shadow3.h"
#include "kernels/resample_shadow4.h"
#include "kernels/resample_shadow5.h"
#include "kernels/resample_shadow6.h"
#include "kernels/resample_shadow7.h"
#include "kernels/resample_widen.h"

namespace umbrage {
namespace {

constexpr int kAllShadows = (1 << kMaxShadows) - 1;

const std::vector<Parameter> kResampleTable = {
    choice_row("part", &ResampleParams::part, kResampleMark, {"mark", "borrow"},
               "what to do: mark the pixels at edges, or fill those of a further sample from the first"),
    choice_row("occlusion", &ResampleParams::occlusion, kResampleAo, {"nothing", "ao", "light"},
               "what to borrow besides shadows: nothing, occlusion, or occlusion and indirect light"),
    int_row("hard_shadows", &ResampleParams::hard_shadows, {.initial = 1, .max = kAllShadows},
            "bit k: mark the border of the shadow of light k"),
    int_row("soft_shadows", &ResampleParams::soft_shadows, {.initial = 0, .max = kAllShadows},
            "bit k: borrow the shadow of light k"),
    real_row("distance", &ResampleParams::distance, {.initial = 1, .min = 0.01, .max = 100, .unit = "px"},
             "max distance of a pixel from another's plane at which both show one surface"),
    real_row("angle", &ResampleParams::angle, {.initial = 25, .min = 1, .max = 180, .unit = "deg"},
             "max angle between normals at which pixels of two samples fit fully"),
    real_row("crease", &ResampleParams::crease, {.initial = 15, .min = 0.1, .max = 180, .unit = "deg"},
             "min angle between the normals of neighbours that is an edge"),
    real_row("albedo", &ResampleParams::albedo, {.initial = 0.1, .min = 0, .max = 1},
             "min difference of the square roots of albedo or emission that is an edge"),
    real_row("shadow", &ResampleParams::shadow, {.initial = 0.1, .min = 0, .max = 1},
             "min difference of a hard shadow that is an edge"),
    real_row("right", &ResampleParams::right, {.initial = 0, .min = -1, .max = 1, .unit = "px"},
             "distance of the sample to the right of the first"),
    real_row("below", &ResampleParams::below, {.initial = 0, .min = -1, .max = 1, .unit = "px"},
             "distance of the sample below the first"),
};

float one_minus_cosine(float angle_deg) { return float(1.0 - std::cos(angle_deg * std::numbers::pi / 180.0)); }

void fill_resample(const ResampleParams& params, const PictureInfo&, ResampleConstants& c) {
  c.hard_shadows = params.hard_shadows;
  c.distance = params.distance;
  c.albedo = params.albedo;
  c.shadow = params.shadow;
  c.right = params.right;
  c.below = params.below;
  c.turn = 1.0f / one_minus_cosine(params.angle);
  c.crease = one_minus_cosine(params.crease);
}

bool marks(const ParameterBytes& bytes) { return as<ResampleParams>(bytes).part == kResampleMark; }
bool borrows(const ParameterBytes& bytes, int occlusion) {
  return !marks(bytes) && as<ResampleParams>(bytes).occlusion == occlusion;
}
bool borrows_ao(const ParameterBytes& bytes) { return borrows(bytes, kResampleAo); }
bool borrows_light(const ParameterBytes& bytes) { return borrows(bytes, kResampleLight); }
template <int light>
bool borrows_shadow(const ParameterBytes& bytes) {
  return !marks(bytes) && (as<ResampleParams>(bytes).soft_shadows >> light & 1) != 0;
}

int resample_reach(const void*, int) { return 1; }

/// Returns the inputs that all dispatches need that borrow, and more.
std::vector<std::string_view> with_surfaces(std::vector<std::string_view> more) {
  std::vector<std::string_view> inputs = {
      "depth",          "normal.x",       "normal.y",      "normal.z", "other_resample_depth",
      "other_normal.x", "other_normal.y", "other_normal.z"};
  inputs.insert(inputs.end(), more.begin(), more.end());
  return inputs;
}

template <int light>
Dispatch shadow_dispatch(std::string_view shadow, std::string_view first, Kernel kernel) {
  return {.name = shadow,
          .inputs = with_surfaces({first}),
          .outputs = {shadow},
          .kernel = kernel,
          .needed = borrows_shadow<light>,
          .reach = resample_reach,
          .columns = resample_reach};
}

}  // namespace

Effect effect_resample() {
  return shading_effect<fill_resample>(
      kResampleTable,
      {.name = "resample",
       .summary = "mark the pixels at edges, and fill them in further samples of an averaged picture",
       .source = "Kopf et al. 2007",
       .variants = {"", "part=borrow", "part=borrow occlusion=light", "part=borrow soft_shadows=255"},
       .quantum = 1.0,
       .neutral = {{"other_resample_depth", 0.0f}, {"other_normal", 0.0f}},
       .dispatches = {
           {.name = "mark",
            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "emission.r",
                       "emission.g", "emission.b", "shadow", "shadow1", "shadow2", "shadow3", "shadow4", "shadow5",
                       "shadow6", "shadow7"},
            .outputs = {"resample_edge", "resample_depth"},
            .kernel = resample_mark_kernel(),
            .needed = marks,
            .reach = resample_reach,
            .columns = resample_reach},
           {.name = "widen",
            .inputs = {"resample_edge"},
            .outputs = {"marks"},
            .kernel = resample_widen_kernel(),
            .needed = marks,
            .reach = resample_reach,
            .columns = resample_reach},
           {.name = "occlusion",
            .inputs = with_surfaces({"other_ao"}),
            .outputs = {"ao"},
            .kernel = resample_ao_kernel(),
            .needed = borrows_ao,
            .reach = resample_reach,
            .columns = resample_reach},
           {.name = "light",
            .inputs = with_surfaces({"other_ao", "other_indirect.r", "other_indirect.g", "other_indirect.b"}),
            .outputs = {"ao", "indirect.r", "indirect.g", "indirect.b"},
            .kernel = resample_light_kernel(),
            .needed = borrows_light,
            .reach = resample_reach,
            .columns = resample_reach},
           shadow_dispatch<0>("shadow", "other_shadow", resample_shadow0_kernel()),
           shadow_dispatch<1>("shadow1", "other_shadow1", resample_shadow1_kernel()),
           shadow_dispatch<2>("shadow2", "other_shadow2", resample_shadow2_kernel()),
           shadow_dispatch<3>("shadow3", "other_shadow3", resample_shadow3_kernel()),
           shadow_dispatch<4>("shadow4", "other_shadow4", resample_shadow4_kernel()),
           shadow_dispatch<5>("shadow5", "other_shadow5", resample_shadow5_kernel()),
           shadow_dispatch<6>("shadow6", "other_shadow6", resample_shadow6_kernel()),
           shadow_dispatch<7>("shadow7", "other_shadow7", resample_shadow7_kernel())}});
}

}  // namespace umbrage
