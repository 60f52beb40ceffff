#include "core/device.h"

#include "core/check.h"

namespace umbrage {

Result<Frame> Device::upload_strip(GBuffer, const Strip&) { fail_check("a device that draws no strips"); }

Result<Frame> Device::capture_marked(const Camera& camera, const CaptureSettings& settings, const Frame& first,
                                     const ProgressMonitor& monitor) {
  auto frame = capture(camera, settings, monitor);
  if (!frame) return frame;
  if (auto added = add_first(first, {"marks"}, *frame); !added) return added.error();
  return frame;
}

Result<void> Device::add_first(const Frame& first, const std::vector<std::string>& names, Frame& frame) {
  Frame whole = first;
  whole.info.guard = 0;  // so that download returns the guard band, too
  auto planes = download(whole, names);
  if (!planes) return planes.error();
  for (std::string& name : planes->names) name = first_plane(name);
  return add(*planes, frame);
}

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
