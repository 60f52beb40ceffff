// The registry of all effects.
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "core/effect.h"

namespace umbrage {

/// Returns all effects, sorted by name.
std::span<const Effect* const> effects();

/// Returns the effect called `name`, or null.
const Effect* find_effect(std::string_view name);

/// Returns the effect whose params struct is `Params`, such as OutputParams. renderer/, library/ and apps/ refer to a
/// particular effect so, never by its name. Throws InternalError if there is none.
const Effect& effect_with(std::type_index params_type);
template <class Params>
const Effect& effect_with() {
  static const Effect& effect = effect_with(typeid(Params));
  return effect;
}

/// Returns the value of a plane that nothing has written, or nullopt if it must exist. Values of a G-buffer's planes
/// and of the outputs of techniques are known here, others declared by Effect::neutral.
std::optional<float> neutral_value(std::string_view plane);

}  // namespace umbrage
