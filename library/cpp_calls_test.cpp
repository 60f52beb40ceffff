// Tests of interactions in the C++ interface: threads that use one object, errors that were not read, persistent
// callbacks, handles of the C interface, and sequences of frames.
#include "umbrage/umbrage.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "vulkan_support.h"

namespace {

const std::string kSolids = "scene:solids?detail=1000";

umb::Job small_job(const umb::Device& device) {
  umb::Scene scene(device);
  scene.load(kSolids);
  umb::Job job(device, scene);
  job.set("look", "ao");
  job.set("width", 24);
  job.set("height", 16);
  return job;
}

/// Returns the error that the call throws; code 0: none.
template <class Call>
umb::Outcome thrown(const Call& call) {
  try {
    call();
  } catch (const umb::Error& error) {
    return {int(error.code), error.what(), {}};
  }
  return {};
}

bool count_calls(void* user, double) {
  ++*static_cast<int*>(user);
  return true;
}

constexpr std::chrono::seconds kMaxWait(20);  // max time for which a thread waits for another

// A second thread uses the job when the first thread's call ends, so that the callback of the first cannot be removed.
struct TwoThreads {
  umb::Device device{"cpu", 1};
  umb::Job job = small_job(device);
  std::thread second;
  std::promise<void> executing, may_end;
  std::atomic<bool> is_executing = false;

  // Log callback: the second thread warns of a setting without effect, and waits.
  static void warned(void* user, const char*) {
    auto* all = static_cast<TwoThreads*>(user);
    if (all->is_executing.exchange(true)) return;
    all->executing.set_value();
    all->may_end.get_future().wait_for(kMaxWait);
  }
  // Error callback: the first thread is at the end of its call, and starts the second one.
  static void failed(void* user, UmbError code, const char*) {
    auto* all = static_cast<TwoThreads*>(user);
    if (code != UMB_ERROR_CANCELLED) return;
    all->second = std::thread([all] { umbExecuteJob(all->job.get()); });
    all->executing.get_future().wait_for(kMaxWait);
  }
};

TEST(CppCalls, AProgressFunctionIsNotCalledAfterItsCall) {
  TwoThreads all;
  all.job.set("outline.width", 3);  // has no effect in the look ao
  int kept = 0;
  all.job.set_progress_callback(count_calls, &kept);
  all.device.set_log_callback(TwoThreads::warned, &all);
  all.device.set_error_callback(TwoThreads::failed, &all);
  const auto first = std::this_thread::get_id();
  std::atomic<int> foreign_calls = 0;
  {
    const umb::Progress once = [&](double) {
      const bool is_foreign = std::this_thread::get_id() != first;
      foreign_calls += is_foreign;
      return is_foreign;
    };
    EXPECT_EQ(thrown([&] { all.job.execute(once); }).code, UMB_ERROR_CANCELLED);
  }
  all.may_end.set_value();
  all.second.join();
  EXPECT_EQ(foreign_calls, 0) << "the second thread's work called the first thread's function";
  all.device.set_error_callback(nullptr);
  all.device.set_log_callback(nullptr);
  // The callback that was set before is called again.
  all.job.set("camera.azimuth_deg", 10);
  kept = 0;
  all.job.execute();
  EXPECT_EQ(foreign_calls, 0);
  EXPECT_GT(kept, 0);
}

TEST(CppCalls, ACallbackIsRestoredAfterACallWithItsOwn) {
  const umb::Device device("cpu", 1);
  umb::Job job = small_job(device);
  const umb::Job copy = job;
  int kept = 0, once = 0;
  const auto counts = [&](double) { return ++once, true; };
  job.set_progress_callback(count_calls, &kept);
  umb::Job(copy).execute(counts);  // a copy refers to the same object
  EXPECT_EQ(kept, 0);
  EXPECT_GT(once, 0);
  job.set("camera.azimuth_deg", 10);
  once = 0;
  job.execute();
  EXPECT_GT(kept, 0);
  EXPECT_EQ(once, 0);
  kept = 0;
  job.set("camera.azimuth_deg", 20);
  job.execute(umb::Progress());
  EXPECT_GT(kept, 0) << "an empty function is none";
  job.set_progress_callback(nullptr);
  kept = 0;
  job.set("camera.azimuth_deg", 30);
  job.execute();
  EXPECT_EQ(kept, 0);

  umb::Scene scene(device);
  scene.set_progress_callback(count_calls, &kept);
  scene.load(kSolids, counts);
  EXPECT_EQ(kept, 0);
  scene.load(kSolids);
  EXPECT_GT(kept, 0);
}

TEST(CppCalls, ACallThrowsOnlyItsOwnError) {
  const umb::Device device("cpu", 1);
  umb::Job job = small_job(device);
  const auto stale = [&] { EXPECT_EQ(umbSetJobString(job.get(), "lok", "ao"), UMB_ERROR_USAGE); };
  stale();
  const umb::Outcome ended = thrown([&] { job.execute([](double) { return false; }); });
  EXPECT_EQ(ended.code, UMB_ERROR_CANCELLED);
  EXPECT_EQ(ended.message.find("lok"), std::string::npos) << ended.message;
  EXPECT_FALSE(ended.message.empty());
  job.execute();

  // A call that was refused because the object is in use reports that.
  umb::Outcome refused;
  job.set("camera.azimuth_deg", 10);
  job.execute([&](double) {
    if (refused.code == 0) refused = thrown([&] { job.set("width", 8); });
    return true;
  });
  EXPECT_EQ(refused.code, UMB_ERROR_USAGE);
  EXPECT_NE(refused.message.find("another thread"), std::string::npos) << refused.message;
  EXPECT_EQ(job.error().code, UMB_ERROR_NONE);
  EXPECT_EQ(umb::thread_error().code, UMB_ERROR_NONE);

  umb::Scene scene(device);
  EXPECT_EQ(umbLoadModel(scene.get(), "missing.obj"), UMB_ERROR_FILE);
  EXPECT_EQ(thrown([&] { scene.set("uq", "+Z"); }).code, UMB_ERROR_USAGE);
}

TEST(CppCalls, HandlesOfTheCInterfaceAreAdopted) {
  const UmbDevice handle = umbNewDevice("cpu", 1);
  umbRetainDevice(handle);
  umb::Device device = umb::Device::adopt(handle);
  EXPECT_EQ(device.get(), handle);
  umb::Scene scene = umb::Scene::adopt(umbNewScene(handle));
  scene.load(kSolids);
  int reported = 0;
  {
    umb::Job job = umb::Job::adopt(umbNewRenderJob(handle, scene.get()));
    job.set("width", 8);
    job.set("height", 8);
    job.execute([&](double) { return ++reported, true; });
    EXPECT_EQ(job.output("color").width, 8);
    const UmbJob gone = job.get();
    job = {};
    EXPECT_EQ(umbCheckJob(gone), UMB_ERROR_USAGE) << "it had the only reference";
    umbGetError(nullptr);
  }
  EXPECT_GT(reported, 0);
  scene = {};
  device = {};
  EXPECT_NE(umbGetDeviceDescription(handle), nullptr) << "the caller's own reference";
  umbReleaseDevice(handle);
  EXPECT_EQ(umbGetDeviceDescription(handle), nullptr);
  EXPECT_FALSE(umb::Device::adopt(nullptr) || umb::Scene::adopt(nullptr) || umb::Job::adopt(nullptr));
}

TEST(CppCalls, FramesDoNotReadFilesAgain) {
  const std::string file = testing::TempDir() + "umbrage_frames.pfm";
  {
    const std::vector<float> sky(3 * 8 * 4, 0.5f);
    std::ofstream pfm(file, std::ios::binary);
    pfm << "PF\n8 4\n-1.0\n";
    pfm.write(reinterpret_cast<const char*>(sky.data()), std::streamsize(sky.size() * sizeof(float)));
  }
  umb::RenderRequest request = {.model = kSolids, .look = "lit", .width = 24, .height = 16, .device = "cpu"};
  request.hdri_file = file;
  request.camera.azimuth_deg = 30.0f;
  umb::FrameRenderer renderer;
  const umb::Outcome opened = renderer.open(request);
  ASSERT_EQ(opened.code, 0) << opened.message;
  umb::Picture first, placed, again;
  ASSERT_EQ(renderer.draw({}, first).code, 0);
  std::filesystem::remove(file);
  umb::FrameCamera camera;
  camera.placed = true;
  camera.eye[0] = 6.0f, camera.eye[1] = 3.0f, camera.eye[2] = 6.0f;
  const umb::Outcome moved = renderer.draw(camera, placed);
  ASSERT_EQ(moved.code, 0) << moved.message;
  EXPECT_NE(placed.rgba, first.rgba);
  // An invalid camera has no lasting effect, and the request's own camera is restored.
  camera.up[1] = 0.0f;
  EXPECT_EQ(renderer.draw(camera, again).code, 2);
  ASSERT_EQ(renderer.draw({}, again).code, 0);
  EXPECT_EQ(again.rgba, first.rgba);
}

TEST(FrameRenderer, DrawsFramesLikeRender) {
  umb::RenderRequest request = {
      .model = "scene:solids?detail=3000", .look = "ao", .width = 64, .height = 48, .device = "cpu"};
  umb::Picture alone;
  ASSERT_EQ(umb::render(request, alone).code, 0);
  for (const char* device : {"cpu", "vulkan"}) {
    request.device = device;
    umb::FrameRenderer renderer;
    umb::Picture picture;
    EXPECT_EQ(renderer.draw({}, picture).code, 2);
    const umb::Outcome opened = renderer.open(request);
    if (opened.code == 4 && umbrage::test::may_lack_vulkan()) continue;
    ASSERT_EQ(opened.code, 0) << opened.message;
    EXPECT_EQ(renderer.device().rfind(device, 0), 0u);
    umb::FrameCamera camera;
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
  umb::FrameRenderer renderer;
  request.device = "vulcan";
  EXPECT_EQ(renderer.open(request).code, 2);
}

TEST(CppCalls, LargeIdsAreReturnedExactly) {
  // Floats cannot distinguish the first two.
  constexpr std::uint32_t kLow = 16777217, kNext = 16777218, kHigh = 4000000001;
  const std::vector<float> depth = {2, 2, 2, 2, 2, std::numeric_limits<float>::infinity()};
  const std::vector<std::uint32_t> ids = {kHigh, kHigh, kLow, kNext, kLow, kHigh};
  umb::ShadeRequest request;
  request.width = 3;
  request.height = 2;
  request.device = "cpu";
  request.effects = {"outline"};
  request.passes = {"object_id"};
  request.arrays = {{.name = "depth", .values = depth.data()}, {.name = "object_id", .ids = ids.data()}};
  umb::Picture picture;
  const umb::Outcome outcome = umb::shade(request, picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  ASSERT_EQ(picture.passes.size(), 1u);
  EXPECT_EQ(picture.passes[0].ids, (std::vector<std::uint32_t>{kHigh, kHigh, kLow, kNext, kLow, 0}));
  EXPECT_EQ(picture.passes[0].values, (std::vector<float>{3, 3, 1, 2, 1, 0})) << "0 is the first one: no surface";
}

}  // namespace
