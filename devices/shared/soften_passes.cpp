#include "devices/shared/soften_passes.h"

#include "kernel/kernel_frame.h"

namespace umbrage {

UMBRAGE_DECLARE_KERNEL(soften)
UMBRAGE_DECLARE_KERNEL(soften_reach)

namespace {

constexpr std::uint32_t kSoftenSpirv[] = {
#include "spirv/soften.inc"
};
constexpr std::uint32_t kReachSpirv[] = {
#include "spirv/soften_reach.inc"
};

}  // namespace

const Pass& soften_reach_pass() {
  static const Pass pass = {.name = "soften reach",
                            .inputs = {"penumbra"},
                            .outputs = {"soften_reach"},
                            .scalar = run_scalar_soften_reach,
                            .lanes = run_lanes_soften_reach,
                            .spirv = kReachSpirv};
  return pass;
}

const Pass& soften_pass() {
  static const Pass pass = {.name = "soften",
                            .inputs = {"depth", "normal.x", "normal.y", "normal.z", "soften_from", "soften_reach"},
                            .outputs = {"soften_to"},
                            .scalar = run_scalar_soften,
                            .lanes = run_lanes_soften,
                            .spirv = kSoftenSpirv};
  return pass;
}

}  // namespace umbrage
