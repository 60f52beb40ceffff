// The list of built-in scenes where none are built.
#include "generators/builtin.h"

namespace umbrage {

std::span<const BuiltinScene> builtin_scenes() { return {}; }

}  // namespace umbrage
