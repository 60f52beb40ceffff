// The picture information and the planes of a capture, and the dispatches that soften its shadows, for all devices.
#pragma once
#include <string>
#include <vector>

#include "core/device.h"
#include "core/effect.h"
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

/// Returns the dispatch that computes `soften_reach`, half the width of the second filter, from `penumbra`, the radius
/// of the penumbra, both in pixels and with one value per block of 4 x 4 pixels. It runs over the blocks as if they
/// were pixels.
const Dispatch& soften_reach_dispatch();

/// Returns the dispatch that filters along rows or columns, from `soften_from` to `soften_to`.
const Dispatch& soften_dispatch();

}  // namespace umbrage
