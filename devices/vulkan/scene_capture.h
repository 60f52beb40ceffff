// Captures a scene on a GPU: visible surfaces by rasterisation or rays, shadows by rays, which are then softened for
// lights that have a size. Traces the rays of dispatches in the captured scene.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/effect.h"
#include "devices/shared/dispatches.h"
#include "devices/vulkan/device_scene.h"
#include "devices/vulkan/dispatch.h"
#include "devices/vulkan/frame_planes.h"
#include "rays/traced_scene.h"
#include "scene/occluders.h"

namespace umbrage {

/// The radii of one light's penumbra along rows and along columns, pixels, with one value per block of 4 x 4 pixels.
struct PenumbraPlanes {
  int light = 0;
  DevicePlanePtr across, down;
};

/// The parts of a device that a capture uses.
struct CaptureParts {
  GpuPtr gpu;
  Memory* memory;
  Commands* commands;
  Pipelines* pipelines;
  PlaneStore* store;
  Dispatcher* dispatcher;
};

class SceneCapture {
 public:
  /// `draws`: draw triangles if possible; otherwise rays find the visible surfaces.
  SceneCapture(const CaptureParts& parts, int threads, bool draws)
      : gpu_(parts.gpu),
        memory_(parts.memory),
        commands_(parts.commands),
        pipelines_(parts.pipelines),
        store_(parts.store),
        dispatcher_(parts.dispatcher),
        threads_(threads),
        draws_(draws) {}

  /// Prepares a scene. Errors: kDevice; kInterrupted, after which nothing is prepared.
  Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor);

  /// Captures the prepared scene with capture.comp. Calls the monitor only while it builds a hierarchy on the host for
  /// extra views.
  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings, const ProgressMonitor& monitor);

  /// Forgets the prepared scene. Frames that were captured keep it.
  void release_scene() { scene_.reset(); }

  /// Returns the prepared scene, or null.
  std::shared_ptr<const DeviceScene> scene() const { return scene_; }

  /// Traces ray number run.round of each pixel in the scene of these planes, and adds it to the outputs of the
  /// dispatch: see Dispatch::rays. `rays`: the planes `ray.x`, `ray.y` and `ray.z`.
  Result<void> trace_rays(const DispatchRun& run, const RaySettings& settings, const DevicePlanes& planes,
                          const StepPlanes& rays);

  /// Releases memory that is not needed between captures, and waits until the device no longer uses it.
  Result<void> release_memory();

 private:
  Result<void> draw_layer(const Frame& frame, const std::vector<std::string>& names, const CaptureSettings& settings,
                          int layer, int back, std::span<const PenumbraPlanes> radii);

  /// Draws all triangles to find the one that is visible in each pixel of a layer. Returns null if there is too little
  /// memory for the render target; rays then find the triangles.
  Result<DevicePlanePtr> draw_triangle_indices(const PictureInfo& info, int layer, const DevicePlanes& planes,
                                               Dispatcher::Constants constants, Dispatcher::Table table);

  /// Softens the shadows of lights that have a size: see devices/shared/capture_info.h.
  Result<void> soften(const Frame& frame, std::span<const PenumbraPlanes> radii);

  GpuPtr gpu_;
  Memory* memory_;
  Commands* commands_;
  Pipelines* pipelines_;
  PlaneStore* store_;
  Dispatcher* dispatcher_;
  int threads_;
  bool draws_;
  RasterTargetPtr target_;                    // has the size of the last picture
  std::shared_ptr<const DeviceScene> scene_;  // null: none is prepared
  MadeOccluders occluders_;
  std::size_t scene_count_ = 0;  // number of scenes prepared so far
  TracedScenePtr traced_;        // null until extra views are requested
};

}  // namespace umbrage
