// Tests `hide_ground`: pixels of the ground become background.
#include <gtest/gtest.h>

#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

/// Returns a picture of four pixels: one of the model (object 1), two of object 3, and one of the background.
GBuffer row_of(int ground_object) {
  GBuffer g = test::empty_gbuffer(4, 1);
  g.info.ground_object = ground_object;
  Image& image = g.layers[0];
  for (const char* name : {"depth", "object_id", "material_id"}) image.add(name) = Plane(4, 1, 2.0f);
  const float objects[] = {1.0f, 3.0f, 3.0f, -1.0f};
  for (int x = 0; x < 4; ++x) image.plane("object_id").at(x, 0) = objects[x];
  image.plane("depth").at(3, 0) = std::numeric_limits<float>::infinity();
  return g;
}

TEST(HideGround, TheGroundIsNoSurface) {
  test::on_every_target("hide_ground", row_of(3), {}, [](const Image& image) {
    EXPECT_EQ(image.plane("depth").at(0, 0), 2.0f) << "the model itself";
    EXPECT_EQ(image.plane("object_id").at(0, 0), 1.0f);
    for (int x = 1; x < 4; ++x) EXPECT_EQ(image.plane("depth").at(x, 0), std::numeric_limits<float>::infinity()) << x;
    for (int x : {1, 2}) {
      EXPECT_EQ(image.plane("object_id").at(x, 0), -1.0f);
      EXPECT_EQ(image.plane("material_id").at(x, 0), -1.0f);
    }
  });
}

TEST(HideGround, WithoutGroundNothingChanges) {
  test::on_every_target("hide_ground", row_of(-1), {}, [](const Image& image) {
    for (int x : {0, 1, 2}) EXPECT_EQ(image.plane("depth").at(x, 0), 2.0f) << x;
    EXPECT_EQ(image.plane("object_id").at(3, 0), -1.0f) << "the background is no ground";
    EXPECT_EQ(image.plane("material_id").at(2, 0), 2.0f);
  });
}

TEST(HideGround, MissingIdsMeanOneObject) {
  GBuffer g = test::empty_gbuffer(40, 30);
  g.layers[0].add("depth") = Plane(40, 30, 2.0f);
  test::on_every_target("hide_ground", g, {}, [](const Image& image) {
    for (const char* name : {"object_id", "material_id"})
      for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) ASSERT_EQ(image.plane(name).at(x, y), 0.0f) << name << ' ' << x << ' ' << y;
  });
}

}  // namespace
}  // namespace umbrage
