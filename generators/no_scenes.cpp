// The list of built-in scenes for a build without them.
#include "generators/builtin.h"

namespace umbrage {

std::span<const BuiltinScene> builtin_scenes() { return {}; }

}  // namespace umbrage
