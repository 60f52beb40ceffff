// Tests of the filter of soft shadows on surfaces at grazing angles, and at depth steps.
#include <limits>

#include "devices/cpu/soften.h"
#include "kernel/isa.h"
#include "run_effect.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

/// Passes the shadow of the first light, softened with the widest filter, to `check`, for every SIMD target and the
/// scalar kernels.
void check_softened(const GBuffer& g, const Plane& shadow, const std::function<void(const Plane&)>& check) {
  PenumbraRadii radii{.light = 0, .across = Plane(g.info.width, g.info.height), .down = {}};
  radii.across = radii.down = Plane(g.info.width, g.info.height, std::numeric_limits<float>::infinity());
  const auto run = [&](bool scalar) {
    Image image = g.layers[0];
    image.add(shadow_plane(0)) = shadow;
    soften_shadows(g.info, {0, g.info.height}, {&radii, 1}, scalar, image);
    check(image.plane(shadow_plane(0)));
  };
  run(true);
  for (const std::string_view target : test::lane_isas()) {
    SCOPED_TRACE(target);
    ASSERT_TRUE(choose_isa(target));
    run(false);
  }
  choose_isa("");
}

TEST(Soften, GrazingPlanesAreFilteredLikeFacingOnes) {
  GBuffer facing = test::seen({.angle_deg = 85.0, .orthographic = true});
  facing.layers[0].plane("depth") = Plane(64, 64, 5.0f);
  for (const char* name : {"normal.x", "normal.y"}) facing.layers[0].plane(name) = Plane(64, 64, 0.0f);
  facing.layers[0].plane("normal.z") = Plane(64, 64, 1.0f);
  Plane shadow(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) shadow.at(x, y) = float(test::hash(x + 4099u * y) >> 31);
  Plane expected;
  check_softened(facing, shadow, [&](const Plane& out) { expected = out; });
  EXPECT_GT(test::difference(expected, shadow, 0.0).mean, 0.1);
  test::at_grazing_angles({.error_deg = 2.0}, [&](const test::TiltedPlane& plane) {
    check_softened(test::seen(plane), shadow,
                   [&](const Plane& out) { EXPECT_LE(test::difference(out, expected, 0.0).max, 1e-5); });
  });
}

TEST(Soften, NothingIsFilteredAcrossAStep) {
  Plane shadow(64, 64, 0.0f);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) shadow.at(x, y) = 1.0f;
  test::at_grazing_angles({.step_px = 150.0, .depth_ratio = 0.1}, [&](const test::TiltedPlane& plane) {
    check_softened(test::seen(plane), shadow,
                   [&](const Plane& out) { EXPECT_EQ(test::difference(out, shadow, 0.0).max, 0.0); });
  });
}

}  // namespace
}  // namespace umbrage
