// Creates devices by name, and applies the instruction set that users set with `isa` or UMBRAGE_ISA.
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "core/device.h"
#include "core/result.h"

namespace umbrage {

/// Creates the device `cpu`, `vulkan` (the best Vulkan device), `vulkan:N`, or `auto`: a hardware GPU if there is one,
/// else the CPU. `threads`: 0 for one per hardware thread. Errors: kUsage for an unknown name; kDevice for a device
/// that is missing or unusable; the errors of use_isa for the value of UMBRAGE_ISA.
Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads);

/// Limits kernels and ray tracing of this process to an instruction set of kernel/isa.h. Errors: kUsage for an unknown
/// name, kDevice for one that this CPU lacks; both list the usable ones.
Result<void> use_isa(std::string_view name);
/// Reports the error of use_isa if the value of UMBRAGE_ISA is not usable, unless use_isa has set another one.
Result<void> check_isa_setting();

}  // namespace umbrage
