// Roles by values, where names leave them open: the channel of a colour that is the depth, bytes of one number,
// positions and normals in layers whose names say nothing.
#pragma once
#include <functional>
#include <span>

#include "gbuffers/gbuffer_file.h"
#include "gbuffers/roles.h"
#include "gbuffers/samples.h"

namespace umbrage {

/// Returns samples of all channels that have roles. Errors: kFile.
using SampleRoles = std::function<Result<Samples>(const Roles&)>;

/// Completes roles, so that depth has one channel unless it is packed, and adds facts and warnings. Errors: kFile; also
/// for a picture of light, or of packed bytes, that was taken for depth, naming the option that would read it; kUsage
/// for a packing that needs more channels.
Result<void> find_roles_by_values(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                  const SampleRoles& sample_roles, Roles& roles, GBufferFacts& facts);

}  // namespace umbrage
