#include "devices/shared/soften_dispatches.h"

#include "kernels/soften.h"
#include "kernels/soften_reach.h"

namespace umbrage {

const Dispatch& soften_reach_dispatch() {
  static const Dispatch dispatch = {
      .name = "soften reach", .inputs = {"penumbra"}, .outputs = {"soften_reach"}, .kernel = soften_reach_kernel()};
  return dispatch;
}

const Dispatch& soften_dispatch() {
  static const Dispatch dispatch = {
      .name = "soften",
      .inputs = {"depth", "normal.x", "normal.y", "normal.z", "soften_from", "soften_reach"},
      .outputs = {"soften_to"},
      .kernel = soften_kernel()};
  return dispatch;
}

}  // namespace umbrage
