#include <vector>

#include "effects/effects.h"

namespace umbrage {

// effects.inc is made by CMake: one line per folder.
#define UMBRAGE_EFFECT(name) const Effect& effect_##name();
#include "effects.inc"
#undef UMBRAGE_EFFECT

std::span<const Effect* const> effects() {
  static const std::vector<const Effect*> all = {
#define UMBRAGE_EFFECT(name) &effect_##name(),
#include "effects.inc"
#undef UMBRAGE_EFFECT
  };
  return all;
}

const Effect* find_effect(std::string_view name) {
  for (const Effect* effect : effects())
    if (effect->name == name) return effect;
  return nullptr;
}

}  // namespace umbrage
