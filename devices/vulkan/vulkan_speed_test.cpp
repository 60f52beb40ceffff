// Measures times on a Vulkan device, in alternation. Prints them without assertions, since machines are never idle
// enough for those.
// umbrage_tests --gtest_also_run_disabled_tests --gtest_filter='VulkanSpeed.*'
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "devices/shared/dispatches.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/vulkan_device.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "run_effect.h"
#include "spirv/bitmask_by_hand_addresses.h"
#include "spirv/bitmask_by_hand_buffers.h"
#include "spirv/bitmask_by_hand_images.h"
#include "spirv/hemisphere_by_hand_addresses.h"
#include "spirv/hemisphere_by_hand_buffers.h"
#include "spirv/hemisphere_by_hand_images.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr int kRuns = 9;

std::unique_ptr<Device> device_without_validation(bool tuned) {
  auto made = make_vulkan_device({.tuned = tuned}, make_cpu_device());
  return made ? std::move(*made) : nullptr;
}

double median(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

/// Returns the scene as captured for the look `unsharp`.
Result<Frame> captured(Device& device, const char* scene_name, int width, int height) {
  auto scene = load_scene(scene_name);
  if (!scene) return scene.error();
  if (auto ready = device.prepare(*scene); !ready) return ready.error();
  Request settings;
  settings.width = width;
  settings.height = height;
  settings.look = "unsharp";
  StageTimes ignored;
  return draw(device, *scene, settings, ignored);
}

/// Returns the GPU time of all dispatches of an effect except those named `without`, milliseconds.
double gpu_ms(Device& device, const Effect& effect, const ParameterBytes& params, Frame& frame,
              std::string_view without = {}) {
  EXPECT_TRUE(device.finish());
  EXPECT_TRUE(device.run(effect, params, frame));
  double ms = 0.0;
  for (const DispatchTime& dispatch : *device.finish())
    if (dispatch.dispatch != without) ms += dispatch.ms;
  return ms;
}

TEST(VulkanSpeed, DISABLED_UnsharpVariantsAndPlain) {
  const auto tuned = device_without_validation(true), plain = device_without_validation(false);
  UMBRAGE_NEEDS_VULKAN(tuned && plain);
  fmt::print("{}\nms of unsharp, median of {}, alternating: variants, plain, ratio\n", tuned->description(), kRuns);
  const Effect& effect = *find_effect("unsharp");
  auto a = captured(*tuned, "scene:claw", 512, 512), b = captured(*plain, "scene:claw", 512, 512);
  ASSERT_TRUE(a && b);
  for (const char* threshold : {"0", "0.02"})
    for (const char* kernel : {"8", "12", "15", "40", "121"}) {
      const ParameterBytes params = test::parameters_of(effect, {{"kernel", kernel}, {"threshold", threshold}});
      std::vector<double> variants_ms, plain_ms;
      for (int turn = 0; turn <= kRuns; ++turn) {
        const double variant_ms = gpu_ms(*tuned, effect, params, *a, "linearize");
        const double one_plain_ms = gpu_ms(*plain, effect, params, *b, "linearize");
        if (turn == 0) continue;
        variants_ms.push_back(variant_ms);
        plain_ms.push_back(one_plain_ms);
      }
      fmt::print("k = {:>3}, threshold {:<5} {:8.2f} {:8.2f} {:6.2f}\n", kernel, threshold, median(variants_ms),
                 median(plain_ms), median(plain_ms) / median(variants_ms));
    }
}

// ---- hand-written shaders ----

/// Functions that loader.h does not list, since the device uses no images of its own.
struct ImageFunctions {
  PFN_vkCreateImage create_image;
  PFN_vkDestroyImage destroy_image;
  PFN_vkGetImageMemoryRequirements needs_of;
  PFN_vkBindImageMemory bind;
  PFN_vkCreateImageView create_view;
  PFN_vkDestroyImageView destroy_view;
  PFN_vkCreateSampler create_sampler;
  PFN_vkDestroySampler destroy_sampler;
};

ImageFunctions image_functions(const Gpu& gpu) {
  ImageFunctions f{};
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(
        gpu.vk.GetInstanceProcAddr(gpu.instance->handle, name));
    ASSERT_NE(function, nullptr) << name;
  };
  find(f.create_image, "vkCreateImage");
  find(f.destroy_image, "vkDestroyImage");
  find(f.needs_of, "vkGetImageMemoryRequirements");
  find(f.bind, "vkBindImageMemory");
  find(f.create_view, "vkCreateImageView");
  find(f.destroy_view, "vkDestroyImageView");
  find(f.create_sampler, "vkCreateSampler");
  find(f.destroy_sampler, "vkDestroySampler");
  return f;
}

void expect_success(VkResult result) { ASSERT_EQ(result, VK_SUCCESS); }

/// A GPU with the planes of a picture as buffers and as images, and shaders bound to them.
struct HandWritten {
  GpuPtr gpu;
  ImageFunctions f;
  std::shared_ptr<Memory> memory;
  std::unique_ptr<Commands> commands;
  int width = 0, height = 0, stride = 0;
  DevicePlanePtr planes[4], ao;  // planes: depth, normal
  VkSampler sampler = VK_NULL_HANDLE;
  VkImage images[2] = {};
  VkDeviceMemory image_memory[2] = {};
  VkImageView views[2] = {};

  struct Shader {
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkPipelineLayout layout;
    VkPipeline pipeline;
  };
  std::vector<Shader> shaders;

  ~HandWritten() {
    const auto& vk = gpu->vk;
    for (const Shader& s : shaders) {
      vk.DestroyPipeline(gpu->device, s.pipeline, nullptr);
      vk.DestroyPipelineLayout(gpu->device, s.layout, nullptr);
      vk.DestroyDescriptorPool(gpu->device, s.pool, nullptr);
      vk.DestroyDescriptorSetLayout(gpu->device, s.set_layout, nullptr);
    }
    for (int k = 0; k < 2; ++k) {
      f.destroy_view(gpu->device, views[k], nullptr);
      f.destroy_image(gpu->device, images[k], nullptr);
      vk.FreeMemory(gpu->device, image_memory[k], nullptr);
    }
    f.destroy_sampler(gpu->device, sampler, nullptr);
  }
};

void upload(HandWritten& h, const std::vector<float>& numbers,
            const std::function<void(VkCommandBuffer, VkBuffer)>& copy) {
  const auto host = h.memory->host(numbers.size() * sizeof(float));
  ASSERT_TRUE(host);
  std::memcpy((*host)->mapped, numbers.data(), numbers.size() * sizeof(float));
  const auto buffer = h.commands->buffer();
  ASSERT_TRUE(buffer);
  copy(*buffer, (*host)->buffer);
  ASSERT_TRUE(h.commands->finish());
}

void add_image(HandWritten& h, int k, VkFormat format, const std::vector<float>& texels) {
  const auto& vk = h.gpu->vk;
  const VkDevice device = h.gpu->device;
  VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = format;
  create.extent = {std::uint32_t(h.width), std::uint32_t(h.height), 1};
  create.mipLevels = create.arrayLayers = 1;
  create.samples = VK_SAMPLE_COUNT_1_BIT;
  create.tiling = VK_IMAGE_TILING_OPTIMAL;
  create.usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  expect_success(h.f.create_image(device, &create, nullptr, &h.images[k]));
  VkMemoryRequirements needs;
  h.f.needs_of(device, h.images[k], &needs);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  for (std::uint32_t type = h.gpu->memory.memoryTypeCount; type-- > 0;)
    if ((needs.memoryTypeBits >> type & 1u) &&
        (h.gpu->memory.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
      allocate.memoryTypeIndex = type;
  expect_success(vk.AllocateMemory(device, &allocate, nullptr, &h.image_memory[k]));
  expect_success(h.f.bind(device, h.images[k], h.image_memory[k], 0));
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = h.images[k];
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  expect_success(h.f.create_view(device, &view, nullptr, &h.views[k]));
  upload(h, texels, [&](VkCommandBuffer buffer, VkBuffer from) {
    const auto change_layout = [&](VkImageLayout old_layout, VkImageLayout new_layout) {
      VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
      barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
      barrier.oldLayout = old_layout;
      barrier.newLayout = new_layout;
      barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
      barrier.image = h.images[k];
      barrier.subresourceRange = view.subresourceRange;
      vk.CmdPipelineBarrier(buffer, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                            nullptr, 0, nullptr, 1, &barrier);
    };
    change_layout(VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = create.extent;
    vk.CmdCopyBufferToImage(buffer, from, h.images[k], VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    change_layout(VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  });
}

std::unique_ptr<HandWritten> hand_written(const Image& image) {
  const auto instance = make_instance(nullptr, {});
  if (!instance) return nullptr;
  const auto gpus = physical_gpus(**instance);
  if (!gpus) return nullptr;
  auto gpu = open_gpu(*instance, gpus->front());
  if (!gpu) return nullptr;
  auto made = std::make_unique<HandWritten>();
  HandWritten& h = *made;
  h.gpu = *gpu;
  h.f = image_functions(*h.gpu);
  h.memory = std::make_shared<Memory>(h.gpu);
  h.commands = std::move(*Commands::make(h.gpu, h.memory));
  h.width = h.stride = image.width;
  h.height = image.height;
  const std::size_t pixels = std::size_t(h.width) * std::size_t(h.height);
  std::vector<float> numbers[4], texels(4 * pixels);
  for (int p = 0; p < 4; ++p) {
    constexpr const char* kNames[] = {"depth", "normal.x", "normal.y", "normal.z"};
    const Plane& plane = image.plane(kNames[p]);
    for (int y = 0; y < h.height; ++y) numbers[p].insert(numbers[p].end(), plane.row(y), plane.row(y) + h.width);
    h.planes[p] = *h.memory->plane(pixels * sizeof(float));
    upload(h, numbers[p], [&](VkCommandBuffer buffer, VkBuffer from) {
      const VkBufferCopy region{0, h.planes[p]->offset, pixels * sizeof(float)};
      h.gpu->vk.CmdCopyBuffer(buffer, from, h.planes[p]->buffer, 1, &region);
    });
  }
  h.ao = *h.memory->plane(pixels * sizeof(float));
  for (std::size_t k = 0; k < pixels; ++k)
    for (std::size_t c = 0; c < 3; ++c) texels[4 * k + c] = numbers[c + 1][k];
  VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  expect_success(h.f.create_sampler(h.gpu->device, &sampler, nullptr, &h.sampler));
  add_image(h, 0, VK_FORMAT_R32_SFLOAT, numbers[0]);
  add_image(h, 1, VK_FORMAT_R32G32B32A32_SFLOAT, texels);
  return made;
}

/// Compiles a shader and binds all planes, as images or buffers, to it. Returns its index.
std::size_t add_shader(HandWritten& h, std::span<const std::uint32_t> spirv, bool images) {
  const auto& vk = h.gpu->vk;
  const VkDevice device = h.gpu->device;
  HandWritten::Shader shader{};
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  const auto bind = [&](std::uint32_t number, VkDescriptorType type) {
    bindings.push_back({number, type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  };
  bind(0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC);
  bind(5, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  for (std::uint32_t k = 1; k <= (images ? 2u : 4u); ++k)
    bind(k, images ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
  VkDescriptorSetLayoutCreateInfo set_layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_layout.bindingCount = std::uint32_t(bindings.size());
  set_layout.pBindings = bindings.data();
  expect_success(vk.CreateDescriptorSetLayout(device, &set_layout, nullptr, &shader.set_layout));
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 1},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 5},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 2}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = 3;
  pool.pPoolSizes = sizes;
  expect_success(vk.CreateDescriptorPool(device, &pool, nullptr, &shader.pool));
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = shader.pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &shader.set_layout;
  expect_success(vk.AllocateDescriptorSets(device, &allocate, &shader.set));
  const VkDeviceSize bytes = VkDeviceSize(h.stride) * VkDeviceSize(h.height) * sizeof(float);
  for (const VkDescriptorSetLayoutBinding& binding : bindings) {
    VkDescriptorBufferInfo range{h.commands->uniform_buffer(), 0, kMaxUniforms};
    VkDescriptorImageInfo sampled{h.sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    if (binding.binding > 0) {
      const DevicePlane& plane = binding.binding == 5 ? *h.ao : *h.planes[binding.binding - 1];
      range = {plane.buffer, plane.offset, bytes};
      if (binding.binding <= 2) sampled.imageView = h.views[binding.binding - 1];
    }
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = shader.set;
    write.dstBinding = binding.binding;
    write.descriptorCount = 1;
    write.descriptorType = binding.descriptorType;
    write.pBufferInfo = &range;
    write.pImageInfo = &sampled;
    vk.UpdateDescriptorSets(device, 1, &write, 0, nullptr);
  }
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &shader.set_layout;
  expect_success(vk.CreatePipelineLayout(device, &layout, nullptr, &shader.layout));
  VkShaderModuleCreateInfo code{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  code.codeSize = spirv.size_bytes();
  code.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  expect_success(vk.CreateShaderModule(device, &code, nullptr, &module));
  VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  create.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = module;
  create.stage.pName = "main";
  create.layout = shader.layout;
  expect_success(vk.CreateComputePipelines(device, VK_NULL_HANDLE, 1, &create, nullptr, &shader.pipeline));
  vk.DestroyShaderModule(device, module, nullptr);
  h.shaders.push_back(shader);
  return h.shaders.size() - 1;
}

double hand_ms(HandWritten& h, std::size_t number, std::span<const std::byte> constants) {
  const auto& vk = h.gpu->vk;
  const HandWritten::Shader& shader = h.shaders[number];
  const auto uniforms = h.commands->uniforms(kMaxUniforms);
  std::memcpy(uniforms->bytes, constants.data(), constants.size());
  const VkCommandBuffer buffer = *h.commands->buffer();
  h.commands->take_dispatch_times();
  h.commands->begin_dispatch("by hand", "by hand", {shader.pipeline, 0}, 1.0, false);
  vk.CmdBindPipeline(buffer, VK_PIPELINE_BIND_POINT_COMPUTE, shader.pipeline);
  vk.CmdBindDescriptorSets(buffer, VK_PIPELINE_BIND_POINT_COMPUTE, shader.layout, 0, 1, &shader.set, 1,
                           &uniforms->offset);
  vk.CmdDispatch(buffer, std::uint32_t(h.width + 7) / 8, std::uint32_t(h.height + 7) / 8, 1);
  h.commands->end_dispatch();
  EXPECT_TRUE(h.commands->finish());
  return h.commands->take_dispatch_times()[0].ms;
}

Plane hand_ao(HandWritten& h) {
  const VkDeviceSize bytes = VkDeviceSize(h.stride) * VkDeviceSize(h.height) * sizeof(float);
  const auto host = h.memory->host(bytes);
  EXPECT_TRUE(h.commands->buffer());
  h.commands->barrier();
  const VkBufferCopy region{h.ao->offset, 0, bytes};
  h.gpu->vk.CmdCopyBuffer(*h.commands->buffer(), h.ao->buffer, (*host)->buffer, 1, &region);
  EXPECT_TRUE(h.commands->finish());
  Plane plane(h.width, h.height);
  for (int y = 0; y < h.height; ++y)
    std::memcpy(plane.row(y), (*host)->mapped + std::size_t(y) * h.stride * sizeof(float), h.width * sizeof(float));
  return plane;
}

struct ByHand {
  const char *effect, *dispatch;
  std::span<const std::uint32_t> addresses, buffers, images;
};
const ByHand kByHand[] = {{"hemisphere", "occlusion", hemisphere_by_hand_addresses_spirv(),
                           hemisphere_by_hand_buffers_spirv(), hemisphere_by_hand_images_spirv()},
                          {"bitmask", "occlusion", bitmask_by_hand_addresses_spirv(), bitmask_by_hand_buffers_spirv(),
                           bitmask_by_hand_images_spirv()}};

/// Times our kernel and the three hand-written shaders in alternation, and checks that they compute the same picture.
void compare_with_hand(const char* scene, int width, int height, int turns) {
  const auto ours = device_without_validation(true);
  UMBRAGE_NEEDS_VULKAN(ours);
  auto frame = captured(*ours, scene, width, height);
  ASSERT_TRUE(frame);
  const auto planes = ours->download(*frame, {"depth", "normal.x", "normal.y", "normal.z"});
  ASSERT_TRUE(planes);
  const auto h = hand_written(*planes);
  ASSERT_TRUE(h);
  for (const ByHand& by_hand : kByHand) {
    const Effect& effect = *find_effect(by_hand.effect);
    const ParameterBytes params = initial_parameters(effect.parameters, effect.params_size);
    const FrameConstants frame_block = frame_constants(frame->info, h->stride, 0);
    std::vector<std::byte> constants(sizeof frame_block + effect.constants_size);
    std::memcpy(constants.data(), &frame_block, sizeof frame_block);
    effect.constants(params, frame->info, constants.data() + sizeof frame_block);
    for (const DevicePlanePtr& plane : h->planes) {
      const auto address = std::as_bytes(std::span(&plane->address, 1));
      constants.insert(constants.end(), address.begin(), address.end());
    }
    const std::size_t shaders[] = {add_shader(*h, by_hand.addresses, false), add_shader(*h, by_hand.buffers, false),
                                   add_shader(*h, by_hand.images, true)};
    std::vector<double> own_ms, hand[3];
    for (int turn = 0; turn <= turns; ++turn) {
      ASSERT_TRUE(ours->finish());
      ASSERT_TRUE(ours->run(effect, params, *frame));
      double own = 0.0;
      for (const DispatchTime& dispatch : *ours->finish())
        if (dispatch.dispatch == by_hand.dispatch) own += dispatch.ms;
      if (turn > 0) own_ms.push_back(own);
      for (int k = 0; k < 3; ++k) {
        const double ms = hand_ms(*h, shaders[k], constants);
        if (turn > 0) {
          hand[k].push_back(ms);
          continue;
        }
        const auto image = ours->download(*frame, {"ao"});
        ASSERT_TRUE(image);
        const auto d = test::difference(image->planes[0], hand_ao(*h), 2.0 / 255.0);
        EXPECT_LE(d.fraction_over, 1e-3) << effect.name << ' ' << k << ", most " << d.max;
      }
    }
    if (turns == 0) continue;
    fmt::print("{:<10} ours {:8.2f} ms; by hand on addresses, buffers, images", effect.name, median(own_ms));
    for (const auto& ms : hand) fmt::print(" {:8.2f}", median(ms));
    fmt::print("; ours / by hand");
    for (const auto& ms : hand) fmt::print(" {:.2f}", median(own_ms) / median(ms));
    fmt::print("\n");
  }
}

TEST(VulkanSpeed, ShadersByHandMakeTheSamePictures) { compare_with_hand("scene:solids?detail=3000", 150, 110, 0); }

TEST(VulkanSpeed, DISABLED_ByHandAndOurs) {
  for (const char* scene : {"scene:solids", "scene:atrium"}) {
    fmt::print("{} at 1024x1024, median of {}, alternating\n", scene, kRuns);
    compare_with_hand(scene, 1024, 1024, kRuns);
  }
}

}  // namespace
}  // namespace umbrage
