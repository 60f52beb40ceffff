// Calls of the C interface in any order, with any arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

/// Makes calls. Pointers are null or to as much memory as their call may read.
class AnyCalls {
 public:
  explicit AnyCalls(unsigned seed) : random_(seed) { std::fill(std::begin(memory_), std::end(memory_), 1.5f); }
  ~AnyCalls() {
    for (UmbJob job : jobs_) umbReleaseJob(job);
    for (UmbScene scene : scenes_) umbReleaseScene(scene);
    for (UmbDevice device : devices_) umbReleaseDevice(device);
  }

  void call() {
    const UmbDevice device = one_of(devices_);
    const UmbScene scene = one_of(scenes_);
    const UmbJob job = one_of(jobs_);
    switch (below(20)) {
      case 0:
        devices_.push_back(
            umbNewDevice(one_of(std::vector<const char*>{"cpu", "gpu", "", nullptr}), int(below(4)) - 1));
        break;
      case 1:
        scenes_.push_back(umbNewScene(device));
        break;
      case 2: {
        jobs_.push_back(below(2) ? umbNewRenderJob(device, scene) : umbNewShadeJob(device));
        const UmbImage depth = {memory_, UMB_TYPE_FLOAT32, 24, 24, 1, 0, 0,
                                0};  // a start from which something can be made
        umbSetJobImage(jobs_.back(), "depth", &depth);
        umbSetJobInt(jobs_.back(), "width", 24);
        umbSetJobInt(jobs_.back(), "height", 24);
        break;
      }
      case 3:
        umbReleaseJob(job);  // its handle stays in the list
        break;
      case 4:
        if (below(4) == 0) umbReleaseScene(scene);
        break;
      case 5:
        umbLoadModel(scene,
                     one_of(std::vector<const char*>{"scene:solids?detail=1000", "scene:", "nothere.obj", nullptr}));
        break;
      case 6:
        meshes_ = std::max(meshes_, umbAddMesh(scene, word(), below(2) ? 8 : below(3), below(13)));
        break;
      case 7:
        umbSetMeshBuffer(scene, mesh(), word(), below(9) ? memory_ : nullptr, UmbType(below(7)), int(below(6)) - 1,
                         std::ptrdiff_t(below(3)) * 4);
        break;
      case 8:
        umbSetMeshFloats(scene, mesh(), word(), floats_, int(below(5)) - 1);
        break;
      case 9:
        umbAddMeshInstance(scene, mesh(), floats_);
        break;
      case 10:
        umbSetJobString(job, word(), one_of(words_));
        break;
      case 11:
        umbSetJobFloats(job, word(), floats_, int(below(12)) - 1);
        break;
      case 12:
        umbSetJobInt(job, below(2) ? "width" : "height", int(below(40)));
        break;
      case 13:
        umbSetJobImage(job, word(), image());
        break;
      case 14:
        umbSetJobOutput(job, word(), image());
        break;
      case 15:
        umbSetSceneParameter(scene, word(), one_of(words_));
        break;
      case 16:
        umbCheckJob(job);
        break;
      case 17: {
        UmbImage made{};
        umbGetJobOutput(job, word(), &made);
        break;
      }
      case 18:
        umbResetJobParameter(job, word());
        break;
      default:
        if (umbExecuteJob(jobs_.back()) == UMB_ERROR_NONE) ++executed;
        umbGetJobError(jobs_.back(), nullptr);
    }
  }

  int executed = 0;

 private:
  unsigned below(unsigned end) { return random_() % end; }
  template <class T>
  T one_of(const std::vector<T>& all) {
    return all.empty() ? T() : all[below(unsigned(all.size()))];
  }
  const char* word() { return one_of(words_); }
  int mesh() { return int(below(unsigned(meshes_ + 3))) - 1; }
  const UmbImage* image() {
    if (below(8) == 0) return nullptr;
    const int side = below(4) ? 24 : int(below(25));
    image_ = {
        below(6) ? memory_ : nullptr, int(below(7)), side, below(5) ? side : int(below(20)), int(below(5)), 0, 0, 0};
    if (below(4) == 0) image_.row_stride = std::ptrdiff_t(below(3)) * 128;
    return &image_;
  }

  std::minstd_rand random_;
  std::vector<UmbDevice> devices_ = {umbNewDevice("cpu", 1), nullptr};
  std::vector<UmbScene> scenes_ = {umbNewScene(devices_[0])};
  std::vector<UmbJob> jobs_ = {umbNewShadeJob(devices_[0]), umbNewRenderJob(devices_[0], scenes_[0])};
  const std::vector<const char*> words_ = {
      "depth",  "normal", "albedo", "color",  "ao",           "object_id",       "position",      "index",
      "uv",     "radius", "look",   "studio", "cartoon",      "effects",         "bitmask",       "bitmask,denoise",
      "output", "1",      "-1",     "nan",    "width",        "camera.zoom",     "bitmask.steps", "camera.view_up",
      "up",     "+Z",     "true",   "all",    "layer1.depth", "outline.opacity", "strokes",       "specular",
      "",       nullptr,  "window", "ray",    "depth_kind",   "view_from_normal"};
  int meshes_ = 0;
  float floats_[16] = {1, 0, 0, 0.5f, 0, 1, 0, -2, 0, 0, 1, NAN, 3, 1e30f, -1, 0};
  float memory_[4 * 128 * 25] = {};
  UmbImage image_{};
};

TEST(AnyCalls, Return) {
  int executed = 0;
  const char* count = std::getenv("UMBRAGE_ANY_CALLS");  // for hours of it
  for (int seed = 0; seed < (count ? std::atoi(count) : 30); ++seed) {
    auto calls = std::make_unique<AnyCalls>(unsigned(seed) + 1);
    for (int k = 0; k < 300; ++k) calls->call();
    executed += calls->executed;
  }
  EXPECT_GT(executed, 10);
}

}  // namespace
}  // namespace umbrage
