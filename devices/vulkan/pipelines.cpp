#include "devices/vulkan/pipelines.h"

#include <algorithm>
#include <cstddef>

#include "core/check.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/pipeline_file.h"
#include "devices/vulkan/slots.h"
#include "machine/frame_constants.h"

namespace umbrage {
namespace {

constexpr std::uint32_t kPickSpirv[] = {
#include "spirv/pick.inc"
};
constexpr std::uint32_t kCaptureSpirv[] = {
#include "spirv/capture.inc"
};
constexpr std::uint32_t kConvertSpirv[] = {
#include "spirv/convert.inc"
};

}  // namespace

GpuStep plain_step(const Pass& pass) {
  return {.name = pass.name, .inputs = pass.inputs, .outputs = pass.outputs, .spirv = pass.spirv};
}

std::vector<std::string_view> plane_table(const GpuStep& step) {
  std::vector<std::string_view> names;
  for (const auto* list : {&step.inputs, &step.outputs})
    for (std::string_view name : *list)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  check_less(names.size(), std::size_t(kMostPlanes) + 1, fmt::format("planes of pass {}", step.name));
  return names;
}

Result<std::unique_ptr<Pipelines>> Pipelines::make(GpuPtr gpu, VkBuffer uniforms, std::filesystem::path file) {
  auto made = std::unique_ptr<Pipelines>(new Pipelines(std::move(gpu)));
  made->file_ = std::move(file);
  if (auto done = made->make_layouts(uniforms); !done) return done.error();
  return made;
}

Result<void> Pipelines::make_layouts(VkBuffer uniforms) {
  const auto& vk = gpu_->vk;
  const VkDevice device = gpu_->device;
  const auto failed = [](VkResult result) -> Error { return vulkan_error(result, "was opened"); };
  const auto binding = [](std::uint32_t number) {
    return VkDescriptorSetLayoutBinding{number, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1,
                                        VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  };
  const VkDescriptorSetLayoutBinding bindings[] = {binding(0), binding(1)};
  VkDescriptorSetLayoutCreateInfo set_layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_layout.bindingCount = 2;
  set_layout.pBindings = bindings;
  if (const auto r = vk.CreateDescriptorSetLayout(device, &set_layout, nullptr, &set_layout_); r != VK_SUCCESS)
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
  const VkDescriptorBufferInfo ranges[] = {{uniforms, 0, kMostUniforms},
                                           {uniforms, 0, kMostPlanes * sizeof(VkDeviceAddress)}};
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
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  if (const auto r = vk.CreatePipelineLayout(device, &layout, nullptr, &pass_layout_); r != VK_SUCCESS)
    return failed(r);
  // Without the padding at the end of the C++ struct.
  const VkPushConstantRange pushed{VK_SHADER_STAGE_COMPUTE_BIT, 0, offsetof(PickConstants, factor) + sizeof(int)};
  layout.setLayoutCount = 0;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &pushed;
  if (const auto r = vk.CreatePipelineLayout(device, &layout, nullptr, &pick_layout_); r != VK_SUCCESS)
    return failed(r);

  const std::vector<std::byte> data = file_.empty() ? std::vector<std::byte>() : read_pipelines(file_);
  read_ = data.size();
  VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  cache.initialDataSize = data.size();
  cache.pInitialData = data.data();
  if (const auto r = vk.CreatePipelineCache(device, &cache, nullptr, &cache_); r != VK_SUCCESS) return failed(r);
  return {};
}

Pipelines::~Pipelines() {
  const auto& vk = gpu_->vk;
  const VkDevice device = gpu_->device;
  std::size_t size = 0;
  if (cache_ && !file_.empty() && vk.GetPipelineCacheData(device, cache_, &size, nullptr) == VK_SUCCESS &&
      size > read_) {
    std::vector<std::byte> data(size);
    if (vk.GetPipelineCacheData(device, cache_, &size, data.data()) == VK_SUCCESS) {
      data.resize(size);
      write_pipelines(file_, data);
    }
  }
  for (const auto& [key, pipeline] : pipelines_) vk.DestroyPipeline(device, pipeline, nullptr);
  if (cache_) vk.DestroyPipelineCache(device, cache_, nullptr);
  if (pick_layout_) vk.DestroyPipelineLayout(device, pick_layout_, nullptr);
  if (pass_layout_) vk.DestroyPipelineLayout(device, pass_layout_, nullptr);
  if (pool_) vk.DestroyDescriptorPool(device, pool_, nullptr);
  if (set_layout_) vk.DestroyDescriptorSetLayout(device, set_layout_, nullptr);
}

Result<VkPipeline> Pipelines::of(const GpuStep& step, std::span<const std::byte> block) {
  auto known = options_.find(step.spirv.data());
  if (known == options_.end()) known = options_.emplace(step.spirv.data(), options_of(step.spirv)).first;
  const Options options = option_values(known->second, block);
  if (const auto found = pipelines_.find({step.spirv.data(), options}); found != pipelines_.end()) return found->second;
  const std::vector<std::string_view> table = plane_table(step);
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<std::int32_t> values;
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
  return compile(step.spirv, options, pass_layout_, &specialization);
}

Result<VkPipeline> Pipelines::pick() { return compile(kPickSpirv, {}, pick_layout_, nullptr); }
Result<VkPipeline> Pipelines::capture() { return compile(kCaptureSpirv, {}, pass_layout_, nullptr); }
Result<VkPipeline> Pipelines::convert() { return compile(kConvertSpirv, {}, pass_layout_, nullptr); }

Result<VkPipeline> Pipelines::compile(std::span<const std::uint32_t> spirv, const Options& options,
                                      VkPipelineLayout layout, const VkSpecializationInfo* values) {
  const std::pair key(spirv.data(), options);
  if (const auto found = pipelines_.find(key); found != pipelines_.end()) return found->second;
  const std::vector<std::uint32_t> words = options.empty() ? std::vector(spirv.begin(), spirv.end())
                                                           : with_options(spirv, options_.at(spirv.data()), options);
  const auto& vk = gpu_->vk;
  VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  code.codeSize = words.size() * sizeof(std::uint32_t);
  code.pCode = words.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  if (const auto r = vk.CreateShaderModule(gpu_->device, &code, nullptr, &shader); r != VK_SUCCESS)
    return vulkan_error(r, "compiled a kernel");
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.flags = VK_PIPELINE_CREATE_DISPATCH_BASE;  // dispatches may be cut into bands
  create.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = shader;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = values;
  create.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult made = vk.CreateComputePipelines(gpu_->device, cache_, 1, &create, nullptr, &pipeline);
  vk.DestroyShaderModule(gpu_->device, shader, nullptr);
  if (made != VK_SUCCESS) return vulkan_error(made, "compiled a kernel");
  pipelines_[key] = pipeline;
  return pipeline;
}

}  // namespace umbrage
