// Tests `steady`: where a surface point is found in another frame, and with which weights its values are joined.
#include "effects/steady/steady.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr int kWidth = 67, kHeight = 29;
constexpr float kDepth = 5.0f;

/// Returns a wall that faces the camera, with a plane `ao` of one value, and the same wall in a frame whose camera is
/// `pixels` pixels farther to the left, with a ramp of `other_ao` along its rows.
GBuffer two_frames(float pixels, float ao, float slope) {
  GBuffer g = empty_gbuffer(kWidth, kHeight);
  Image& image = g.layers[0];
  image.add("depth") = image.add("other_depth") = Plane(kWidth, kHeight, kDepth);
  for (const char* name : kNormal)
    for (const std::string start : {"", "other_"})
      image.add(start + name) = Plane(kWidth, kHeight, name == kNormal[2] ? 1.0f : 0.0f);
  image.add("ao") = Plane(kWidth, kHeight, ao);
  Plane& ramp = image.add("other_ao") = Plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ramp.at(x, y) = slope * float(x);
  const float spread = g.info.camera.projection == Projection::kOrthographic ? 1.0f : kDepth;
  g.info.other_camera = g.info.camera;
  g.info.other_camera->view_from_world =
      glm::translate(glm::mat4(1.0f), {pixels * g.info.pixel_width() * spread, 0.0f, 0.0f}) *
      g.info.camera.view_from_world;
  return g;
}

TEST(Steady, TakesTheMeanWithTheSamePointOfTheOtherFrame) {
  for (const float pixels : {0.0f, 3.0f, -7.25f}) {
    const GBuffer g = two_frames(pixels, 0.5f, 0.01f);
    on_every_target("steady", g, {}, [&](const Image& made) {
      for (int x = 0; x < kWidth; ++x) {
        const float there = float(x) + pixels;
        const bool is_seen = there >= 0.0f && there <= float(kWidth - 1);
        if (there > -1.0f && there < float(kWidth) && !is_seen) continue;  // between the border and the last pixel
        EXPECT_NEAR(made.plane("ao").at(x, 7), is_seen ? 0.5f * (0.5f + 0.01f * there) : 0.5f, 1e-4f) << x;
        EXPECT_NEAR(made.plane("steady_weight").at(x, 7), is_seen ? 2.0f : 1.0f, 1e-4f) << x;
      }
    });
  }
}

TEST(Steady, FurtherFramesCountAsTheFirstOne) {
  GBuffer g = two_frames(0.0f, 0.5f, 0.01f);
  g.layers[0].add("steady_weight") = Plane(kWidth, kHeight, 3.0f);
  on_every_target("steady", g, {{"begin", "off"}}, [&](const Image& made) {
    for (int x = 0; x < kWidth; ++x)
      EXPECT_NEAR(made.plane("ao").at(x, 7), 0.75f * 0.5f + 0.25f * 0.01f * float(x), 1e-4f) << x;
    EXPECT_NEAR(made.plane("steady_weight").at(9, 7), 4.0f, 1e-4f);
  });
}

TEST(Steady, WeighsByRays) {
  GBuffer g = two_frames(0.0f, 0.5f, 0.0f);
  g.layers[0].add("traced_confidence") = Plane(kWidth, kHeight, 0.75f);       // 3 rays
  g.layers[0].add("other_traced_confidence") = Plane(kWidth, kHeight, 0.5f);  // 1 ray
  on_every_target("steady", g, {{"weight", "rays"}}, [&](const Image& made) {
    EXPECT_NEAR(made.plane("ao").at(9, 7), 0.375f, 1e-4f);
    EXPECT_NEAR(made.plane("steady_weight").at(9, 7), 4.0f, 1e-3f);
  });
}

TEST(Steady, LeavesOutOtherSurfacesAndBackground) {
  for (const char* what : {"other_depth", "other_normal", "depth"}) {
    GBuffer g = two_frames(0.0f, 0.5f, 0.01f);
    Image& image = g.layers[0];
    if (what == std::string("other_depth")) image.plane(what) = Plane(kWidth, kHeight, kDepth * 1.2f);
    if (what == std::string("depth")) image.plane(what) = Plane(kWidth, kHeight, INFINITY);
    if (what == std::string("other_normal")) std::swap(image.plane("other_normal.x"), image.plane("other_normal.z"));
    on_every_target("steady", g, {}, [&](const Image& made) {
      for (int x = 0; x < kWidth; ++x) EXPECT_EQ(made.plane("ao").at(x, 7), 0.5f) << what << " " << x;
    });
  }
}

TEST(Steady, FindsPointsByThePlanesThere) {
  GBuffer g = two_frames(0.0f, 0.5f, 0.01f);
  g.layers[0].plane("other_ao") = Plane(kWidth, kHeight, 0.52f);
  const auto places = [&](float x, float y, float z) {
    const float values[] = {x, y, z};
    const char* const names[] = {"there.x", "there.y", "there.z"};
    for (int k = 0; k < 3; ++k) g.layers[0].add(names[k]) = Plane(kWidth, kHeight, values[k]);
  };
  const auto expect = [&](float ao) {
    on_every_target("steady", g, {{"motion", "planes"}},
                    [&](const Image& made) { EXPECT_NEAR(made.plane("ao").at(9, 7), ao, 1e-4f); });
  };
  places(30.0f, 12.0f, kDepth);
  expect(0.51f);
  g.layers[0].plane("other_ao") = Plane(kWidth, kHeight, 0.6f);  // more than noise
  expect(0.5f);
  g.layers[0].plane("other_ao") = Plane(kWidth, kHeight, 0.52f);
  places(30.0f, 12.0f, kDepth * 1.2f);  // hidden there
  expect(0.5f);
  places(30.0f, 12.0f, 0.0f);
  expect(0.5f);
  places(NAN, 12.0f, kDepth);
  expect(0.5f);
  places(float(kWidth), 12.0f, kDepth);  // outside
  expect(0.5f);
}

TEST(Steady, JoinsLightAlike) {
  GBuffer g = two_frames(0.0f, 0.5f, 0.0f);
  for (const char* name : kIndirect) {
    g.layers[0].add(name) = Plane(kWidth, kHeight, 1.0f);
    g.layers[0].add(std::string("other_") + name) = Plane(kWidth, kHeight, 4.0f);
  }
  on_every_target("steady", g, {{"light", "on"}}, [&](const Image& made) {
    EXPECT_NEAR(made.plane("indirect.g").at(9, 7), 2.5f, 1e-4f);
    EXPECT_NEAR(made.plane("ao").at(9, 7), 0.25f, 1e-4f);
  });
}

TEST(Steady, AConstantStaysBitwiseTheSame) {
  GBuffer g = two_frames(2.5f, 0.37f, 0.0f);
  g.layers[0].plane("other_ao") = Plane(kWidth, kHeight, 0.37f);
  on_every_target("steady", g, {}, [&](const Image& made) {
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(made.plane("ao").at(x, 7), 0.37f) << x;
  });
}

}  // namespace
}  // namespace umbrage
