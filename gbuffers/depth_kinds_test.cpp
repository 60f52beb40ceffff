// Depth without a unit, damaged or unusual: small copies of the cases that people report.
#include <gtest/gtest.h>

#include <algorithm>

#include "gbuffers/test_scene.h"

namespace umbrage {
namespace {

using test::grey_png;
using test::has_warning;
using test::Hit;
using test::hit_at;
using test::scene;
using test::TestFile;
using test::understand;
using test::Understood;

/// Returns the correlation of the order of depths with the true ones: 1 if each nearer pixel is nearer.
double order_agreement(const Understood& got) {
  const Plane& depth = got.planes.plane("depth");
  int same = 0, all = 0;
  for (int y = 0; y < scene().height; y += 3)
    for (int x = 0; x + 60 < scene().width; x += 3) {
      const Hit &a = hit_at(x, y), &b = hit_at(x + 60, scene().height - 1 - y);
      if (!a.found || !b.found || std::abs(a.depth - b.depth) < 0.3) continue;
      ++all;
      same += (a.depth < b.depth) == (depth.at(x, y) < depth.at(x + 60, scene().height - 1 - y));
    }
  return all == 0 ? 0.0 : double(same) / all;
}

TEST(DepthKinds, SixteenBitMillimetresKeepTheirValues) {
  const Understood got = understand(grey_png(65535, 0.0f, [](const Hit& hit) { return 1000.0 * hit.depth; }));
  ASSERT_EQ(got.error, "");
  EXPECT_NEAR(got.planes.plane("depth").at(120, 140), 1000.0 * hit_at(120, 140).depth, 0.51);
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
  EXPECT_NE(got.text().find("planar"), std::string::npos) << got.text();
  GBufferSettings settings;
  settings.depth_scale = 0.001f;
  const Understood scaled =
      understand(grey_png(65535, 0.0f, [](const Hit& hit) { return 1000.0 * hit.depth; }), settings);
  EXPECT_NEAR(scaled.planes.plane("depth").at(120, 140), hit_at(120, 140).depth, 0.001);
}

TEST(DepthKinds, SeparateValueFarBeyondTheSceneIsBackground) {
  const Understood got = understand(grey_png(65535, 65000.0f, [](const Hit& hit) { return 1000.0 * hit.depth; }));
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0))) << got.text();
  EXPECT_NE(got.text().find("65000"), std::string::npos) << got.text();
  TestFile huge(scene());
  for (const char* channel : {"R", "G", "B"}) huge.add(channel, 1e10f, [](const Hit& hit) { return hit.depth; });
  const Understood equal = understand(huge);
  ASSERT_EQ(equal.error, "");
  EXPECT_TRUE(std::isinf(equal.planes.plane("depth").at(120, 0)));
  EXPECT_FLOAT_EQ(equal.planes.plane("depth").at(120, 140), float(hit_at(120, 140).depth));
}

TEST(DepthKinds, WallThatFacesTheCameraIsNoBackground) {
  // The farthest depth is that of a large wall, with normals.
  TestFile file(scene());
  file.add("Z", 40.0f, [](const Hit& hit) { return hit.depth; });
  file.add("N.X", 0.0f, [](const Hit& hit) { return hit.normal_view.x; });
  file.add("N.Y", 0.0f, [](const Hit& hit) { return hit.normal_view.y; });
  file.add("N.Z", 1.0f, [](const Hit& hit) { return hit.normal_view.z; });
  const Understood got = understand(file);
  EXPECT_FLOAT_EQ(got.planes.plane("depth").at(120, 0), 40.0f) << got.text();
}

TEST(DepthKinds, EightBitsAreWarnedOfWithTheStep) {
  const Understood got =
      understand(grey_png(255, 255.0f, [](const Hit& hit) { return 255.0 * (hit.depth - 3.0) / 20.0; }));
  ASSERT_EQ(got.error, "");
  EXPECT_TRUE(has_warning(got, "different values")) << got.text();
  EXPECT_TRUE(has_warning(got, "no scale")) << got.text();
  EXPECT_TRUE(has_warning(got, "is read as depth of unknown scale, dark is near")) << got.text();
  EXPECT_GT(order_agreement(got), 0.95) << got.text();
}

TEST(DepthKinds, TwentyFourBitsInThreeChannels) {
  const auto part = [](const Hit& hit, int shift) {
    const auto v = unsigned(std::lround(hit.depth / 25.0 * 16777215.0));
    return double((v >> shift) & 255u);
  };
  for (const bool red_high : {true, false}) {
    TestFile file(scene(), "PNG");
    file.max_integer = 255.0;
    file.add(
        "R", 255.0f, [&](const Hit& hit) { return part(hit, red_high ? 16 : 0); }, ChannelType::kUint8);
    file.add(
        "G", 255.0f, [&](const Hit& hit) { return part(hit, 8); }, ChannelType::kUint8);
    file.add(
        "B", 255.0f, [&](const Hit& hit) { return part(hit, red_high ? 0 : 16); }, ChannelType::kUint8);
    GBufferSettings settings;
    settings.depth_packing = red_high ? "rgb24" : "bgr24";
    settings.depth_range = {0.0f, 25.0f};
    settings.depth_background = 16777215.0f;
    const Understood got = understand(file, settings);
    ASSERT_EQ(got.error, "");
    EXPECT_NEAR(got.planes.plane("depth").at(120, 140), hit_at(120, 140).depth, 1e-5) << got.text();
    EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
    EXPECT_FALSE(has_warning(got, "different values"));
  }
}

TEST(DepthKinds, IntegersOfDepthBuffersStandForZeroToOne) {
  const double n = 0.5, f = 30.0;
  for (const bool reversed : {false, true})
    for (const double max : {255.0, 65535.0, 16777215.0}) {
      const auto stored = [&](const Hit& hit) {
        const double v = hit.found ? f * (hit.depth - n) / (hit.depth * (f - n)) : 1.0;
        return unsigned(std::lround(max * (reversed ? 1.0 - v : v)));
      };
      const bool packed = max > 65535.0;
      TestFile file(scene(), "PNG");
      file.max_integer = std::min(max, packed ? 255.0 : max);
      for (const int shift : packed ? std::vector{16, 8, 0} : std::vector{0}) {
        const unsigned mask = packed ? 255u : 0xffffu;
        const auto none = float((stored(Hit()) >> shift) & mask);
        file.add(
            packed ? std::string(1, "BGR"[shift / 8]) : "Y", none,
            [&](const Hit& hit) { return double((stored(hit) >> shift) & mask); },
            max == 65535.0 ? ChannelType::kUint16 : ChannelType::kUint8);
      }
      GBufferSettings settings;
      settings.depth_kind = reversed ? "reversed" : "window";
      settings.depth_packing = packed ? "rgb24" : "none";
      settings.near_plane = float(n);
      settings.far_plane = float(f);
      const Understood got = understand(file, settings);
      ASSERT_EQ(got.error, "");
      const double depth = hit_at(120, 140).depth, step = depth * depth * (f - n) / (n * f) / max;
      EXPECT_NEAR(got.planes.plane("depth").at(120, 140), depth, step + 1e-5) << got.text();
      EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0))) << got.text();
      EXPECT_EQ(got.text().find("millimetres"), std::string::npos) << got.text();
    }
}

TEST(DepthKinds, PictureUpsideDownWithSkyOfZero) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  auto& values = file.values[0];
  std::vector<float> turned;
  for (int y = scene().height - 1; y >= 0; --y)
    turned.insert(turned.end(), values.begin() + long(y) * scene().width, values.begin() + long(y + 1) * scene().width);
  values = turned;
  EXPECT_TRUE(has_warning(understand(file), "upside down")) << understand(file).text();
  GBufferSettings settings;
  settings.flip = true;
  const Understood got = understand(file, settings);
  EXPECT_FALSE(has_warning(got, "upside down"));
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
  EXPECT_FLOAT_EQ(got.planes.plane("depth").at(120, 140), float(hit_at(120, 140).depth));
}

TEST(DepthKinds, DisparityOfEitherPolarity) {
  // A network's inverse depth, from 0 to the full range: near is bright, or dark.
  double near_depth = 1e9, far_depth = 0.0;
  for (const Hit& hit : scene().hits)
    if (hit.found) near_depth = std::min(near_depth, hit.depth), far_depth = std::max(far_depth, hit.depth);
  const auto t = [&](const Hit& hit) {
    return std::clamp((1.0 / hit.depth - 1.0 / far_depth) / (1.0 / near_depth - 1.0 / far_depth), 0.0, 1.0);
  };
  for (const bool inverted : {false, true}) {
    const Understood got = understand(grey_png(65535, inverted ? 65535.0f : 0.0f, [&](const Hit& hit) {
      return 65535.0 * (inverted ? 1.0 - t(hit) : t(hit));
    }));
    ASSERT_EQ(got.error, "");
    EXPECT_TRUE(has_warning(got, "times as far")) << got.text();
    EXPECT_GT(order_agreement(got), 0.99) << got.text();
  }
}

TEST(DepthKinds, InvertedRange) {
  const double near = 2.0, far = 25.0, max = 65535.0;  // the max stored value is the nearest
  GBufferSettings settings;
  settings.depth_range = {float(near), float(far)};
  settings.depth_invert = true;
  settings.depth_background = 0.0f;
  const Understood got =
      understand(grey_png(max, 0.0f, [&](const Hit& hit) { return max * (far - hit.depth) / (far - near); }), settings);
  ASSERT_EQ(got.error, "");
  EXPECT_NEAR(got.planes.plane("depth").at(120, 140), hit_at(120, 140).depth, 1e-3) << got.text();
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
}

TEST(DepthKinds, DisparityWithKnownCoefficients) {
  const double a = 0.01, b = 0.002;
  TestFile file(scene());
  file.add("disparity.V", -1.0f, [&](const Hit& hit) { return (1.0 / hit.depth - a) / b; });
  GBufferSettings settings;
  settings.depth_scale = float(b);
  settings.depth_offset = float(a);
  const Understood got = understand(file, settings);
  ASSERT_EQ(got.error, "");
  EXPECT_NEAR(got.planes.plane("depth").at(120, 140), hit_at(120, 140).depth, 1e-4) << got.text();
}

TEST(DepthKinds, DisparityOfUnknownOffsetIsFittedToNormals) {
  TestFile file(scene());
  file.add("disparity.V", 0.0f, [](const Hit& hit) { return (1.0 / hit.depth - 0.02) * 3.0; });
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("normal.") + "XYZ"[axis], 0.0f, [&](const Hit& hit) { return hit.normal_view[axis]; });
  GBufferSettings settings;
  settings.fov_deg = 40.0f;
  const Understood got = understand(file, settings);
  ASSERT_EQ(got.error, "");
  const double scale = hit_at(120, 140).depth / got.planes.plane("depth").at(120, 140);
  EXPECT_NEAR(got.planes.plane("depth").at(60, 100) * scale / hit_at(60, 100).depth, 1.0, 0.03) << got.text();
}

TEST(DepthKinds, FocalLengths) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  GBufferSettings mm;
  mm.focal_length_mm = 50.0f;
  const Camera lens = understand(file, mm).conventions.camera;
  EXPECT_FLOAT_EQ(lens.right, 18.0f / 50.0f);
  EXPECT_FLOAT_EQ(lens.top, 18.0f / 50.0f * 160.0f / 240.0f);
  GBufferSettings px;
  px.focal_length_px = {200.0f, 210.0f, 119.5f, 79.5f};
  const Camera calibrated = understand(file, px).conventions.camera;
  EXPECT_FLOAT_EQ(calibrated.left, -120.0f / 200.0f);
  EXPECT_FLOAT_EQ(calibrated.right, 120.0f / 200.0f);
  EXPECT_FLOAT_EQ(calibrated.top, 80.0f / 210.0f);
  px.fov_deg = 40.0f;
  EXPECT_NE(understand(file, px).error.find("focal_length_px"), std::string::npos);
}

TEST(DepthKinds, ElevationIsSeenFromAbove) {
  TestFile file(scene(), "TIFF");
  file.header.geo = GeoRaster{30.0, 20.0, -9999.0};
  file.add("Y", -9999.0f, [](const Hit& hit) { return 500.0 + 10.0 * hit.world.z; });
  const Understood got = understand(file);
  ASSERT_EQ(got.error, "");
  const Camera& camera = got.conventions.camera;
  EXPECT_EQ(camera.projection, Projection::kOrthographic);
  EXPECT_FLOAT_EQ(camera.right - camera.left, 30.0f * 240.0f);
  EXPECT_FLOAT_EQ(camera.top - camera.bottom, 20.0f * 160.0f);
  const Plane& depth = got.planes.plane("depth");
  EXPECT_TRUE(std::isinf(depth.at(120, 0)));
  EXPECT_NEAR(depth.at(120, 140) - depth.at(60, 100), 10.0 * (hit_at(60, 100).world.z - hit_at(120, 140).world.z),
              1e-3);
  EXPECT_GT(depth.at(60, 100), 0.0f);
}

TEST(DepthKinds, ElevationIsRecognisedByItsValues) {
  const auto nameless = [](float none, double base) {
    TestFile file(scene(), "NPY");
    file.add("Y", none, [&](const Hit& hit) { return base + 10.0 * hit.world.z + hit.world.x; });
    return understand(file);
  };
  const auto is_height = [](const Understood& got) {
    return got.conventions.depth.model.meaning == DepthMeaning::kHeight;
  };
  for (const float marker : {-9999.0f, -32768.0f, std::numeric_limits<float>::lowest()}) {
    const Understood got = nameless(marker, 500.0);
    EXPECT_TRUE(is_height(got)) << got.text();
    EXPECT_NE(got.text().find("elevation, by nodata -"), std::string::npos) << got.text();
    EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
    EXPECT_TRUE(has_warning(got, "`cell_size`")) << got.text();
    EXPECT_EQ(got.conventions.camera.projection, Projection::kOrthographic);
  }
  // Land below the sea is land.
  const Understood low = nameless(-9999.0f, 0.0);
  EXPECT_NE(low.text().find("elevation, by values below zero and nodata -9999"), std::string::npos) << low.text();
  for (int y = 0; y < scene().height; ++y)
    for (int x = 0; x < scene().width; ++x)
      ASSERT_EQ(std::isfinite(low.planes.plane("depth").at(x, y)), hit_at(x, y).found) << x << ' ' << y;
  // One value below zero is a marker of any kind, and lengths have one sign.
  for (const float none : {-1.0f, 0.0f}) EXPECT_FALSE(is_height(nameless(none, 500.0)));
  EXPECT_FALSE(is_height(nameless(0.0f, -500.0)));
}

TEST(DepthKinds, AssumedCellSizeGivesTheSlopesOfHills) {
  TestFile file(scene(), "TIFF");
  file.header.geo = GeoRaster{.no_data = -9999.0, .has_cell = false};
  const int width = scene().width;
  file.add("Y", -9999.0f, [](const Hit&) { return 0.0; });
  file.values[0].clear();
  for (int y = 0; y < scene().height; ++y)
    for (int x = 0; x < width; ++x) file.values[0].push_back(3.0f * float(x));
  const Camera camera = understand(file).conventions.camera;
  const double cell = double(camera.right - camera.left) / width;
  EXPECT_NEAR(std::atan(3.0 / cell) * 180.0 / 3.14159265358979, 20.0, 1.0);
}

TEST(DepthKinds, TwoValuesAreNoSteps) {
  TestFile file(scene());
  file.add("Z", 1.0f, [](const Hit& hit) { return 1.0 + (hit.object == 0 ? 1.0 : 0.0); });
  EXPECT_FALSE(has_warning(understand(file), "different values")) << understand(file).text();
}

TEST(DepthKinds, RowsOfALevelFloorAreNoSteps) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit&) { return 0.0; });
  for (std::size_t k = 0; k < file.values[0].size(); ++k)
    file.values[0][k] = 100.0f / float(1 + k / std::size_t(scene().width));
  EXPECT_FALSE(has_warning(understand(file), "different values")) << understand(file).text();
}

TEST(DepthKinds, ColourPictureHasNoDepth) {
  TestFile file(scene(), "PNG");
  file.max_integer = 255.0;
  file.add("R", 0.0f, [](const Hit& hit) { return 20.0 + 10.0 * hit.object; });
  file.add("G", 9.0f, [](const Hit& hit) { return 90.0 + 10.0 * hit.object; });
  file.add("B", 99.0f, [](const Hit&) { return 3.0; });
  EXPECT_NE(understand(file).error.find("neither depth nor positions"), std::string::npos) << understand(file).text();
}

TEST(DepthKinds, NothingButBackground) {
  TestFile file(scene());
  file.add("Z", 1e10f, [](const Hit&) { return std::numeric_limits<double>::quiet_NaN(); });
  for (int axis = 0; axis < 3; ++axis) file.add(std::string("N.") + "XYZ"[axis], 0.0f, [](const Hit&) { return 0.0; });
  const Understood got = understand(file);
  ASSERT_EQ(got.error, "");
  EXPECT_TRUE(has_warning(got, "no surface"));
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(3, 3)));
}

TEST(DepthKinds, ValuesThatAreAllBackgroundAreWarnedOf) {
  TestFile file(scene());
  file.add("Z", 1e10f, [](const Hit& hit) { return hit.depth; });
  GBufferSettings settings;
  EXPECT_FALSE(has_warning(understand(file, settings), "no surface"));
  settings.depth_scale = 0.0f;
  EXPECT_TRUE(has_warning(understand(file, settings), "no surface"));
  settings.depth_scale.reset();
  settings.depth_kind = "window";
  EXPECT_TRUE(has_warning(understand(file, settings), "window depth")) << understand(file, settings).text();
}

TEST(DepthKinds, NanOfSinglePixelsGetsTheValueBeside) {
  const auto file_with = [](int one_in) {
    TestFile file(scene());
    file.add("Z", 1e10f, [](const Hit& hit) { return hit.depth; });
    file.add_vector("N", [](const Hit& hit) { return hit.normal_view; });
    file.add_vector(
        "albedo", [](const Hit&) { return glm::dvec3(0.5); }, "RGB");
    for (std::size_t c = 1; c < file.values.size(); ++c)
      for (std::size_t k = 0; k < file.values[c].size(); ++k)
        if (int(k % 100) < one_in) file.values[c][k] = std::numeric_limits<float>::quiet_NaN();
    return file;
  };
  const Understood few = understand(file_with(3)), all = understand(file_with(100));
  ASSERT_EQ(few.error + all.error, "");
  EXPECT_TRUE(has_warning(few, "N (XYZ) is NaN")) << few.text();
  EXPECT_TRUE(has_warning(few, "albedo (RGB) is NaN")) << few.text();
  for (std::size_t k = 0; k < scene().hits.size(); ++k) {
    if (!scene().hits[k].found) continue;
    const int x = int(k) % scene().width, y = int(k) / scene().width;
    ASSERT_FLOAT_EQ(few.planes.plane("albedo.r").at(x, y), 0.5f) << x << " " << y;
    const float nx = few.planes.plane("normal.x").at(x, y), ny = few.planes.plane("normal.y").at(x, y),
                nz = few.planes.plane("normal.z").at(x, y);
    if (x > 3 && scene().hits[k - 3].found) {
      ASSERT_NEAR(nx * nx + ny * ny + nz * nz, 1.0f, 1e-4f) << x << " " << y;
    }
  }
  // A layer without numbers is none, and no black picture.
  EXPECT_TRUE(has_warning(all, "not used")) << all.text();
  EXPECT_FALSE(all.planes.find("normal.x"));
  EXPECT_FALSE(all.planes.find("albedo.r"));
}

TEST(DepthKinds, ContradictionsAreWarnedOf) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("N.") + "XYZ"[axis], 0.0f, [&](const Hit& hit) {
      const double a = 40.0 * hit.world.x, b = 70.0 * hit.world.y;  // noise
      return glm::dvec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a))[axis];
    });
  EXPECT_TRUE(has_warning(understand(file), "do not fit")) << understand(file).text();
}

TEST(DepthKinds, NormalsThatAreFifteenDegreesOffAreWarnedOf) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("N.") + "XYZ"[axis], 0.0f, [&](const Hit& hit) {
      const double a = 40.0 * hit.world.x + 70.0 * hit.world.y;  // noise
      return glm::normalize(hit.normal_view + 0.25 * glm::dvec3(std::sin(a), std::cos(a), std::sin(2.0 * a)))[axis];
    });
  EXPECT_TRUE(has_warning(understand(file), "do not fit")) << understand(file).text();
}

TEST(DepthKinds, NormalsThatFitNothingDoNotBendPlanarDepth) {
  TestFile file(scene());
  file.add("Z", 1e10f, [](const Hit& hit) { return hit.depth; });
  file.max_integer = 255.0;
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("N.") + "XYZ"[axis], 0.0f,
             [&](const Hit& hit) { return axis == 2 ? 10.0 * hit.object : 127.5 + 127.5 * hit.normal_view[axis]; });
  const Understood got = understand(file, {.fov_deg = 40.0f});
  EXPECT_EQ(got.conventions.depth.model.meaning, DepthMeaning::kPlanar) << got.text();
}

TEST(DepthKinds, ManyPixelsAtTheMaxAreWarnedOf) {
  double far = 0.0;
  for (const Hit& hit : scene().hits) far = std::max(far, hit.found ? hit.depth : 0.0);
  TestFile file(scene());
  file.add("Z", float(far), [](const Hit& hit) { return hit.depth; });
  GBufferSettings settings;
  EXPECT_TRUE(has_warning(understand(file, settings), "`depth_background`")) << understand(file, settings).text();
  settings.depth_background = float(far);
  EXPECT_TRUE(understand(file, settings).facts.warnings.empty()) << understand(file, settings).text();
}

TEST(DepthKinds, NegativeDepthMayHaveZeroAsBackground) {
  TestFile file(scene());
  file.add("Z", 0.0f, [](const Hit& hit) { return -hit.depth; });
  for (const bool by_option : {false, true}) {
    GBufferSettings settings;
    if (by_option) settings.depth_scale = -1.0f;
    const Understood got = understand(file, settings);
    EXPECT_TRUE(got.facts.warnings.empty()) << got.text();
    EXPECT_FLOAT_EQ(got.planes.plane("depth").at(120, 140), float(hit_at(120, 140).depth));
    EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
  }
}

TEST(DepthKinds, NearestPixelsAtZeroAreNoBackgroundBelow) {
  const double near = hit_at(120, 110).depth;
  const Understood got = understand(grey_png(
      65535, 65535.0f, [&](const Hit& hit) { return std::clamp((hit.depth - near) / near, 0.0, 0.9) * 65535.0; }));
  EXPECT_FALSE(has_warning(got, "upside down")) << got.text();
}

}  // namespace
}  // namespace umbrage
