// The ICC profile of sRGB, for picture formats that state their colour space by a profile.
#pragma once
#include <cstdint>
#include <vector>

namespace umbrage {

/// Returns an ICC profile, version 4.3 (ICC.1:2010), of sRGB (IEC 61966-2-1): primaries adapted to D50, and the
/// transfer function as a parametric curve of type 3.
const std::vector<std::uint8_t>& srgb_profile();

}  // namespace umbrage
