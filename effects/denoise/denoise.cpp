// The parameter table, kernel constants and dispatches of `denoise` [Dammertz et al. 2010].
#include "effects/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effect.h"
#include "kernels/denoise_ao_across.h"
#include "kernels/denoise_ao_down.h"
#include "kernels/denoise_light_across.h"
#include "kernels/denoise_light_down.h"

namespace umbrage {
namespace {

constexpr int kMaxRounds = 6;                  // with these, the filter is 253 pixels wide
constexpr float kNear = 0.25f, kFar = 0.125f;  // [1 2 2 2 1]/8

const std::vector<Parameter> kDenoiseTable = {
    int_row("rounds", &DenoiseParams::rounds, {.initial = 1, .max = kMaxRounds},
            "number of times the 5x5 filter is applied; the spacing of its taps doubles each time; 0 changes nothing"),
    real_row("occlusion", &DenoiseParams::occlusion, {.initial = 1, .max = 1},
             "fraction of the occlusion's noise that is filtered"),
    real_row("indirect", &DenoiseParams::indirect, {.max = 1},
             "fraction of the indirect light's noise that is filtered; above 0, both are filtered together"),
    real_row("distance", &DenoiseParams::distance, {.initial = 1, .min = 0.01, .max = 100, .unit = "px"},
             "max distance of a pixel from another's plane at full weight"),
    real_row("angle", &DenoiseParams::angle, {.initial = 25, .min = 1, .max = 180, .unit = "deg"},
             "max angle between normals at full weight"),
    int_row("light_rounds", &DenoiseParams::light_rounds, {.max = kMaxRounds, .zero_means = "as rounds"},
            "number of times indirect light is filtered, if different from occlusion"),
    int_row("for_height", &DenoiseParams::for_height, {.max = 65536, .unit = "px", .zero_means = "any"},
            "picture height that the rounds are meant for: each doubling of the height adds one (rounded), up to six"),
};

int light_rounds(const DenoiseParams& params) { return params.light_rounds > 0 ? params.light_rounds : params.rounds; }

/// Returns `rounds`, plus one for each doubling of the picture height over `for_height`, rounded; at most kMaxRounds.
int rounds_for_height(int rounds, const DenoiseParams& params, const PictureInfo& info) {
  if (rounds == 0 || params.for_height == 0) return rounds;
  const int added = int(std::lround(std::log2(info.reference_height() / float(params.for_height))));
  return std::min(rounds + std::max(added, 0), kMaxRounds);
}

void fill_denoise(const DenoiseParams& params, const PictureInfo& info, DenoiseConstants& c) {
  const double cosine = std::cos(params.angle * std::numbers::pi / 180.0);
  c = {kNear,
       kFar,
       params.occlusion,
       params.indirect,
       params.distance,
       float(1.0 / (1.0 - cosine)),
       rounds_for_height(params.rounds, params, info),
       rounds_for_height(light_rounds(params), params, info)};
}

bool includes_light(const ParameterBytes& bytes) {
  const auto& params = as<DenoiseParams>(bytes);
  return light_rounds(params) > 0 && params.indirect > 0.0f;
}
int denoise_rounds(const ParameterBytes& bytes, const PictureInfo& info) {
  const auto& params = as<DenoiseParams>(bytes);
  const int max_rounds = includes_light(bytes) ? std::max(params.rounds, light_rounds(params)) : params.rounds;
  return rounds_for_height(max_rounds, params, info);
}
bool ao_only(const ParameterBytes& bytes) {
  const auto& params = as<DenoiseParams>(bytes);
  return params.rounds > 0 && params.occlusion > 0.0f && !includes_light(bytes);
}

/// Returns Dispatch::reach of the dispatches along columns: two taps, whose spacing doubles in each round.
int denoise_reach(const void*, int round) { return 2 << round; }

}  // namespace

Effect effect_denoise() {
  return filter_effect<fill_denoise>(
      kDenoiseTable,
      {.name = "denoise",
       .summary = "smooth the noise of occlusion and indirect light along surfaces, preserving their mean",
       .source = "Dammertz et al. 2010",
       .tunable = {"rounds", "distance", "angle"},
       .variants = {"", "rounds=2", "rounds=3", "indirect=1", "indirect=1 light_rounds=3"},
       .dispatches = {{.name = "ao_across",
                       .inputs = {"ao", "depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"denoise_ao"},
                       .kernel = denoise_ao_across_kernel(),
                       .needed = ao_only,
                       .reach = own_row},
                      {.name = "ao_down",
                       .inputs = {"denoise_ao", "depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"ao"},
                       .kernel = denoise_ao_down_kernel(),
                       .needed = ao_only,
                       .reach = denoise_reach},
                      {.name = "light_across",
                       .inputs = {"ao", "indirect.r", "indirect.g", "indirect.b", "depth", "normal.x", "normal.y",
                                  "normal.z"},
                       .outputs = {"denoise_ao", "denoise_indirect.r", "denoise_indirect.g", "denoise_indirect.b"},
                       .kernel = denoise_light_across_kernel(),
                       .needed = includes_light,
                       .reach = own_row},
                      {.name = "light_down",
                       .inputs = {"denoise_ao", "denoise_indirect.r", "denoise_indirect.g", "denoise_indirect.b",
                                  "depth", "normal.x", "normal.y", "normal.z"},
                       .outputs = {"ao", "indirect.r", "indirect.g", "indirect.b"},
                       .kernel = denoise_light_down_kernel(),
                       .needed = includes_light,
                       .reach = denoise_reach}},
       .rounds = denoise_rounds});
}

}  // namespace umbrage
