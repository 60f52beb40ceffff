// Helpers for the tests of the program: small pictures and checks of their content.
#pragma once
#include <cmath>

#include "io/image_file.h"
#include "run_program.h"
#include "support.h"

namespace umbrage::test {

inline const std::string kSmall = " --resolution 64x64";
inline const std::string kSolids = "scene:solids?detail=2000";

/// Expects `depth_picture` to show depth (near is light, far is dark) and `normal_picture` to show the normal.
inline void expect_pictures_of(const Plane& depth, const Plane& normal_y, const Image& depth_picture,
                               const Image& normal_picture) {
  float nearest = 1e9f, farthest = 0.0f, light = 0.0f, dark = 1.0f;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float d = depth.at(x, y), grey = depth_picture.planes[0].at(x, y);
      if (!std::isfinite(d)) {
        ASSERT_EQ(grey, 0.0f);
        continue;
      }
      ASSERT_NEAR(normal_picture.plane("color.g").at(x, y), normal_y.at(x, y) * 0.5f + 0.5f, 0.003f);
      if (d < nearest) nearest = d, light = grey;
      if (d > farthest) farthest = d, dark = grey;
    }
  EXPECT_GT(light, dark + 0.3f) << "near is light";
}

}  // namespace umbrage::test
