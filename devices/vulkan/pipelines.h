// Pipelines compiled by the driver, the file that keeps them, the planes that a compiled kernel accesses (see
// kernel/glsl.h), and the bindings of constants and planes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/effect.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/options.h"

namespace umbrage {

/// Returns the path umbrage/NAME in $XDG_CACHE_HOME or ~/.cache; empty if there is no such folder.
std::filesystem::path pipeline_file(const std::string& name);

/// Returns the data of write_pipelines; empty if there is none or the file is damaged.
std::vector<std::byte> read_pipelines(const std::filesystem::path& file);

/// Writes a temporary file, then renames it. Ignores errors: the next run compiles again.
void write_pipelines(const std::filesystem::path& file, const std::vector<std::byte>& data);

/// A specialization constant that gives the index of a plane in the table of planes.
struct Slot {
  std::string plane;  ///< with _ in place of dots: normal_x
  std::uint32_t constant = 0;
};

/// Returns all slots of a shader, in the order in which it declares them.
std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv);

/// Returns the name of a plane in the form of Slot::plane.
std::string slot_name(std::string_view plane);

/// Push constants of pick.comp.
struct PickConstants {
  VkDeviceAddress from = 0, to = 0;
  int from_width = 0, from_height = 0, from_stride = 0;
  int to_width = 0, to_height = 0, to_stride = 0;
  int factor = 1;
};

/// Returns the step that runs a dispatch with its plain kernel, rather than with a GpuVariant.
GpuStep plain_step(const Dispatch& dispatch);

/// Returns the names of a step's planes, each once: inputs of the first layer, other inputs, outputs. This is the order
/// of their addresses in the table of kernel/glsl.h; the first kBoundPlanes are bound.
std::vector<std::string_view> plane_table(const GpuStep& step);

class Pipelines {
 public:
  /// Creates an empty set of pipelines. `uniforms` is the buffer of constants and tables: see Commands. Compiled
  /// pipelines are stored in `file`, unless it is empty. Errors: kDevice.
  static Result<std::unique_ptr<Pipelines>> make(GpuPtr gpu, VkBuffer uniforms, std::filesystem::path file);
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;

  /// Returns the step's pipeline for this block of constants. Compiles it on the first request with these options.
  /// `bound`: its first planes are bound, as in bound_layout(). Errors: kDevice.
  Result<VkPipeline> kernel(const GpuStep& step, std::span<const std::byte> block, bool bound);
  Result<VkPipeline> pick();
  /// Return the pipelines of capture.comp, trace_rays.comp and convert.comp, which get constants and a table, like
  /// kernels.
  Result<VkPipeline> capture();
  Result<VkPipeline> trace_rays();
  Result<VkPipeline> convert();

  /// Returns the pipeline of corner.vert and peel.frag, which get constants and a table too. `masks`: the scene has
  /// alpha masks; `points`: it has points. Errors: kDevice.
  Result<VkPipeline> peel(bool masks, bool points);
  /// Returns the render pass that starts drawing (`clear`) or continues it. Errors: kDevice.
  Result<VkRenderPass> drawing(bool clear);

  VkPipelineLayout kernel_layout() const { return kernel_layout_; }
  VkPipelineLayout pick_layout() const { return pick_layout_; }
  /// Returns the first descriptor set, which has two dynamic offsets: of the constants and of the table.
  VkDescriptorSet constants() const { return set_; }
  /// Returns the layout of the second descriptor set, which binds kBoundPlanes planes.
  VkDescriptorSetLayout bound_layout() const { return bound_layout_; }

 private:
  explicit Pipelines(GpuPtr gpu) : gpu_(std::move(gpu)) {}
  Result<void> make_layouts(VkBuffer uniforms);
  void save() const;
  using Options = std::vector<std::optional<std::int32_t>>;
  /// SPIR-V, options, whether planes are bound.
  using Key = std::tuple<const std::uint32_t*, Options, bool>;
  /// Returns the pipeline of `spirv` with these options, compiled if needed.
  Result<VkPipeline> compile(std::span<const std::uint32_t> spirv, const Options& options, bool bound,
                             VkPipelineLayout layout, const VkSpecializationInfo* values);

  Result<VkShaderModule> shader_of(std::span<const std::uint32_t> words);

  GpuPtr gpu_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE, bound_layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPipelineLayout kernel_layout_ = VK_NULL_HANDLE, pick_layout_ = VK_NULL_HANDLE;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::map<const std::uint32_t*, KernelOptions> options_;  // by SPIR-V
  std::map<Key, VkPipeline> pipelines_;
  VkRenderPass drawing_[2] = {};  // [0] continues drawing, [1] starts it
  std::filesystem::path file_;
  std::size_t file_bytes_ = 0;  // size of the data read from the file
};

}  // namespace umbrage
