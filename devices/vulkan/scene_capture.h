// Captures a scene on a GPU: what a pixel sees by rasterisation or rays, shadows by rays, softened where lights have a
// size.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/device_scene.h"
#include "devices/vulkan/dispatch.h"
#include "devices/vulkan/frame_planes.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// The radius of one light's penumbrae along a row and along a column, in pixels, by block of 4 x 4 pixels.
struct PenumbraPlanes {
  int light = 0;
  DevicePlanePtr across, down;
};

/// Of a device: what it draws with.
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
  /// `draws`: triangles, where it can; otherwise rays find what is seen.
  SceneCapture(const CaptureParts& parts, int threads, bool draws)
      : gpu_(parts.gpu),
        memory_(parts.memory),
        commands_(parts.commands),
        pipelines_(parts.pipelines),
        store_(parts.store),
        dispatcher_(parts.dispatcher),
        threads_(threads),
        draws_(draws) {}

  /// Errors: kDevice; kInterrupted, after which nothing is prepared.
  Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor);

  /// Draws the prepared scene with capture.comp. The monitor is asked while a hierarchy is built on the host for it.
  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings, const ProgressMonitor& monitor);

  /// Gives back the memory that is not needed between captures, and waits for what uses it.
  Result<void> spare();

 private:
  Result<void> draw_layer(const Frame& frame, const std::vector<std::string>& names, const CaptureSettings& settings,
                          int layer, int back, std::span<const PenumbraPlanes> radii);

  /// Which triangle each pixel of a layer sees, by drawing them all. Null where there is no memory to draw into: rays
  /// need none.
  Result<DevicePlanePtr> draw_seen(const PictureInfo& info, int layer, const DevicePlanes& planes,
                                   Dispatcher::Constants constants, Dispatcher::Table table);

  /// Softens the shadows of lights that have a size: see devices/shared/soften_passes.h.
  Result<void> soften(const Frame& frame, std::span<const PenumbraPlanes> radii);

  GpuPtr gpu_;
  Memory* memory_;
  Commands* commands_;
  Pipelines* pipelines_;
  PlaneStore* store_;
  Dispatcher* dispatcher_;
  int threads_;
  bool draws_;
  RasterTargetPtr target_;  // of the last picture's size
  DeviceScene scene_;
  std::size_t scenes_ = 0;  // prepared so far
  TracedScenePtr traced_;   // only where somebody wanted further cameras
};

}  // namespace umbrage
