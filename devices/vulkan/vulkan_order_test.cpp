// The order of memory accesses on the GPU: the model of memory_order.h finds what is not in order, and all work of the
// Vulkan device is in order.
#include <cstddef>
#include <utility>
#include <vector>

#include "devices/vulkan/commands.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/pipelines.h"
#include "faulty_vulkan.h"
#include "memory_order.h"
#include "renderer/models.h"
#include "run_effect.h"
#include "scene/framing.h"
#include "support.h"
#include "vulkan_recorder.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

using test::MemoryOrder;

constexpr VkPipelineStageFlags kKernels = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                               kCopies = VK_PIPELINE_STAGE_TRANSFER_BIT,
                               kFragments = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                               kVertices = VK_PIPELINE_STAGE_VERTEX_SHADER_BIT;
constexpr VkAccessFlags kWritten = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                        kUsed = kWritten | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;

/// A model whose reports are counted.
struct Counted {
  int reports = 0;
  MemoryOrder order{[this](const std::string&) { ++reports; }};
  Counted() = default;
  Counted(const Counted&) = delete;

  void full_barrier() { order.barrier(kKernels | kCopies, kKernels | kCopies, kWritten, kUsed); }
  /// Returns the number of reports since the last call.
  int taken() { return std::exchange(reports, 0); }
};

TEST(MemoryOrder, KernelsNeedABarrierBetweenThem) {
  Counted c;
  c.order.kernel();
  EXPECT_EQ(c.taken(), 0);
  c.full_barrier();
  c.order.kernel();
  EXPECT_EQ(c.taken(), 0);
  c.order.kernel();
  EXPECT_EQ(c.taken(), 2);  // reads after writes, writes after writes
  c.order.begin();
  c.order.kernel();
  EXPECT_EQ(c.taken(), 0);
}

TEST(MemoryOrder, BarriersMustNameStagesAndAccesses) {
  struct Case {
    VkPipelineStageFlags from, to;
    VkAccessFlags available, visible;
    int reports;
  };
  // A copy to the host's memory after a kernel: it reads what was written.
  for (const Case& k :
       {Case{kKernels, kCopies, kWritten, kUsed, 0}, Case{kCopies, kCopies, kWritten, kUsed, 1},
        Case{kKernels, kKernels, kWritten, kUsed, 1}, Case{kKernels, kCopies, VK_ACCESS_TRANSFER_WRITE_BIT, kUsed, 1},
        Case{kKernels, kCopies, kWritten, kWritten, 1}, Case{kKernels, kCopies, 0, 0, 1}}) {
    Counted c;
    c.order.kernel();
    c.order.barrier(k.from, k.to, k.available, k.visible);
    c.order.copy(true, false);
    EXPECT_EQ(c.taken(), k.reports) << k.from << ' ' << k.to << ' ' << k.available << ' ' << k.visible;
  }
  // The host is none of the stages of commands.
  for (const auto& [to, reports] :
       {std::pair(VK_PIPELINE_STAGE_HOST_BIT, 0), std::pair(VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 1)}) {
    Counted c;
    c.order.copy(false, true);
    c.order.barrier(kCopies, to, VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_HOST_READ_BIT);
    c.order.submit();
    EXPECT_EQ(c.taken(), reports) << to;
  }
  // A copy over what a draw has read: order is enough.
  for (const auto& [from, reports] : {std::pair(kFragments, 0), std::pair(kVertices, 1), std::pair(kKernels, 2)}) {
    Counted c;
    c.order.draw();
    c.order.barrier(from, kCopies, 0, 0);
    c.order.copy(false, true);
    EXPECT_EQ(c.taken(), reports) << from;
  }
}

TEST(MemoryOrder, BarriersChain) {
  Counted c;
  c.order.kernel();
  c.order.barrier(kKernels, kCopies, kWritten, kUsed);
  c.order.barrier(kCopies, kVertices, 0, VK_ACCESS_SHADER_READ_BIT);
  c.order.draw();
  EXPECT_EQ(c.taken(), 1);  // fragment shaders come later, but the kernel's writes are visible to vertex shaders alone
  c.order.copy(true, true);
  EXPECT_EQ(c.taken(), 2);  // writes after both reads of the draw
  c.order.begin();
  c.order.copy(true, true);
  c.order.copy(true, true);  // left to the validation layer
  EXPECT_EQ(c.taken(), 0);
  c.order.submit();
  EXPECT_EQ(c.taken(), 1);
  c.order.begin();
  c.order.copy(true, true);
  c.order.barrier(kCopies, VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_HOST_READ_BIT);
  c.order.submit();
  EXPECT_EQ(c.taken(), 0);
}

/// Collects the reports of test::checked_get during its lifetime.
struct Reports {
  std::vector<std::string> texts;
  std::function<void(const std::string&)> before = test::memory_order_report();
  Reports() {
    test::memory_order_report() = [this](const std::string& text) { texts.push_back(text); };
  }
  ~Reports() { test::memory_order_report() = before; }
};

TEST(Vulkan, KernelsThatAreNotInOrderAreReported) {
  const auto instance = make_instance(test::checked_get, {});
  UMBRAGE_NEEDS_VULKAN(instance);
  const auto [gpu, memory, commands] = test::open_recorder(*instance);
  ASSERT_TRUE(commands);
  const auto pipelines = Pipelines::make(gpu, commands->uniform_buffer(), {});
  ASSERT_TRUE(pipelines);
  const auto pick = (*pipelines)->pick();
  ASSERT_TRUE(pick);
  const auto from = memory->plane(1024), to = memory->plane(1024);
  ASSERT_TRUE(from && to);
  const auto buffer = commands->buffer();
  ASSERT_TRUE(buffer);
  const auto run_kernel = [&] {
    const PickConstants constants{(*from)->address, (*to)->address, 8, 8, 8, 8, 8, 8, 1};
    gpu->vk.CmdBindPipeline(*buffer, VK_PIPELINE_BIND_POINT_COMPUTE, *pick);
    gpu->vk.CmdPushConstants(*buffer, (*pipelines)->pick_layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                             offsetof(PickConstants, factor) + sizeof(int), &constants);
    gpu->vk.CmdDispatch(*buffer, 1, 1, 1);
  };
  Reports reports;
  gpu->vk.CmdFillBuffer(*buffer, (*from)->buffer, (*from)->offset, 1024, 1);
  commands->barrier();
  run_kernel();
  EXPECT_EQ(reports.texts, std::vector<std::string>());
  run_kernel();
  ASSERT_EQ(reports.texts.size(), 2u);
  EXPECT_EQ(reports.texts[0],
            "no barrier orders the reads of a kernel (command 3) after the writes of a kernel (command 2)");
  gpu->vk.CmdFillBuffer(*buffer, (*from)->buffer, (*from)->offset, 1024, 2);
  EXPECT_EQ(reports.texts.size(), 4u);
  EXPECT_TRUE(commands->finish());
  EXPECT_EQ(reports.texts.size(), 4u);  // finish() makes copies visible to the host
}

TEST(VulkanOrder, OneSubmissionOfAllKindsOfWorkIsInOrder) {
  // Everything is recorded before anything is submitted, so that each step follows those before it.
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu = test::new_vulkan_device({.max_submission_ms = 0.0, .get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const auto run = [&](std::string_view name, Frame& frame) {
    const Effect& effect = *find_effect(name);
    EXPECT_TRUE(gpu->run(effect, initial_parameters(effect.parameters, effect.params_size), frame)) << name;
  };
  const GBuffer gbuffer = test::bumpy_gbuffer(64, 48, 5);
  auto frame = gpu->upload(gbuffer);
  ASSERT_TRUE(frame);
  run("lighting", *frame);
  run("hemisphere", *frame);
  Image ao(64, 48);
  ao.names = {"ao"};
  ao.planes = {Plane(64, 48, 1.0f)};
  ASSERT_TRUE(gpu->add(ao, *frame));  // copies over what a kernel has written
  run("composite", *frame);
  {
    Frame branch = gpu->branch(*frame);
    run("denoise", branch);  // copies the plane that it shares
  }
  auto small = gpu->reduced(*frame, 2, {"depth", "normal.x", "normal.y", "normal.z", "ao"});
  ASSERT_TRUE(small);
  ASSERT_TRUE(gpu->add_planes_of(*small, {"ao"}, *frame));
  frame = gpu->upload(gbuffer);  // copies after kernels
  ASSERT_TRUE(frame);
  run("composite", *frame);  // fills a plane with a neutral value
  EXPECT_EQ(test::faulty().faults.submits, 0);
  ASSERT_TRUE(gpu->finish());
  EXPECT_EQ(test::faulty().faults.submits, 1);
}

TEST(VulkanOrder, ASceneMayBeReplacedBeforeItsCaptureIsDone) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu =
      test::new_vulkan_device({.capture = VulkanCapture::kRaster, .max_submission_ms = 0.0, .get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const auto scene = load_scene("scene:solids?detail=2000");
  ASSERT_TRUE(scene);
  CaptureSettings settings;
  settings.width = 64;
  settings.height = 48;
  settings.layers = 2;
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(gpu->prepare(*scene));
    const int before = test::faulty().faults.submits;
    const auto frame = gpu->capture(frame_scene(*scene, {}, 64, 48), settings);
    ASSERT_TRUE(frame);
    EXPECT_EQ(test::faulty().faults.submits, before);
    EXPECT_TRUE(gpu->prepare(*scene));  // reads of the capture come before the new scene is copied
  }
  ASSERT_TRUE(gpu->finish());
}

}  // namespace
}  // namespace umbrage
