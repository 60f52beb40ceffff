#include "devices/shared/soften_passes.h"

#include "kernels/soften.h"
#include "kernels/soften_reach.h"

namespace umbrage {

const Pass& soften_reach_pass() {
  static const Pass pass = {
      .name = "soften reach", .inputs = {"penumbra"}, .outputs = {"soften_reach"}, .kernel = soften_reach_kernel()};
  return pass;
}

const Pass& soften_pass() {
  static const Pass pass = {.name = "soften",
                            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "soften_from", "soften_reach"},
                            .outputs = {"soften_to"},
                            .kernel = soften_kernel()};
  return pass;
}

}  // namespace umbrage
