// What people say of the instruction set, `isa` and UMBRAGE_ISA, in sentences where it cannot be.
#pragma once
#include <string_view>

#include "core/result.h"

namespace umbrage {

/// Bounds kernels and rays of this process to an instruction set of kernel/isa.h. Errors: kUsage for a name that there
/// is not, kDevice for one that this CPU lacks; both name those that it has.
Result<void> use_isa(std::string_view name);
/// The same for what UMBRAGE_ISA says.
Result<void> check_isa_setting();

}  // namespace umbrage
