// Shades Vulkan images of an engine: opens a Vulkan device as an engine would, fills depth and normal images with a
// sphere on a floor, has Umbrage compute ambient occlusion on that device, and writes the result: vulkan_images OUT.pgm
#include <vulkan/vulkan.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "umbrage/vulkan.hpp"

namespace {

constexpr int kWidth = 256, kHeight = 192;
constexpr float kNear = 0.1f;

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  std::fprintf(stderr, "vulkan_images: %s: error %d\n", what, int(result));
  std::exit(4);
}

struct Engine {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice gpu = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
};

Engine open_engine() {
  Engine e;
  VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  app.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo instance{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  instance.pApplicationInfo = &app;
  check(vkCreateInstance(&instance, nullptr, &e.instance), "vkCreateInstance");
  uint32_t count = 1;
  vkEnumeratePhysicalDevices(e.instance, &count, &e.gpu);
  if (count == 0) check(VK_ERROR_INITIALIZATION_FAILED, "no device");
  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  // The features that Umbrage requires.
  VkPhysicalDeviceVulkan12Features features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  features.bufferDeviceAddress = VK_TRUE;
  features.scalarBlockLayout = VK_TRUE;
  VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  device.pNext = &features;
  device.queueCreateInfoCount = 1;
  device.pQueueCreateInfos = &queue;
  check(vkCreateDevice(e.gpu, &device, nullptr, &e.device), "vkCreateDevice");
  vkGetDeviceQueue(e.device, 0, 0, &e.queue);
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  check(vkCreateCommandPool(e.device, &pool, nullptr, &e.pool), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = e.pool;
  allocate.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(e.device, &allocate, &e.commands), "vkAllocateCommandBuffers");
  return e;
}

VkDeviceMemory memory_for(const Engine& e, const VkMemoryRequirements& requirements, VkMemoryPropertyFlags properties) {
  VkPhysicalDeviceMemoryProperties types;
  vkGetPhysicalDeviceMemoryProperties(e.gpu, &types);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = requirements.size;
  for (uint32_t k = 0; k < types.memoryTypeCount; ++k)
    if ((requirements.memoryTypeBits >> k & 1u) && (types.memoryTypes[k].propertyFlags & properties) == properties) {
      allocate.memoryTypeIndex = k;
      break;
    }
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(e.device, &allocate, nullptr, &memory), "vkAllocateMemory");
  return memory;
}

struct Image {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
};

Image make_image(const Engine& e, VkFormat format) {
  Image out;
  VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = format;
  create.extent = {kWidth, kHeight, 1};
  create.mipLevels = create.arrayLayers = 1;
  create.samples = VK_SAMPLE_COUNT_1_BIT;
  create.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  check(vkCreateImage(e.device, &create, nullptr, &out.image), "vkCreateImage");
  VkMemoryRequirements requirements;
  vkGetImageMemoryRequirements(e.device, out.image, &requirements);
  out.memory = memory_for(e, requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  vkBindImageMemory(e.device, out.image, out.memory, 0);
  return out;
}

/// Records commands that use a host-visible buffer, submits them and waits. With `upload`, copies `bytes` to the buffer
/// before; otherwise copies the buffer to `bytes` afterwards.
template <class Record>
void with_buffer(const Engine& e, VkDeviceSize size, const Record& record, void* bytes, bool upload) {
  VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  create.size = size;
  create.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  VkBuffer buffer = VK_NULL_HANDLE;
  check(vkCreateBuffer(e.device, &create, nullptr, &buffer), "vkCreateBuffer");
  VkMemoryRequirements requirements;
  vkGetBufferMemoryRequirements(e.device, buffer, &requirements);
  const VkDeviceMemory memory =
      memory_for(e, requirements, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  vkBindBufferMemory(e.device, buffer, memory, 0);
  void* mapped = nullptr;
  check(vkMapMemory(e.device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
  if (upload) std::memcpy(mapped, bytes, size);
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  vkBeginCommandBuffer(e.commands, &begin);
  record(buffer);
  VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  to_host.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(e.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0,
                       nullptr, 0, nullptr);
  vkEndCommandBuffer(e.commands);
  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &e.commands;
  check(vkQueueSubmit(e.queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  check(vkQueueWaitIdle(e.queue), "vkQueueWaitIdle");
  if (!upload) std::memcpy(bytes, mapped, size);
  vkDestroyBuffer(e.device, buffer, nullptr);
  vkFreeMemory(e.device, memory, nullptr);
}

VkBufferImageCopy whole_image() {
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {kWidth, kHeight, 1};
  return region;
}

/// Uploads texels to an image and leaves it in the layout that shaders read.
void fill(const Engine& e, const Image& image, std::vector<float>& texels) {
  with_buffer(
      e, texels.size() * sizeof(float),
      [&](VkBuffer buffer) {
        VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
        barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.image = image.image;
        barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        vkCmdPipelineBarrier(e.commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                             nullptr, 0, nullptr, 1, &barrier);
        const VkBufferImageCopy region = whole_image();
        vkCmdCopyBufferToImage(e.commands, buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
        barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        vkCmdPipelineBarrier(e.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0,
                             nullptr, 0, nullptr, 1, &barrier);
      },
      texels.data(), true);
}

/// Draws a sphere of radius 1 on a floor, as reversed window depth and view-space normals.
void draw_sphere(std::vector<float>& depth, std::vector<float>& normals) {
  const float tangent = 0.5f, aspect = float(kWidth) / kHeight;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float d[3] = {(2.0f * (x + 0.5f) / kWidth - 1.0f) * tangent * aspect,
                          (1.0f - 2.0f * (y + 0.5f) / kHeight) * tangent, -1.0f};
      float t = 0.0f, n[3] = {0, 1, 0};
      if (d[1] < 0.0f) t = -1.0f / d[1];  // the floor, at height -1
      const float center[3] = {0.0f, 0.0f, -5.0f};
      const float a = d[0] * d[0] + d[1] * d[1] + 1.0f, b = d[2] * center[2], c = center[2] * center[2] - 1.0f;
      if (const float root = b * b - a * c; root > 0.0f) {
        t = (b - std::sqrt(root)) / a;
        for (int k = 0; k < 3; ++k) n[k] = d[k] * t - center[k];
      }
      depth.push_back(t > 0.0f ? kNear / t : 0.0f);  // the far plane is at infinity
      normals.insert(normals.end(), {n[0], n[1], n[2], 0.0f});
    }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: vulkan_images OUT.pgm\n");
    return 2;
  }
  const Engine e = open_engine();
  const Image depth = make_image(e, VK_FORMAT_R32_SFLOAT), normal = make_image(e, VK_FORMAT_R32G32B32A32_SFLOAT);
  const Image ao = make_image(e, VK_FORMAT_R32_SFLOAT);
  std::vector<float> depths, normals;
  draw_sphere(depths, normals);
  fill(e, depth, depths);
  fill(e, normal, normals);

  std::vector<float> result(kWidth * kHeight);
  {
    umb::VulkanShading shading;
    if (const auto opened = shading.open({vkGetInstanceProcAddr, e.instance, e.gpu, e.device, e.queue, 0});
        opened.code != 0) {
      std::fprintf(stderr, "vulkan_images: %s\n", opened.message.c_str());
      return opened.code;
    }
    umb::VulkanGBuffer gbuffer;
    gbuffer.width = kWidth;
    gbuffer.height = kHeight;
    gbuffer.depth = {depth.image, VK_FORMAT_R32_SFLOAT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    gbuffer.depth_kind = umb::DepthKind::kReversed;
    gbuffer.near_plane = kNear;
    gbuffer.normal = {normal.image, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    gbuffer.right = 0.5f * kWidth / kHeight;
    gbuffer.left = -gbuffer.right;
    gbuffer.top = 0.5f;
    gbuffer.bottom = -0.5f;
    gbuffer.scene_radius = 3.0f;
    umb::VulkanShadeRequest request;
    request.effects = {"bitmask", "denoise"};
    request.settings = {"bitmask.radius=1"};
    // The old layout is undefined, so that the old content of the image may be discarded.
    request.outputs = {
        {{"ao"}, {ao.image, VK_FORMAT_R32_SFLOAT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL}}};
    for (int frame = 0; frame < 2; ++frame)
      if (const auto shaded = shading.shade(gbuffer, request); shaded.code != 0) {
        std::fprintf(stderr, "vulkan_images: %s\n", shaded.message.c_str());
        return shaded.code;
      }
    // The third frame is a part of the engine's own submission.
    with_buffer(
        e, result.size() * sizeof(float),
        [&](VkBuffer buffer) {
          if (const auto recorded = shading.record(e.commands, 0, gbuffer, request); recorded.code != 0)
            check(VK_ERROR_UNKNOWN, recorded.message.c_str());
          const VkBufferImageCopy region = whole_image();
          vkCmdCopyImageToBuffer(e.commands, ao.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &region);
        },
        result.data(), false);
    const UmbVulkanCost cost = shading.cost(0);
    std::printf("%.1f MiB of device memory; a frame: %d dispatches, %.0f bytes per pixel, %.1f ms\n",
                double(shading.device_bytes()) / 1048576.0, int(cost.dispatches),
                double(cost.bytes_read + cost.bytes_written) / (kWidth * kHeight), cost.milliseconds);
  }
  for (const Image& image : {depth, normal, ao}) {
    vkDestroyImage(e.device, image.image, nullptr);
    vkFreeMemory(e.device, image.memory, nullptr);
  }
  vkDestroyCommandPool(e.device, e.pool, nullptr);
  vkDestroyDevice(e.device, nullptr);
  vkDestroyInstance(e.instance, nullptr);

  std::FILE* file = std::fopen(argv[1], "wb");
  if (!file) {
    std::fprintf(stderr, "vulkan_images: %s cannot be written\n", argv[1]);
    return 3;
  }
  std::fprintf(file, "P5 %d %d 255\n", kWidth, kHeight);
  for (const float v : result) std::fputc(int(std::fmin(std::fmax(v, 0.0f), 1.0f) * 255.0f + 0.5f), file);
  std::fclose(file);
  // The floor below the sphere is occluded; the floor in front and the top of the sphere are not.
  const float below = result[126 * kWidth + kWidth / 2], front = result[185 * kWidth + kWidth / 4],
              top = result[60 * kWidth + kWidth / 2];
  std::printf("below the sphere %.2f, floor in front %.2f, top of the sphere %.2f\n", below, front, top);
  return below < 0.8f && front > 0.9f && top > 0.9f ? 0 : 1;
}
