// What a capture is, on every device: what shading needs to know of it, and which planes it has.
#pragma once
#include <string>
#include <vector>

#include "core/device.h"
#include "rays/traced_scene.h"
#include "scene/scene.h"

namespace umbrage {

/// What shading needs to know of a scene seen by a camera: lights in view space, depths. The camera sees the picture
/// without its guard band.
PictureInfo picture_info(const Scene& scene, const Camera& camera, const CaptureSettings& settings);

/// Says in `info` which layers a capture with these settings has: see CaptureSettings.
void add_layers(const TracedScene& traced, const CaptureSettings& settings, PictureInfo& info);

/// The planes of a layer. That of the key light's shadow is always there.
std::vector<std::string> captured_planes(const Scene& scene, const PictureInfo& info, const CaptureSettings& settings);

/// The lights that have a size: their shadows, of the first layer, are softened where a capture has shadow rays.
std::vector<int> softened_lights(const PictureInfo& info, const CaptureSettings& settings);

}  // namespace umbrage
