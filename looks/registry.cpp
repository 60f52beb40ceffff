// The registry of all looks.
#include "core/registry.h"
#include "looks/looks.h"

namespace umbrage {

// CMake generates looks.inc, with one line per look.
#define UMBRAGE_LOOK(name) Look look_##name();
#include "looks.inc"
#undef UMBRAGE_LOOK

std::span<const Look* const> looks() {
  static const Look list[] = {
#define UMBRAGE_LOOK(name) look_##name(),
#include "looks.inc"
#undef UMBRAGE_LOOK
  };
  static const std::vector<const Look*> all = pointers_to(list);
  return all;
}

std::span<const Look* const> scene_looks() {
  static const std::vector<const Look*> all = [] {
    std::vector<const Look*> kept(looks().begin(), looks().end());
    std::erase_if(kept, [](const Look* look) { return look->needs_beauty; });
    return kept;
  }();
  return all;
}

const Look* find_look(std::string_view name) { return find_named(looks(), name); }

std::vector<std::string_view> occlusion_names(std::span<const Effect* const> external_effects) {
  std::vector<std::string_view> names;
  for (const Effect* effect : all_effects(external_effects))
    if (effect->kind == EffectKind::kOcclusion) names.push_back(effect->name);
  names.push_back(kNoOcclusion);
  return names;
}

}  // namespace umbrage
