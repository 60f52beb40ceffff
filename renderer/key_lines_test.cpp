// Lines between key frames: they stay on surfaces, and frames do not depend on the order of drawing.
#include "renderer/key_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "core/gbuffer.h"
#include "core/pixel_grid.h"
#include "devices/cpu/cpu_device.h"
#include "renderer/models.h"
#include "renderer/times.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kSide = 224;
const std::vector<std::string> kPlanes = {"color.r", "outline", "depth"};

struct Picture {
  Image image;
  PictureInfo info;
};

/// A turn of a scene by half a degree from frame to frame.
class Turn {
 public:
  explicit Turn(int count = 720)
      : count_(count), device_(make_cpu_device({})), scene_(*load_scene("scene:solids?detail=2000")) {
    Request request;
    request.look = "hatching";
    request.width = request.height = kSide;
    request.anti_aliasing = 1;
    request.settings = {"outline.opacity=0", "hatching.spacing=4", "hatching.width=1"};
    auto recipe = *make_recipe(request);
    EXPECT_TRUE(complete_scene(scene_, recipe));
    EXPECT_TRUE(device_->prepare(scene_));
    first_ = *make_plan(recipe, scene_, device_->threads());
  }

  Plan plan(int frame) const { return turned(first_, scene_, 0.5f * float(frame)); }
  KeyLines lines() const {
    return {*device_, [this](int frame) { return plan(frame); }, count_, true};
  }
  /// A camera that moves to the side, so that the first and the last of the frames do not show what is in the middle.
  Plan plan_sideways(int frame, int count) const {
    constexpr float kWay = 40.0f;  // scene units
    Plan moved = first_;
    const glm::vec3 way{kWay * (float(frame) / float(count - 1) - 0.5f), 0.0f, 0.0f};
    moved.camera.view_from_world = glm::translate(glm::mat4(1.0f), way) * first_.camera.view_from_world;
    return moved;
  }
  KeyLines sideways(int count) const {
    return {*device_, [this, count](int frame) { return plan_sideways(frame, count); }, count, false};
  }
  Picture drawn_sideways(int frame, int count, KeyLines* lines) const {
    return drawn(plan_sideways(frame, count), frame, lines);
  }
  Picture drawn(int frame, KeyLines* lines) const { return drawn(plan(frame), frame, lines); }
  Picture drawn(Plan of_frame, int frame, KeyLines* lines) const {
    StageTimes times;
    if (lines) {
      EXPECT_TRUE(lines->complete(frame, of_frame, times, {}));
    }
    auto picture = draw(*device_, scene_, of_frame, times, {});
    EXPECT_TRUE(picture);
    return {*device_->download(picture->frame, kPlanes), inner_info(picture->frame.info)};
  }

 private:
  const int count_;
  std::unique_ptr<Device> device_;
  Scene scene_;
  Plan first_;
};

bool equal(const Picture& a, const Picture& b) { return test::first_difference(a.image, b.image).empty(); }

/// Returns the root mean square of the change of lines from one frame to the next, over surfaces that both show.
double change_of(const Picture& from, const Picture& to) {
  const glm::dmat4 motion = from.info.camera.view_from_world * glm::inverse(to.info.camera.view_from_world);
  const PixelGrid grid(to.info.camera, kSide, kSide);
  const Plane &depth = to.image.plane("depth"), &before = from.image.plane("depth");
  double sum = 0.0;
  long count = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float z = depth.at(x, y);
      if (!std::isfinite(z)) continue;
      const glm::vec3 place = grid.place(glm::dvec3(motion * glm::dvec4(grid.point(x, y, z), 1.0)));
      const float u = place.x, v = place.y;
      if (!(u >= 0.0f && v >= 0.0f && u < float(kSide - 1) && v < float(kSide - 1))) continue;
      double value = 0.0;
      bool same = true;
      for (int k = 0; k < 4; ++k) {
        const int i = int(u) + k % 2, j = int(v) + k / 2;
        const float fx = u - std::floor(u), fy = v - std::floor(v);
        same &= std::fabs(before.at(i, j) - place.z) < 0.01f * z;
        value += (k % 2 ? fx : 1.0f - fx) * (k / 2 ? fy : 1.0f - fy) * from.image.plane("outline").at(i, j);
      }
      if (!same) continue;
      sum += std::pow(value - to.image.plane("outline").at(x, y), 2), ++count;
    }
  EXPECT_GT(count, 5000);
  return std::sqrt(sum / double(count));
}

/// Returns the mean ink of a block of the picture.
double ink_of(const Picture& picture, int left, int top, int side) {
  double sum = 0.0;
  for (int y = top; y < top + side; ++y)
    for (int x = left; x < left + side; ++x) sum += picture.image.plane("outline").at(x, y);
  return sum / double(side * side);
}

TEST(KeyLines, AFrameAloneEqualsThatOfTheRun) {
  const Turn turn;
  KeyLines run = turn.lines(), alone = turn.lines();
  std::optional<Picture> fifth;
  for (int frame = 0; frame < 14; ++frame) {
    Picture picture = turn.drawn(frame, &run);
    if (frame == 5) fifth = std::move(picture);
  }
  for (const int frame : {700, 14, 719, 5}) {
    const Picture again = turn.drawn(frame, &alone);
    if (frame == 5) {
      EXPECT_TRUE(equal(again, *fifth));
    }
  }
}

TEST(KeyLines, OneFrameIsASinglePicture) {
  const Turn turn(1), whole;
  KeyLines lines = turn.lines(), of_turn = whole.lines();
  EXPECT_TRUE(equal(turn.drawn(0, &lines), turn.drawn(0, nullptr)));
  EXPECT_FALSE(equal(whole.drawn(1, &of_turn), whole.drawn(1, nullptr)));
}

TEST(KeyLines, FramesThatKeyFramesDoNotShowHaveNewLines) {
  const Turn turn;
  constexpr int kFrames = 5;
  KeyLines lines = turn.sideways(kFrames);
  const Picture middle = turn.drawn_sideways(2, kFrames, &lines);
  EXPECT_TRUE(equal(middle, turn.drawn_sideways(2, kFrames, nullptr)));
}

TEST(KeyLines, LinesDoNotJumpAtKeyFrames) {
  const Turn turn;
  KeyLines lines = turn.lines();
  std::vector<double> changes;
  Picture before = turn.drawn(11, &lines);
  for (int frame = 12; frame < 20; ++frame) {  // frame 16 or 15 is a key frame
    Picture after = turn.drawn(frame, &lines);
    changes.push_back(change_of(before, after));
    before = std::move(after);
  }
  for (const double change : changes) EXPECT_LT(change, 1.15 * changes[0]);
}

TEST(KeyLines, LinesStayOnSurfaces) {
  const Turn turn;
  KeyLines lines = turn.lines();
  Picture before = turn.drawn(4, &lines), single = turn.drawn(4, nullptr);
  double now = 0.0, then = 0.0;
  for (int frame = 5; frame < 8; ++frame) {
    Picture after = turn.drawn(frame, &lines), single_after = turn.drawn(frame, nullptr);
    now += change_of(before, after), then += change_of(single, single_after);
    // The tone is that of a single picture.
    for (int top = 32; top < kSide - 64; top += 32)
      for (int left = 32; left < kSide - 64; left += 32)
        EXPECT_NEAR(ink_of(after, left, top, 32), ink_of(single_after, left, top, 32), 0.04) << left << ", " << top;
    before = std::move(after), single = std::move(single_after);
  }
  RecordProperty("change", std::to_string(now / 3.0) + ", single pictures " + std::to_string(then / 3.0));
  EXPECT_LT(now, then / 3.0) << now << ", single " << then;
}

}  // namespace
}  // namespace umbrage
