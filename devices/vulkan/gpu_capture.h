// What capture.comp and what draws triangles for it are told of a picture.
#pragma once
#include "core/device.h"
#include "devices/vulkan/capture.h"
#include "devices/vulkan/device_scene.h"

namespace umbrage {

/// Of a layer of the picture. `back`: its other sides are drawn too.
CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back);

/// Whether triangles can be drawn for this layer, so that no ray is needed to find what is seen.
bool can_draw(const DeviceScene& scene, const CaptureConstants& constants, const Gpu& gpu);

/// Where a captured plane's address stands in the table.
int capture_slot(std::string_view plane);

}  // namespace umbrage
