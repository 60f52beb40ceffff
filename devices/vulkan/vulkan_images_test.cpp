// Tests of a caller's Vulkan device, images and command buffers.
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

std::vector<float> texels(Engine& engine, const VulkanImage& image) {
  const auto device = make_vulkan_device_on(engine.foreign());
  auto frame = empty_frame(**device, picture());
  EXPECT_TRUE(
      read_image(**device, {image.image, image.format, image.layout_after, image.layout_after}, {}, {"v"}, *frame));
  const Plane plane = std::move((*device)->download(*frame, {"v"})->planes[0]);
  std::vector<float> all;
  for (int y = 0; y < kHeight; ++y) all.insert(all.end(), plane.row(y), plane.row(y) + kWidth);
  return all;
}

float middle_texel(Engine& engine, const VulkanImage& image) {
  return texels(engine, image)[std::size_t(kHeight / 2) * kWidth + kWidth / 2];
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
  EXPECT_NEAR(middle_texel(*engine, request.outputs[0].image), 1.0f, 0.02f);  // a wall is unoccluded
  EXPECT_NEAR(middle_texel(*engine, request.outputs[1].image), 1.0f, 1e-3f);
  EXPECT_EQ(middle_texel(*engine, request.outputs[2].image), 0.0f);
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
  EXPECT_NEAR(middle_texel(*engine, request.outputs[0].image), 1.0f, 0.005f);
  g.view_from_normal[6] = -1.0f;
  ASSERT_EQ(shading.shade(g, request).code, 0);
  EXPECT_NEAR(middle_texel(*engine, request.outputs[0].image), -1.0f, 0.005f);
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

/// Command buffers of an engine, one for each of two frames in flight.
struct InFlight {
  explicit InFlight(const Engine& engine) : memory(std::make_shared<Memory>(engine.gpu)) {
    for (auto& frame : frames) frame = std::move(*Commands::make(engine.gpu, memory));
  }

  std::shared_ptr<Memory> memory;
  std::unique_ptr<Commands> frames[2];
};

/// Fills the depth image of a G-buffer with hills.
void draw_hills(const Engine& engine, const VulkanGBuffer& g) {
  const auto device = make_vulkan_device_on(engine.foreign());
  auto frame = empty_frame(**device, picture());
  Image hills(kWidth, kHeight);
  Plane& depth = hills.add("depth") = Plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      depth.at(x, y) = 3.0f + 0.4f * std::sin(0.7f * float(x)) * std::cos(0.5f * float(y));
  ASSERT_TRUE((*device)->add(std::move(hills), *frame));
  ASSERT_TRUE(
      write_image(**device, *frame, {"depth"}, {g.depth.image, g.depth.format, g.depth.layout, g.depth.layout_after}));
  ASSERT_TRUE((*device)->finish());
}

VulkanShadeRequest occlusion_request(Engine& engine, const std::vector<std::string>& settings) {
  return {.effects = {"bitmask", "denoise"},
          .settings = settings,
          .outputs = {{{"ao"}, {engine.image(VK_FORMAT_R32_SFLOAT), VK_FORMAT_R32_SFLOAT}}}};
}

TEST(VulkanShading, RecordsIntoACallersCommandBuffers) {
  const test::NoMessages no_messages;
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  auto engine = open_engine(test::faulty_get);
  UMBRAGE_NEEDS_VULKAN(engine);
  VulkanGBuffer g = wall(*engine);
  g.normal = {};
  draw_hills(*engine, g);
  const VulkanShadeRequest requests[] = {occlusion_request(*engine, {"bitmask.radius=50%"}),
                                         occlusion_request(*engine, {"bitmask.radius=20%", "denoise.rounds=2"})};
  VulkanShading shading;
  ASSERT_EQ(shading.open(engine->context(test::faulty_get)).code, 0);
  std::vector<float> expected[2];
  const auto result = [&](int k) { return texels(*engine, requests[k].outputs[0].image); };
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(shading.shade(g, requests[k]).code, 0);
    ASSERT_EQ(shading.finish().code, 0);
    expected[k] = result(k);
    engine->clear(requests[k].outputs[0].image.image, {}, false);
  }
  EXPECT_NE(expected[0], expected[1]);
  EXPECT_EQ(shading.cost(0).dispatches, 0);

  const InFlight flight(*engine);
  const int submits = test::faulty().faults.submits;
  for (int k = 0; k < 2; ++k) {
    const Outcome recorded = shading.record(*flight.frames[k]->buffer(), k, g, requests[k]);
    ASSERT_EQ(recorded.code, 0) << recorded.message;
  }
  EXPECT_EQ(test::faulty().faults.submits, submits);
  // A picture for which the memory does not suffice must not take that of the recordings.
  test::faulty().faults.memory_left = 0;
  VulkanGBuffer large = g;
  large.width = large.height = 4096;
  EXPECT_EQ(shading.shade(large, requests[0]).code, 4);
  test::faulty().faults = {};
  for (const int k : {1, 0}) ASSERT_TRUE(flight.frames[k]->submit_without_waiting({}));  // in another order
  for (const int k : {1, 0}) ASSERT_TRUE(flight.frames[k]->finish());
  for (const int k : {1, 0}) EXPECT_EQ(result(k), expected[k]) << k;

  // Dispatches: two conversions of images, normals, bitmask, and two for each round of denoise.
  const UmbVulkanCost cost = shading.cost(0), other = shading.cost(1);
  EXPECT_EQ(cost.dispatches, 6);
  EXPECT_EQ(other.dispatches, 8);
  const std::uint64_t plane = 48 * kHeight * 4, image = kWidth * kHeight * 4;  // bytes; rows of planes are padded
  EXPECT_EQ(cost.bytes_written, 8 * plane + 3 * image) << "depth, normals, no mips, ao thrice";
  EXPECT_EQ(other.bytes_written - cost.bytes_written, 2 * plane);
  EXPECT_EQ(other.bytes_read - cost.bytes_read, 2 * 5 * plane) << "ao, depth and normal";
  EXPECT_GT(cost.milliseconds, 0.0);

  // Later frames take no more memory.
  const std::uint64_t bytes = shading.device_bytes();
  for (int frame = 0; frame < 10; ++frame) {
    ASSERT_TRUE(flight.frames[frame % 2]->finish());
    ASSERT_EQ(shading.record(*flight.frames[frame % 2]->buffer(), frame % 2, g, requests[1 - frame % 2]).code, 0);
    ASSERT_TRUE(flight.frames[frame % 2]->submit_without_waiting({}));
  }
  for (const int k : {1, 0}) ASSERT_TRUE(flight.frames[k]->finish());
  for (const int k : {1, 0}) EXPECT_EQ(result(k), expected[k]) << k;
  EXPECT_EQ(shading.device_bytes(), bytes);
}

TEST(VulkanShading, RefusesWhatCannotBeRecorded) {
  const test::NoMessages no_messages;
  auto engine = open_engine();
  UMBRAGE_NEEDS_VULKAN(engine);
  const VulkanGBuffer g = wall(*engine);
  VulkanShading shading;
  ASSERT_EQ(shading.open(engine->context()).code, 0);
  const InFlight flight(*engine);
  const auto refused = [&](const VulkanShadeRequest& request, int slot, const std::string& text) {
    const Outcome outcome = shading.record(*flight.frames[0]->buffer(), slot, g, request);
    EXPECT_EQ(outcome.code, 2) << outcome.message;
    EXPECT_NE(outcome.message.find(text), std::string::npos) << outcome.message;
  };
  VulkanShadeRequest request = occlusion_request(*engine, {});
  EXPECT_EQ(shading.record(VK_NULL_HANDLE, 0, g, request).code, 2);
  refused(request, UMB_VULKAN_SLOTS, "0 to 7, not 8");
  request.effects = {"bitmask", "outline"};
  refused(request, 0, "outline also runs on the host");
  request.effects = {"traced"};
  refused(request, 0, "traced traces rays");
  request.effects.assign(200, "bitmask");
  refused(request, 0, "a command buffer takes at most");
  request.effects = {"bitmask"};
  flight.frames[0]->drop();
  EXPECT_EQ(shading.record(*flight.frames[0]->buffer(), 0, g, request).code, 0);  // later calls work
  request.signal = VkSemaphore(std::uintptr_t(1));
  refused(request, 0, "semaphores");
}

}  // namespace
}  // namespace umbrage
