// Tests `ground`: only the shadow remains of the ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

/// Returns a row of pixels of object 3, the ground; the first is of object 1. `open` is the light without occluders,
/// `arrives` the light of each pixel.
GBuffer row_of(const std::vector<float>& arrives, float open, int ground_object = 3) {
  GBuffer g = test::empty_gbuffer(int(arrives.size()), 1);
  g.info.ground_object = ground_object;
  Image& image = g.layers[0];
  for (const char* name : {"depth", "object_id", "material_id", "open_light", "lit.r", "lit.g", "lit.b"})
    image.add(name) = Plane(image.width, 1, 2.0f);
  for (int x = 0; x < image.width; ++x) {
    image.plane("object_id").at(x, 0) = x == 0 ? 1.0f : 3.0f;
    image.plane("open_light").at(x, 0) = open;
    for (const char* name : {"lit.r", "lit.g", "lit.b"}) image.plane(name).at(x, 0) = arrives[x];
  }
  return g;
}

TEST(Ground, CoverIsTheFractionOfMissingLight) {
  const std::vector<float> arrives = {0.3f, 0.0f, 0.4f, 0.8f, 1.6f};
  test::on_every_target("ground", row_of(arrives, 0.8f), {}, [&](const Image& image) {
    EXPECT_EQ(image.plane("shadow_catcher").at(0, 0), 0.0f) << "the model itself";
    EXPECT_EQ(image.plane("lit.g").at(0, 0), 0.3f);
    for (int x = 1; x < image.width; ++x) {
      EXPECT_NEAR(image.plane("shadow_catcher").at(x, 0), std::max(1.0 - arrives[x] / 0.8, 0.0), 1e-6) << x;
      EXPECT_EQ(image.plane("lit.g").at(x, 0), 0.0f);
    }
  });
  test::on_every_target("ground", row_of(arrives, 0.8f), {{"strength", "0.5"}}, [](const Image& image) {
    EXPECT_NEAR(image.plane("shadow_catcher").at(1, 0), 0.5, 1e-6);
    EXPECT_NEAR(image.plane("shadow_catcher").at(2, 0), 0.25, 1e-6);
  });
}

TEST(Ground, AboveStrengthOneTheShadowKeepsItsGradation) {
  const std::vector<float> arrives = {0.3f, 0.04f, 0.1f, 0.4f, 0.8f, 1.6f};
  for (const auto& [strength, text] : {std::pair{1.5, "1.5"}, {2.0, "2"}})
    test::on_every_target("ground", row_of(arrives, 0.8f), {{"strength", text}}, [&](const Image& image) {
      for (int x = 1; x < image.width; ++x) {
        const double light = std::min(arrives[x] / 0.8, 1.0);
        const double cover = (2.0 - strength) * (1.0 - light) + (strength - 1.0) * (1.0 - light * light);
        EXPECT_NEAR(image.plane("shadow_catcher").at(x, 0), cover, 1e-6) << strength << " " << x;
        EXPECT_LT(image.plane("shadow_catcher").at(x, 0), 1.0f);
      }
    });
}

TEST(Ground, OverAnyBackgroundViewersShowTheSameShade) {
  // A viewer that blends black by that alpha in display values gets the shadow in linear light, except near black,
  // where sRGB is linear.
  test::on_every_target("ground", row_of({0.3f, 0.4f, 0.2f}, 0.8f), {{"blend", "display"}}, [](const Image& image) {
    for (int x : {1, 2}) {
      const double arrives = x == 1 ? 0.5 : 0.25;
      EXPECT_NEAR(1.0 - image.plane("shadow_catcher").at(x, 0), 1.055 * std::pow(arrives, 1.0 / 2.4) - 0.055, 1e-4);
    }
  });
}

TEST(Ground, LightThatSurfacesSendIsLeftOut) {
  GBuffer g = row_of({0.3f, 0.6f}, 0.8f);
  for (const char* name : {"indirect.r", "indirect.g", "indirect.b"}) g.layers[0].add(name) = Plane(2, 1, 0.2f);
  test::on_every_target("ground", g, {},
                        [](const Image& image) { EXPECT_NEAR(image.plane("shadow_catcher").at(1, 0), 0.5, 1e-6); });
}

TEST(Ground, NothingChangesWithoutOne) {
  test::on_every_target("ground", row_of({0.3f, 0.2f}, 0.8f, -1), {}, [](const Image& image) {
    for (int x : {0, 1}) {
      EXPECT_EQ(image.plane("shadow_catcher").at(x, 0), 0.0f);
      EXPECT_EQ(image.plane("lit.r").at(x, 0), x == 0 ? 0.3f : 0.2f);
    }
  });
}

TEST(Ground, NoLightGivesNoShadow) {
  test::on_every_target("ground", row_of({0.3f, 0.0f}, 0.0f), {},
                        [](const Image& image) { EXPECT_EQ(image.plane("shadow_catcher").at(1, 0), 0.0f); });
}

TEST(Ground, ShadowFadesTowardsTheEdgeOfTheGround) {
  // A row of pixels at one depth, with the centre of the ground at the leftmost pixel. Half of the light arrives.
  GBuffer g = row_of(std::vector<float>(40, 0.4f), 0.8f);
  const float step = 2.0f * (g.info.camera.right - g.info.camera.left) / 40.0f;  // at depth 2
  g.info.ground_center = {2.0f * g.info.camera.left + 0.5f * step, 0.0f, -2.0f};
  g.info.ground_fade_distance = 30.0f * step;
  test::on_every_target("ground", g, {}, [&](const Image& image) {
    for (int x = 1; x < 40; ++x) {
      const double outer = std::clamp(2.0 - 2.0 * x / 30.0, 0.0, 1.0);
      EXPECT_NEAR(image.plane("shadow_catcher").at(x, 0), 0.5 * outer * outer * (3.0 - 2.0 * outer), 2e-5) << x;
    }
  });
}

TEST(Ground, ShadowFadesTowardsTheBorderOfThePicture) {
  // Half of the light arrives. The shadow fades over the outer fifth of the half axes of a superellipse.
  constexpr int kGuard = 2, kWidth = 50 + 2 * kGuard, kHeight = 40 + 2 * kGuard;
  GBuffer g = test::empty_gbuffer(kWidth, kHeight);
  g.info.ground_object = 3;
  g.info.guard = kGuard;
  for (const char* name : {"depth", "object_id", "open_light", "lit.r", "lit.g", "lit.b"})
    g.layers[0].add(name) = Plane(kWidth, kHeight, name[0] == 'l' ? 0.4f : name[0] == 'd' ? 2.0f : 0.8f);
  g.layers[0].plane("object_id") = Plane(kWidth, kHeight, 3.0f);
  test::on_every_target("ground", g, {{"border", "10"}}, [&](const Image& image) {
    ASSERT_EQ(image.width, 50);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const double radius =
            std::pow(std::pow((x + 0.5) / 25.0 - 1.0, 4.0) + std::pow((y + 0.5) / 20.0 - 1.0, 4.0), 0.25);
        const double t = std::clamp((1.0 - radius) / 0.2, 0.0, 1.0);
        EXPECT_NEAR(image.plane("shadow_catcher").at(x, y), 0.5 * t * t * (3.0 - 2.0 * t), 2e-6) << x << ' ' << y;
      }
  });
}

}  // namespace
}  // namespace umbrage
