// Random sequences of calls of the C interface with random arguments (tests/fuzz/calls.h) for a few seeds, and tests of
// the defects that such calls have found.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fuzz/calls.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

std::string bytes_of(unsigned seed) {
  constexpr std::size_t kBytes = 2048;
  std::mt19937 random(seed);
  std::string bytes(kBytes, '\0');
  for (char& byte : bytes) byte = char(random());
  return bytes;
}

TEST(AnyCalls, ObeyTheContractOfTheHeader) {
  fuzz::CallCounts all;
  for (unsigned seed = 1; seed <= 60; ++seed) all += fuzz::make_calls(bytes_of(seed));
  EXPECT_GT(all.calls, 2000);
  EXPECT_GT(all.failed, 1000);
  EXPECT_GT(all.executed, 30);
  EXPECT_GT(all.cancelled, 15);
}

TEST(AnyCalls, ObeyTheContractInThreads) {
  fuzz::CallCounts all;
  for (unsigned seed = 1; seed <= 3; ++seed) all += fuzz::make_calls_in_threads(bytes_of(seed), 3);
  EXPECT_GT(all.executed, 5);
}

/// A device, a scene, and a job that draws it.
struct Picture {
  UmbDevice device = umbNewDevice("cpu", 2);
  UmbScene scene = umbNewScene(device);
  UmbJob job = umbNewRenderJob(device, scene);

  Picture() {
    umbLoadModel(scene, "scene:solids?detail=1000");
    for (const char* side : {"width", "height"}) umbSetJobInt(job, side, 24);
  }
  ~Picture() {
    umbReleaseJob(job);
    umbReleaseScene(scene);
    umbReleaseDevice(device);
  }
  std::string error() const {
    const char* message = "";
    umbGetJobError(job, &message);
    return message;
  }
  std::string scene_error() const {
    const char* message = "";
    umbGetSceneError(scene, &message);
    return message;
  }
  /// Executes the job and calls `act` at the first report of progress.
  UmbError execute(std::function<void()> act) {
    umbSetJobProgressCallback(job, once, &act);
    const UmbError code = umbExecuteJob(job);
    umbSetJobProgressCallback(job, nullptr, nullptr);
    EXPECT_FALSE(act) << "no progress was reported";
    return code;
  }

 private:
  static bool once(void* user, double) {
    if (const auto act = std::exchange(*static_cast<std::function<void()>*>(user), nullptr)) act();
    return true;
  }
};

/// Expects the error of an object in use. The error is stored with the thread, since the errors of the object belong to
/// the call that uses it.
void expect_in_use(UmbError code) {
  EXPECT_EQ(code, UMB_ERROR_USAGE);
  const char* message = "";
  EXPECT_EQ(umbGetError(&message), UMB_ERROR_USAGE);
  EXPECT_NE(std::string(message).find("in use"), std::string::npos) << message;
}

TEST(AnyCalls, CallbacksCannotUseObjectsInUse) {
  Picture p, other;
  std::vector<float> pixels(24 * 24 * 4), small(4);
  const UmbImage image{pixels.data(), UMB_TYPE_FLOAT32, 24, 24, 4, 0, 0, 0};
  ASSERT_EQ(umbSetJobOutput(p.job, "color", &image), UMB_ERROR_NONE);
  const auto act = [&] {
    // If this output were accepted, the picture would be written to an image that is too small.
    const UmbImage wrong{small.data(), UMB_TYPE_FLOAT32, 1, 1, 4, 0, 0, 0};
    expect_in_use(umbSetJobOutput(p.job, "color", &wrong));
    expect_in_use(umbSetJobInt(p.job, "width", 8));
    expect_in_use(umbSetJobProgressCallback(p.job, nullptr, nullptr));
    expect_in_use(umbExecuteJob(p.job));
    expect_in_use(umbLoadModel(p.scene, "scene:solids?detail=1000"));
    EXPECT_EQ(umbAddMesh(p.scene, "mesh", 1, 0), -1);
    expect_in_use(UMB_ERROR_USAGE);
    double box[6];
    EXPECT_EQ(umbGetSceneBounds(p.scene, box, box + 3), UMB_ERROR_NONE) << "reads are allowed meanwhile";
    EXPECT_GE(umbGetJobCounter(p.job, "hierarchies_built"), 0);
    EXPECT_EQ(umbGetJobOutputName(p.job, 0), nullptr);
    // Otherwise two devices could wait for each other.
    EXPECT_EQ(umbExecuteJob(other.job), UMB_ERROR_USAGE);
    EXPECT_NE(other.error().find("a callback cannot execute"), std::string::npos);
    EXPECT_EQ(umbPrepareJob(other.job), UMB_ERROR_USAGE);
    other.error();
    EXPECT_EQ(umbSetJobInt(other.job, "width", 8), UMB_ERROR_NONE) << other.error();
    umbRetainJob(p.job);
    umbReleaseJob(p.job);
  };
  EXPECT_EQ(p.execute(act), UMB_ERROR_NONE) << p.error();
  EXPECT_EQ(umbSetJobInt(p.job, "width", 24), UMB_ERROR_NONE) << "afterwards";
  EXPECT_EQ(umbExecuteJob(other.job), UMB_ERROR_NONE) << other.error();
}

TEST(AnyCalls, AJobMayBeReleasedWhileItExecutes) {
  Picture p;
  EXPECT_EQ(p.execute([&] { umbReleaseJob(p.job); }), UMB_ERROR_NONE);
  EXPECT_EQ(umbExecuteJob(p.job), UMB_ERROR_USAGE);
  EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_USAGE);
}

TEST(AnyCalls, ThreadsCannotUseAnObjectBeingChanged) {
  Picture p;
  EXPECT_EQ(p.execute([&] {
    std::thread([&] {
      expect_in_use(umbSetJobInt(p.job, "width", 8));
      expect_in_use(umbExecuteJob(p.job));
      expect_in_use(umbCheckJob(p.job));
    }).join();
  }),
            UMB_ERROR_NONE);
  EXPECT_EQ(p.error(), "") << "refused calls of others are not errors of the job";
}

TEST(AnyCalls, AChangeWaitsForReads) {
  Picture p;
  ASSERT_EQ(umbExecuteJob(p.job), UMB_ERROR_NONE) << p.error();
  std::atomic<bool> is_done = false;
  std::thread reader([&] {
    UmbImage image{};
    while (!is_done) umbGetJobOutput(p.job, "color", &image);
  });
  for (int k = 0; k < 2000; ++k) EXPECT_EQ(umbSetJobInt(p.job, "width", 8 + k % 8), UMB_ERROR_NONE);
  is_done = true;
  reader.join();
}

TEST(AnyCalls, ReleasedObjectsAreFreed) {
  const auto kilobytes = [] {  // resident memory of the process
    ::malloc_trim(0);
    long pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * (::sysconf(_SC_PAGESIZE) / 1024);
  };
  UmbDevice device = umbNewDevice("cpu", 2);
  UmbScene scene = umbNewScene(device);
  ASSERT_EQ(umbLoadModel(scene, "scene:solids?detail=300000"), UMB_ERROR_NONE);
  const UmbJob job = umbNewRenderJob(device, scene);
  for (const char* side : {"width", "height"}) umbSetJobInt(job, side, 24);
  ASSERT_EQ(umbPrepareJob(job), UMB_ERROR_NONE);
  const long before = kilobytes();
  umbReleaseJob(job);  // frees its copy of the scene and the acceleration structure
  EXPECT_LT(kilobytes(), before - 20000);
  umbReleaseScene(scene);
  umbReleaseDevice(device);
}

TEST(AnyCalls, AMeshIsRemoved) {
  Picture p;
  double before[6], box[6];
  ASSERT_EQ(umbGetSceneBounds(p.scene, before, before + 3), UMB_ERROR_NONE);
  const int mesh = umbAddMesh(p.scene, "far", 1, 0);
  const float far[3] = {1000, 0, 0};
  ASSERT_EQ(umbSetMeshBuffer(p.scene, mesh, "position", far, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetSceneBounds(p.scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_GT(box[3], 900.0f);
  EXPECT_EQ(umbRemoveMesh(p.scene, mesh), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetSceneBounds(p.scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_TRUE(std::equal(box, box + 6, before));
  EXPECT_EQ(umbRemoveMesh(p.scene, mesh), UMB_ERROR_USAGE);
  EXPECT_NE(p.scene_error().find("was removed"), std::string::npos);
  EXPECT_EQ(umbAddMesh(p.scene, "next", 1, 0), mesh + 1);
}

TEST(AnyCalls, SeveralDevicesMayDrawASceneAtOnce) {
  Picture p, other;
  const UmbJob job = umbNewRenderJob(other.device, p.scene);
  for (const char* side : {"width", "height"}) umbSetJobInt(job, side, 24);
  UmbError code = UMB_ERROR_INTERNAL;
  EXPECT_EQ(p.execute([&] { std::thread([&] { code = umbExecuteJob(job); }).join(); }), UMB_ERROR_NONE) << p.error();
  EXPECT_EQ(code, UMB_ERROR_NONE);
  umbReleaseJob(job);
}

TEST(AnyCalls, ErrorCallbacksAreNotCalledForTheirOwnErrors) {
  Picture p;
  struct CallbackData {
    UmbJob job;
    int count = 0;
  } data{p.job};
  umbSetDeviceErrorCallback(
      p.device,
      [](void* user, UmbError, const char*) {
        auto& h = *static_cast<CallbackData*>(user);
        ++h.count;
        EXPECT_EQ(umbSetJobInt(h.job, "widht", 1), UMB_ERROR_USAGE);
      },
      &data);
  EXPECT_EQ(umbSetJobInt(p.job, "heihgt", 1), UMB_ERROR_USAGE);
  EXPECT_EQ(umbSetJobInt(p.job, "heihgt", 1), UMB_ERROR_USAGE);
  EXPECT_EQ(data.count, 2);
}

TEST(AnyCalls, MeshCountsAloneTakeNoMemory) {
  Picture p;
  constexpr std::size_t kMax = (std::size_t(1) << 31) - 1;
  EXPECT_GE(umbAddMesh(p.scene, "huge", kMax, kMax), 0) << p.scene_error();
  double box[6];
  EXPECT_EQ(umbGetSceneBounds(p.scene, box, box + 3), UMB_ERROR_NONE) << "of the complete meshes";
  const UmbScene lone = umbNewScene(p.device);
  EXPECT_EQ(umbAddMesh(lone, "huge", kMax, kMax), 0);
  EXPECT_EQ(umbGetSceneBounds(lone, box, box + 3), UMB_ERROR_USAGE);
  const char* message = "";
  umbGetSceneError(lone, &message);
  EXPECT_NE(std::string(message).find("lacks its positions"), std::string::npos) << message;
  umbReleaseScene(lone);
}

TEST(AnyCalls, ATextureWithoutPixelsIsAnError) {
  Picture p;
  const int mesh = umbAddMesh(p.scene, "mesh", 3, 1);
  const UmbImage none{nullptr, UMB_TYPE_UINT8, 4, 4, 4, 0, 0, 0};
  EXPECT_EQ(umbSetMeshTexture(p.scene, mesh, "albedo", &none), UMB_ERROR_USAGE);
  EXPECT_NE(p.scene_error().find("no pixels"), std::string::npos);
}

TEST(AnyCalls, PointsHaveTheGivenRadii) {
  const UmbDevice device = umbNewDevice("cpu", 1);
  const UmbScene scene = umbNewScene(device);
  const int mesh = umbAddMesh(scene, "points", 3, 0);
  const float at[9] = {0, 0, 0, 10, 0, 0, 0, 10, 0}, radii[3] = {1, 2, 3}, wrong[3] = {5, 5, -1};
  ASSERT_EQ(umbSetMeshBuffer(scene, mesh, "position", at, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  ASSERT_EQ(umbSetMeshBuffer(scene, mesh, "radius", radii, UMB_TYPE_FLOAT32, 1, 0), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetMeshBuffer(scene, mesh, "radius", wrong, UMB_TYPE_FLOAT32, 1, 0), UMB_ERROR_USAGE);
  const float twice[12] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0};
  double box[6];
  ASSERT_EQ(umbGetSceneBounds(scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_EQ(std::vector<float>(box, box + 6), (std::vector<float>{-3, -2, -3, 12, 13, 3}));
  ASSERT_EQ(umbAddMeshInstance(scene, mesh, twice), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetSceneBounds(scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_EQ(std::vector<float>(box, box + 6), (std::vector<float>{-6, -4, -6, 24, 26, 6}));
  umbReleaseScene(scene);
  umbReleaseDevice(device);
}

TEST(AnyCalls, BoundsContainOnlyWhatIsDrawn) {
  const UmbDevice device = umbNewDevice("cpu", 1);
  const UmbScene scene = umbNewScene(device);
  // A triangle, a triangle without area, a triangle that is not finite, and a vertex that no triangle uses.
  const float at[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}, {8, 8, 8}, {NAN, 0, 0}, {7, 7, 7}, {-7, 0, 0}};
  const std::uint8_t corners[9] = {0, 1, 2, 3, 4, 3, 5, 0, 1};
  const int mesh = umbAddMesh(scene, "mesh", 8, 3);
  ASSERT_EQ(umbSetMeshBuffer(scene, mesh, "position", at, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  double box[6];
  EXPECT_EQ(umbGetSceneBounds(scene, box, box + 3), UMB_ERROR_USAGE) << "no indices";
  ASSERT_EQ(umbSetMeshBuffer(scene, mesh, "index", corners, UMB_TYPE_UINT8, 3, 0), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetSceneBounds(scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_EQ(std::vector<float>(box, box + 6), (std::vector<float>{0, 0, 0, 1, 1, 0}));
  const float places[2][12] = {{-1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 50, 0, 0, 0, 50, 0, 0, 0, 50}};
  for (const auto& place : places) ASSERT_EQ(umbAddMeshInstance(scene, mesh, place), UMB_ERROR_NONE);
  ASSERT_EQ(umbGetSceneBounds(scene, box, box + 3), UMB_ERROR_NONE);
  EXPECT_EQ(std::vector<float>(box, box + 6), (std::vector<float>{4, 0, 0, 5, 1, 0})) << "flat ones are not drawn";
  umbReleaseScene(scene);
  umbReleaseDevice(device);
}

TEST(AnyCalls, AnOutputRequestedTwiceIsProducedOnce) {
  Picture p;
  const UmbImage own{};
  for (const char* pass : {"all", "color"}) ASSERT_EQ(umbSetJobOutput(p.job, pass, &own), UMB_ERROR_NONE);
  ASSERT_EQ(umbExecuteJob(p.job), UMB_ERROR_NONE) << p.error();
  int colors = 0, k = 0;
  for (const char* name = nullptr; (name = umbGetJobOutputName(p.job, k)); ++k) colors += std::string(name) == "color";
  EXPECT_EQ(colors, 1);
  EXPECT_GT(k, 3);
}

TEST(AnyCalls, TooLargeIdsMeanNoObject) {
  Picture p;
  const UmbJob job = umbNewShadeJob(p.device);
  std::vector<float> depth(16, 2.0f), ids(16, 1e30f);
  ids[0] = 3.0f;
  std::vector<std::uint32_t> out(16);
  const UmbImage depths{depth.data(), UMB_TYPE_FLOAT32, 4, 4, 1, 0, 0, 0};
  const UmbImage given{ids.data(), UMB_TYPE_FLOAT32, 4, 4, 1, 0, 0, 0};
  const UmbImage wanted{out.data(), UMB_TYPE_UINT32, 4, 4, 1, 0, 0, 0};
  ASSERT_EQ(umbSetJobImage(job, "depth", &depths), UMB_ERROR_NONE);
  ASSERT_EQ(umbSetJobImage(job, "object_id", &given), UMB_ERROR_NONE);
  ASSERT_EQ(umbSetJobOutput(job, "object_id", &wanted), UMB_ERROR_NONE);
  EXPECT_EQ(umbExecuteJob(job), UMB_ERROR_NONE);
  EXPECT_EQ(out[0], 3u);
  EXPECT_EQ(out[1], ~0u);
  umbReleaseJob(job);
}

TEST(AnyCalls, OnlyListedCountersExist) {
  Picture p;
  for (const char* name : {"hierarchies_built", "captures_made", "planes_copied"})
    EXPECT_EQ(umbGetJobCounter(p.job, name), 0) << name;
  EXPECT_EQ(umbGetJobCounter(p.job, "devices_opened"), -1);
  EXPECT_EQ(umbGetJobCounter(p.job, nullptr), -1);
}

}  // namespace
}  // namespace umbrage
