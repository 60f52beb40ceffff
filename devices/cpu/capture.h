// Capture on the CPU: traces a Scene with Embree, in packets of sixteen rays, into the planes of a G-buffer.
#pragma once
#include "core/device.h"
#include "core/image.h"
#include "devices/shared/capture_info.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// The block of pixels that the CPU computes if a mask has one of them: dispatches work in lanes of up to 16 pixels,
/// and the capture in packets of 4 x 4 rays. Blocks start at multiples of their size in the picture, also in strips.
inline constexpr int kMaskWidth = 16, kMaskHeight = 4;

/// Captures the planes of core/gbuffer.h along the ray of each pixel centre, one set for each layer in `info`. The
/// layers of one camera are the surfaces along the ray in order, whether they face the camera or not. Two surfaces
/// count as one, and rounding decides which, if they are closer than 1e-5 of the sum of their distances from the camera
/// and from the centre of the scene. Reads only shadows, shadow_rays, soft_shadows, sample, planes, mask and strip of
/// `settings`. In blocks of kMaskWidth x kMaskHeight pixels with one of the mask, the other pixels become background.
/// Uses all threads of the calling task arena; the result does not depend on their number. `monitor`: see
/// Device::capture. `scalar`: use the scalar form of the kernels. Errors: kInterrupted.
Result<Image> capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings,
                             const ProgressMonitor& monitor = {}, bool scalar = false);

}  // namespace umbrage
