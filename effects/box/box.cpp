// The parameter table, kernel constants and dispatches of `box` [Colliander and Törnquist 2015].
#include "effects/box/box.h"

#include <algorithm>

#include "core/effect.h"
#include "kernels/box_ao_across.h"
#include "kernels/box_ao_down.h"
#include "kernels/box_indirect_across.h"
#include "kernels/box_indirect_down.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kBoxTable = {
    int_row("size", &BoxParams::size, {.initial = 4, .min = 1, .max = 15, .unit = "px"},
            "side of the window; with the side of the noise tile, it removes the noise on flat surfaces entirely; 1 "
            "changes nothing"),
    choice_row(
        "background", &BoxParams::background, 0, {"skip", "mix"},
        "pixels without a surface: left out of the mean, or included as in the paper, which brightens silhouettes"),
    bool_row("ao", &BoxParams::ao, true, "blur the occlusion"),
    bool_row("indirect", &BoxParams::indirect, true, "blur the indirect light"),
};

void fill_box(const BoxParams& params, const PictureInfo&, BoxConstants& c) {
  // A window of even size extends one pixel farther to the left and upwards.
  const int first = -(params.size / 2);
  c = {first, first + params.size - 1, params.background == 0 ? 1 : 0};
}

bool blurs_ao(const ParameterBytes& bytes) { return as<BoxParams>(bytes).ao != 0; }
bool blurs_indirect(const ParameterBytes& bytes) { return as<BoxParams>(bytes).indirect != 0; }

int box_reach(const void* constants, int) {
  const auto& c = *static_cast<const BoxConstants*>(constants);
  return std::max(-c.first, c.last);
}

}  // namespace

Effect effect_box() {
  return filter_effect<fill_box>(
      kBoxTable, {.name = "box",
                  .summary = "average occlusion and indirect light over a small square",
                  .source = "Colliander and Törnquist 2015",
                  .variants = {"", "indirect=off", "size=8"},
                  .dispatches = {{.name = "ao across",
                                  .inputs = {"ao", "depth"},
                                  .outputs = {"box_ao", "box_count"},
                                  .kernel = box_ao_across_kernel(),
                                  .needed = blurs_ao,
                                  .reach = own_row},
                                 {.name = "ao down",
                                  .inputs = {"box_ao", "box_count"},
                                  .outputs = {"ao"},
                                  .kernel = box_ao_down_kernel(),
                                  .needed = blurs_ao,
                                  .reach = box_reach},
                                 {.name = "indirect across",
                                  .inputs = {"indirect.r", "indirect.g", "indirect.b", "depth"},
                                  .outputs = {"box_indirect.r", "box_indirect.g", "box_indirect.b", "box_count"},
                                  .kernel = box_indirect_across_kernel(),
                                  .needed = blurs_indirect,
                                  .reach = own_row},
                                 {.name = "indirect down",
                                  .inputs = {"box_indirect.r", "box_indirect.g", "box_indirect.b", "box_count"},
                                  .outputs = {"indirect.r", "indirect.g", "indirect.b"},
                                  .kernel = box_indirect_down_kernel(),
                                  .needed = blurs_indirect,
                                  .reach = box_reach}}});
}

}  // namespace umbrage
