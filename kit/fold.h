// Removes the branches of a shader that constants decide, so that it holds what its settings need, and no more.
#pragma once
#include <map>
#include <string>

namespace umbrage {

/// Values of names that are known: numbers, and 0 or 1 for booleans.
using KnownValues = std::map<std::string, double, std::less<>>;

/// Returns a function in GLSL without the `if` and `?:` that `known` decides, and without what follows a `return` that
/// is always reached.
std::string folded(std::string function, const KnownValues& known);

}  // namespace umbrage
