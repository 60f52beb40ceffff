// The instruction set of kernels and rays: one for the whole process, the widest that the machine has unless
// UMBRAGE_ISA or choose_isa limits it.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Returns all names: "avx512", "avx2", "sse4" of x86, widest first, "neon" of ARM, and "scalar", plain C++ that
/// computes one pixel at a time.
const std::vector<std::string_view>& known_isas();

/// Returns the names of those that this CPU supports, widest first.
const std::vector<std::string_view>& usable_isas();

/// Returns the name of the one in use.
std::string_view isa_in_use();

/// Limits kernels that run, and devices that are created, from now on; the empty name restores the state at process
/// start. Returns false for a name that is not in usable_isas(). No other thread may use Umbrage meanwhile.
bool choose_isa(std::string_view name);

/// Returns the value of UMBRAGE_ISA if this CPU lacks that instruction set and choose_isa has not set one; else empty.
/// Code that creates devices for users must report it as an error.
std::string_view wrong_isa_setting();

}  // namespace umbrage
