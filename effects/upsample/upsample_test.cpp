// Tests reduced frames and `upsample`: positions of pixels, separation of surfaces, and the error of half resolution.
#include "effects/upsample/upsample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "generators/builtin.h"
#include "kernel/frame_constants.h"
#include "program/program.h"
#include "run_effect.h"
#include "scene/framing.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using test::Settings;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Size {
  int width, height;
};

glm::dvec3 position_of(const PictureInfo& info, const Camera& camera, int x, int y, double depth) {
  const double spread = camera.projection == Projection::kOrthographic ? 1.0 : depth;
  const double across = (double(camera.right) - camera.left) / info.width;
  const double down = (double(camera.top) - camera.bottom) / info.height;
  return {(camera.left + (x + 0.5) * across) * spread, (camera.top - (y + 0.5) * down) * spread, -depth};
}

/// Returns a picture with only a depth plane, whose camera has an off-centre window.
GBuffer off_centre(int width, int height, bool orthographic, int guard) {
  GBuffer g = test::empty_gbuffer(width, height);
  const float aspect = float(width) / float(height);
  if (orthographic) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, aspect);
  g.info.camera.left *= 1.7f;
  g.info.camera.top *= 0.6f;
  g.info = with_guard(g.info, guard);
  g.layers[0] = Image(g.info.width, g.info.height);
  Plane& depth = g.layers[0].add("depth");
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) depth.at(x, y) = 1.0f + float(test::hash(x + 4099u * y) % 1000) * 0.01f;
  return g;
}

TEST(Reduced, PixelsKeepTheirPlaces) {
  for (const bool orthographic : {false, true})
    for (const int factor : {2, 4})
      for (const int guard : {0, 7})
        for (const Size size : {Size{1, 1}, {3, 2}, {191, 347}, {64, 64}}) {
          SCOPED_TRACE(fmt::format("{}x{}, guard {}, factor {}", size.width, size.height, guard, factor));
          GBuffer g = off_centre(size.width, size.height, orthographic, guard);
          // A second layer, from another camera.
          g.info.more_layers = {{.kind = LayerKind::kOther, .camera = g.info.camera}};
          g.info.more_layers[0].camera.left -= 0.25f;
          g.layers.push_back(g.layers[0]);
          g.layers[1].plane("depth").at(0, 0) = 99.0f;
          const auto device = make_cpu_device();
          const auto full = device->upload(g);
          const auto small = device->reduced(*full, factor, {"depth", "normal.x"});
          ASSERT_TRUE(small);
          const PictureInfo& info = small->info;
          EXPECT_EQ(info.width, (g.info.width + factor - 1) / factor);
          EXPECT_EQ(info.height, (g.info.height + factor - 1) / factor);
          EXPECT_EQ(info.reduced, factor);
          EXPECT_FLOAT_EQ(info.reference_width() * float(factor), float(g.info.inner_width()));
          EXPECT_FLOAT_EQ(info.reference_height() * float(factor), float(g.info.inner_height()));
          const Image planes = *device->download_all(*small);
          ASSERT_EQ(planes.names, (std::vector<std::string>{"depth", "layer1.depth"}));
          ASSERT_EQ(planes.width, info.width);
          ASSERT_EQ(planes.height, info.height);
          EXPECT_EQ(planes.planes[1].at(0, 0), 99.0f);
          const double window =
              std::max({std::fabs(double(g.info.camera.left)), std::fabs(double(g.info.camera.right)),
                        std::fabs(double(g.info.camera.top)), std::fabs(double(g.info.camera.bottom))});
          for (int y = 0; y < info.height; ++y)
            for (int x = 0; x < info.width; ++x) {
              const float depth = planes.planes[0].at(x, y);
              EXPECT_EQ(depth, g.layers[0].planes[0].at(x * factor, y * factor));
              for (int layer = 0; layer < 2; ++layer) {
                const auto here = position_of(info, layer_info(info, layer).camera, x, y, depth);
                const auto there = position_of(g.info, layer_info(g.info, layer).camera, x * factor, y * factor, depth);
                EXPECT_LT(glm::length(here - there), 1e-6 * depth * (1.0 + window)) << x << ',' << y;
              }
            }
        }
}

TEST(Reduced, LengthsInPixelsMeanTheSameDistance) {
  const GBuffer g = off_centre(191, 347, false, 9);
  const PictureInfo half = reduced_info(g.info, 2), quarter = reduced_info(half, 2);
  EXPECT_EQ(quarter.reduced, 4);
  EXPECT_EQ(quarter.width, reduced_info(g.info, 4).width);
  for (const Length& length : {Length{12.0f, 0}, Length{3.125f, 1}}) {
    const float full = length_px(length, g.info.reference_width(), g.info);
    EXPECT_FLOAT_EQ(full, length.relative ? 0.03125f * 191.0f : 12.0f);
    EXPECT_FLOAT_EQ(2.0f * length_px(length, half.reference_width(), half), full);
    EXPECT_FLOAT_EQ(4.0f * length_px(length, quarter.reference_width(), quarter), full);
  }
}

TEST(Reduced, PlacedPlanesAreInTheUpperLeftCorner) {
  const GBuffer g = off_centre(191, 347, false, 0);
  const auto device = make_cpu_device();
  auto full = *device->upload(g);
  const auto small = *device->reduced(full, 4, {"depth"});
  ASSERT_TRUE(device->add_planes_of(small, {"depth"}, full));
  const Image placed = *device->download(full, {"reduced_depth"});
  for (int y = 0; y < 347; ++y)
    for (int x = 0; x < 191; ++x)
      EXPECT_EQ(placed.planes[0].at(x, y), x < 48 && y < 87 ? g.layers[0].planes[0].at(4 * x, 4 * y) : 0.0f);
  const auto missing = device->add_planes_of(small, {"ao"}, full);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("'ao'"), std::string::npos);
}

/// Returns a G-buffer of a plane that faces the camera, with `reduced_ao` and `reduced_indirect` of 0.
GBuffer to_upsample(int width, int height) {
  GBuffer g = test::empty_gbuffer(width, height);
  for (const char* name :
       {"normal.x", "normal.y", "reduced_ao", "reduced_indirect.r", "reduced_indirect.g", "reduced_indirect.b"})
    g.layers[0].add(name) = Plane(width, height, 0.0f);
  g.layers[0].add("normal.z") = Plane(width, height, 1.0f);
  g.layers[0].add("depth") = Plane(width, height, 5.0f);
  return g;
}

/// Returns the settings for a factor, with or without light.
Settings by(int factor, bool light = true) {
  return {{"factor", std::to_string(factor)}, {"indirect", light ? "on" : "off"}};
}

const char* const kOutputs[] = {"ao", "indirect.r", "indirect.g", "indirect.b"};

TEST(Upsample, IsBilinearOnAPlane) {
  for (const int factor : {2, 4}) {
    GBuffer g = to_upsample(47, 31);
    for (const char* name : kOutputs) {
      Plane& small = g.layers[0].plane(reduced_plane(name));
      for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) small.at(x, y) = 0.1f + 0.01f * float(x) + 0.02f * float(y);
    }
    test::on_every_target("upsample", g, by(factor), [&](const Image& image) {
      const int last_x = (47 - 1) / factor * factor, last_y = (31 - 1) / factor * factor;
      for (const char* name : kOutputs)
        for (int y = 0; y <= last_y; ++y)
          for (int x = 0; x <= last_x; ++x) {
            const double expected = 0.1 + 0.01 * x / factor + 0.02 * y / factor;
            EXPECT_NEAR(image.plane(name).at(x, y), expected, 1e-4) << name << ' ' << x << ',' << y;
          }
    });
  }
}

TEST(Upsample, KeepsComputedPixelsAndConstants) {
  for (const int factor : {2, 4})
    for (const bool hostile : {false, true}) {
      GBuffer g = hostile ? test::hostile_gbuffer(191, 63, 5) : test::bumpy_gbuffer(191, 63, 5);
      Plane& ao = g.layers[0].add("reduced_ao");
      for (int y = 0; y < ao.height; ++y)
        for (int x = 0; x < ao.width; ++x) ao.at(x, y) = float(test::hash(x + 4099u * y) >> 8) * 0x1p-24f;
      test::on_every_target("upsample", g, by(factor, false), [&](const Image& image) {
        for (int y = 0; y < 63; y += factor)
          for (int x = 0; x < 191; x += factor)
            EXPECT_EQ(image.plane("ao").at(x, y), ao.at(x / factor, y / factor)) << x << ',' << y;
      });
      ao = Plane(191, 63, 0.3f);
      test::on_every_target("upsample", g, by(factor, false), [&](const Image& image) {
        EXPECT_EQ(test::difference(image.plane("ao"), ao, 0.0).max, 0.0);
      });
    }
}

TEST(Upsample, NothingCrossesASilhouette) {
  // To the left of a slanted edge is a near surface, whose occlusion and light differ from those of the surface or
  // background behind it.
  for (const int factor : {2, 4})
    for (const float behind : {5.2f, 9.0f, kInfinity})
      for (const bool turned : {false, true}) {  // a crease of 90 degrees that points at the camera
        if (turned && behind != 9.0f) continue;
        SCOPED_TRACE(fmt::format("factor {}, behind {}, turned {}", factor, behind, turned));
        GBuffer g = to_upsample(80, 64);
        Image& image = g.layers[0];
        const auto left_of = [&](int x, int y) { return turned ? x < 37 : x < 20 + y / 2; };
        const Camera& camera = g.info.camera;
        const auto across = [&](double x) { return camera.left + (camera.right - camera.left) * x / 80.0; };
        for (int y = 0; y < 64; ++y)
          for (int x = 0; x < 80; ++x) {
            if (turned) {
              const double nz = std::sqrt(0.5), nx = left_of(x, y) ? -nz : nz;
              image.plane("normal.x").at(x, y) = float(nx);
              image.plane("normal.z").at(x, y) = float(nz);
              image.plane("depth").at(x, y) = float(5.0 * (nz - nx * across(37.0)) / (nz - nx * across(x + 0.5)));
            } else if (!left_of(x, y)) {
              image.plane("depth").at(x, y) = behind;
            }
          }
        for (int y = 0; y < 64; y += factor)
          for (int x = 0; x < 80; x += factor)
            for (const char* name : kOutputs)
              image.plane(reduced_plane(name)).at(x / factor, y / factor) = left_of(x, y) ? 0.25f : 0.75f;
        test::on_every_target("upsample", g, by(factor), [&](const Image& out) {
          for (const char* name : kOutputs)
            // Excludes pixels beyond the last computed row and column, whose four corners are not all in the picture.
            for (int y = 0; y <= 64 - factor; ++y)
              for (int x = 0; x <= 80 - factor; ++x) {
                // Excludes pixels none of whose four corners is on their side.
                bool has_own = false;
                for (const int i : {0, factor})
                  for (const int j : {0, factor})
                    has_own |= left_of(x / factor * factor + i, y / factor * factor + j) == left_of(x, y);
                if (!has_own) continue;
                EXPECT_NEAR(out.plane(name).at(x, y), left_of(x, y) ? 0.25f : 0.75f, 1e-6) << x << ',' << y;
              }
        });
      }
}

TEST(Upsample, WhereNoPixelFitsTheNearestInDepthCounts) {
  GBuffer g = to_upsample(16, 16);
  Image& image = g.layers[0];
  // A wire of depth 8 between computed pixels; the depth is 5 to its left and 9 to its right.
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      image.plane("depth").at(x, y) = x == 5 ? 8.0f : x < 5 ? 5.0f : 9.0f;
      image.plane("reduced_ao").at(x, y) = x < 3 ? 0.25f : 0.75f;
    }
  test::on_every_target("upsample", g, by(2, false), [&](const Image& out) {
    for (int y = 0; y < 14; ++y) {
      EXPECT_EQ(out.plane("ao").at(4, y), 0.25f);
      // The wire's distance in depth to the right side is a third of that to the left; weights are inverse fourth
      // powers.
      EXPECT_NEAR(out.plane("ao").at(5, y), 0.75, 0.5 / 81.0);
      EXPECT_EQ(out.plane("ao").at(6, y), 0.75f);
    }
  });
}

TEST(Upsample, LeavesPixelsThatNoComputedPixelFits) {
  // The same wire, with a gap that shows background.
  GBuffer g = to_upsample(16, 16);
  Image& image = g.layers[0];
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      image.plane("depth").at(x, y) = x != 5 ? (x < 5 ? 5.0f : 9.0f) : y == 7 ? kInfinity : 8.0f;
      for (const char* name : kOutputs) image.plane(reduced_plane(name)).at(x, y) = x < 3 ? 0.25f : 0.75f;
    }
  for (const bool light : {false, true}) {
    Settings settings = by(2, light);
    settings.push_back({"leave", "on"});
    test::on_every_target("upsample", g, settings, [&](const Image& out) {
      for (int y = 0; y < 14; ++y) {
        EXPECT_EQ(out.plane("ao").at(4, y), 0.25f);
        EXPECT_EQ(out.plane("ao").at(5, y), y == 7 ? 1.0f : kMissing);
        EXPECT_EQ(out.plane("ao").at(6, y), 0.75f);
        if (!light) continue;
        EXPECT_GE(out.plane("indirect.g").at(5, y), 0.25f);
        EXPECT_LE(out.plane("indirect.g").at(5, y), 0.75f);
      }
    });
  }
}

TEST(Upsample, PlanesAtGrazingAnglesAreLikeFacingOnes) {
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {30.0, 69.0, 80.0}) {
      GBuffer g = to_upsample(48, 64);
      if (orthographic) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 0.75f);
      Plane& ao = g.layers[0].plane("reduced_ao");
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 48; ++x) ao.at(x, y) = float(test::hash(x + 4099u * y) >> 8) * 0x1p-24f;
      const Image facing = test::run_effect(*find_effect("upsample"), g, by(2, false), {});
      const int horizon = test::tilt_about_x(g, tilt_deg);
      test::on_every_target("upsample", g, by(2, false), [&](const Image& image) {
        const int first = horizon > 0 ? horizon + 2 : 0;
        EXPECT_LT(first, 30);
        for (int y = first; y < 64; ++y)
          for (int x = 0; x < 48; ++x)
            EXPECT_NEAR(image.plane("ao").at(x, y), facing.plane("ao").at(x, y), 1e-6) << tilt_deg << ' ' << y;
      });
    }
}

TEST(Upsample, GrazingPlanesWithInaccurateNormalsAreLikeFacingOnesButStepsSeparate) {
  GBuffer facing = to_upsample(64, 64);
  for (const char* name : kOutputs) {
    Plane& small = facing.layers[0].plane(reduced_plane(name));
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) small.at(x, y) = float(test::hash(x + 4099u * y) >> 8) * 0x1p-24f;
  }
  const auto with_planes = [&](const test::TiltedPlane& plane) {
    GBuffer g = test::seen(plane);
    for (const char* name : kOutputs)
      g.layers[0].add(reduced_plane(name)) = facing.layers[0].plane(reduced_plane(name));
    return g;
  };
  for (const int factor : {2, 4}) {
    const Image expected = test::run_effect(*find_effect("upsample"), facing, by(factor), {});
    test::at_grazing_angles({.error_deg = 2.0}, [&](const test::TiltedPlane& plane) {
      test::on_every_target("upsample", with_planes(plane), by(factor), [&](const Image& image) {
        for (const char* name : kOutputs)
          EXPECT_LE(test::difference(image.plane(name), expected.plane(name), 0.0).max, 1e-6) << name;
      });
    });
    test::at_grazing_angles({.step_px = 200.0, .depth_ratio = 0.05}, [&](const test::TiltedPlane& plane) {
      GBuffer g = with_planes(plane);
      for (const char* name : kOutputs)
        for (int y = 0; y < 64; ++y)
          for (int x = 0; x < 64; ++x)
            g.layers[0].plane(reduced_plane(name)).at(x, y) = x * factor < 32 ? 0.25f : 0.75f;
      test::on_every_target("upsample", g, by(factor), [&](const Image& image) {
        for (const char* name : kOutputs)
          for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
              EXPECT_NEAR(image.plane(name).at(x, y), x < 32 ? 0.25f : 0.75f, 0.02) << x << ',' << y;
      });
    });
  }
}

TEST(Upsample, BackgroundTakesNothingFromSurfaces) {
  GBuffer g = to_upsample(32, 32);
  Image& image = g.layers[0];
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      if ((x - 15) * (x - 15) + (y - 15) * (y - 15) > 90) image.plane("depth").at(x, y) = kInfinity;
      if (x % 2 == 0 && y % 2 == 0) {
        const bool open = !std::isfinite(image.plane("depth").at(x, y));
        image.plane("reduced_ao").at(x / 2, y / 2) = open ? 1.0f : 0.5f;
      }
    }
  long found = 0;
  const Image out = test::run_effect(*find_effect("upsample"), g, by(2, false), {});
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 31; ++x)
      if (!std::isfinite(image.plane("depth").at(x, y))) {
        ++found;
        EXPECT_NEAR(out.plane("ao").at(x, y), 1.0f, 1e-6) << x << ',' << y;
      }
  EXPECT_GT(found, 100);
}

/// Computes the `ao` of a scene's picture by a look with an occlusion technique and `denoise`.
struct AoRenderer {
  std::unique_ptr<Device> device = make_cpu_device();
  Scene scene;

  explicit AoRenderer(const std::string& name) {
    auto made = make_builtin_scene(name);
    EXPECT_TRUE(made);
    scene = std::move(*made);
    EXPECT_TRUE(device->prepare(scene));
  }

  Plane ao(Size size, bool orthographic, int guard, int factor, std::string_view technique,
           const std::vector<std::string>& settings, Plane* depth) {
    const Camera camera = frame_scene(scene, {.orthographic = orthographic}, size.width, size.height);
    scene.lights = default_lighting(camera, scene.up).lights;
    auto frame = *device->capture(camera, {.width = size.width, .height = size.height, .guard = guard});
    const Look look{
        .name = "test", .summary = "", .occlusion = technique, .effects = {"occlusion", "denoise"}, .presets = {}};
    EffectSettings all = look_settings(look);
    for (const std::string& setting : settings) EXPECT_TRUE(apply_setting(all, setting)) << setting;
    const LookRun run{.look = &look, .occlusion = technique, .occlusion_downsampling = factor, .settings = &all};
    const auto status = run_look(run, *device, frame);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
    Image image = *device->download(frame, {"ao", "depth"});
    *depth = image.planes[1];
    return image.planes[0];
  }
};

struct Deviation {
  double rmse = 0.0, bias = 0.0;  // bias: mean difference
};

/// Returns the deviation of a from b, over the pixels that show a surface.
Deviation error_of(const Plane& a, const Plane& b, const Plane& depth) {
  double squares = 0.0, sum = 0.0;
  long count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      const double e = double(a.at(x, y)) - b.at(x, y);
      squares += e * e;
      sum += e;
      ++count;
    }
  EXPECT_GT(count, 0);
  return {std::sqrt(squares / double(count)), sum / double(count)};
}

const std::vector<std::string> kHemisphere = {
    "sphere.samples=64",   "sphere.shape=hemisphere", "sphere.reach=8%",   "sphere.depth=linear", "sphere.sample_z=on",
    "sphere.range=smooth", "sphere.range_factor=1",   "sphere.map=linear", "sphere.threshold=0",  "sphere.border=skip"};

TEST(Upsample, HalfResolutionIsCloseToFull) {
  for (const char* name :
       {"scene:solids?detail=4000", "scene:claw?detail=20000", "scene:room?detail=20000", "scene:pink?detail=20000",
        "scene:tank?detail=20000", "scene:terrain?detail=20000", "scene:atrium?detail=20000"}) {
    AoRenderer renderer(name);
    for (const Size size : {Size{1023, 767}, {191, 347}, {3, 2}, {1, 1}})
      for (const int factor : {2, 4}) {
        if (factor == 4 && size.width > 1000) continue;
        const bool orthographic = size.width == 191;
        const int guard = orthographic ? 13 : 0;
        SCOPED_TRACE(fmt::format("{} {}x{}, factor {}", name, size.width, size.height, factor));
        Plane depth;
        const Plane full = renderer.ao(size, orthographic, guard, 1, "sphere", kHemisphere, &depth);
        const Plane small = renderer.ao(size, orthographic, guard, factor, "sphere", kHemisphere, &depth);
        const Deviation e = error_of(small, full, depth);
        EXPECT_LT(std::fabs(e.bias), factor == 2 ? 0.003 : 0.005);
        // The tank consists of thin parts, which few computed pixels fit. At 191 x 347, the noise of two pictures with
        // 64 samples is already 0.021; with 256 samples it is half of that.
        const bool noisy = size.width == 191 && std::string_view(name).starts_with("scene:tank");
        if (factor == 2) {
          EXPECT_LT(e.rmse, noisy ? 0.0237 : 0.02);
        }
        if (factor == 2 && noisy) {
          std::vector<std::string> finer = kHemisphere;
          finer[0] = "sphere.samples=256";
          const Plane fine = renderer.ao(size, orthographic, guard, 1, "sphere", finer, &depth);
          const Plane fine_half = renderer.ao(size, orthographic, guard, 2, "sphere", finer, &depth);
          EXPECT_LT(error_of(fine_half, fine, depth).rmse, 0.02);
        }
        if (size.width > 100) {
          EXPECT_GT(e.rmse, 1e-3);  // shows that another resolution was used
        }
      }
  }
}

TEST(Upsample, LaterRoundsReadPlanesThatTheFirstDoesNot) {
  // At reduced resolution, only the planes that a round reads are reduced. The second round also needs the albedo.
  const Scene scene = *make_builtin_scene("scene:atrium?detail=4000");
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const Size size{127, 95};
  auto frame =
      *device->capture(frame_scene(scene, {}, size.width, size.height), {.width = size.width, .height = size.height});
  const Look look{.name = "test", .summary = "", .occlusion = "hemisphere", .effects = {"occlusion"}, .presets = {}};
  const EffectSettings initial = look_settings(look);
  ASSERT_TRUE(device->run(*find_effect("lighting"), initial.find("lighting")->second, frame));
  const auto light = [&](int bounces) {
    EffectSettings all = look_settings(look);
    for (const std::string& setting :
         {std::string("hemisphere.bleeding=1"), fmt::format("hemisphere.bounces={}", bounces)})
      EXPECT_TRUE(apply_setting(all, setting));
    const LookRun run{.look = &look, .occlusion = "hemisphere", .occlusion_downsampling = 2, .settings = &all};
    EXPECT_TRUE(run_look(run, *device, frame));
    return device->download(frame, {"indirect.g"})->planes[0];
  };
  const Plane once = light(1), twice = light(2);
  // The second round reflects the light of the first, times the albedo.
  Image dark = *device->download(frame, {"albedo.r", "albedo.g", "albedo.b"});
  for (Plane& plane : dark.planes) plane = Plane(size.width, size.height, 0.0f);
  ASSERT_TRUE(device->add(dark, frame));
  const Plane by_black = light(2);
  EXPECT_GT(test::difference(twice, by_black, 0.0).mean, 1e-3);
  EXPECT_GT(test::difference(twice, once, 0.0).mean, 1e-3);
}

TEST(Upsample, EveryTechniqueKeepsItsStrength) {
  AoRenderer renderer("scene:solids?detail=4000");
  for (const Effect* effect : effects()) {
    if (effect->kind != EffectKind::kOcclusion || effect->filters_itself) continue;
    SCOPED_TRACE(effect->name);
    // The window of `unsharp` must be an integer number of pixels at half resolution too.
    std::vector<std::string> settings = {"unsharp.kernel=42",         "unsharp.linearization=extent",
                                         "unsharp.background=ignore", "unsharp.threshold=0.02",
                                         "unsharp.strength=20",       "unsharp.white_edge=on"};
    settings.insert(settings.end(), kHemisphere.begin(), kHemisphere.end());
    Plane depth;
    const Plane full = renderer.ao({511, 383}, false, 10, 1, effect->name, settings, &depth);
    const Plane half = renderer.ao({511, 383}, false, 10, 2, effect->name, settings, &depth);
    const Deviation e = error_of(half, full, depth), darkness = error_of(full, Plane(511, 383, 1.0f), depth);
    EXPECT_GT(darkness.rmse, 0.02);
    EXPECT_LT(std::fabs(e.bias), 0.003);
    EXPECT_LT(e.rmse, 0.5 * darkness.rmse);
  }
}

}  // namespace
}  // namespace umbrage
