// Warnings about settings of a depth that do nothing.
#pragma once
#include <string>
#include <vector>

#include "gbuffers/conventions.h"
#include "gbuffers/settings.h"

namespace umbrage {

/// Returns a sentence for each setting of the depth that the conventions do not use.
std::vector<std::string> unused_settings(const GBufferSettings& settings, const DepthConvention& depth);

}  // namespace umbrage
