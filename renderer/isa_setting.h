// Applies the instruction set that the user sets with `isa` or UMBRAGE_ISA, and reports values that are not usable.
#pragma once
#include <string_view>

#include "core/result.h"

namespace umbrage {

/// Limits kernels and ray tracing of this process to an instruction set of kernel/isa.h. Errors: kUsage for an unknown
/// name, kDevice for one that this CPU lacks; both list the usable ones.
Result<void> use_isa(std::string_view name);
/// Does the same for the value of UMBRAGE_ISA, if it is set.
Result<void> check_isa_setting();

}  // namespace umbrage
