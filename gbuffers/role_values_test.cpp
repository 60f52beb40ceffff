// What names leave open: channels, packed bytes, positions and normals without a known name, masks, encodings per
// layer.
#include "gbuffers/role_values.h"

#include <gtest/gtest.h>

#include <bit>

#include "gbuffers/test_scene.h"

namespace umbrage {
namespace {

using test::has_warning;
using test::Hit;
using test::hit_at;
using test::scene;
using test::TestFile;
using test::understand;
using test::Understood;

double depth_of(const Hit& hit) { return hit.depth; }

/// Checks the depth of all pixels, within a fraction.
void expect_depth(const Understood& got, double tolerance, double scale = 1.0) {
  ASSERT_EQ(got.error, "");
  for (int y = 0; y < scene().height; ++y)
    for (int x = 0; x < scene().width; ++x) {
      const Hit& hit = scene().hits[std::size_t(y * scene().width + x)];
      const float depth = got.planes.plane("depth").at(x, y);
      ASSERT_EQ(std::isfinite(depth), hit.found) << x << ' ' << y << '\n' << got.text();
      if (!hit.found) continue;
      ASSERT_NEAR(depth / (scale * hit.depth), 1.0, tolerance) << x << ' ' << y << '\n' << got.text();
    }
}

bool says(const Understood& got, std::string_view words) { return got.text().find(words) != std::string::npos; }

TEST(RoleValues, DepthIsTheOnlyChannelWithDifferentValues) {
  for (const char letter : {'R', 'G', 'B'})
    for (const std::string layer : {"", "Depth."}) {
      TestFile file(scene());
      for (const char each : {'R', 'G', 'B', 'A'})
        file.add(layer + each, each == 'A' ? 1.0f : 0.0f, [&](const Hit& hit) {
          return each == 'A' ? 1.0 : each == letter ? hit.depth : 0.0;
        });
      expect_depth(understand(file), 1e-6);
    }
  // Beside other layers, too.
  TestFile file(scene());
  for (const char each : {'R', 'G', 'B'})
    file.add(std::string(1, each), 0.0f, [&](const Hit& hit) { return each == 'R' ? hit.depth : 0.0; });
  file.add_vector("N", [](const Hit& hit) { return hit.normal_view; });
  expect_depth(understand(file), 1e-6);
}

/// A PNG with bytes of the depth, or of 100 times the elevation in metres.
TestFile packed_png(const Packing& packing) {
  TestFile file(scene(), "PNG");
  file.max_integer = 255.0;
  const auto bytes_of = [&](const Hit& hit) -> std::uint32_t {
    if (packing.is_bits) return std::bit_cast<std::uint32_t>(hit.found ? float(hit.depth) : 1e4f);
    if (packing.is_height)
      return std::uint32_t((100.0 * hit.world.z - packing.offset) * (packing.offset < -2e4 ? 256.0 : 10.0));
    return hit.found ? std::uint32_t(std::lround(hit.depth / 200.0 * packing.max_integer)) : 0xffffffu;
  };
  // A byte is the one whose weight is highest, next and so on.
  for (std::size_t c = 0; c < 4; ++c) {
    std::uint32_t shift = 0;
    for (std::size_t other = 0; other < packing.channels(); ++other)
      shift += packing.weights[other] < packing.weights[c] ? 8u : 0u;
    file.add(
        std::string(1, "RGBA"[c]), 0.0f,
        [&](const Hit& hit) { return c < packing.channels() ? double(bytes_of(hit) >> shift & 255u) : 255.0; },
        ChannelType::kUint8);
    for (std::size_t k = 0; k < scene().hits.size(); ++k)
      if (!scene().hits[k].found && c < packing.channels())
        file.values.back()[k] = float(bytes_of(scene().hits[k]) >> shift & 255u);
  }
  return file;
}

TEST(RoleValues, PackedBytesAreRefusedWithTheOptionThatReadsThem) {
  for (const Packing& packing : packings()) {
    const TestFile file = packed_png(packing);
    const Understood refused = understand(file);
    EXPECT_NE(refused.error.find("bytes of one number"), std::string::npos) << packing.name << refused.text();
    EXPECT_NE(refused.error.find(packing.name), std::string::npos) << packing.name << refused.text();
    EXPECT_EQ(refused.error.find("`depth_kind` height") != std::string::npos, packing.is_height) << refused.error;
    GBufferSettings settings;
    settings.depth_packing = packing.name;
    const Understood got = understand(file, settings);
    if (!packing.is_height) {
      expect_depth(got, 1e-4, packing.is_bits ? 1.0 : packing.max_integer / 200.0);
      continue;
    }
    ASSERT_EQ(got.error, "");
    EXPECT_EQ(got.conventions.depth.model.meaning, DepthMeaning::kHeight) << got.text();
    const auto at = [&](int x, int y) { return got.planes.plane("depth").at(x, y); };
    const auto height = [&](int x, int y) { return 100.0 * scene().hits[std::size_t(y * scene().width + x)].world.z; };
    EXPECT_NEAR(at(60, 100) - at(150, 80), height(150, 80) - height(60, 100), 0.2) << got.text();
  }
}

TEST(RoleValues, PictureOfLightIsNotTakenForBytes) {
  TestFile file(scene(), "PNG");
  file.max_integer = 255.0;
  for (int c = 0; c < 3; ++c)
    file.add(
        std::string(1, "RGB"[c]), 200.0f,
        [&](const Hit& hit) { return std::round(255.0 * std::pow(0.4 + 0.3 * hit.normal_view[c], 0.45)); },
        ChannelType::kUint8);
  const Understood got = understand(file);
  EXPECT_NE(got.error.find("colour picture"), std::string::npos) << got.text();
  EXPECT_NE(got.error.find("`depth_packing`"), std::string::npos) << got.text();
  EXPECT_NE(got.error.find("FILE:B"), std::string::npos) << got.text();
}

TEST(RoleValues, PointMapIsPositions) {
  for (const bool is_opencv : {true, false}) {
    TestFile file(scene(), "NPY");
    file.add_vector(
        "", [&](const Hit& hit) { return is_opencv ? hit.view * glm::dvec3(1, -1, -1) : hit.view; }, "RGB");
    const Understood got = understand(file);
    expect_depth(got, 1e-4);
    EXPECT_TRUE(says(got, "fitted to positions")) << got.text();
  }
}

TEST(RoleValues, VectorsOfLengthOneThatFitTheDepthAreNormals) {
  TestFile file(scene());
  file.add("dd.y.T", 0.0f, [](const Hit& hit) { return hit.distance; });
  file.add_vector("nn", [](const Hit& hit) { return hit.normal_world; });
  const Understood got = understand(file);
  expect_depth(got, 3e-3);
  EXPECT_TRUE(says(got, "normal: nn (XYZ), signed, world space")) << got.text();
  // Tangents have the length 1, too.
  TestFile tangents(scene());
  tangents.add("Z", 0.0f, depth_of);
  tangents.add_vector("dpdu", [](const Hit& hit) {
    const double a = 3.0 * hit.world.x;
    return glm::normalize(glm::cross(hit.normal_world, glm::dvec3(std::cos(a), std::sin(a), 0.3)));
  });
  EXPECT_FALSE(understand(tangents).planes.find("normal.x")) << understand(tangents).text();
  EXPECT_TRUE(says(understand(tangents), "dpdu (XYZ) are no normals")) << understand(tangents).text();
}

TEST(RoleValues, PositionsWithoutAKnownName) {
  TestFile file(scene());
  file.add_vector("where", [](const Hit& hit) { return hit.world; });
  expect_depth(understand(file), 1e-4);
}

TEST(RoleValues, EncodingIsThatOfEachLayer) {
  TestFile file(scene(), "NPZ");
  const auto add = [&](const std::string& part, const std::string& name, double max, const auto& value) {
    file.max_integer = max;
    file.add(name, 0.0f, value, max > 0.0 ? ChannelType::kUint8 : ChannelType::kFloat, part);
  };
  for (const char letter : {'R', 'G', 'B'})
    add("image", std::string(1, letter), 255.0, [](const Hit&) { return 255.0; });
  add("depth", "Y", 0.0, [](const Hit& hit) { return 0.02 * hit.depth; });
  for (const char letter : {'R', 'G', 'B'}) add("albedo", std::string(1, letter), 0.0, [](const Hit&) { return 0.5; });
  const Understood got = understand(file);
  expect_depth(got, 1e-5, 0.02);
  EXPECT_TRUE(says(got, "depth (Y), planar")) << got.text();
  EXPECT_FLOAT_EQ(got.planes.plane("beauty.r").at(120, 140), 1.0f);
  EXPECT_FLOAT_EQ(got.planes.plane("albedo.r").at(120, 140), 0.5f);
}

TEST(RoleValues, MaskAndIntrinsicsOfAnNpz) {
  TestFile file(scene(), "NPZ");
  file.add(
      "Y", 0.0f, [](const Hit& hit) { return hit.depth; }, ChannelType::kFloat, "depth");
  file.max_integer = 255.0;
  file.add(
      "Y", 0.0f, [](const Hit& hit) { return hit.object == 1 ? 0.0 : 1.0; }, ChannelType::kUint8, "mask");
  const double f = 80.0 / scene().top();
  for (const std::string& text :
       {fmt::format("{},0,120,0,{},80,0,0,1", f, f), fmt::format("{},0,119.5,0,{},79.5,0,0,1", f, f),
        fmt::format("{},0,0.5,0,{},0.5,0,0,1", f / 240.0, f / 160.0), fmt::format("{}", f)}) {
    file.header.attributes = {{"intrinsics", text}};
    const Understood got = understand(file);
    ASSERT_EQ(got.error, "");
    EXPECT_NEAR(got.conventions.camera.top, scene().top(), 1e-6) << text;
    EXPECT_NEAR(got.conventions.camera.bottom, -scene().top(), 1e-6) << text;
    for (std::size_t k = 0; k < scene().hits.size(); ++k) {
      const Hit& hit = scene().hits[k];
      const int x = int(k) % scene().width, y = int(k) / scene().width;
      ASSERT_EQ(std::isfinite(got.planes.plane("depth").at(x, y)), hit.found && hit.object != 1) << x << ' ' << y;
    }
  }
}

TEST(RoleValues, UnrealNamesAndAngle) {
  TestFile file(scene());
  for (const char letter : {'R', 'G', 'B'}) {
    file.add(
        std::string(1, letter), 0.0f, [](const Hit&) { return 0.5; }, ChannelType::kHalf);
    file.add(std::string("FinalImageMovieRenderQueue_WorldDepth.") + letter, 1e6f,
             [](const Hit& hit) { return 100.0 * hit.depth; });
    file.add(std::string("FinalImageMovieRenderQueue_MotionVectors.") + letter, 0.0f, [](const Hit&) { return 0.5; });
    file.add(std::string("FinalImage_BaseColor.") + letter, 0.0f, [](const Hit&) { return 0.25; });
  }
  file.add_vector("FinalImageWorldNormal", [](const Hit& hit) { return hit.normal_world; });
  const double angle = 360.0 / 3.14159265358979 * std::atan(scene().top() * 1.5);
  file.header.attributes = {{"unreal/camera/FinalImage/fov", fmt::format("{}", angle)}};
  const Understood got = understand(file);
  expect_depth(got, 1e-5, 100.0);
  EXPECT_NEAR(got.conventions.camera.top, scene().top(), 1e-5) << got.text();
  EXPECT_TRUE(says(got, "normal: FinalImageWorldNormal (XYZ)")) << got.text();
  EXPECT_TRUE(says(got, "albedo: FinalImage_BaseColor (RGB)")) << got.text();
}

TEST(RoleValues, PointMapsBesideMaskAndConfidence) {
  // OpenCV axes; points of the background are as wrong as networks make them.
  for (const char* name : {"points", "pts3d", "world_points", "anything"}) {
    TestFile file(scene(), "NPZ");
    int axis = 0;
    for (const char* letter : {"R", "G", "B"}) {
      file.add(
          letter, 7.0f, [&](const Hit& hit) { return (axis == 0 ? 1.0 : -1.0) * hit.view[axis]; }, ChannelType::kFloat,
          name);
      ++axis;
    }
    file.add(
        "Y", 0.0f, [](const Hit&) { return 1.0; }, ChannelType::kFloat, "mask");
    file.add(
        "Y", 0.5f, [](const Hit& hit) { return 2.0 + hit.view.x; }, ChannelType::kFloat, "conf");
    const Understood got = understand(file);
    expect_depth(got, 1e-5);
    EXPECT_NEAR(got.conventions.camera.top, scene().top(), 1e-4) << got.text();
    EXPECT_TRUE(says(got, "not used: conf (Y)")) << got.text();
  }
}

TEST(RoleValues, AnglesOfAnNpz) {
  TestFile file(scene(), "NPZ");
  file.add(
      "Y", 0.0f, [](const Hit& hit) { return hit.depth; }, ChannelType::kFloat, "depth");
  const double across = 360.0 / 3.14159265358979 * std::atan(scene().top() * 1.5);
  for (const auto& [name, angle] : {std::pair("fov_y", 40.0), {"fov_x", across}, {"fov", 40.0}}) {
    file.header.attributes = {{name, fmt::format("{}", angle)}};
    const Understood got = understand(file);
    if (std::string(name) == "fov")
      EXPECT_TRUE(has_warning(got, "fov 40 is not used: vertical degrees are `fov_deg`")) << got.text();
    else
      EXPECT_NEAR(got.conventions.camera.top, scene().top(), 1e-5) << got.text();
  }
}

TEST(RoleValues, DepthOfOneSignIsPreferred) {
  TestFile file(scene());
  file.add("Depth.V", 1.0f, [](const Hit& hit) { return 0.1 * (hit.depth - hit_at(120, 110).depth); });
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  const Understood got = understand(file);
  expect_depth(got, 1e-5);
  EXPECT_TRUE(has_warning(got, "the depth Depth (V) is below and above 0: Z is used")) << got.text();
  EXPECT_TRUE(says(got, "not used: Depth (V) (`depth_file` test.exr:Depth.V)")) << got.text();
}

}  // namespace
}  // namespace umbrage
