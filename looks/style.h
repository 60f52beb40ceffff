// Style: colours of background and model for a purpose, such as a slide. A style changes any look.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/look.h"

namespace umbrage {

struct Style {
  std::string_view name, summary;
  LookPresets presets;                          ///< applied after those of the look
  std::optional<std::array<float, 3>> color{};  ///< of the whole model, as clay, display values
};

std::span<const Style> styles();

/// Returns the style of that name, or null.
const Style* find_style(std::string_view name);

}  // namespace umbrage
