// The instruction set that kernels and ray tracing use. There is one for the whole process: the widest that the machine
// supports, unless UMBRAGE_ISA or choose_isa limits it.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Returns the names of all instruction sets: "avx512", "avx2" and "sse4" for x86, widest first; "neon" for ARM; and
/// "scalar", plain C++ that computes one pixel at a time.
const std::vector<std::string_view>& known_isas();

/// Returns the names of the instruction sets that this CPU supports, widest first.
const std::vector<std::string_view>& usable_isas();

/// Returns the name of the instruction set in use.
std::string_view isa_in_use();

/// Limits the instruction set for kernels that run and devices that are created after the call. The empty name restores
/// the state at process start. Returns false for a name that is not in usable_isas(). No other thread may use Umbrage
/// during the call.
bool choose_isa(std::string_view name);

/// Returns the value of UMBRAGE_ISA if this CPU does not support it and choose_isa has not been called with a name;
/// else an empty string. Code that creates devices for users must report the value as an error.
std::string_view unusable_isa_setting();

}  // namespace umbrage
