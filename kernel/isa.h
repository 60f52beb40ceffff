// The instruction set of kernels and rays: one for the whole process, the widest that the machine has unless
// UMBRAGE_ISA or choose_isa bounds it.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// All names: "avx512", "avx2", "sse4" of x86, widest first, "neon" of ARM, and "scalar", which is plain C++, in which
/// a kernel takes one pixel at a time.
const std::vector<std::string_view>& known_isas();

/// Names of those that this CPU has, widest first.
const std::vector<std::string_view>& usable_isas();

/// The one in use.
std::string_view isa_in_use();

/// Bounds what is dispatched from now on, and devices that are made from now on; the empty name means what the process
/// started with. False for a name that is not among usable_isas(). Not while another thread uses Umbrage.
bool choose_isa(std::string_view name);

/// The value of UMBRAGE_ISA where this CPU has no such instruction set, until choose_isa takes a name; else empty.
/// Whoever makes devices for people makes an error of it.
std::string_view wrong_isa_setting();

}  // namespace umbrage
