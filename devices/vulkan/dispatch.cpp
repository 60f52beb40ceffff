#include "devices/vulkan/dispatch.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr int kMinTrianglesPerSubmission = 1024;
/// Size of the table of plane addresses, bytes; on every device a multiple of the alignment of constants.
constexpr std::size_t kTableBytes = kMaxPlanes * sizeof(VkDeviceAddress);

}  // namespace

std::vector<std::byte> block_of(const FrameConstants& frame, std::span<const std::byte> constants) {
  std::vector<std::byte> block(sizeof frame + constants.size());
  std::memcpy(block.data(), &frame, sizeof frame);
  std::copy(constants.begin(), constants.end(), block.begin() + sizeof frame);
  return block;
}

Result<void> Dispatcher::run_kernel(const GpuStep& step, GpuWork work, const PictureInfo& info, Constants block,
                                    VkDeviceSize bytes, std::span<const DevicePlane* const> planes) {
  const VkDeviceSize max = gpu_->properties.limits.maxStorageBufferRange;
  const auto pipeline = pipelines_->kernel(step, block, bytes <= max);
  if (!pipeline) return pipeline.error();
  std::vector<VkDeviceAddress> table;
  for (const DevicePlane* plane : planes) table.push_back(plane ? plane->address : 0);
  // All bindings must be set, even those that no shader reads: in place of a missing plane another one is bound, and of
  // a plane that is too large only the beginning.
  const auto any = std::find_if(planes.begin(), planes.end(), [](auto* plane) { return plane != nullptr; });
  if (any == planes.end()) fail_check(fmt::format("kernel {} has no planes", step.name));
  std::array<VkDescriptorBufferInfo, kBoundPlanes> bound;
  for (std::size_t k = 0; k < bound.size(); ++k) {
    const DevicePlane* plane = k < planes.size() && planes[k] ? planes[k] : *any;
    bound[k] = {plane->buffer, plane->offset, std::min(bytes, max)};
  }
  work.pipeline = *pipeline;
  work.group_width = step.group_width;
  work.group_height = step.group_height;
  work.bound = bound;
  return dispatch(work, info, block, table);
}

Result<void> Dispatcher::dispatch(const GpuWork& work, const PictureInfo& info, Constants constants, Table table) {
  const int columns = work.target ? 1 : groups_of(info.width, work.group_width);
  const int rows =
      work.target ? groups_of(work.triangles, kMinTrianglesPerSubmission) : groups_of(info.height, work.group_height);
  if (!(max_submission_ms_ > 0.0) || !commands_->measures_times())
    return record_rows(work, columns, 0, rows, false, constants, table);
  const Commands::Kind kind{work.pipeline, work.settings};
  const int first_rows = std::max(first_groups_ / columns, 1);
  int begin = 0, end = 0;  // rows that are done
  if (!commands_->ms_per_group(kind)) {
    if (rows <= first_rows) return record_rows(work, columns, 0, rows, false, constants, table);
    // Triangles must be drawn in order: of coincident ones the first is visible.
    begin = work.target ? 0 : (rows - first_rows) / 2;
    end = begin + first_rows;
    if (auto status = record_rows(work, columns, begin, end, false, constants, table); !status) return status;
    if (auto status = commands_->finish(); !status) return status;
  }
  const bool continues = end > begin;
  if (auto status = record_strips(work, columns, 0, begin, continues, constants, table); !status) return status;
  return record_strips(work, columns, end, rows, continues, constants, table);
}

Result<void> Dispatcher::record_strips(const GpuWork& work, int columns, int row, int end, bool continues,
                                       Constants constants, Table table) {
  while (row < end) {
    const double ms_per_row =
        std::max(columns * commands_->ms_per_group({work.pipeline, work.settings}).value_or(0.0), 1e-9);
    const double left_ms = max_submission_ms_ - commands_->recorded_ms();
    if (left_ms < ms_per_row && commands_->recorded_ms() > 0.0) {
      if (auto status = commands_->finish(); !status) return status;
      continue;
    }
    const int strip = int(std::clamp(left_ms / ms_per_row, 1.0, double(end - row)));
    if (auto status = record_rows(work, columns, row, row + strip, continues, constants, table); !status) return status;
    row += strip;
    continues = true;
  }
  return {};
}

Result<void> Dispatcher::record_rows(const GpuWork& work, int columns, int row, int end, bool continues,
                                     Constants constants, Table table) {
  const auto drawing = work.target ? pipelines_->drawing(row == 0) : VkRenderPass(VK_NULL_HANDLE);
  if (!drawing) return drawing.error();
  const auto uniforms = commands_->uniforms(kTableBytes + constants.size());
  if (!uniforms) return uniforms.error();
  VkDescriptorSet sets[] = {pipelines_->constants(), VK_NULL_HANDLE};
  if (!work.bound.empty()) {
    const auto bound = commands_->descriptor_set(pipelines_->bound_layout(), work.bound);
    if (!bound) return bound.error();
    sets[1] = *bound;
  }
  const auto buffer = commands_->buffer();
  if (!buffer) return buffer.error();
  // The table comes first: its size is the same for all shaders, so the constants are as aligned as the table.
  std::memcpy(uniforms->bytes, table.data(), table.size_bytes());
  std::memcpy(uniforms->bytes + kTableBytes, constants.data(), constants.size());
  // This precedes the barrier because lavapipe measures the end of a draw at the next barrier.
  commands_->begin_dispatch(work.effect, work.dispatch, {work.pipeline, work.settings}, double(columns) * (end - row),
                            continues);
  commands_->barrier();
  const VkPipelineBindPoint point = work.target ? VK_PIPELINE_BIND_POINT_GRAPHICS : VK_PIPELINE_BIND_POINT_COMPUTE;
  gpu_->vk.CmdBindPipeline(*buffer, point, work.pipeline);
  const std::uint32_t offsets[] = {uniforms->offset + std::uint32_t(kTableBytes), uniforms->offset};
  gpu_->vk.CmdBindDescriptorSets(*buffer, point, pipelines_->kernel_layout(), 0, sets[1] ? 2 : 1, sets, 2, offsets);
  if (work.target) {
    const int first = row * kMinTrianglesPerSubmission,
              last = std::min(end * kMinTrianglesPerSubmission, work.triangles);
    begin_drawing(*gpu_, *buffer, *work.target, *drawing, row == 0);
    const std::uint32_t corners = work.points ? 6 : 3;  // vertices of each triangle or point: see corner.vert
    gpu_->vk.CmdDraw(*buffer, std::uint32_t(last - first) * corners, 1, std::uint32_t(first) * corners, 0);
    end_drawing(*gpu_, *buffer);
  } else {
    gpu_->vk.CmdDispatchBase(*buffer, 0, std::uint32_t(row), 0, std::uint32_t(columns), std::uint32_t(end - row), 1);
  }
  commands_->end_dispatch();
  return {};
}

}  // namespace umbrage
