// Capture on the CPU: traces a Scene with Embree, in packets of sixteen rays, into the planes of a G-buffer.
#pragma once
#include "core/device.h"
#include "core/image.h"
#include "devices/shared/capture_info.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// The block of pixels that the CPU computes if one of them is marked: dispatches work in lanes of up to 16 pixels, and
/// the capture in packets of 4 x 4 rays. Blocks start at multiples of their size in the picture, also in strips.
inline constexpr int kMarkedWidth = 16, kMarkedHeight = 4;

/// The pixels where a plane is 1.
struct MarkedPixels {
  const Plane& marks;
  int first_row = 0;  ///< row of the picture that is the plane's row 0

  bool at(int x, int y) const { return marks.row(y - first_row)[x] > 0.0f; }
  /// Returns whether a pixel of [x0, x1) x [y0, y1) is marked.
  bool any(int x0, int x1, int y0, int y1) const {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        if (at(x, y)) return true;
    return false;
  }
};

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
