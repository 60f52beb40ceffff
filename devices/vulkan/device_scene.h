// A scene on a Vulkan device: its hierarchy, vertices, materials and textures, uploaded once.
#pragma once
#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "core/progress.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/memory.h"
#include "scene/scene.h"

namespace umbrage {

struct DeviceScene {
  const Scene* scene = nullptr;  ///< must live until the last capture
  std::size_t number = 0;        ///< distinguishes the scenes of a device
  glm::vec3 center{0.0f};        ///< see TracedScene
  float scale = 1.0f;
  int root = 0;  ///< see Hierarchy
  bool empty = false;
  bool points = false;  ///< has discs or spheres
  bool masks = false;   ///< has alpha masks
  int triangles = 0;    ///< number of triangles and points
  /// The buffers of the scene, in the order of the table of addresses, starting with kNodesSlot.
  std::vector<DevicePlanePtr> buffers;
};

/// Uploads a scene. Errors: kDevice; kInterrupted.
Result<DeviceScene> upload_scene(const Scene& scene, Memory& memory, Commands& commands, const Gpu& gpu,
                                 const ProgressMonitor& monitor = {});

}  // namespace umbrage
