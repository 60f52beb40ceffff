// The parameter table, kernel constants and dispatches of `gaussian` [Lajzer and Nottingham].
#include "effects/gaussian/gaussian.h"

#include <algorithm>

#include "core/effect.h"
#include "kernels/gaussian_across.h"
#include "kernels/gaussian_down.h"

namespace umbrage {
namespace {

constexpr float kSideWeight = 0.25f;  // [1 2 1]/4

const std::vector<Parameter> kGaussianTable = {
    // The paper says "several times". Each round halves noise of period 4 pixels, so that 6 % of it remains after four.
    int_row("rounds", &GaussianParams::rounds, {.initial = 4, .max = 64},
            "number of times the 3x3 Gaussian is applied; 0 changes nothing"),
    bool_row("edges", &GaussianParams::edges, false,
             "blur along each surface only, not across its silhouette or into the background; off, as in the paper: "
             "across everything"),
};

void fill_gaussian(const GaussianParams& params, const PictureInfo&, GaussianConstants& c) {
  c = {params.rounds > 0 ? kSideWeight : 0.0f, params.edges};
}

/// Returns the number of rounds, at least 1: for `rounds` = 0, one round with weight 0 leaves `ao` unchanged.
int gaussian_rounds(const ParameterBytes& bytes, const PictureInfo&) {
  return std::max(1, as<GaussianParams>(bytes).rounds);
}

int gaussian_reach(const void*, int) { return 1; }

}  // namespace

Effect effect_gaussian() {
  return filter_effect<fill_gaussian>(
      kGaussianTable, {.name = "gaussian",
                       .summary = "blur the occlusion with a 3x3 Gaussian, several times",
                       .source = "Lajzer and Nottingham",
                       .tunable = {"rounds"},
                       .variants = {"", "rounds=1", "edges=on"},
                       .dispatches = {{.name = "across",
                                       .inputs = {"ao", "depth", "normal.x", "normal.y", "normal.z"},
                                       .outputs = {"gaussian_ao"},
                                       .kernel = gaussian_across_kernel(),
                                       .reach = own_row},
                                      {.name = "down",
                                       .inputs = {"gaussian_ao", "depth", "normal.x", "normal.y", "normal.z"},
                                       .outputs = {"ao"},
                                       .kernel = gaussian_down_kernel(),
                                       .reach = gaussian_reach}},
                       .rounds = gaussian_rounds});
}

}  // namespace umbrage
