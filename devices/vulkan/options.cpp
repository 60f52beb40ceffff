#include "devices/vulkan/options.h"

#include <cstring>
#include <map>
#include <set>
#include <spirv/unified1/spirv.hpp>
#include <string_view>
#include <utility>

namespace umbrage {
namespace {

struct Member {
  std::uint32_t first = 0, second = 0;  // index of a struct in the block, and of a member in that struct
  auto operator<=>(const Member&) const = default;
};

/// The declarations of a shader, by id.
struct Module {
  std::map<std::uint32_t, std::vector<std::uint32_t>> structs;               // member types
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> offsets;  // by struct and member, bytes
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> arrays;   // element type and number of elements
  std::map<std::uint32_t, std::uint32_t> pointees;                           // the type to which a pointer type points
  std::map<std::uint32_t, std::uint32_t> constants;                          // value
  std::set<std::uint32_t> ints, blocks, block_variables;
  std::map<std::uint32_t, Member> pointers;  // the member to which a pointer points
  std::map<std::uint32_t, Member> loaded;    // the member from which a value was loaded
};

}  // namespace

KernelOptions options_of(std::span<const std::uint32_t> spirv) {
  Module m;
  KernelOptions found;
  std::vector<std::pair<Member, std::size_t>> loads;
  std::set<Member> compared;
  for (std::size_t at = kSpirvHeaderWords; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> spv::WordCountShift;
    if (words == 0 || at + words > spirv.size()) break;
    const std::span<const std::uint32_t> op = spirv.subspan(at, words);
    switch (spirv[at] & spv::OpCodeMask) {
      case spv::OpName:
        if (std::string_view(reinterpret_cast<const char*>(&op[2])) == "constants_block") m.blocks.insert(op[1]);
        break;
      case spv::OpMemberDecorate:
        if (op[3] == spv::DecorationOffset) m.offsets[{op[1], op[2]}] = op[4];
        break;
      case spv::OpTypeInt:
        m.ints.insert(op[1]);
        break;
      case spv::OpTypeArray:
        m.arrays[op[1]] = {op[2], m.constants[op[3]]};
        break;
      case spv::OpTypeStruct:
        m.structs[op[1]].assign(op.begin() + 2, op.end());
        break;
      case spv::OpTypePointer:
        m.pointees[op[1]] = op[3];
        break;
      case spv::OpConstant:
        m.constants[op[2]] = op[3];
        break;
      case spv::OpVariable:
        if (m.blocks.contains(m.pointees[op[1]])) m.block_variables.insert(op[2]);
        break;
      case spv::OpFunction:
        if (found.first_function == 0) found.first_function = at;
        break;
      case spv::OpAccessChain:
        if (words >= 6 && m.block_variables.contains(op[3]) && m.constants.contains(op[4]) &&
            m.constants.contains(op[5]))
          m.pointers[op[2]] = {m.constants[op[4]], m.constants[op[5]]};
        break;
      case spv::OpLoad:
        if (const auto from = m.pointers.find(op[3]); from != m.pointers.end() && m.ints.contains(op[1])) {
          m.loaded[op[2]] = from->second;
          loads.push_back({from->second, at});
        }
        break;
      case spv::OpIEqual:
      case spv::OpINotEqual:
        for (const auto& [a, b] : {std::pair(op[3], op[4]), std::pair(op[4], op[3])})
          if (m.loaded.contains(a) && m.constants.contains(b)) compared.insert(m.loaded[a]);
        break;
      default:
        break;
    }
    at += words;
  }
  if (m.blocks.empty()) return found;
  const std::uint32_t block = *m.blocks.begin();
  std::map<Member, std::size_t> index;
  for (const Member& member : compared) {
    const std::uint32_t inner = m.structs[block][member.first];
    const auto array = m.arrays.find(m.structs[inner][member.second]);
    index[member] = found.options.size();
    found.options.push_back({m.offsets[{block, member.first}] + m.offsets[{inner, member.second}],
                             array == m.arrays.end() ? 1 : int(array->second.second)});
  }
  for (const auto& [member, word] : loads)
    if (const auto option = index.find(member); option != index.end()) found.loads.push_back({option->second, word});
  return found;
}

std::vector<std::optional<std::int32_t>> option_values(const KernelOptions& options, std::span<const std::byte> block) {
  std::vector<std::optional<std::int32_t>> values;
  for (const KernelOption& option : options.options) {
    std::optional<std::int32_t> value;
    for (int k = 0; k < option.count; ++k) {
      std::int32_t number = 0;
      std::memcpy(&number, block.subspan(option.offset + std::size_t(k) * sizeof number, sizeof number).data(),
                  sizeof number);
      if (k > 0 && value != number) {
        value.reset();
        break;
      }
      value = number;
    }
    values.push_back(value);
  }
  return values;
}

std::vector<std::uint32_t> with_options(std::span<const std::uint32_t> spirv, const KernelOptions& options,
                                        std::span<const std::optional<std::int32_t>> values) {
  std::vector<std::uint32_t> constants, rest(spirv.begin(), spirv.end());
  for (const OptionLoad& load : options.loads) {
    const auto& value = values[load.option];
    if (!value) continue;
    // A constant of the same id replaces the load.
    const std::uint32_t type = rest[load.word + 1], id = rest[load.word + 2],
                        words = rest[load.word] >> spv::WordCountShift;
    constants.insert(constants.end(), {4u << spv::WordCountShift | spv::OpConstant, type, id, std::uint32_t(*value)});
    for (std::uint32_t k = 0; k < words; ++k) rest[load.word + k] = 1u << spv::WordCountShift | spv::OpNop;
  }
  rest.insert(rest.begin() + std::ptrdiff_t(options.first_function), constants.begin(), constants.end());
  return rest;
}

}  // namespace umbrage
