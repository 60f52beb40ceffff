// Dispatches that compute whole planes on the host: they work in the same way on every device, and run once for a
// picture in strips.
#include "kernel/host_frame.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <stdexcept>

#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "scene/framing.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr float kScale = 2.0f;
std::atomic<int> calls = 0, threads = 0;
std::atomic<bool> fails = false;

/// Writes twice the depth of the opposite pixel, plus the value of a missing plane.
void turn(const HostFrame& frame) {
  ++calls;
  threads = tbb::this_task_arena::max_concurrency();
  const int width = frame.frame.width, height = frame.frame.height;
  EXPECT_EQ(width, frame.info.width);
  const HostPlane &depth = frame.input("depth"), &albedo = frame.input("albedo.r"), &ao = frame.output("ao");
  EXPECT_EQ(depth.stride, frame.frame.stride);
  EXPECT_EQ(ao.stride, frame.frame.stride);
  EXPECT_THROW(frame.input("ao"), std::logic_error);
  EXPECT_THROW(frame.output("depth"), std::logic_error);
  tbb::parallel_for(0, height, [&](int y) {
    if (fails) throw std::out_of_range("a step that fails");
    for (int x = 0; x < width; ++x)
      ao.row(y)[x] =
          *static_cast<const float*>(frame.constants) * depth.row(height - 1 - y)[width - 1 - x] + albedo.row(y)[x];
  });
}

/// Writes the value of the pixel to the right, to the plane from which it reads.
void move(const HostFrame& frame) {
  ++calls;
  const HostPlane &from = frame.input("ao"), &to = frame.output("ao");
  for (int y = 0; y < frame.frame.height; ++y)
    for (int x = 0; x < frame.frame.width; ++x) to.row(y)[x] = from.row(y)[std::min(x + 1, frame.frame.width - 1)];
}

const Effect& turned() {
  static const Effect effect = {
      .name = "turned",
      .constants_size = sizeof(float),
      .constants = [](const ParameterBytes&, const PictureInfo&, void* out) { *static_cast<float*>(out) = kScale; },
      .dispatches = {{.name = "turn", .inputs = {"depth", "albedo.r"}, .outputs = {"ao"}, .host = turn},
                     {.name = "move", .inputs = {"ao"}, .outputs = {"ao"}, .host = move}}};
  return effect;
}

float expected(const Plane& depth, const Plane* albedo, int x, int y) {
  x = std::min(x + 1, depth.width - 1);
  return kScale * depth.at(depth.width - 1 - x, depth.height - 1 - y) + (albedo ? albedo->at(x, y) : 0.8f);
}

/// Returns a picture of two layers with a guard band; the second lacks albedo.
GBuffer picture(int width, int height) {
  GBuffer g = test::bumpy_gbuffer(width, height, 5);
  g.layers.emplace_back(width, height).add("depth") = test::bumpy_gbuffer(width, height, 6).layers[0].plane("depth");
  g.info.more_layers.resize(1);
  g.info.guard = width > 20 ? 7 : 0;
  return g;
}

void expect_turned(Device& device, int width, int height) {
  const GBuffer g = picture(width, height);
  auto frame = *device.upload(g);
  for (const int layer : {0, 1}) {
    ASSERT_TRUE(device.run(turned(), {}, frame, {.layer = layer}));
    const Image made = *device.download(frame, {layer_plane(layer, "ao")});
    const Plane &ao = made.planes[0], &depth = g.layers[std::size_t(layer)].plane("depth");
    const int guard = g.info.guard;
    for (int y = 0; y < ao.height; ++y)
      for (int x = 0; x < ao.width; ++x)
        ASSERT_EQ(ao.at(x, y), expected(depth, g.layers[std::size_t(layer)].find("albedo.r"), x + guard, y + guard))
            << layer << ": " << x << ", " << y;
  }
}

constexpr std::pair<int, int> kSizes[] = {{1, 1}, {5, 3}, {131, 77}};

TEST(HostStep, DoesNotDependOnThreads) {
  for (const auto& [width, height] : kSizes)
    for (const bool scalar : {false, true})
      for (const int count : {1, 2}) {
        const auto device = make_cpu_device({.threads = count, .scalar = scalar});
        expect_turned(*device, width, height);
        EXPECT_EQ(threads, device->threads());
      }
}

TEST(Vulkan, RunsHostSteps) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  for (const auto& [width, height] : kSizes) expect_turned(*device, width, height);
}

/// Checks that an exception of a step is passed on, and that later steps work.
void expect_failure_reported(Device& device) {
  const GBuffer g = picture(33, 20);
  auto frame = *device.upload(g);
  fails = true;
  EXPECT_THROW((void)device.run(turned(), {}, frame), std::out_of_range);
  fails = false;
  const auto ended = device.run(turned(), {}, frame, {}, [](double) { return false; });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kInterrupted);
  expect_turned(device, 33, 20);
}

TEST(HostStep, MayFail) { expect_failure_reported(*make_cpu_device({.threads = 2})); }

TEST(Vulkan, HostStepsMayFail) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  expect_failure_reported(*device);
}

TEST(HostStep, RunsOnceForAllStrips) {
  constexpr int kWidth = 60, kHeight = 83, kRows = 16;
  Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const Camera camera = frame_scene(scene, {}, kWidth, kHeight);
  const auto device = make_cpu_device({.threads = 2});
  ASSERT_TRUE(device->prepare(scene));
  auto whole = *device->capture(camera, {.width = kWidth, .height = kHeight});
  ASSERT_TRUE(device->run(turned(), {}, whole));
  const Plane ao = device->download(whole, {"ao"})->planes[0];

  const auto wholes = std::make_shared<WholePlanes>();
  calls = 0;
  int sweeps = 0, rows = 0;
  for (bool finished = false; !finished; ++sweeps) {
    finished = true;
    for (int first = 0; first < kHeight; first += kRows) {
      const Strip strip{{first, std::min(first + kRows, kHeight)}, 0, wholes};
      auto frame = *device->capture(camera, {.width = kWidth, .height = kHeight, .strip = strip});
      const auto state = device->run(turned(), {}, frame);
      ASSERT_TRUE(state);
      finished = finished && state->finished;
      if (!state->finished) continue;
      const Plane part = device->download(frame, {"ao"})->planes[0];
      for (int y = 0; y < part.height; ++y, ++rows)
        for (int x = 0; x < kWidth; ++x) ASSERT_EQ(part.at(x, y), ao.at(x, first + y)) << x << ", " << first + y;
    }
    for (auto& [key, entry] : wholes->planes) entry.complete = true;
  }
  EXPECT_EQ(sweeps, 2);
  EXPECT_EQ(rows, kHeight);
  EXPECT_EQ(calls, 2) << "a step each";
}

}  // namespace
}  // namespace umbrage
