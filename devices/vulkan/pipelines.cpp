#include "devices/vulkan/pipelines.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <spirv/unified1/spirv.hpp>

#include "core/check.h"
#include "core/gbuffer.h"
#include "core/lists.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/raster.h"
#include "kernel/frame_constants.h"
#include "spirv/capture.h"
#include "spirv/convert.h"
#include "spirv/corner.h"
#include "spirv/peel.h"
#include "spirv/pick.h"
#include "spirv/trace_rays.h"

namespace umbrage {
namespace {

/// The beginning of the file, before the driver's data. It reveals damaged data, which not all drivers detect.
struct Header {
  char magic[8] = {'u', 'm', 'b', 'r', 'p', 'i', 'p', '1'};
  std::uint64_t size = 0, hash = 0;
};

/// Returns the FNV-1a hash.
std::uint64_t hash_of(const std::vector<std::byte>& data) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte byte : data) hash = (hash ^ std::uint64_t(byte)) * 0x100000001b3u;
  return hash;
}

}  // namespace

std::filesystem::path pipeline_file(const std::string& name) {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  std::filesystem::path folder;
  if (cache && cache[0] == '/')
    folder = cache;
  else if (home && home[0] == '/')
    folder = std::filesystem::path(home) / ".cache";
  else
    return {};
  return folder / "umbrage" / name;
}

std::vector<std::byte> read_pipelines(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  constexpr std::uint64_t kMax = std::uint64_t(1) << 30;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.magic, Header().magic, sizeof header.magic) != 0 || header.size > kMax)
    return {};
  std::vector<std::byte> data(header.size);
  if (!in.read(reinterpret_cast<char*>(data.data()), std::streamsize(data.size())) || hash_of(data) != header.hash)
    return {};
  return data;
}

void write_pipelines(const std::filesystem::path& file, const std::vector<std::byte>& data) {
  std::error_code failed;
  std::filesystem::create_directories(file.parent_path(), failed);
  const std::filesystem::path temporary = file.string() + "." + std::to_string(::getpid());
  Header header;
  header.size = data.size();
  header.hash = hash_of(data);
  bool written = false;
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(data.data()), std::streamsize(data.size()));
    written = bool(out.flush());
  }
  if (written) std::filesystem::rename(temporary, file, failed);
  if (!written || failed) std::filesystem::remove(temporary, failed);
}

std::vector<Slot> slots_of(std::span<const std::uint32_t> spirv) {
  constexpr std::string_view kSuffix = "_slot";
  std::vector<Slot> slots;
  std::map<std::uint32_t, std::string> names;
  for (std::size_t at = kSpirvHeaderWords; at < spirv.size();) {
    const std::uint32_t op = spirv[at] & spv::OpCodeMask, words = spirv[at] >> spv::WordCountShift;
    if (words == 0) break;
    if (op == spv::OpName) {
      const std::string name(reinterpret_cast<const char*>(&spirv[at + 2]));
      if (name.ends_with(kSuffix)) names[spirv[at + 1]] = name.substr(0, name.size() - kSuffix.size());
    }
    if (op == spv::OpDecorate && spirv[at + 2] == spv::DecorationSpecId)
      if (const auto named = names.find(spirv[at + 1]); named != names.end())
        slots.push_back({named->second, spirv[at + 3]});
    at += words;
  }
  return slots;
}

std::string slot_name(std::string_view plane) {
  std::string name(plane);
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

GpuStep plain_step(const Dispatch& dispatch) {
  return {
      .name = dispatch.name, .inputs = dispatch.inputs, .outputs = dispatch.outputs, .spirv = dispatch.kernel.spirv};
}

std::vector<std::string_view> plane_table(const GpuStep& step) {
  std::vector<std::string_view> names;
  const auto add = [&](std::string_view name) {
    if (!contains(names, name)) names.push_back(name);
  };
  const auto of_layer = [](std::string_view name) { return layer_of_plane(name) > 0; };
  for (std::string_view name : step.inputs)
    if (!of_layer(name)) add(name);
  for (const auto* list : {&step.inputs, &step.outputs})
    for (std::string_view name : *list) add(name);
  check_less(names.size(), std::size_t(kMaxPlanes) + 1, fmt::format("planes of pass {}", step.name));
  return names;
}

Result<std::unique_ptr<Pipelines>> Pipelines::make(GpuPtr gpu, VkBuffer uniforms, std::filesystem::path file) {
  auto pipelines = std::unique_ptr<Pipelines>(new Pipelines(std::move(gpu)));
  pipelines->file_ = std::move(file);
  if (auto status = pipelines->make_layouts(uniforms); !status) return status.error();
  return pipelines;
}

Result<void> Pipelines::make_layouts(VkBuffer uniforms) {
  const auto& vk = gpu_->vk;
  const VkDevice device = gpu_->device;
  const auto failed = [](VkResult result) -> Error { return vulkan_error(result, "was opened"); };
  const auto binding = [](std::uint32_t number) {
    return VkDescriptorSetLayoutBinding{
        number, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1,
        VK_SHADER_STAGE_COMPUTE_BIT | VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, nullptr};
  };
  const VkDescriptorSetLayoutBinding bindings[] = {binding(0), binding(1)};
  VkDescriptorSetLayoutCreateInfo set_layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_layout.bindingCount = 2;
  set_layout.pBindings = bindings;
  if (const auto r = vk.CreateDescriptorSetLayout(device, &set_layout, nullptr, &set_layout_); r != VK_SUCCESS)
    return failed(r);
  const VkDescriptorSetLayoutBinding bound{0, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::uint32_t(kBoundPlanes),
                                           VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  set_layout.bindingCount = 1;
  set_layout.pBindings = &bound;
  if (const auto r = vk.CreateDescriptorSetLayout(device, &set_layout, nullptr, &bound_layout_); r != VK_SUCCESS)
    return failed(r);
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 2};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = &size;
  if (const auto r = vk.CreateDescriptorPool(device, &pool, nullptr, &pool_); r != VK_SUCCESS) return failed(r);
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &set_layout_;
  if (const auto r = vk.AllocateDescriptorSets(device, &allocate, &set_); r != VK_SUCCESS) return failed(r);
  const VkDescriptorBufferInfo ranges[] = {{uniforms, 0, kMaxUniforms},
                                           {uniforms, 0, kMaxPlanes * sizeof(VkDeviceAddress)}};
  VkWriteDescriptorSet writes[2];
  for (std::uint32_t k = 0; k < 2; ++k) {
    writes[k] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[k].dstSet = set_;
    writes[k].dstBinding = k;
    writes[k].descriptorCount = 1;
    writes[k].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC;
    writes[k].pBufferInfo = &ranges[k];
  }
  vk.UpdateDescriptorSets(device, 2, writes, 0, nullptr);

  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  const VkDescriptorSetLayout sets[] = {set_layout_, bound_layout_};
  layout.setLayoutCount = 2;
  layout.pSetLayouts = sets;
  if (const auto r = vk.CreatePipelineLayout(device, &layout, nullptr, &kernel_layout_); r != VK_SUCCESS)
    return failed(r);
  // The size excludes the padding at the end of the C++ struct.
  const VkPushConstantRange pushed{VK_SHADER_STAGE_COMPUTE_BIT, 0, offsetof(PickConstants, factor) + sizeof(int)};
  layout.setLayoutCount = 0;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &pushed;
  if (const auto r = vk.CreatePipelineLayout(device, &layout, nullptr, &pick_layout_); r != VK_SUCCESS)
    return failed(r);

  const std::vector<std::byte> data = file_.empty() ? std::vector<std::byte>() : read_pipelines(file_);
  file_bytes_ = data.size();
  VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  cache.initialDataSize = data.size();
  cache.pInitialData = data.data();
  if (const auto r = vk.CreatePipelineCache(device, &cache, nullptr, &cache_); r != VK_SUCCESS) return failed(r);
  return {};
}

void Pipelines::save() const {
  const auto& vk = gpu_->vk;
  std::size_t size = 0;
  if (!cache_ || file_.empty() || vk.GetPipelineCacheData(gpu_->device, cache_, &size, nullptr) != VK_SUCCESS) return;
  if (size <= file_bytes_) return;
  std::vector<std::byte> data(size);
  if (vk.GetPipelineCacheData(gpu_->device, cache_, &size, data.data()) != VK_SUCCESS) return;
  data.resize(size);
  write_pipelines(file_, data);
}

Pipelines::~Pipelines() {
  const auto& vk = gpu_->vk;
  const VkDevice device = gpu_->device;
  try {
    save();
  } catch (const std::exception&) {  // the next process compiles them again
  }
  for (const auto& [key, pipeline] : pipelines_) vk.DestroyPipeline(device, pipeline, nullptr);
  for (const VkRenderPass render_pass : drawing_)
    if (render_pass) vk.DestroyRenderPass(device, render_pass, nullptr);
  if (cache_) vk.DestroyPipelineCache(device, cache_, nullptr);
  if (pick_layout_) vk.DestroyPipelineLayout(device, pick_layout_, nullptr);
  if (kernel_layout_) vk.DestroyPipelineLayout(device, kernel_layout_, nullptr);
  if (pool_) vk.DestroyDescriptorPool(device, pool_, nullptr);
  for (const VkDescriptorSetLayout layout : {set_layout_, bound_layout_})
    if (layout) vk.DestroyDescriptorSetLayout(device, layout, nullptr);
}

Result<VkPipeline> Pipelines::kernel(const GpuStep& step, std::span<const std::byte> block, bool bound) {
  auto known = options_.find(step.spirv.data());
  if (known == options_.end()) known = options_.emplace(step.spirv.data(), options_of(step.spirv)).first;
  const Options options = option_values(known->second, block);
  if (const auto found = pipelines_.find({step.spirv.data(), options, bound}); found != pipelines_.end())
    return found->second;
  const std::vector<std::string_view> table = plane_table(step);
  std::vector<VkSpecializationMapEntry> entries = {{0, 0, sizeof(std::int32_t)}};  // bound_planes
  std::vector<std::int32_t> values = {bound ? kBoundPlanes : 0};
  for (const Slot& slot : slots_of(step.spirv)) {
    const auto plane =
        std::find_if(table.begin(), table.end(), [&](auto name) { return slot_name(name) == slot.plane; });
    if (plane == table.end())
      fail_check(fmt::format("kernel {} reads plane '{}', which its pass does not list", step.name, slot.plane));
    entries.push_back({slot.constant, std::uint32_t(values.size() * sizeof(std::int32_t)), sizeof(std::int32_t)});
    values.push_back(std::int32_t(plane - table.begin()));
  }
  const VkSpecializationInfo specialization{std::uint32_t(entries.size()), entries.data(),
                                            values.size() * sizeof(std::int32_t), values.data()};
  return compile(step.spirv, options, bound, kernel_layout_, &specialization);
}

Result<VkPipeline> Pipelines::pick() { return compile(pick_spirv(), {}, false, pick_layout_, nullptr); }
Result<VkPipeline> Pipelines::capture() { return compile(capture_spirv(), {}, false, kernel_layout_, nullptr); }
Result<VkPipeline> Pipelines::trace_rays() { return compile(trace_rays_spirv(), {}, false, kernel_layout_, nullptr); }
Result<VkPipeline> Pipelines::convert() { return compile(convert_spirv(), {}, false, kernel_layout_, nullptr); }

Result<VkShaderModule> Pipelines::shader_of(std::span<const std::uint32_t> words) {
  VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  code.codeSize = words.size_bytes();
  code.pCode = words.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  if (const auto r = gpu_->vk.CreateShaderModule(gpu_->device, &code, nullptr, &shader); r != VK_SUCCESS)
    return vulkan_error(r, "compiled a kernel");
  return shader;
}

Result<VkRenderPass> Pipelines::drawing(bool clear) {
  VkRenderPass& render_pass = drawing_[clear];
  if (!render_pass) {
    auto created = make_render_pass(*gpu_, clear);
    if (!created) return created;
    render_pass = *created;
  }
  return render_pass;
}

Result<VkPipeline> Pipelines::peel(bool masks, bool points) {
  const Key key(std::data(peel_spirv()), Options{masks ? 1 : 0, points ? 1 : 0}, false);
  if (const auto found = pipelines_.find(key); found != pipelines_.end()) return found->second;
  const auto render_pass = drawing(true);
  if (!render_pass) return render_pass.error();
  const auto& vk = gpu_->vk;
  const VkBool32 numbers[] = {masks, points};
  const VkSpecializationMapEntry entries[] = {{0, 0, sizeof *numbers}, {1, sizeof *numbers, sizeof *numbers}};
  const VkSpecializationInfo values{2, entries, sizeof numbers, numbers};
  VkPipelineShaderStageCreateInfo stages[2] = {{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO},
                                               {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO}};
  const auto corner = shader_of(corner_spirv());
  if (!corner) return corner.error();
  const auto pixel = shader_of(peel_spirv());
  if (!pixel) {
    vk.DestroyShaderModule(gpu_->device, *corner, nullptr);
    return pixel.error();
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = *corner;
  stages[0].pName = "main";
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = *pixel;
  stages[1].pName = "main";
  stages[0].pSpecializationInfo = stages[1].pSpecializationInfo = &values;
  const VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo fill{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  fill.polygonMode = VK_POLYGON_MODE_FILL;
  fill.cullMode = VK_CULL_MODE_NONE;  // surfaces are visible from both sides
  fill.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;  // 1 is near
  VkPipelineColorBlendAttachmentState color_attachment{};
  color_attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &color_attachment;
  const VkDynamicState dynamic_states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamic_states;
  VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  create.stageCount = 2;
  create.pStages = stages;
  create.pVertexInputState = &vertices;
  create.pInputAssemblyState = &assembly;
  create.pViewportState = &viewport;
  create.pRasterizationState = &fill;
  create.pMultisampleState = &samples;
  create.pDepthStencilState = &depth;
  create.pColorBlendState = &blend;
  create.pDynamicState = &dynamic;
  create.layout = kernel_layout_;
  create.renderPass = *render_pass;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = vk.CreateGraphicsPipelines(gpu_->device, cache_, 1, &create, nullptr, &pipeline);
  vk.DestroyShaderModule(gpu_->device, *corner, nullptr);
  vk.DestroyShaderModule(gpu_->device, *pixel, nullptr);
  if (result != VK_SUCCESS) return vulkan_error(result, "compiled a kernel");
  pipelines_[key] = pipeline;
  return pipeline;
}

Result<VkPipeline> Pipelines::compile(std::span<const std::uint32_t> spirv, const Options& options, bool bound,
                                      VkPipelineLayout layout, const VkSpecializationInfo* values) {
  const Key key(spirv.data(), options, bound);
  if (const auto found = pipelines_.find(key); found != pipelines_.end()) return found->second;
  const std::vector<std::uint32_t> words = options.empty() ? std::vector(spirv.begin(), spirv.end())
                                                           : with_options(spirv, options_.at(spirv.data()), options);
  const auto shader = shader_of(words);
  if (!shader) return shader.error();
  const auto& vk = gpu_->vk;
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.flags = VK_PIPELINE_CREATE_DISPATCH_BASE;  // dispatches may be split into row ranges
  create.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = *shader;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = values;
  create.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result = vk.CreateComputePipelines(gpu_->device, cache_, 1, &create, nullptr, &pipeline);
  vk.DestroyShaderModule(gpu_->device, *shader, nullptr);
  if (result != VK_SUCCESS) return vulkan_error(result, "compiled a kernel");
  pipelines_[key] = pipeline;
  return pipeline;
}

}  // namespace umbrage
