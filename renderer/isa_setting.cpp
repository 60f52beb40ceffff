#include "renderer/isa_setting.h"

#include <fmt/ranges.h>

#include "core/lists.h"
#include "kernel/isa.h"

namespace umbrage {

Result<void> use_isa(std::string_view name) {
  if (choose_isa(name)) return {};
  const auto& known = known_isas();
  const std::string usable_text = fmt::format("this machine has {}", fmt::join(usable_isas(), ", "));
  if (!contains(known, name)) return usage_error("`isa` (or UMBRAGE_ISA) cannot be '{}': {}", name, usable_text);
  return device_error("`isa` (or UMBRAGE_ISA) cannot be '{}' on this CPU: {}", name, usable_text);
}

Result<void> check_isa_setting() {
  return unusable_isa_setting().empty() ? Result<void>() : use_isa(unusable_isa_setting());
}

}  // namespace umbrage
