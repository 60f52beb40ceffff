// Capture on the CPU: a Scene drawn into the planes of a G-buffer by Embree, sixteen rays at a time.
#pragma once

#include "core/device.h"
#include "core/image.h"
#include "devices/shared/capture_info.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// The planes of core/gbuffer.h for each pixel centre's ray, one set per layer that `info` names: first the surfaces
/// that the ray meets, one behind the other, fronts and backs alike. Surfaces nearer to each other than a hundred-
/// thousandth of their distances from the eye and from the scene's middle, added up, are one; which of them it is,
/// rounding decides. Of the settings only those of shadows and of a band count. Uses all threads of the calling task
/// arena; the result does not depend on their number. `monitor`: see Device::capture. `scalar`: kernels run in their
/// plain form. Errors: kInterrupted.
Result<Image> capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings,
                             const ProgressMonitor& monitor = {}, bool scalar = false);

}  // namespace umbrage
