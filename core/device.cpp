#include "core/device.h"

namespace umbrage {

Result<int> layer_count(const CaptureSettings& settings) {
  const int sides = settings.back_sides ? 2 : 1;
  const int count = settings.layers * sides + settings.extra_views;
  const bool mixed = settings.back_sides || settings.extra_views > 0;
  if (mixed && count > kMaxMixedLayers)
    return usage_error("{}{}{} are {} layers; at most {} can be captured",
                       settings.layers == 1 ? "one layer" : fmt::format("{} layers", settings.layers),
                       settings.back_sides ? " with back sides" : "",
                       settings.extra_views == 0   ? ""
                       : settings.extra_views == 1 ? " and 1 extra view"
                                                   : fmt::format(" and {} extra views", settings.extra_views),
                       count, kMaxMixedLayers);
  return count;
}

}  // namespace umbrage
