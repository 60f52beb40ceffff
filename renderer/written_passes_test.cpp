// Tests the values of passes at pixels without surface.
#include "renderer/written_passes.h"

#include <gtest/gtest.h>

#include <limits>

namespace umbrage {
namespace {

TEST(Background, PlanesOfMaterialsHaveThoseOfACaptureWithoutSurface) {
  Image image(3, 1);
  image.add("depth") = Plane(3, 1, 2.0f);
  image.plane("depth").at(1, 0) = std::numeric_limits<float>::infinity();
  image.add("object_id") = Plane(3, 1, 0.0f);
  image.plane("object_id").at(2, 0) = 7.0f;  // the unseen ground
  const std::pair<const char*, float> expected[] = {{"metallic", 0.0f}, {"roughness", -1.0f}, {"material_ao", 1.0f}};
  for (const auto& [name, value] : expected) image.add(name) = Plane(3, 1, 0.5f);
  set_background(image, 7);
  for (const auto& [name, value] : expected) {
    EXPECT_EQ(image.plane(name).at(0, 0), 0.5f) << name;
    EXPECT_EQ(image.plane(name).at(1, 0), value) << name;
    EXPECT_EQ(image.plane(name).at(2, 0), value) << name;
  }
}

}  // namespace
}  // namespace umbrage
