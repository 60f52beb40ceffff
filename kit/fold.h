// Removes the branches of a shader that constants decide, so that it holds what its settings need, and no more.
#pragma once
#include <map>
#include <optional>
#include <string>

namespace umbrage {

/// Values of names that are known: numbers, and 0 or 1 for booleans.
using KnownValues = std::map<std::string, double, std::less<>>;

/// Returns the value of a condition, if `known` decides it.
std::optional<bool> decided(const std::string& condition, const KnownValues& known);

/// Returns a function in GLSL without the branches that `known` decides, and without what follows a `return` that is
/// always reached. An `if` stands on its own line, in a block or behind `else`.
std::string folded(std::string function, const KnownValues& known);

}  // namespace umbrage
