// Devices by name.
#pragma once
#include <memory>
#include <string>

#include "core/device.h"

namespace umbrage {

/// `cpu`, `vulkan` (the best), `vulkan:N`, or `auto`: a real GPU if there is one, else the CPU. `threads`: 0 for as
/// many as the machine has. Errors: kUsage for a name that does not exist; kDevice for a device that is not there or
/// cannot be used; those of use_isa for UMBRAGE_ISA.
Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads);

}  // namespace umbrage
