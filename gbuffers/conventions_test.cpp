// G-buffers in the conventions of renderers: depth and normals come back without an option.
#include <gtest/gtest.h>

#include "gbuffers/test_scene.h"

namespace umbrage {
namespace {

using test::Hit;
using test::scene;
using test::TestFile;
using test::TestScene;
using test::understand;
using test::Understood;

/// Depth, relative to the true one, and normals of a result against the scene's. `up_to_scale`: the unit of depth is
/// free.
struct Deviation {
  double depth = 0.0, normal = 0.0;
  int wrong_background = 0;
};

Deviation deviation_of(const Understood& got, const TestScene& made, bool up_to_scale = false) {
  Deviation out;
  const Plane* depth = got.planes.find("depth");
  if (!depth) return {1e9, 1e9, 1 << 30};
  double scale = 1.0;
  const int middle = made.width / 2 + made.width * (made.height * 3 / 4);
  if (up_to_scale) scale = made.hits[std::size_t(middle)].depth / depth->at(middle % made.width, middle / made.width);
  for (int y = 0; y < made.height; ++y)
    for (int x = 0; x < made.width; ++x) {
      const Hit& hit = made.hits[std::size_t(y * made.width + x)];
      const float d = depth->at(x, y);
      out.wrong_background += std::isfinite(d) != hit.found;
      if (!hit.found || !std::isfinite(d)) continue;
      out.depth = std::max(out.depth, std::abs(double(d) * scale / hit.depth - 1.0));
      if (!got.planes.find("normal.x")) continue;
      const glm::dvec3 n(got.planes.plane("normal.x").at(x, y), got.planes.plane("normal.y").at(x, y),
                         got.planes.plane("normal.z").at(x, y));
      out.normal = std::max(out.normal, glm::length(n - hit.normal_view));
    }
  return out;
}

void expect_same(const Understood& got, const TestScene& made, double depth_bound = 1e-4, double normal_bound = 1e-3,
                 bool up_to_scale = false) {
  ASSERT_EQ(got.error, "");
  const Deviation off = deviation_of(got, made, up_to_scale);
  EXPECT_LE(off.depth, depth_bound) << got.text();
  EXPECT_LE(off.normal, normal_bound) << got.text();
  EXPECT_EQ(off.wrong_background, 0) << got.text();
}

double fov_of(const Understood& got) {
  return 360.0 / 3.14159265358979323846 * std::atan(double(got.conventions.camera.top));
}

double depth_of(const Hit& hit) { return hit.depth; }
double distance_of(const Hit& hit) { return hit.distance; }
glm::dvec3 normal_world(const Hit& hit) { return hit.normal_world; }
glm::dvec3 normal_view(const Hit& hit) { return hit.normal_view; }
glm::dvec3 position_world(const Hit& hit) { return hit.world; }
glm::dvec3 position_view(const Hit& hit) { return hit.view; }
glm::dvec3 grey(const Hit&) { return glm::dvec3(0.5); }

TEST(Conventions, CyclesHasPlanarDepthWorldNormalsAndPositions) {
  TestFile file(scene());
  file.add_vector("ViewLayer.Combined", grey, "RGB");
  file.add("ViewLayer.Combined.A", 0.0f, [](const Hit&) { return 1.0; });
  file.add("ViewLayer.Depth.Z", 1e10f, depth_of);
  file.add_vector("ViewLayer.Normal", normal_world);
  file.add_vector("ViewLayer.Position", position_world);
  file.add_vector("ViewLayer.DiffCol", grey, "RGB");
  file.add_vector("ViewLayer.DiffInd", grey, "RGB");
  const Understood got = understand(file);
  expect_same(got, scene());
  EXPECT_NEAR(fov_of(got), 40.0, 0.01);
  EXPECT_LE(glm::length(glm::dvec3(got.conventions.camera.eye()) - scene().eye), 1e-3);
  ASSERT_TRUE(got.planes.find("ambient.r"));
  EXPECT_FLOAT_EQ(got.planes.plane("ambient.r").at(120, 120), 0.25f);
}

TEST(Conventions, CyclesWithoutPositionsFitsTheCameraToNormals) {
  TestFile file(scene());
  file.add("ViewLayer.Depth.V", 1e10f, depth_of);
  file.add_vector("ViewLayer.Normal", normal_world);
  const Understood got = understand(file);
  expect_same(got, scene());
  EXPECT_NEAR(fov_of(got), 40.0, 0.1) << got.text();
}

TEST(Conventions, PartsOfRecentBlender) {
  TestFile file(scene());
  file.add("Z", 1e10f, depth_of, ChannelType::kFloat, "ViewLayer.Depth");
  file.add_vector("", normal_world, "XYZ", "ViewLayer.Normal");
  file.add_vector("", position_world, "XYZ", "ViewLayer.Position");
  file.add_vector("", grey, "RGB", "ViewLayer.Diffuse Color");
  const Understood got = understand(file);
  expect_same(got, scene());
  EXPECT_TRUE(got.planes.find("albedo.g"));
}

TEST(Conventions, DenoisingDataHasRayDistanceAndCameraNormals) {
  TestFile file(scene());
  file.add_vector("ViewLayer.Noisy Image", grey, "RGB");
  file.add("ViewLayer.Denoising Depth.Z", 0.0f, distance_of);
  file.add_vector("ViewLayer.Denoising Normal", normal_view);
  file.add_vector("ViewLayer.Denoising Albedo", grey, "RGB");
  const Understood got = understand(file);
  expect_same(got, scene());
  EXPECT_NEAR(fov_of(got), 40.0, 0.05) << got.text();
}

TEST(Conventions, PbrtHasPositionsInCameraSpaceAndNoDepth) {
  const auto left_handed = [](glm::dvec3 v) { return glm::dvec3(v.x, v.y, -v.z); };
  TestFile file(scene());
  file.add_vector("", grey, "RGB");
  file.add_vector("P", [&](const Hit& hit) { return left_handed(hit.view); });
  file.add_vector("N", [&](const Hit& hit) { return left_handed(hit.normal_view); });
  file.add_vector("Ns", [&](const Hit& hit) { return left_handed(hit.normal_view); });
  file.add("dzdx", 0.0f, [](const Hit&) { return 0.1; });
  file.add("u", 0.0f, [](const Hit&) { return 0.1; });
  expect_same(understand(file), scene());
}

TEST(Conventions, PositionsInTheWorldGiveDepth) {
  TestFile file(scene());
  file.add_vector("P", position_world);
  file.add_vector("N", normal_world);
  expect_same(understand(file), scene());
}

TEST(Conventions, ArnoldHasUnnamedZ) {
  TestFile file(scene());
  file.add_vector("", grey, "RGB");
  file.add("A", 0.0f, [](const Hit&) { return 1.0; });
  file.add("Z", 0.0f, depth_of);
  file.add_vector("N", normal_world);
  file.add_vector("P", position_world);
  file.add_vector("albedo", grey, "RGB");
  file.add_vector("indirect_diffuse", grey, "RGB");
  const Understood got = understand(file);
  expect_same(got, scene());
  EXPECT_FLOAT_EQ(got.planes.plane("ambient.g").at(120, 120), 0.5f);
}

TEST(Conventions, MitsubaHasDistanceUnderAPlainName) {
  TestFile file(scene());
  file.add_vector("", grey, "RGB");
  file.add("depth.T", 0.0f, distance_of);
  file.add_vector("sh_normal", normal_world);
  file.add_vector("position", position_world);
  expect_same(understand(file), scene());
  TestFile bare(scene());
  bare.add("depth.T", 0.0f, distance_of);
  bare.add_vector("sh_normal", normal_world);
  expect_same(understand(bare), scene(), 3e-4, 1e-3);
}

TEST(Conventions, DistanceWithoutNormalsMakesFlatSurfacesFlat) {
  TestFile file(scene());
  file.add("depth.T", 0.0f, distance_of);
  const Understood got = understand(file);
  expect_same(got, scene(), 5e-3);
  EXPECT_NEAR(fov_of(got), 40.0, 0.5) << got.text();
}

TEST(Conventions, PlanarDepthAloneStaysPlanar) {
  TestFile file(scene());
  file.add("Z", std::numeric_limits<float>::infinity(), depth_of);
  const Understood got = understand(file);
  expect_same(got, scene(), 1e-6);
  EXPECT_NEAR(fov_of(got), 55.0, 1e-3);
  EXPECT_NE(got.text().find("`fov_deg`"), std::string::npos) << got.text();
}

TEST(Conventions, VRayHasCameraNormalsEncoded) {
  TestFile file(scene());
  file.add_vector(
      "VRayZDepth", [](const Hit& hit) { return glm::dvec3(hit.depth); }, "RGB");
  file.add_vector("VRayNormals", [](const Hit& hit) { return hit.normal_view * 0.5 + 0.5; });
  file.add_vector("VRayDiffuseFilter", grey, "RGB");
  expect_same(understand(file), scene());
}

TEST(Conventions, VRayRemappedAndInvertedDepthIsFittedToNormals) {
  TestFile file(scene());
  const double black = 25.0, white = 2.0;  // inverted: near is bright
  file.add_vector(
      "VRayZDepth", [&](const Hit& hit) { return glm::dvec3((hit.depth - black) / (white - black)); }, "RGB");
  file.add_vector("VRayNormals", normal_view);
  const Understood got = understand(file);
  expect_same(got, scene(), 0.02, 0.02, true);
}

TEST(Conventions, KarmaHasDepthOfTheHitInTheNameOfItsPart) {
  TestFile file(scene());
  file.add_vector("C", grey, "RGB");
  file.add("depth", 0.0f, depth_of);
  file.add_vector("N", normal_world, "xyz");
  file.add_vector("P", position_view, "xyz");
  expect_same(understand(file), scene());
}

TEST(Conventions, RenderManAnd3Delight) {
  TestFile renderman(scene());
  renderman.add_vector("Ci", grey, "rgb");
  renderman.add("z", 1e30f, depth_of);
  renderman.add_vector(
      "Nn", [](const Hit& hit) { return glm::dvec3(hit.normal_view.x, hit.normal_view.y, -hit.normal_view.z); });
  renderman.add_vector("__Pworld", position_world);
  expect_same(understand(renderman), scene());
  TestFile delight(scene());
  delight.add("z", 1e38f, distance_of);
  delight.add_vector("N.camera", normal_view, "xyz");
  delight.add_vector("P.camera", position_view, "xyz");
  expect_same(understand(delight), scene());
}

TEST(Conventions, NukeHasInverseDepthAndAnotherLayersZ) {
  TestFile file(scene());
  file.add_vector("", grey, "RGB");
  file.add("character.Z", 0.0f, [](const Hit&) { return 7.0; });
  file.add("depth.Z", 0.0f, [](const Hit& hit) { return 1.0 / hit.depth; });
  file.add("depth.ZBack", 0.0f, [](const Hit&) { return 9.0; });
  file.add_vector("N", normal_view);
  expect_same(understand(file), scene(), 1e-4, 1e-3, true);
}

TEST(Conventions, AnariAndOmniverse) {
  TestFile anari(scene());
  anari.add_vector("channel.color", grey, "RGB");
  anari.add("channel.depth.V", std::numeric_limits<float>::infinity(), distance_of);
  anari.add_vector("channel.normal", normal_world);
  expect_same(understand(anari), scene(), 3e-4, 1e-3);
  TestFile omniverse(scene());
  omniverse.add("DistanceToCameraSD", 0.0f, distance_of);
  omniverse.add("DistanceToImagePlaneSD", 0.0f, depth_of);
  omniverse.add_vector("NormalSD", normal_world);
  expect_same(understand(omniverse), scene());
}

TEST(Conventions, LeftHandedWorldOfGames) {
  // x forward, y right, z up, in centimetres.
  const auto world = [](glm::dvec3 v) { return glm::dvec3(v.y, v.x, v.z); };
  TestFile file(scene());
  file.add("SceneDepth.R", 65504.0f, [](const Hit& hit) { return 100.0 * hit.depth; });
  file.add_vector(
      "WorldNormal", [&](const Hit& hit) { return world(hit.normal_world); }, "RGB");
  file.add_vector(
      "WorldPosition", [&](const Hit& hit) { return 100.0 * world(hit.world); }, "RGB");
  expect_same(understand(file), scene(), 1e-4, 1e-3, true);
}

TEST(Conventions, DepthBuffers) {
  const double n = 0.5, f = 100.0;
  TestFile window(scene());
  window.add("depth", 1.0f, [&](const Hit& hit) { return f * (hit.depth - n) / (hit.depth * (f - n)); });
  window.add_vector("normal", normal_view);
  GBufferSettings settings;
  settings.depth_kind = "window";
  settings.near_plane = 0.5f;
  settings.far_plane = 100.0f;
  settings.fov_deg = 40.0f;
  expect_same(understand(window, settings), scene());
  TestFile reversed(scene());
  reversed.add("depth", 0.0f, [&](const Hit& hit) { return n / hit.depth; });
  reversed.add_vector("normal", normal_view);
  expect_same(understand(reversed), scene(), 1e-4, 1e-3, true);
}

TEST(Conventions, NormalsTellTheWindowOfAnOrthographicCamera) {
  for (const double height : {3.0, 7.0}) {
    const TestScene made(40.0, height);
    TestFile file(made);
    file.add("ViewLayer.Depth.Z", 1e10f, depth_of);
    file.add_vector("ViewLayer.Normal", normal_world);
    for (const bool by_option : {false, true}) {
      GBufferSettings settings;
      settings.orthographic = by_option;
      const Understood got = understand(file, settings);
      expect_same(got, made);
      EXPECT_EQ(got.conventions.camera.projection, Projection::kOrthographic) << got.text();
      EXPECT_NEAR(2.0 * double(got.conventions.camera.top) / height, 1.0, 2e-3) << got.text();
    }
  }
}

TEST(Conventions, NoisyNormalsMakeNoCameraOrthographic) {
  for (const double amount : {0.2, 0.6, 1.5}) {
    TestFile file(scene());
    file.add("ViewLayer.Depth.Z", 1e10f, depth_of);
    std::uint32_t state = 1;
    const auto noise = [&] {
      state = state * 1664525u + 1013904223u;
      return amount * (double(state >> 8) / double(1 << 24) - 0.5);
    };
    file.add_vector("ViewLayer.Normal", [&](const Hit& hit) { return hit.normal_world + noise(); });
    const Understood got = understand(file);
    EXPECT_EQ(got.conventions.camera.projection, Projection::kPerspective) << amount << "\n" << got.text();
  }
}

TEST(Conventions, OnlySurfacesTellTheEncodingOfNormals) {
  TestScene objects;  // without the floor, so that most of the picture is background
  for (Hit& hit : objects.hits) hit.found = hit.found && hit.object != 0;
  for (const bool is_unsigned : {false, true})
    for (const float none : {0.5f, 1.0f, 1e-6f}) {
      TestFile file(objects);
      file.add("Z", std::numeric_limits<float>::infinity(), depth_of);
      for (int axis = 0; axis < 3; ++axis)
        file.add(std::string("N.") + "XYZ"[axis], none, [&](const Hit& hit) {
          return is_unsigned ? hit.normal_view[axis] * 0.5 + 0.5 : hit.normal_view[axis];
        });
      const Understood got = understand(file);
      EXPECT_EQ(got.conventions.normal.offset, is_unsigned ? -1.0 : 0.0) << none << "\n" << got.text();
      expect_same(got, objects, 1e-4, 2e-3);
    }
}

TEST(Conventions, SkyOfBytesDoesNotTellTheEncodingOfNormals) {
  TestScene objects;
  for (Hit& hit : objects.hits) hit.found = hit.found && hit.object != 0;
  TestFile file(objects);
  file.max_integer = 255.0;
  file.add(
      "Z", 255.0f, [](const Hit& hit) { return std::round(255.0 * (1.2 - 3.0 / hit.depth)); }, ChannelType::kUint8);
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("N.") + "XYZ"[axis], 127.5f,
             [&](const Hit& hit) { return 255.0 * (hit.normal_view[axis] * 0.5 + 0.5); });
  const Understood got = understand(file);
  EXPECT_EQ(got.conventions.normal.offset, -1.0) << got.text();
}

TEST(Conventions, DepthTellsTheEncodingThatLengthsLeaveOpen) {
  // The normals are too short.
  for (const bool is_unsigned : {false, true}) {
    TestFile file(scene());
    file.add("Z", std::numeric_limits<float>::infinity(), depth_of);
    for (int axis = 0; axis < 3; ++axis)
      file.add(std::string("N.") + "XYZ"[axis], 0.5f, [&](const Hit& hit) {
        const double n = 0.7 * hit.normal_view[axis];
        return is_unsigned ? n * 0.5 + 0.5 : n;
      });
    const Understood got = understand(file);
    EXPECT_EQ(got.conventions.normal.offset, is_unsigned ? -1.0 : 0.0) << got.text();
  }
}

TEST(Conventions, WarnsOfBrightAlbedoAndIntrinsicsOfAnotherSize) {
  for (const double albedo : {0.9, 230.0}) {
    TestFile file(scene());
    file.add("Z", 0.0f, depth_of);
    file.add_vector(
        "albedo", [&](const Hit&) { return glm::dvec3(albedo); }, "RGB");
    file.add_vector(
        "", [](const Hit& hit) { return 99.0 * hit.normal_view; }, "RGB");  // light may be bright
    const float w = float(scene().width), h = float(scene().height), f = h;
    const Understood got = understand(file, {.focal_length_px = {f, f, w / 2, h / 2}});
    const bool is_bright = albedo > 1.0;
    EXPECT_EQ(test::has_warning(got, "albedo (RGB) has values up to 230"), is_bright) << got.text();
    EXPECT_EQ(got.facts.warnings.size(), std::size_t(is_bright)) << got.text();
    EXPECT_TRUE(test::has_warning(understand(file, {.focal_length_px = {f, f, 1.5f * w, 1.5f * h}}),
                                  "the centre of the intrinsics, (360, 240), is far from the middle of 240 x 160"));
  }
}

TEST(Conventions, NegativeDepthAndFlippedGreen) {
  TestFile file(scene());
  file.add("Z", -1e10f, [](const Hit& hit) { return -hit.depth; });
  file.add_vector(
      "normal",
      [](const Hit& hit) { return glm::dvec3(hit.normal_view.x, -hit.normal_view.y, hit.normal_view.z) * 0.5 + 0.5; },
      "RGB");
  expect_same(understand(file), scene());
}

/// The scene from farther away: nearly all of what is not background is the floor.
TestScene far_scene(bool floor_alone = false) {
  TestScene made;
  made.eye = made.target + 3.5 * (made.eye - made.target);
  made.hits.clear();
  for (int y = 0; y < made.height; ++y)
    for (int x = 0; x < made.width; ++x) made.hits.push_back(made.cast(x, y));
  for (Hit& hit : made.hits) hit.found = hit.found && (!floor_alone || hit.object == 0);
  return made;
}

/// Depth as floats, and normals of 8 bits times `signs`.
TestFile byte_normals(const TestScene& made, const glm::dvec3& signs) {
  TestFile file(made);
  file.add("Z", 0.0f, depth_of);
  file.max_integer = 255.0;
  for (int axis = 0; axis < 3; ++axis)
    file.add(std::string("N.") + "XYZ"[axis], 128.0f,
             [&](const Hit& hit) { return std::round(255.0 * (signs[axis] * hit.normal_view[axis] * 0.5 + 0.5)); });
  return file;
}

TEST(Conventions, FewPixelsTellTheAxesOfByteNormals) {
  const TestScene made = far_scene();
  for (const glm::dvec3 signs : {glm::dvec3(1, 1, 1), glm::dvec3(1, -1, -1), glm::dvec3(1, -1, 1)}) {
    const Understood got = understand(byte_normals(made, signs));
    expect_same(got, made, 1e-4, 0.02);
    EXPECT_NEAR(fov_of(got), 40.0, 1.0) << got.text();
    EXPECT_NE(got.text().find("camera space, x right"), std::string::npos) << got.text();
    EXPECT_TRUE(got.facts.warnings.empty()) << got.text();
  }
}

TEST(Conventions, OneDirectionOfNormalsLeavesAxesOpen) {
  const Understood got = understand(byte_normals(far_scene(true), glm::dvec3(1.0)));
  EXPECT_NE(got.text().find("camera space, x right, y up, z to the camera"), std::string::npos) << got.text();
  EXPECT_TRUE(test::has_warning(got, "one direction")) << got.text();
}

TEST(Conventions, DepthOfAnotherPictureIsWarnedOf) {
  const auto moved_by = [](double across, double down) {
    TestScene moved = scene();
    for (int y = 0; y < moved.height; ++y)
      for (int x = 0; x < moved.width; ++x) {
        const Hit other = moved.cast(x + across, y + down);
        moved.hits[std::size_t(y * moved.width + x)].depth = other.found ? other.depth : 0.0;
      }
    return moved;
  };
  TestScene flipped = scene();
  for (int y = 0; y < flipped.height; ++y)
    for (int x = 0; x < flipped.width; ++x) {
      const Hit& other = test::hit_at(x, flipped.height - 1 - y);
      flipped.hits[std::size_t(y * flipped.width + x)].depth = other.found ? other.depth : 0.0;
    }
  for (const TestScene& made : {moved_by(40.0, 12.0), moved_by(5.0, 0.0), flipped})
    for (const auto normal : {normal_view, normal_world}) {
      TestFile file(made);
      file.add("Z", 0.0f, depth_of);
      file.add_vector("N", normal);
      EXPECT_TRUE(test::has_warning(understand(file), "do not fit")) << understand(file).text();
    }
}

TEST(Conventions, SmoothNormalsOfFacetsFitDepth) {
  // A solid of facets around a ball, whose normals are those of the ball.
  TestScene made;
  made.hits.clear();
  const glm::dvec3 center(0.0, 0.0, -6.0);
  for (int y = 0; y < made.height; ++y)
    for (int x = 0; x < made.width; ++x) {
      const glm::dvec3 ray(made.top() * made.width / made.height * (2.0 * (x + 0.5) / made.width - 1.0),
                           made.top() * (1.0 - 2.0 * (y + 0.5) / made.height), -1.0);
      double enter = 0.0, leave = 1e9;
      for (int k = 0; k < 32; ++k) {
        const double height = (k / 8 + 0.5) / 2.0 - 1.0, angle = 0.785 * (k % 8) + 0.2,
                     across = std::sqrt(1.0 - height * height);
        const glm::dvec3 n(across * std::cos(angle), height, across * std::sin(angle));
        const double t = (glm::dot(n, center) + 1.5) / glm::dot(n, ray);
        (glm::dot(n, ray) < 0.0 ? enter : leave) = glm::dot(n, ray) < 0.0 ? std::max(enter, t) : std::min(leave, t);
      }
      Hit& hit = made.hits.emplace_back();
      hit.found = enter < leave;
      hit.depth = enter;
      hit.normal_view = glm::normalize(enter * ray - center);
    }
  TestFile file(made);
  file.add("Z", 0.0f, depth_of);
  file.add_vector("N", normal_view);
  GBufferSettings settings;
  settings.fov_deg = 40.0f;
  const Understood got = understand(file, settings);
  EXPECT_TRUE(got.facts.warnings.empty()) << got.text();
  EXPECT_NE(got.text().find("camera space, x right, y up, z to the camera"), std::string::npos) << got.text();
}

TEST(Conventions, ConstantThirdChannelLeavesZToTheOthers) {
  for (const float constant : {0.0f, 128.0f, 255.0f})
    for (const bool octahedral : {false, true}) {
      TestFile file = byte_normals(scene(), glm::dvec3(1.0));
      for (std::size_t k = 0; k < scene().hits.size(); ++k) {
        const glm::dvec3 n = glm::abs(scene().hits[k].normal_view);
        for (std::size_t axis = 0; axis < 2 && octahedral; ++axis)
          file.values[1 + axis][k] = 127.5f + (file.values[1 + axis][k] - 127.5f) / float(n.x + n.y + n.z + 1e-9);
        file.values[3][k] = constant;
      }
      const Understood got = understand(file, {.fov_deg = 40.0f});
      expect_same(got, scene(), 1e-4, octahedral ? 2.0 : 0.15);
      EXPECT_NE(got.text().find("third channel is constant"), std::string::npos) << got.text();
      EXPECT_EQ(test::has_warning(got, "third channel is constant"), octahedral) << got.text();
    }
}

}  // namespace
}  // namespace umbrage
