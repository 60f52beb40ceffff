// The memory of the machine.
#pragma once

namespace umbrage {

/// Returns how much memory, in bytes, programs may take without swapping: of the machine as the kernel estimates it,
/// and at most the limit of the container. Infinite if it is not known.
double available_memory();

}  // namespace umbrage
