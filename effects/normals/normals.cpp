#include "effects/normals/normals.h"

#include "core/effect.h"
#include "kernels/normals.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kNormalsTable = {
    choice_row("sides", &NormalsParams::sides, 0, {"better", "mean"},
               "neighbours that determine a normal: of the two sides the one on the pixel's own surface, or the mean "
               "of both, which is smoother on curved surfaces and wrong at edges"),
};

void fill_normals(const NormalsParams& params, const PictureInfo&, NormalsConstants& c) { c = {.mean = params.sides}; }

/// Returns the number of rows that the kernel reads above and below a pixel.
int normals_reach(const void*, int) { return 2; }

}  // namespace

Effect effect_normals() {
  return shading_effect<fill_normals>(kNormalsTable, {.name = "normals",
                                                      .summary = "normals from depth alone, sharp at edges",
                                                      .source = "Wu 2020",
                                                      .variants = {"", "sides=mean"},
                                                      .quantum = 1.0,
                                                      .dispatches = {{.inputs = {"depth"},
                                                                      .outputs = {"normal.x", "normal.y", "normal.z"},
                                                                      .kernel = normals_kernel(),
                                                                      .reach = normals_reach}}});
}

}  // namespace umbrage
