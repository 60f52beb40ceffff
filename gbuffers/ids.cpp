#include "gbuffers/ids.h"

#include <algorithm>
#include <bit>

#include "core/lists.h"
#include "core/lowercase.h"

namespace umbrage {
namespace {

constexpr int kBlockRows = 256;

/// Returns how well a layer's name says that its Cryptomatte is of objects; the lower, the better.
int rank_of(const std::string& name, bool materials) {
  constexpr int kUnknown = 3, kOther = 100;
  const bool material = name.find("material") != std::string::npos;
  if (material != materials) return kOther;
  if (material || name.find("object") != std::string::npos) return 0;
  if (name.find("node") != std::string::npos) return 1;
  if (name.find("asset") != std::string::npos) return 2;
  return kUnknown;
}

}  // namespace

float IdTable::index_of(std::uint32_t id) const {
  if (zero_is_none && id == 0) return -1.0f;
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  return at != ids.end() && *at == id ? float(at - ids.begin()) : -1.0f;
}

std::optional<RoleChannels> find_cryptomatte(const LayeredFile& header, int file, bool materials) {
  constexpr std::string_view kRank0 = "00";
  constexpr int kOther = 100;
  // A layer is Cryptomatte's if the header has an attribute "cryptomatte/KEY/name" for it, or by its own name.
  std::vector<std::string> declared;
  for (const auto& [key, value] : header.attributes)
    if (key.starts_with("cryptomatte/") && key.ends_with("/name")) declared.push_back(lowercase(value));
  std::optional<RoleChannels> best;
  int best_rank = kOther;
  for (const ChannelGroup& group : groups_of(header, file)) {
    const std::string& layer = group.layer.empty() ? group.part : group.layer;
    if (!group.is_color || !layer.ends_with(kRank0)) continue;
    const std::string name = lowercase(layer.substr(0, layer.size() - kRank0.size()));
    const bool is_declared = contains(declared, name);
    if (!is_declared && name.find("crypto") == std::string::npos) continue;
    if (header.channels[std::size_t(group.channels[0])].type != ChannelType::kFloat) continue;
    const int rank = rank_of(name, materials);
    if (rank >= best_rank) continue;
    best_rank = rank;
    best = RoleChannels{file, {group.channels[0]}, layer + " (Cryptomatte)"};
  }
  return best;
}

IdReader::IdReader(const RawRows& raw, Role role)
    : first_(raw.find(role, 0)), second_(raw.find(role, 1)), third_(raw.find(role, 2)) {}

std::uint32_t IdReader::at(int x, int row) const {
  if (!second_ || !third_) return std::bit_cast<std::uint32_t>(first_->at(x, row));
  const auto value = [&](const Plane& plane) {
    constexpr float kMaxShort = 65536.0f;
    const float v = plane.at(x, row);
    return v >= 0.0f && v < kMaxShort && v == float(int(v)) ? std::uint32_t(v) : std::bit_cast<std::uint32_t>(v);
  };
  const std::uint32_t r = value(*first_), g = value(*second_), b = value(*third_);
  constexpr std::uint32_t kByte = 256, kStart = 0x811c9dc5u, kFactor = 0x01000193u;  // of the hash FNV-1a
  if (r < kByte && g < kByte && b < kByte) return (r << 16) | (g << 8) | b;
  return (((kStart ^ r) * kFactor ^ g) * kFactor ^ b) * kFactor;
}

Result<IdTable> collect_ids(const RawPlanes& raw, Role role, bool zero_is_none) {
  IdTable table;
  table.zero_is_none = zero_is_none;
  std::vector<std::uint32_t>& ids = table.ids;
  std::size_t sorted_size = 0;
  const auto compact = [&] {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    sorted_size = ids.size();
  };
  for (int begin = 0; begin < raw.height(); begin += kBlockRows) {
    const Rows block{begin, std::min(begin + kBlockRows, raw.height())};
    const auto rows = raw.rows(block);
    if (!rows) return rows.error();
    const IdReader reader(*rows, role);
    for (int y = block.begin; y < block.end; ++y)
      for (int x = 0; x < raw.width(); ++x) {
        const std::uint32_t id = reader.at(x, y - rows->first);
        if (ids.size() > sorted_size && ids.back() == id) continue;
        ids.push_back(id);
      }
    compact();
    if (ids.size() > kMaxIds)
      return file_error("there are more than {} different ids, which are too many to distinguish", kMaxIds);
  }
  return table;
}

}  // namespace umbrage
