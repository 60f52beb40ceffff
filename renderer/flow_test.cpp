// Flow: found by vectors of one or both directions, composed over several frames, and not through what covers a
// surface.
#include "renderer/flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace umbrage {
namespace {

constexpr int kWidth = 80, kHeight = 48, kSpeed = 4, kSide = 16;
constexpr float kWall = 5.0f;

bool is_object(int x, int y, int frame) {
  const int left = 10 + kSpeed * frame;
  return x >= left && x < left + kSide && y >= 16 && y < 16 + kSide;
}

/// A square of depth `object` that moves to the right before a still wall. `directions`: those that it has vectors of.
FlowFrame frame_of(int frame, const std::string& directions, float object = 4.0f) {
  FlowFrame out{{}, Plane(kWidth, kHeight, kWall), Image(kWidth, kHeight)};
  for (const std::string name : {"before", "after"}) {
    if (directions.find(name) == std::string::npos) continue;
    Plane& motion = out.motion.add(name + ".x") = Plane(kWidth, kHeight, 0.0f);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (is_object(x, y, frame)) motion.at(x, y) = name == "after" ? float(kSpeed) : -float(kSpeed);
    out.motion.add(name + ".y") = Plane(kWidth, kHeight, 0.0f);
  }
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (is_object(x, y, frame)) out.depth.at(x, y) = object;
  return out;
}

/// Checks the flow of the square and the wall over `frames` frames.
void expect_right(const Flow& flow, int frame, int frames, float object) {
  int found = 0;
  for (int y = 2; y < kHeight - 2; ++y)
    for (int x = 2; x < kWidth - 2; ++x) {
      const bool own = is_object(x, y, frame);
      const bool covered = !own && is_object(x, y, frame + frames);
      const float there = flow.x.at(x, y);
      if (covered) {
        EXPECT_TRUE(std::isnan(there)) << x << ' ' << y << " leads to what covers it, at " << there;
        continue;
      }
      if (std::isnan(there)) continue;
      ++found;
      EXPECT_NEAR(there, float(x + (own ? kSpeed * frames : 0)), 1e-3f) << x << ' ' << y;
      EXPECT_NEAR(flow.y.at(x, y), float(y), 1e-3f);
      EXPECT_NEAR(flow.z.at(x, y), own ? object : kWall, 1e-3f);
    }
  EXPECT_GT(found, (kWidth - 4) * (kHeight - 4) * 9 / 10) << frame << " by " << frames;
}

TEST(Flow, LeadsNeitherToNorThroughWhatCovers) {
  for (const float object : {4.0f, 4.9f})  // the second differs from the wall by less than depths of one surface may
    for (const char* directions : {"before after", "before", "after"}) {
      SCOPED_TRACE(directions);
      std::vector<FlowFrame> frames;
      for (int k = 0; k < 6; ++k) frames.push_back(frame_of(k, directions, object));
      for (const int way : {1, -1}) {
        const int start = way > 0 ? 1 : 4;
        std::optional<Flow> flow;
        for (int step = 1; step <= 3; ++step) {
          const FlowFrame& last = frames[std::size_t(start + way * (step - 1))];
          const auto link = flow_between(last, frames[std::size_t(start + way * step)], way > 0);
          ASSERT_TRUE(link);
          flow = flow ? composed(*flow, *link, last.depth) : *link;
          expect_right(*flow, start, way * step, object);
        }
      }
    }
}

TEST(Flow, UnknownMotionLeadsNowhere) {
  FlowFrame here = frame_of(1, "before after"), next = frame_of(2, "before after");
  here.motion.plane("after.x").at(60, 5) = std::numeric_limits<float>::quiet_NaN();
  const auto flow = flow_between(here, next, true);
  EXPECT_TRUE(std::isnan(flow->x.at(60, 5)));
  EXPECT_EQ(flow->x.at(62, 5), 62.0f);
  EXPECT_FALSE(flow_between(frame_of(1, ""), frame_of(2, ""), true)) << "there are no vectors";
}

TEST(Flow, CamerasLeadToStillSurfacesAndTheirDepth) {
  FlowFrame here = frame_of(1, ""), there = here;
  EXPECT_FALSE(camera_flow(here, there));
  here.camera = there.camera = Camera();
  const float pixel = (here.camera->right - here.camera->left) / float(kWidth);
  // The camera moves by two pixels of the wall to the right, and forward by a tenth of its distance.
  there.camera->view_from_world = glm::translate(glm::mat4(1.0f), {-2.0f * pixel * kWall, 0.0f, 0.1f * kWall});
  const auto flow = camera_flow(here, there);
  ASSERT_TRUE(flow);
  EXPECT_NEAR(flow->z.at(40, 5), 0.9f * kWall, 1e-5f);
  EXPECT_NEAR(flow->x.at(40, 5) - 39.5f, (40 - 39.5f - 2.0f) / 0.9f, 1e-4f);
}

TEST(Flow, ACutIsFoundByDepth) {
  const FlowFrame here = frame_of(1, "before after"), next = frame_of(2, "before after");
  FlowFrame other = next;
  other.depth = Plane(kWidth, kHeight, 2.0f * kWall);
  EXPECT_FALSE(is_cut(*flow_between(here, next, true), here.depth, next.depth));
  EXPECT_TRUE(is_cut(*flow_between(here, other, true), here.depth, other.depth));
}

}  // namespace
}  // namespace umbrage
