// Records shader runs over all pixels, split into row ranges if one submission would take too long.
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

/// A shader to run over all pixels; its time is reported under these names.
struct GpuWork {
  VkPipeline pipeline = VK_NULL_HANDLE;
  std::string_view effect, dispatch;
  std::size_t settings = 0;                         // see Commands::Kind
  int group_width = kGroup, group_height = kGroup;  // pixels per workgroup
  // Not null: draws the triangles and points of a scene into it, instead of a dispatch.
  const RasterTarget* target = nullptr;
  int triangles = 0;                                   // number in the scene, points included
  bool points = false;                                 // whether the scene has points
  std::span<const VkDescriptorBufferInfo> bound = {};  // kBoundPlanes buffers, for kernels that use kernel/glsl.h
};
/// The temporary planes of GpuSteps, by name.
using StepPlanes = std::map<std::string_view, DevicePlanePtr>;

/// Returns the number of workgroups that cover this many pixels.
inline int groups_of(int pixels, int group) { return (pixels + group - 1) / group; }

/// Returns the block of constants that a kernel reads.
std::vector<std::byte> block_of(const FrameConstants& frame, std::span<const std::byte> constants);

/// Records shader runs.
class Dispatcher {
 public:
  /// `max_submission_ms`: max time of a submission; 0: unlimited. A shader with unknown time first runs on
  /// `first_groups` workgroups.
  Dispatcher(const Gpu& gpu, Commands& commands, Pipelines& pipelines, double max_submission_ms, int first_groups)
      : gpu_(&gpu),
        commands_(&commands),
        pipelines_(&pipelines),
        max_submission_ms_(max_submission_ms),
        first_groups_(first_groups) {}

  using Constants = std::span<const std::byte>;
  using Table = std::span<const VkDeviceAddress>;

  /// Records a kernel on planes of `bytes` bytes each, in the order of plane_table. Null: a layer that does not exist,
  /// which is neither read nor written.
  Result<void> run_kernel(const GpuStep& step, GpuWork work, const PictureInfo& info, Constants block,
                          VkDeviceSize bytes, std::span<const DevicePlane* const> planes);

  /// Records a shader over all pixels that reads constants and a table of addresses. A dispatch that may take too long
  /// for one submission is split into row ranges; one of unknown time first runs on a few rows in the middle, where
  /// there is likely to be more than background.
  Result<void> dispatch(const GpuWork& work, const PictureInfo& info, Constants constants, Table table);

 private:
  /// Records rows of workgroups whose time is known; submits whenever the recorded work takes too long.
  Result<void> record_strips(const GpuWork& work, int columns, int row, int end, bool continues, Constants constants,
                             Table table);

  Result<void> record_rows(const GpuWork& work, int columns, int row, int end, bool continues, Constants constants,
                           Table table);

  const Gpu* gpu_;
  Commands* commands_;
  Pipelines* pipelines_;
  double max_submission_ms_;
  int first_groups_;
};

}  // namespace umbrage
