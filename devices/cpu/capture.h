// Capture on the CPU: traces a Scene with Embree, in packets of sixteen rays, into the planes of a G-buffer.
#pragma once

#include "core/device.h"
#include "core/image.h"
#include "devices/cpu/marked_pixels.h"
#include "devices/shared/capture_info.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// Captures the planes of core/gbuffer.h along the ray of each pixel centre, one set for each layer in `info`. The
/// layers of one camera are the surfaces along the ray in order, whether they face the camera or not. Two surfaces
/// count as one, and rounding decides which, if they are closer than 1e-5 of the sum of their distances from the camera
/// and from the centre of the scene. Reads only shadows, shadow_rays, sample, planes and strip of `settings`. Uses all
/// threads of the calling task arena; the result does not depend on their number. `monitor`: see Device::capture.
/// `scalar`: use the scalar form of the kernels. `marked`: capture only these pixels, without the shadows of
/// softened_lights; in blocks of kMarkedWidth x kMarkedHeight pixels with a marked one, the other pixels become
/// background. Errors: kInterrupted.
Result<Image> capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings,
                             const ProgressMonitor& monitor = {}, bool scalar = false,
                             const MarkedPixels* marked = nullptr);

}  // namespace umbrage
