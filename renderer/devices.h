// Creates devices by name.
#pragma once
#include <memory>
#include <string>

#include "core/device.h"

namespace umbrage {

/// Creates the device `cpu`, `vulkan` (the best Vulkan device), `vulkan:N`, or `auto`: a hardware GPU if there is one,
/// else the CPU. `threads`: 0 for one per hardware thread. Errors: kUsage for an unknown name; kDevice for a device
/// that is missing or unusable; the errors of use_isa for the value of UMBRAGE_ISA.
Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads);

}  // namespace umbrage
