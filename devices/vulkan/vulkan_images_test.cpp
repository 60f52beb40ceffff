// Tests of a caller's Vulkan device and images, and of successive frames.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/guarded.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "faulty_vulkan.h"
#include "support.h"
#include "umbrage/umbrage.hpp"
#include "umbrage/vulkan.hpp"
#include "vulkan_support.h"
using namespace umb;  // the public interface; its names used here are not in umbrage

namespace umbrage {
namespace {

constexpr int kWidth = 37, kHeight = 23;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A device as opened by an engine, with functions to create and clear images.
struct Engine {
  InstancePtr instance;
  GpuPtr gpu;
  std::vector<std::pair<VkImage, VkDeviceMemory>> images;

  template <class Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(gpu->vk.GetInstanceProcAddr(gpu->instance->handle, name));
  }
  ForeignGpu foreign(PFN_vkGetInstanceProcAddr get = nullptr) const {
    return {get ? get : test::checked_get, gpu->instance->handle, gpu->physical, gpu->device, gpu->queue, gpu->family};
  }
  VulkanContext context(PFN_vkGetInstanceProcAddr get = nullptr) const {
    const ForeignGpu f = foreign(get);
    return {f.get, f.instance, f.physical, f.device, f.queue, f.family};
  }

  Engine() = default;
  Engine(Engine&&) = default;
  ~Engine() {
    for (const auto& [image, memory] : images) {
      function<PFN_vkDestroyImage>("vkDestroyImage")(gpu->device, image, nullptr);
      gpu->vk.FreeMemory(gpu->device, memory, nullptr);
    }
  }

  VkImage image(VkFormat format) {
    VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    create.imageType = VK_IMAGE_TYPE_2D;
    create.format = format;
    create.extent = {kWidth, kHeight, 1};
    create.mipLevels = create.arrayLayers = 1;
    create.samples = VK_SAMPLE_COUNT_1_BIT;
    create.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    VkImage made = VK_NULL_HANDLE;
    EXPECT_EQ(function<PFN_vkCreateImage>("vkCreateImage")(gpu->device, &create, nullptr, &made), VK_SUCCESS);
    VkMemoryRequirements needs;
    function<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(gpu->device, made, &needs);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = needs.size;
    while (!(needs.memoryTypeBits >> allocate.memoryTypeIndex & 1u)) ++allocate.memoryTypeIndex;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    EXPECT_EQ(gpu->vk.AllocateMemory(gpu->device, &allocate, nullptr, &memory), VK_SUCCESS);
    function<PFN_vkBindImageMemory>("vkBindImageMemory")(gpu->device, made, memory, 0);
    images.emplace_back(made, memory);
    return made;
  }

  /// Fills an image with driver calls and leaves it in layout GENERAL.
  void clear(VkImage image, const std::array<float, 4>& value, bool depth) const {
    const auto memory = std::make_shared<Memory>(gpu);
    const auto commands = Commands::make(gpu, memory);
    ASSERT_TRUE(commands);
    const VkCommandBuffer buffer = *(*commands)->buffer();
    const VkImageSubresourceRange range = {
        VkImageAspectFlags(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1, 0, 1};
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = range;
    gpu->vk.CmdPipelineBarrier(buffer, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0,
                               nullptr, 1, &barrier);
    if (depth) {
      const VkClearDepthStencilValue to = {value[0], 0};
      function<PFN_vkCmdClearDepthStencilImage>("vkCmdClearDepthStencilImage")(buffer, image, VK_IMAGE_LAYOUT_GENERAL,
                                                                               &to, 1, &range);
    } else {
      VkClearColorValue to;
      std::copy(value.begin(), value.end(), to.float32);
      function<PFN_vkCmdClearColorImage>("vkCmdClearColorImage")(buffer, image, VK_IMAGE_LAYOUT_GENERAL, &to, 1,
                                                                 &range);
    }
    ASSERT_TRUE((*commands)->finish());
  }
};

std::optional<Engine> open_engine(PFN_vkGetInstanceProcAddr get = nullptr) {
  Engine engine;
  auto instance = make_instance(get, test::note_message());
  if (!instance) {
    if (!test::may_lack_vulkan()) ADD_FAILURE() << instance.error().message;
    return std::nullopt;
  }
  engine.instance = *instance;
  const auto gpus = physical_gpus(*engine.instance);
  if (!gpus) return std::nullopt;
  auto gpu = open_gpu(engine.instance, gpus->front());
  if (!gpu) return std::nullopt;
  engine.gpu = *gpu;
  return engine;
}

struct KnownFormat {
  VkFormat format;
  double step;  // between adjacent values near 1
};
constexpr KnownFormat kFormats[] = {{VK_FORMAT_R32_SFLOAT, 0.0},           {VK_FORMAT_R32G32B32A32_SFLOAT, 0.0},
                                    {VK_FORMAT_R16G16B16A16_SFLOAT, 1e-3}, {VK_FORMAT_R8G8B8A8_UNORM, 1.0 / 255},
                                    {VK_FORMAT_B8G8R8A8_UNORM, 1.0 / 255}, {VK_FORMAT_R8G8B8A8_SRGB, 0.01},
                                    {VK_FORMAT_B8G8R8A8_SRGB, 0.01}};

const std::vector<std::string> kFour = {"a", "b", "c", "d"};

PictureInfo picture() { return test::empty_gbuffer(kWidth, kHeight).info; }

TEST(VulkanImages, AreReadAndWrittenInEveryFormat) {
  const test::NoMessages no_messages;
  auto engine = open_engine();
  UMBRAGE_NEEDS_VULKAN(engine);
  const auto device = make_vulkan_device_on(engine->foreign());
  ASSERT_TRUE(device) << device.error().message;
  for (const KnownFormat& known : kFormats) {
    SCOPED_TRACE(int(known.format));
    const int channels = known.format == VK_FORMAT_R32_SFLOAT ? 1 : 4;
    const std::array<float, 4> value = {0.25f, 0.5f, 0.875f, 0.625f};
    const VkImage image = engine->image(known.format);
    engine->clear(image, value, false);
    auto frame = empty_frame(**device, picture());
    ASSERT_TRUE(frame);
    const DeviceImage as_cleared{image, known.format, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL};
    ASSERT_TRUE(read_image(**device, as_cleared, {}, kFour, *frame));
    const auto read = (*device)->download(*frame, kFour);
    ASSERT_TRUE(read);
    for (int c = 0; c < channels; ++c)
      EXPECT_LE(test::difference(read->planes[c], Plane(kWidth, kHeight, value[c]), 0.0).max, 0.5 * known.step + 1e-6);

    // Written planes are read back.
    Image waves(kWidth, kHeight);
    for (const std::string& name : kFour) {
      Plane& plane = waves.add(name) = Plane(kWidth, kHeight);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          plane.at(x, y) = float(test::hash(x + 131u * y + unsigned(name[0])) >> 8) * 0x1p-24f;
    }
    ASSERT_TRUE((*device)->add(waves, *frame));
    ASSERT_TRUE(write_image(**device, *frame, {kFour.begin(), kFour.begin() + channels}, as_cleared));
    auto back = empty_frame(**device, picture());
    ASSERT_TRUE(read_image(**device, as_cleared, {}, kFour, *back));
    const auto again = (*device)->download(*back, kFour);
    ASSERT_TRUE(again);
    for (int c = 0; c < channels; ++c)
      EXPECT_LE(test::difference(again->planes[c], waves.planes[c], 0.0).max, 0.5 * known.step + 1e-6) << c;
  }
}

TEST(VulkanImages, DepthBecomesViewDepth) {
  const test::NoMessages no_messages;
  auto engine = open_engine();
  UMBRAGE_NEEDS_VULKAN(engine);
  const auto device = make_vulkan_device_on(engine->foreign());
  ASSERT_TRUE(device);
  const float n = 0.5f, f = 20.0f, z = 3.0f;
  struct Case {
    int role;
    bool orthographic;
    float far, stored, distance;
  };
  const float window = f / (f - n) * (1.0f - n / z);  // window depth of a projection to [0, 1]
  // Ray depth divided by view depth at the last pixel, for a window from -1 to 1.
  const float across = 1.0f - 1.0f / float(kWidth), down = 1.0f - 1.0f / float(kHeight);
  const float slant = std::sqrt(1.0f + across * across + down * down);
  const Case cases[] = {{kWindowDepthRole, false, f, window, z},
                        {kWindowDepthRole, false, f, 1.0f, kInfinity},
                        {kReversedDepthRole, false, f, 1.0f - window, z},
                        {kReversedDepthRole, false, kInfinity, n / z, z},
                        {kReversedDepthRole, false, kInfinity, 0.0f, kInfinity},
                        {kWindowDepthRole, false, kInfinity, 1.0f - n / z, z},
                        {kWindowDepthRole, true, f, (z - n) / (f - n), z},
                        {kReversedDepthRole, true, f, 1.0f - (z - n) / (f - n), z},
                        {kViewDepthRole, false, f, z / 10.0f, z / 10.0f},
                        {kViewDepthRole, false, f, 0.0f, kInfinity},
                        {kRayDepthRole, false, f, z / 10.0f * slant, z / 10.0f},
                        {kRayDepthRole, true, f, z / 10.0f, z / 10.0f},
                        {kRayDepthRole, false, f, 0.0f, kInfinity}};
  for (const VkFormat format : {VK_FORMAT_R32_SFLOAT, VK_FORMAT_D32_SFLOAT}) {
    const VkImage image = engine->image(format);
    for (const Case& c : cases) {
      engine->clear(image, {c.stored, 0, 0, 0}, format == VK_FORMAT_D32_SFLOAT);
      auto frame = empty_frame(**device, picture());
      ASSERT_TRUE(read_image(**device, {image, format, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL},
                             {.role = c.role, .orthographic = c.orthographic, .near_depth = n, .far_depth = c.far},
                             {"depth"}, *frame));
      const auto read = (*device)->download(*frame, {"depth"});
      ASSERT_TRUE(read);
      const float got = read->planes[0].at(kWidth - 1, kHeight - 1);
      if (std::isfinite(c.distance))
        EXPECT_NEAR(got, c.distance, 1e-4) << c.role << ' ' << c.stored;
      else
        EXPECT_EQ(got, kInfinity) << c.role << ' ' << c.stored;
    }
  }
}

/// Returns a G-buffer of an engine: a wall 3 units away that faces the camera, normals as bytes in world space.
VulkanGBuffer wall(Engine& engine) {
  VulkanGBuffer g;
  g.width = kWidth;
  g.height = kHeight;
  g.depth = {engine.image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT, VK_IMAGE_LAYOUT_GENERAL,
             VK_IMAGE_LAYOUT_GENERAL};
  engine.clear(g.depth.image, {3.0f, 0, 0, 0}, false);
  g.depth_kind = DepthKind::kPlanar;
  g.normal = {engine.image(VK_FORMAT_R8G8B8A8_UNORM), VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_LAYOUT_GENERAL,
              VK_IMAGE_LAYOUT_GENERAL};
  engine.clear(g.normal.image, {1.0f, 0.5f, 0.5f, 0}, false);  // along +x in world space, the direction of the camera
  const float rotation[9] = {0, 0, 1, 0, 1, 0, 1, 0, 0};       // world x is view z
  std::copy_n(rotation, 9, g.view_from_normal);
  return g;
}

float first_texel(Engine& engine, const VulkanImage& image) {
  const auto device = make_vulkan_device_on(engine.foreign());
  auto frame = empty_frame(**device, picture());
  EXPECT_TRUE(
      read_image(**device, {image.image, image.format, image.layout_after, image.layout_after}, {}, {"v"}, *frame));
  return (*device)->download(*frame, {"v"})->planes[0].at(kWidth / 2, kHeight / 2);
}

TEST(VulkanShading, ShadesAnEnginesImages) {
  const test::NoMessages no_messages;
  auto engine = open_engine();
  UMBRAGE_NEEDS_VULKAN(engine);
  const VulkanGBuffer g = wall(*engine);
  VulkanShading shading;
  ASSERT_EQ(shading.open(engine->context()).code, 0);
  VulkanShadeRequest request;
  request.effects = {"normals", "bitmask", "outline"};  // the last one also runs on the host
  request.settings = {"bitmask.radius=50%"};
  request.outputs = {
      {{"ao"}, {engine->image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT}},
      {{"normal.z", "depth"}, {engine->image(VK_FORMAT_R32G32B32A32_SFLOAT), VK_FORMAT_R32G32B32A32_SFLOAT}},
      {{"outline"}, {engine->image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT}}};
  // A chain of semaphores: each picture waits for the previous one.
  VkSemaphore semaphores[2];
  const VkSemaphoreCreateInfo create{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  for (VkSemaphore& s : semaphores)
    engine->function<PFN_vkCreateSemaphore>("vkCreateSemaphore")(engine->gpu->device, &create, nullptr, &s);
  std::uint64_t after_two = 0;
  for (int k = 0; k < 6; ++k) {
    request.wait = k > 0 ? semaphores[(k + 1) % 2] : VK_NULL_HANDLE;
    request.signal = k < 5 ? semaphores[k % 2] : VK_NULL_HANDLE;
    const Outcome shaded = shading.shade(g, request);
    ASSERT_EQ(shaded.code, 0) << shaded.message;
    if (k == 1) after_two = shading.device_bytes();
  }
  ASSERT_EQ(shading.finish().code, 0);
  EXPECT_GT(after_two, 0u);
  EXPECT_EQ(shading.device_bytes(), after_two);
  EXPECT_NEAR(first_texel(*engine, request.outputs[0].image), 1.0f, 0.02f);  // a wall is unoccluded
  EXPECT_NEAR(first_texel(*engine, request.outputs[1].image), 1.0f, 1e-3f);
  EXPECT_EQ(first_texel(*engine, request.outputs[2].image), 0.0f);
  for (const VkSemaphore s : semaphores)
    engine->function<PFN_vkDestroySemaphore>("vkDestroySemaphore")(engine->gpu->device, s, nullptr);
}

TEST(VulkanShading, RotatesNormals) {
  const test::NoMessages no_messages;
  auto engine = open_engine();
  UMBRAGE_NEEDS_VULKAN(engine);
  VulkanGBuffer g = wall(*engine);
  VulkanShading shading;
  ASSERT_EQ(shading.open(engine->context()).code, 0);
  VulkanShadeRequest request;
  request.outputs = {{{"normal.z"}, {engine->image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT}}};
  ASSERT_EQ(shading.shade(g, request).code, 0);
  EXPECT_NEAR(first_texel(*engine, request.outputs[0].image), 1.0f, 0.005f);
  g.view_from_normal[6] = -1.0f;
  ASSERT_EQ(shading.shade(g, request).code, 0);
  EXPECT_NEAR(first_texel(*engine, request.outputs[0].image), -1.0f, 0.005f);
}

TEST(VulkanShading, ReportsErrors) {
  const test::NoMessages no_messages;
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  auto engine = open_engine(test::faulty_get);
  UMBRAGE_NEEDS_VULKAN(engine);
  VulkanShading shading;
  EXPECT_EQ(shading.shade({}, {}).code, 2);
  EXPECT_EQ(shading.open({}).code, 2);
  ASSERT_EQ(shading.open(engine->context(test::faulty_get)).code, 0);
  const VulkanGBuffer good = wall(*engine);
  VulkanShadeRequest request;
  request.effects = {"sphere"};
  request.outputs = {{{"ao"}, {engine->image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT}}};
  const auto refused = [&](const VulkanGBuffer& g, const VulkanShadeRequest& r, int code, const std::string& text) {
    const Outcome outcome = shading.shade(g, r);
    EXPECT_EQ(outcome.code, code) << outcome.message;
    EXPECT_NE(outcome.message.find(text), std::string::npos) << outcome.message;
  };
  test::faulty().faults.memory_left = 0;
  refused(good, request, 4, "memory");
  test::faulty().faults = {};
  VulkanGBuffer g = good;
  g.width = 0;
  refused(g, request, 2, "0 pixels");
  g = good;
  g.depth.format = VK_FORMAT_R8_UNORM;
  refused(g, request, 2, "R32_SFLOAT");
  g = good;
  g.depth_kind = DepthKind::kWindow;
  g.near_plane = 5.0f;
  g.far_plane = 1.0f;
  refused(g, request, 2, "near_plane");
  VulkanShadeRequest r = request;
  r.effects = {"spher"};
  refused(good, r, 2, "did you mean 'sphere'");
  r = request;
  r.settings = {"sphere.samples=0"};
  refused(good, r, 2, "samples");
  r = request;
  r.outputs[0].planes = {"nothing"};
  refused(good, r, 2, "'nothing'");
  injected_fault = [] { check_equal(2, 3, "injected"); };
  refused(good, request, 1, "internal error: injected: 2 != 3");
  injected_fault = [] { throw std::bad_alloc(); };
  refused(good, request, 4, "not enough memory for a G-buffer of");
  injected_fault = nullptr;
  EXPECT_EQ(shading.shade(good, request).code, 0);  // later calls work
  EXPECT_EQ(shading.finish().code, 0);
  test::faulty().faults.submit = VK_ERROR_DEVICE_LOST;
  refused(good, request, 4, "lost");
  test::faulty().faults = {};
  refused(good, request, 4, "lost");  // permanently
  EXPECT_EQ(shading.finish().code, 4);
}

TEST(FrameRenderer, DrawsFramesLikeRender) {
  RenderRequest request = {
      .model = "scene:solids?detail=3000", .look = "ao", .width = 64, .height = 48, .device = "cpu"};
  Picture alone;
  ASSERT_EQ(render(request, alone).code, 0);
  for (const char* device : {"cpu", "vulkan"}) {
    request.device = device;
    FrameRenderer renderer;
    Picture picture;
    EXPECT_EQ(renderer.draw({}, picture).code, 2);
    const Outcome opened = renderer.open(request);
    if (opened.code == 4 && test::may_lack_vulkan()) continue;
    ASSERT_EQ(opened.code, 0) << opened.message;
    EXPECT_EQ(renderer.device().rfind(device, 0), 0u);
    FrameCamera camera;
    unsigned long long after_two = 0;
    for (int k = 0; k < 8; ++k) {
      camera.placed = k % 2 == 1;
      camera.eye[0] = 7.0f;
      camera.eye[2] = 3.0f;
      ASSERT_EQ(renderer.draw(camera, picture).code, 0);
      ASSERT_EQ(picture.rgba.size(), alone.rgba.size());
      long far = 0;
      for (std::size_t i = 0; i < alone.rgba.size(); ++i)
        far += std::fabs(picture.rgba[i] - alone.rgba[i]) > 2.0f / 255;
      if (camera.placed)
        EXPECT_GT(far, 1000) << device;
      else
        EXPECT_LE(far, long(alone.rgba.size()) / 500) << device;
      if (k == 1) after_two = renderer.device_bytes();
    }
    EXPECT_EQ(renderer.device_bytes(), after_two);
    EXPECT_EQ(after_two > 0, std::string(device) == "vulkan");
    camera.placed = true;
    camera.angle_deg = 0.0f;
    EXPECT_EQ(renderer.draw(camera, picture).code, 2);
    EXPECT_EQ(renderer.open({.model = "missing.obj", .device = device}).code, 3);
    EXPECT_EQ(renderer.draw({}, picture).code, 0);  // the open scene remains
  }
  FrameRenderer renderer;
  request.device = "vulcan";
  EXPECT_EQ(renderer.open(request).code, 2);
}

}  // namespace
}  // namespace umbrage
