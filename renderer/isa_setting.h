// Applies the instruction set that users set with `isa` or UMBRAGE_ISA, and reports values that are not usable.
#pragma once
#include <string_view>

#include "core/result.h"

namespace umbrage {

/// Limits kernels and ray tracing of this process to an instruction set of kernel/isa.h. Errors: kUsage for an unknown
/// name, kDevice for one that this CPU lacks; both list the usable ones.
Result<void> use_isa(std::string_view name);
/// Reports the error of use_isa if the value of UMBRAGE_ISA is not usable, unless use_isa has set another one.
Result<void> check_isa_setting();

}  // namespace umbrage
