// Arrays of floats that another program has drawn become a G-buffer.
#pragma once
#include "core/gbuffer.h"
#include "core/result.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// The request's arrays in our conventions. Errors: kUsage.
Result<GBuffer> gbuffer_of(const ShadeRequest& request);

}  // namespace umbrage
