// Constants of capture.comp, of trace_rays.comp, and of the shaders that draw triangles.
#pragma once
#include "core/device.h"
#include "core/ray_settings.h"
#include "devices/vulkan/capture.h"
#include "devices/vulkan/device_scene.h"

namespace umbrage {

/// Returns the constants of a layer of the picture. `back`: also capture the back sides of its surfaces.
CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back);

/// Returns the constants for ray number `ray` of each pixel of a picture of the scene. Does not read the host's scene.
CaptureConstants ray_constants(const DeviceScene& scene, const PictureInfo& info, const RaySettings& settings, int ray,
                               int stride);

/// Returns whether the triangles of this layer can be rasterised, which replaces primary rays.
bool can_draw(const DeviceScene& scene, const CaptureConstants& constants, const Gpu& gpu);

/// Returns the index of a captured plane in the table of addresses.
int capture_slot(std::string_view plane);

}  // namespace umbrage
