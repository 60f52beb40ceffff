// Which SIMD target the lanes run on.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace umbrage {

/// Name of the target that lanes are dispatched to now: "SSE4", "AVX2", "AVX3" (AVX-512), "NEON".
std::string simd_target_name();

/// Names of all targets that were compiled and that this CPU can run, best first.
std::vector<std::string> simd_target_names();

/// Runs lanes on the target of that name from now on; the empty name means the best. Returns whether there is one.
bool choose_simd_target(const std::string& name);

}  // namespace umbrage
