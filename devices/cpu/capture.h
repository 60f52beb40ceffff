// Capture on the CPU: a Scene drawn into the planes of a G-buffer by Embree, sixteen rays at a time.
#pragma once
#include <memory>

#include "core/device.h"
#include "core/image.h"
#include "scene/scene.h"

namespace umbrage {

/// A scene made ready for rays: Embree's hierarchy and filtered textures.
struct TracedScene;
struct FreeTracedScene {
  void operator()(TracedScene* scene) const;
};
using TracedScenePtr = std::unique_ptr<TracedScene, FreeTracedScene>;

/// Builds the hierarchy. The scene must outlive the result. Errors: kDevice where Embree cannot (out of memory).
Result<TracedScenePtr> trace_ready(const Scene& scene);

/// What shading needs to know of a scene seen by a camera: lights in view space, depths.
PictureInfo picture_info(const Scene& scene, const Camera& camera, int width, int height);

/// The planes of core/gbuffer.h for the nearest surface along each pixel centre's ray. Uses all threads of the calling
/// task arena; the result does not depend on their number.
Image capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings);

}  // namespace umbrage
