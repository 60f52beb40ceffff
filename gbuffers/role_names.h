// The names that renderers give to layers.
#pragma once
#include <span>
#include <string_view>

#include "gbuffers/roles.h"

namespace umbrage {

using Names = std::span<const std::string_view>;

/// A name of depth layers, and what it says of their values.
struct DepthName {
  std::string_view name;
  DepthHint hint = DepthHint::kNone;
};

/// Returns the names of depth layers, the preferred first: exact depth before depth for a denoiser, planar before ray
/// distance.
std::span<const DepthName> depth_names();

/// Returns the names of layers with a role, the preferred first, in small letters without blanks, underscores and
/// hyphens.
Names names_of(Role role);

}  // namespace umbrage
