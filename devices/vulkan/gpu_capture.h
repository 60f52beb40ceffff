// Constants of capture.comp and of the drawing of triangles.
#pragma once
#include "core/device.h"
#include "devices/vulkan/capture.h"
#include "devices/vulkan/device_scene.h"

namespace umbrage {

/// Returns the constants of a layer of the picture. `back`: capture its other sides too.
CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back);

/// Returns whether triangles can be drawn for this layer, so that no primary rays are needed.
bool can_draw(const DeviceScene& scene, const CaptureConstants& constants, const Gpu& gpu);

/// Returns the index of a captured plane's address in the table.
int capture_slot(std::string_view plane);

}  // namespace umbrage
