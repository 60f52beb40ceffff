#include "core/effect.h"

namespace umbrage {

const Parameter* find_parameter(const Effect& effect, std::string_view name) {
  for (const Parameter& row : effect.parameters)
    if (row.name == name) return &row;
  return nullptr;
}

}  // namespace umbrage
