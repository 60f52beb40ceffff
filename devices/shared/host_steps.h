// Host steps: dispatches that compute whole planes on the host, in the same way on every device.
#pragma once
#include <span>
#include <vector>

#include "core/image.h"
#include "devices/shared/dispatches.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Returns planes as the inputs of a host step, which does not write to them. `planes`: in the order of
/// Dispatch::inputs.
std::vector<HostPlane> host_inputs(const Dispatch& dispatch, std::span<const Plane* const> planes);

/// Runs the host step of a dispatch. `inputs`: planes of the picture's size, in the order of Dispatch::inputs. Returns
/// the planes of Dispatch::outputs in order; those of layers that do not exist are empty. Exceptions of the step
/// propagate.
std::vector<Plane> run_host_step(const DispatchRun& run, std::span<const Plane* const> inputs);

}  // namespace umbrage
