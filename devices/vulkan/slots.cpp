#include "devices/vulkan/slots.h"

#include <algorithm>
#include <map>

namespace umbrage {
namespace {

// SPIR-V's numbers: words before the first instruction, and the instructions and the decoration that are looked at.
constexpr std::size_t kHeaderWords = 5;
constexpr std::uint32_t kOpName = 5, kOpDecorate = 71, kSpecId = 1;

}  // namespace

std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv) {
  constexpr std::string_view kEnd = "_slot";
  std::vector<Slot> slots;
  std::map<std::uint32_t, std::string> names;
  for (std::size_t at = kHeaderWords; at < spirv.size();) {
    const std::uint32_t op = spirv[at] & 0xffff, words = spirv[at] >> 16;
    if (words == 0) break;
    if (op == kOpName) {
      const std::string name(reinterpret_cast<const char*>(&spirv[at + 2]));
      if (name.ends_with(kEnd)) names[spirv[at + 1]] = name.substr(0, name.size() - kEnd.size());
    }
    if (op == kOpDecorate && spirv[at + 2] == kSpecId)
      if (const auto named = names.find(spirv[at + 1]); named != names.end())
        slots.push_back({named->second, spirv[at + 3]});
    at += words;
  }
  return slots;
}

std::string slot_name(std::string_view plane) {
  std::string name(plane);
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

}  // namespace umbrage
