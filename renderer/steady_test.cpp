// Steady sequences: frames do not depend on the order of drawing, and what a camera that moves shows does not flicker.
#include "renderer/steady.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "devices/cpu/cpu_device.h"
#include "renderer/models.h"
#include "renderer/times.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kSide = 192;
const std::vector<std::string> kColor = {"color.r", "color.g", "color.b"};
const std::vector<std::string> kPlanes = {"color.r", "color.g", "color.b", "depth"};

/// A scene before a parallel camera that moves by one pixel to the right from frame to frame.
class Pan {
 public:
  Pan(const std::string& model, const std::string& look, std::vector<std::string> planes = kPlanes)
      : device_(make_cpu_device({})), scene_(*load_scene(model)), planes_(std::move(planes)) {
    Request request;
    request.look = look;
    request.width = request.height = kSide;
    request.camera.orthographic = true;
    request.anti_aliasing = 1;
    request.passes = {"shadow", "depth"};
    auto recipe = *make_recipe(request);
    recipe.is_steady = true;
    EXPECT_TRUE(complete_scene(scene_, recipe));
    EXPECT_TRUE(device_->prepare(scene_));
    plan_ = *make_plan(recipe, scene_, device_->threads());
  }

  SteadyFrames frames(int reach) const {
    SteadyFrames frames = frames_of_still_scene(*device_, scene_, [this](int frame) {
      Plan plan = plan_;
      const float step = (plan.camera.right - plan.camera.left) / float(kSide);
      plan.camera.view_from_world =
          glm::translate(glm::mat4(1.0f), {-step * float(frame), 0.0f, 0.0f}) * plan.camera.view_from_world;
      plan.first_noise += frame;
      plan.first_shadow_sample += frame;
      return plan;
    });
    frames.reach = reach;
    frames.count = 12;
    return frames;
  }

  Image drawn(SteadySequence& sequence, int frame) {
    StageTimes times;
    const auto picture = sequence.draw(frame, times, {}, {}, {});
    EXPECT_TRUE(picture) << picture.error().message;
    return *device_->download(picture->frame, planes_);
  }

  SteadySequence sequence(int reach) { return {*device_, frames(reach)}; }

 private:
  std::unique_ptr<Device> device_;
  Scene scene_;
  const std::vector<std::string> planes_;
  Plan plan_;
};

/// Returns whether a pixel and those around it show one surface.
bool is_open(const Plane& depth, int x, int y) {
  for (const auto& [i, j] : {std::pair(-3, 0), {3, 0}, {0, -3}, {0, 3}}) {
    const int column = std::clamp(x + i, 0, kSide - 1), row = std::clamp(y + j, 0, kSide - 1);
    if (!(std::fabs(depth.at(column, row) - depth.at(x, y)) < 0.02f * depth.at(x, y))) return false;
  }
  return true;
}

/// Returns the 99th percentile of the differences of two frames of a pan, of 255, in open parts of the surfaces that
/// both show.
double change_of(const Image& first, const Image& second, const std::vector<std::string>& planes = kColor) {
  std::vector<double> changes;
  for (int y = 0; y < kSide; ++y)
    for (int x = 1; x < kSide; ++x) {
      const float depth = first.plane("depth").at(x, y), there = second.plane("depth").at(x - 1, y);
      if (!std::isfinite(depth) || std::fabs(depth - there) > 1e-3f * depth) continue;
      if (!is_open(first.plane("depth"), x, y)) continue;
      for (const std::string& name : planes)
        changes.push_back(255.0 * std::fabs(first.plane(name).at(x, y) - second.plane(name).at(x - 1, y)));
    }
  EXPECT_GT(changes.size(), 1000u);
  const auto place = changes.begin() + long(changes.size() * 99 / 100);
  std::nth_element(changes.begin(), place, changes.end());
  return *place;
}

TEST(SteadySequence, AFrameAloneEqualsThatOfTheRun) {
  Pan pan("scene:solids?detail=2000", "studio");
  SteadySequence run = pan.sequence(2), alone = pan.sequence(2);
  Image fifth;
  for (int frame = 0; frame < 6; ++frame) fifth = pan.drawn(run, frame);
  for (const int frame : {11, 0, 5}) {
    const Image again = pan.drawn(alone, frame);
    if (frame == 5) {
      EXPECT_EQ(test::first_difference(again, fifth), "");
    }
  }
}

TEST(SteadySequence, SoftShadowsOfStillLightsFlickerLess) {
  Pan pan("scene:solids?detail=2000", "studio", {"shadow", "depth"});
  SteadySequence single = pan.sequence(0), steady = pan.sequence(3);
  const std::vector<std::string> shadow = {"shadow"};
  const double before = change_of(pan.drawn(single, 5), pan.drawn(single, 6), shadow);
  const double now = change_of(pan.drawn(steady, 5), pan.drawn(steady, 6), shadow);
  EXPECT_LE(now, 0.4 * before) << now << ", before " << before;
  EXPECT_GT(before, 1.0);
}

TEST(SteadySequence, APanFlickersLess) {
  Pan pan("scene:solids?detail=2000", "ao");
  SteadySequence single = pan.sequence(0), steady = pan.sequence(3);
  const double before = change_of(pan.drawn(single, 5), pan.drawn(single, 6));
  const double now = change_of(pan.drawn(steady, 5), pan.drawn(steady, 6));
  EXPECT_LE(now, 0.25 * before) << now << ", before " << before;
}

}  // namespace
}  // namespace umbrage
