// The planes that a compiled kernel accesses: see kernel/glsl.h.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// A specialization constant that gives the index of a plane in the table of planes.
struct Slot {
  std::string plane;  ///< with _ in place of dots: normal_x
  std::uint32_t constant = 0;
};

/// Returns all slots of a shader, in the order in which it declares them.
std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv);

/// Returns the name of a plane in the form of Slot::plane.
std::string slot_name(std::string_view plane);

}  // namespace umbrage
