#include "devices/vulkan/slots.h"

#include <algorithm>
#include <map>
#include <spirv/unified1/spirv.hpp>

namespace umbrage {
namespace {

constexpr std::size_t kHeaderWords = 5;  // words of a module before its first instruction

}  // namespace

std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv) {
  constexpr std::string_view kSuffix = "_slot";
  std::vector<Slot> slots;
  std::map<std::uint32_t, std::string> names;
  for (std::size_t at = kHeaderWords; at < spirv.size();) {
    const std::uint32_t op = spirv[at] & spv::OpCodeMask, words = spirv[at] >> spv::WordCountShift;
    if (words == 0) break;
    if (op == spv::OpName) {
      const std::string name(reinterpret_cast<const char*>(&spirv[at + 2]));
      if (name.ends_with(kSuffix)) names[spirv[at + 1]] = name.substr(0, name.size() - kSuffix.size());
    }
    if (op == spv::OpDecorate && spirv[at + 2] == spv::DecorationSpecId)
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
