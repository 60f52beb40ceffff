// Translates the text of kernels from the kernel dialect to GLSL, with its comments and line breaks.
#pragma once
#include <set>
#include <string>

namespace umbrage {

/// Returns an item in GLSL. `floats`: names of constants and "C.field" of type float, around which conversions are left
/// out.
std::string glsl_of(const std::string& item, const std::set<std::string>& floats);

}  // namespace umbrage
