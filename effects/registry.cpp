// The list of all effects, which CMake generates.
#include <vector>

#include "core/registry.h"
#include "effects/effects.h"

namespace umbrage {

// CMake generates effects.inc, with one line per folder of effects/.
#define UMBRAGE_EFFECT(name) Effect effect_##name();
#include "effects.inc"
#undef UMBRAGE_EFFECT

std::span<const Effect* const> effects() {
  static const Effect list[] = {
#define UMBRAGE_EFFECT(name) effect_##name(),
#include "effects.inc"
#undef UMBRAGE_EFFECT
  };
  static const std::vector<const Effect*> all = pointers_to(list);
  return all;
}

const Effect* find_effect(std::string_view name) { return find_named(effects(), name); }

}  // namespace umbrage
