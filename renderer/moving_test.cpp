// Moving scenes: what moves is found in the other frames, and it leaves no trail.
#include "renderer/moving.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_access.hpp>

#include "devices/cpu/cpu_device.h"
#include "renderer/models.h"
#include "renderer/times.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kSide = 160, kFrames = 14, kStep = 2;
const std::vector<std::string> kPlanes = {"ao", "depth", "object_id"};

/// Solids before a parallel camera, of which one moves by two pixels to the right from frame to frame.
class MovingSolid {
 public:
  explicit MovingSolid(const std::vector<std::string>& settings = {}) : device_(make_cpu_device({})) {
    Request request;
    request.look = "ao";
    request.width = request.height = kSide;
    request.anti_aliasing = 1;
    request.camera.orthographic = true;
    request.passes = kPlanes;
    request.settings = settings;
    recipe_ = *make_recipe(request);
    recipe_.is_steady = true;
  }

  SteadySequence sequence(int reach) {
    SteadyFrames frames = frames_of_moving_scene(*device_, recipe_, reach, [this](int frame) { return moved(frame); });
    frames.count = kFrames;
    return {*device_, std::move(frames)};
  }
  Image drawn(SteadySequence& sequence, int frame) {
    StageTimes times;
    const auto picture = sequence.draw(frame, times, {}, {}, {});
    EXPECT_TRUE(picture) << picture.error().message;
    return *device_->download(picture->frame, kPlanes);
  }
  Image drawn(int reach, int frame) {
    SteadySequence one = sequence(reach);
    return drawn(one, frame);
  }
  /// Returns the object id of the solid that moves.
  static int solid() { return load_scene(kScene)->meshes[kMoving].object; }

 private:
  static constexpr const char* kScene = "scene:solids?detail=2000";
  static constexpr int kMoving = 3;

  Result<MovingFrame> moved(int frame) const {
    Scene scene = *load_scene(kScene);
    EXPECT_TRUE(complete_scene(scene, recipe_));
    auto plan = make_plan(recipe_, scene, device_->threads());
    if (!plan) return plan.error();
    const float pixel = (plan->camera.right - plan->camera.left) / float(kSide);
    const glm::vec3 right = glm::row(plan->camera.view_from_world, 0);
    for (glm::vec3& position : scene.meshes[kMoving].positions)
      position += right * (pixel * float(kStep * (frame - kFrames / 2)));
    return MovingFrame{std::make_shared<const Scene>(std::move(scene)), std::move(*plan)};
  }

  std::unique_ptr<Device> device_;
  Recipe recipe_;
};

bool is_solid(const Image& image, int x, int y) {
  static const float id = float(MovingSolid::solid());
  return image.plane("object_id").at(x, y) == id;
}

TEST(MovingScene, AFrameAloneEqualsThatOfTheRun) {
  MovingSolid solid;
  SteadySequence run = solid.sequence(2);
  Image fifth;
  for (int frame = 3; frame < 7; ++frame) fifth = solid.drawn(run, frame);
  EXPECT_EQ(test::first_difference(solid.drawn(2, 6), fifth), "");
}

TEST(MovingScene, WhatMovesFlickersLess) {
  MovingSolid solid;
  const auto change = [&](int reach) {
    SteadySequence sequence = solid.sequence(reach);
    const Image first = solid.drawn(sequence, 6), second = solid.drawn(sequence, 7);
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x + kStep < kSide; ++x) {
        if (!is_solid(first, x, y) || !is_solid(second, x + kStep, y)) continue;
        sum += std::pow(first.plane("ao").at(x, y) - second.plane("ao").at(x + kStep, y), 2.0);
        ++count;
      }
    EXPECT_GT(count, 200);
    return std::sqrt(sum / count);
  };
  const double single = change(0), steady = change(3);
  EXPECT_LT(steady, 0.6 * single) << steady << ", single " << single;
}

TEST(MovingScene, LeavesNoTrail) {
  MovingSolid solid, truth({"traced.rays=64", "traced.max_rays=64"});
  const Image before = solid.drawn(0, 6), now = truth.drawn(0, 7);
  const auto error = [&](const Image& made) {
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (!is_solid(before, x, y) || is_solid(now, x, y)) continue;  // what comes out behind the solid
        sum += std::pow(made.plane("ao").at(x, y) - now.plane("ao").at(x, y), 2.0);
        ++count;
      }
    EXPECT_GT(count, 30);
    return std::sqrt(sum / count);
  };
  const double single = error(solid.drawn(0, 7)), steady = error(solid.drawn(3, 7));
  EXPECT_LT(steady, 1.1 * single) << steady << ", single " << single;
}

}  // namespace
}  // namespace umbrage
