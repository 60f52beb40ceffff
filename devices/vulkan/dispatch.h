// How shaders are noted down: over all pixels, in bands where one submission would take too long.
#pragma once
#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "core/effect.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/pipelines.h"
#include "devices/vulkan/raster.h"
#include "kernel/frame_constants.h"

namespace umbrage {

inline constexpr int kGroup = 8;  // pixels of a workgroup, across and down: kernel/glsl.h

/// A shader that is to run over all pixels, and whose time is taken under these names.
struct GpuWork {
  VkPipeline pipeline = VK_NULL_HANDLE;
  std::string_view effect, pass;
  std::size_t settings = 0;                         // see Commands::Kind
  int group_width = kGroup, group_height = kGroup;  // pixels that a workgroup computes
  const RasterTarget* target = nullptr;             // not null: a scene's triangles and points are drawn, some at once
  int triangles = 0;                                // of such a scene, points among them
  bool points = false;                              // whether it has any
  std::span<const VkDescriptorBufferInfo> bound = {};  // of a kernel of kernel/glsl.h: kBoundPlanes of them
};
/// Planes that steps know besides those of a frame.
using StepPlanes = std::map<std::string_view, DevicePlanePtr>;

/// Workgroups that so many pixels take.
inline int groups_of(int pixels, int group) { return (pixels + group - 1) / group; }

/// What a kernel reads besides planes.
std::vector<std::byte> block_of(const FrameConstants& frame, std::span<const std::byte> constants);

/// Notes shaders down.
class Dispatcher {
 public:
  /// Submissions are to take no longer than `longest_ms`; 0: as long as they take. What is new begins with so many
  /// workgroups.
  Dispatcher(const Gpu& gpu, Commands& commands, Pipelines& pipelines, double longest_ms, int first_groups)
      : gpu_(&gpu),
        commands_(&commands),
        pipelines_(&pipelines),
        longest_ms_(longest_ms),
        first_groups_(first_groups) {}

  using Constants = std::span<const std::byte>;
  using Table = std::span<const VkDeviceAddress>;

  /// Notes down a kernel on planes of so many bytes in the order of plane_table. Null: a layer that is not there, which
  /// nobody reads or stores to.
  Result<void> run_kernel(const GpuStep& step, GpuWork work, const PictureInfo& info, Constants block,
                          VkDeviceSize bytes, std::span<const DevicePlane* const> planes);

  /// Notes down a shader over all pixels that reads constants and a table of addresses. What
  /// may take too long for one submission is done in bands; of what is new first a few rows in the middle, where
  /// there is likely to be more than background.
  Result<void> dispatch(const GpuWork& work, const PictureInfo& info, Constants constants, Table table);

 private:
  /// Rows of workgroups whose time is known, handed over wherever they become too many.
  Result<void> note_bands(const GpuWork& work, int columns, int row, int end, bool further, Constants constants,
                          Table table);

  Result<void> note_rows(const GpuWork& work, int columns, int row, int end, bool further, Constants constants,
                         Table table);

  const Gpu* gpu_;
  Commands* commands_;
  Pipelines* pipelines_;
  double longest_ms_;
  int first_groups_;
};

}  // namespace umbrage
