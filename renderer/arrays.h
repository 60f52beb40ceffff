// Arrays of floats that another program has drawn become a G-buffer.
#pragma once
#include "core/gbuffer.h"
#include "core/result.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// The channels' letters of a pass: ".x", ".y" and ".z" for `normal`, one empty text for `depth`; nothing for a name
/// that no effect reads or makes.
std::vector<std::string> channels_of(std::string_view pass);

/// The request's arrays in our conventions. Errors: kUsage.
Result<GBuffer> gbuffer_of(const ShadeRequest& request);

}  // namespace umbrage
