#include "gbuffers/role_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/lists.h"
#include "gbuffers/camera_guess.h"
#include "gbuffers/packing.h"

namespace umbrage {
namespace {

struct Finding {
  const GBufferSettings& settings;
  std::span<const LayeredFile> headers;
  const SampleRoles& sample_roles;
  Roles& roles;
  GBufferFacts& facts;

  const LayeredFile& header_of(const RoleChannels& channels) const { return headers[std::size_t(channels.file)]; }
  double max_integer(const RoleChannels& channels) const {
    return header_of(channels).channels[std::size_t(channels.channels[0])].max_integer;
  }
  bool is_integer(const RoleChannels& channels) const { return max_integer(channels) > 0.0; }
  /// Returns samples of channels that are given a role.
  Result<Samples> samples_of(Role role, const RoleChannels& channels) const {
    Roles trial;
    trial[role] = channels;
    trial[Role::kMask] = roles[Role::kMask];
    return sample_roles(trial);
  }
};

/// Returns whether three channels are equal but for a few pixels, such as those that a lossy file changed.
bool are_equal(const Samples& samples) {
  constexpr double kRounding = 1e-3, kFew = 0.01;  // relative difference; fraction of the pixels
  const auto [r, g, b] = samples.find_three(Role::kDepth);
  std::size_t differ = 0;
  for (const TapValues* other : {g, b})
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double x = (*r)[kCenter][k], y = (*other)[kCenter][k];
      differ += std::abs(x - y) > kRounding * std::max(std::abs(x), std::abs(y));
    }
  return double(differ) <= kFew * double(samples.size());
}

/// Returns which of three channels is the only one with different values; none if several are, or if a fourth one is
/// no coverage.
std::optional<std::size_t> only_varying(const Samples& samples, double max_integer) {
  const double one = max_integer > 0.0 ? max_integer : 1.0;
  if (const TapValues* alpha = samples.find(Role::kDepth, 3))
    for (const float v : (*alpha)[kCenter])
      if (!(v >= 0.0f && v <= one)) return std::nullopt;
  std::optional<std::size_t> only;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>& values = (*samples.find(Role::kDepth, c))[kCenter];
    if (std::all_of(values.begin(), values.end(), [&](float v) { return v == values.front(); })) continue;
    if (only) return std::nullopt;
    only = c;
  }
  return only;
}

/// Leaves one channel of the depth.
void take_channel(Finding& f, std::size_t channel) {
  RoleChannels& depth = f.roles[Role::kDepth];
  depth.channels = {depth.channels[channel]};
}

/// Turns a layer that was taken for depth, or that has no role, into positions if some camera projects them to their
/// pixels.
Result<bool> are_positions(const Finding& f, const RoleChannels& channels) {
  if (f.is_integer(channels)) return false;
  const auto samples = f.samples_of(Role::kPosition, channels);
  if (!samples) return samples.error();
  constexpr double kExact_px = 0.5;
  return position_camera(*samples, kExact_px).has_value();
}

void take_positions(Finding& f, const RoleChannels& channels) {
  f.roles[Role::kPosition] = channels;
  f.facts.lines.push_back(
      fmt::format("positions: {}, by their values: a camera projects them to their pixels", channels.name));
}

Error packed_error(const Finding& f, const std::vector<const Packing*>& packings) {
  std::vector<std::string> names;
  for (const Packing* packing : packings)
    names.push_back(fmt::format("{}{}", packing->name, packing->is_height ? " (elevation, `depth_kind` height)" : ""));
  const RoleChannels& depth = f.roles[Role::kDepth];
  return file_error("the channels of {} in '{}' are the bytes of one number: `depth_packing` {} reads them", depth.name,
                    f.header_of(depth).path.string(), fmt::join(names, " or "));
}

/// Leaves one channel of a depth in several. Errors: those of find_roles_by_values.
Result<void> find_depth_channel(Finding& f) {
  const RoleChannels depth = f.roles[Role::kDepth];
  if (f.settings.depth_packing != "none") {
    const Packing& packing = *find_packing(f.settings.depth_packing);
    if (depth.channels.size() < packing.channels())
      return field_error("depth_packing", f.settings.depth_packing, "`{}` {} needs {} channels: the layer {} has {}",
                         packing.channels(), depth.name, depth.channels.size());
    f.roles[Role::kDepth].channels.resize(packing.channels());
    if (packing.is_height && f.roles.depth_hint == DepthHint::kNone) f.roles.depth_hint = DepthHint::kHeight;
    return {};
  }
  if (depth.channels.size() < 3) return {};
  const auto samples = f.samples_of(Role::kDepth, depth);
  if (!samples) return samples.error();
  const auto only = only_varying(*samples, f.max_integer(depth));
  if (only)
    f.facts.lines.push_back(
        fmt::format("depth: channel {} of {}, the only one with different values", "RGB"[*only], depth.name));
  take_channel(f, only.value_or(0));
  if (only || are_equal(*samples)) return {};
  f.roles[Role::kDepth] = depth;
  if (const auto packings = recognised_packings(*samples); f.is_integer(depth) && !packings.empty())
    return packed_error(f, packings);
  const auto is_position = are_positions(f, depth);
  if (!is_position) return is_position.error();
  if (f.roles.depth_is_guess && *is_position) {
    f.roles[Role::kDepth] = {};
    f.roles.depth_is_guess = false;
    take_positions(f, depth);
    return {};
  }
  if (f.roles.depth_is_guess)
    return file_error(
        "'{}' has neither depth nor positions: its only layer is a colour picture, {}; `depth_file` names a file with "
        "depth, or one channel, as FILE:B; `depth_packing` says that the channels are the bytes of one number",
        f.header_of(depth).path.string(), depth.name);
  f.facts.warnings.push_back(
      fmt::format("the channels of the depth {} differ, and only the first is used: `depth_packing` rgb24 if they "
                  "are the bytes of one number",
                  depth.name));
  take_channel(f, 0);
  return {};
}

/// Returns whether vectors have the length 1, and several directions.
bool are_unit(const Samples& samples) {
  constexpr double kTolerance = 0.02, kNearlyAll = 0.9;  // averages at edges are shorter
  const auto [x, y, z] = samples.find_three(Role::kNormal);
  std::size_t all = 0, unit = 0, differ = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double length = std::hypot((*x)[kCenter][k], (*y)[kCenter][k], (*z)[kCenter][k]);
    if (length == 0.0 || !std::isfinite(length)) continue;
    ++all;
    unit += std::abs(length - 1.0) < kTolerance;
    differ += (*x)[kLeft][k] != (*x)[kRight][k] || (*y)[kAbove][k] != (*y)[kBelow][k];
  }
  return differ > 0 && double(unit) > kNearlyAll * double(all);
}

/// Gives roles to vectors whose names say nothing. Errors: kFile.
Result<void> find_vectors(Finding& f) {
  constexpr std::size_t kMaxTried = 32;  // each is read by itself
  if (f.roles.unknown.size() > kMaxTried)
    f.facts.warnings.push_back(fmt::format("of {} vectors with unknown names only the first {} are examined",
                                           f.roles.unknown.size(), kMaxTried));
  for (const ChannelGroup& group : std::span(f.roles.unknown).first(std::min(f.roles.unknown.size(), kMaxTried))) {
    const RoleChannels channels{group.file, {group.channels.begin(), group.channels.begin() + 3}, group.name};
    if (f.is_integer(channels)) continue;
    if (f.roles[Role::kNormal].empty()) {
      const auto samples = f.samples_of(Role::kNormal, channels);
      if (!samples) return samples.error();
      if (are_unit(*samples)) {
        f.roles[Role::kNormal] = channels;
        f.roles.normal_is_guess = true;
        continue;
      }
    }
    if (!f.roles[Role::kPosition].empty()) continue;
    const auto is_position = are_positions(f, channels);
    if (!is_position) return is_position.error();
    if (*is_position) take_positions(f, channels);
  }
  return {};
}

/// Takes the depth from the only channel of the picture that has different values, in a file without a depth.
Result<void> find_depth_in_beauty(Finding& f) {
  const RoleChannels beauty = f.roles[Role::kBeauty];
  if (!f.roles[Role::kDepth].empty() || !f.roles[Role::kPosition].empty() || beauty.channels.size() < 3) return {};
  const auto samples = f.samples_of(Role::kDepth, beauty);
  if (!samples) return samples.error();
  if (!only_varying(*samples, f.max_integer(beauty))) return {};
  f.roles[Role::kDepth] = beauty;
  f.roles[Role::kBeauty] = {};
  return {};
}

/// Takes another depth instead of one with values below and above 0, if there is one without. Errors: kFile.
Result<void> find_depth_of_one_sign(Finding& f) {
  const auto is_mixed = [&](const RoleChannels& channels) -> Result<bool> {
    constexpr double kSome = 0.01;  // fraction of the samples
    const auto samples = f.samples_of(Role::kDepth, channels);
    if (!samples) return samples.error();
    const std::vector<float>& v = (*samples->find(Role::kDepth, 0))[kCenter];
    const auto below = std::count_if(v.begin(), v.end(), [](float x) { return x < 0.0f; });
    const auto above = std::count_if(v.begin(), v.end(), [](float x) { return x > 0.0f; });
    return double(std::min(below, above)) > kSome * double(v.size());
  };
  RoleChannels& depth = f.roles[Role::kDepth];
  auto mixed = f.roles.other_depths.empty() ? Result<bool>(false) : is_mixed(depth);
  for (std::size_t k = 0; mixed && *mixed && k < f.roles.other_depths.size(); ++k) {
    auto& [other, hint] = f.roles.other_depths[k];
    mixed = is_mixed(other);
    if (!mixed || *mixed) continue;
    f.facts.warnings.push_back(fmt::format("the depth {} is below and above 0: {} is used", depth.name, other.name));
    std::swap(depth, other);
    std::swap(f.roles.depth_hint, hint);
  }
  return mixed ? Result<void>() : mixed.error();
}

/// Tells which arrays of an NPZ are not used, such as confidences, and which other depths.
void tell_unused(Finding& f) {
  std::vector<std::string> names;
  for (std::size_t file = 0; file < f.headers.size(); ++file) {
    if (f.headers[file].format != "NPZ") continue;
    for (const ChannelGroup& group : groups_of(f.headers[file], int(file)))
      if (std::none_of(f.roles.of.begin(), f.roles.of.end(), [&](const RoleChannels& role) {
            return !role.empty() && role.file_of(0) == int(file) && contains(role.channels, group.channels.front());
          }))
        names.push_back(group.name);
  }
  for (const auto& [other, hint] : f.roles.other_depths)
    if (const LayeredFile& header = f.header_of(other); header.format != "NPZ")
      names.push_back(fmt::format("{} (`depth_file` {}:{})", other.name, header.path.filename().string(),
                                  header.channels[std::size_t(other.channels[0])].full_name()));
  if (!names.empty()) f.facts.lines.push_back(fmt::format("not used: {}", fmt::join(names, ", ")));
}

}  // namespace

Result<void> find_roles_by_values(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                  const SampleRoles& sample_roles, Roles& roles, GBufferFacts& facts) {
  Finding f{settings, headers, sample_roles, roles, facts};
  if (auto found = find_vectors(f); !found) return found;
  if (auto found = find_depth_in_beauty(f); !found) return found;
  if (roles.depth_hint != DepthHint::kHeight && roles.depth_hint != DepthHint::kDisparity)
    if (auto found = find_depth_of_one_sign(f); !found) return found;
  if (!roles[Role::kDepth].empty())
    if (auto found = find_depth_channel(f); !found) return found;
  tell_unused(f);
  return {};
}

}  // namespace umbrage
