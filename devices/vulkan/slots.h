// Which planes a compiled kernel asks for: see kernel/glsl.h.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// A specialization constant that says where in the table of planes a plane stands.
struct Slot {
  std::string plane;  ///< with _ in place of dots: normal_x
  std::uint32_t constant = 0;
};

/// All of a shader, in its order.
std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv);

/// A plane's name as slots have it.
std::string slot_name(std::string_view plane);

}  // namespace umbrage
