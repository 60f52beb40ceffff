// Capture on the CPU: a Scene drawn into the planes of a G-buffer by Embree, sixteen rays at a time.
#pragma once
#include "core/device.h"
#include "core/image.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// What shading needs to know of a scene seen by a camera: lights in view space, depths. The camera sees the picture
/// without its guard band.
PictureInfo picture_info(const Scene& scene, const Camera& camera, const CaptureSettings& settings);

/// The planes of core/gbuffer.h for the nearest surfaces along each pixel centre's ray, one set per layer: the n-th
/// surface that the ray meets, fronts and backs alike. Surfaces nearer to each other than a hundred-thousandth of their
/// distances from the eye and from the scene's middle, added up, are one; which of them it is, rounding decides. Uses
/// all threads of the calling task arena; the result does not depend on their number.
Image capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings);

}  // namespace umbrage
