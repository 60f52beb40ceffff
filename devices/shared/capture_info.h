// The picture information and the planes of a capture, for all devices.
#pragma once
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/shared/soften.h"
#include "rays/traced_scene.h"
#include "scene/scene.h"

namespace umbrage {

/// Returns the picture information of a capture: lights and ground in view space, the range of depths, the guard band.
/// `camera` is that of the picture without its guard band.
PictureInfo picture_info(const Scene& scene, const Camera& camera, const CaptureSettings& settings);

/// Adds the layers of a capture with these settings to `info`: see CaptureSettings.
void add_layers(const TracedScene& traced, const CaptureSettings& settings, PictureInfo& info);

/// Returns the names of the planes of a layer. The shadow of the key light is always among them.
std::vector<std::string> captured_planes(const Scene& scene, const PictureInfo& info, const CaptureSettings& settings);

/// Returns the lights whose shadows in the first layer are softened: if the capture has shadow rays, those that have a
/// size.
std::vector<int> softened_lights(const PictureInfo& info, const CaptureSettings& settings);

/// The number of pixels in each direction from a pixel on which its softened shadow depends: the second filter reads
/// kSoftenReachBlocks - 1 blocks, and its width there depends on penumbrae up to kSoftenReachBlocks blocks farther
/// away.
inline constexpr int kSoftenMargin = (2 * kSoftenReachBlocks - 1) * kSoftenBlock;

}  // namespace umbrage
