// Captured masks, shadows and emission, against geometry in double.
#include <functional>
#include <limits>
#include <tuple>

#include "capture_support.h"
#include "devices/cpu/soften.h"
#include "kernel/isa.h"
#include "run_effect.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using namespace test;

// ---- masks and shadows ----

/// Numbers of ground pixels that are wrongly dark or wrongly lit, and of all dark and lit ones; pixels nearer than
/// `margin` to the edge of the shadow are left out.
struct ShadowErrors {
  long wrongly_dark = 0, wrongly_lit = 0, dark = 0, lit = 0;
};

/// Compares the ground's shadow with an exact one. `inside` returns the distance by which the ray from a point of the
/// ground to the light passes inside the occluder; < 0: outside.
ShadowErrors compare_shadow(const Picture& picture, const std::function<double(glm::dvec3)>& inside, double margin,
                            std::string_view plane = "shadow") {
  ShadowErrors errors;
  for (int y = 0; y < picture.info.height; ++y)
    for (int x = 0; x < picture.info.width; ++x) {
      if (picture["object_id"].at(x, y) != 0.0f) continue;
      const double distance_inside = inside(ray_of(picture.info, x, y).at(picture.depth(x, y)));
      if (std::fabs(distance_inside) < margin) continue;
      const float shadow = picture[plane].at(x, y);
      (distance_inside > 0.0 ? errors.dark : errors.lit) += 1;
      if (distance_inside > 0.0) errors.wrongly_lit += shadow != 0.0f;
      if (distance_inside < 0.0) errors.wrongly_dark += shadow != 1.0f;
    }
  return errors;
}

/// Captures a scene with one light from above.
Picture lit_from_above(Scene scene, const Light& light, int size) {
  scene.lights = {light};
  return capture(scene, from_above(12.0f), size, size);
}

TEST(Capture, DirectionalLightCastsTheShadowOfTheSquare) {
  for (const bool orthographic : {true, false}) {
    Scene scene = square_over_ground();
    const glm::vec3 towards(0.9f, 0.5f, 1.0f);
    scene.lights = {key_light(towards)};
    const Camera camera =
        orthographic ? from_above(10.0f) : perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 1.0f);
    const Picture picture = capture(scene, camera, 200, 200);
    const auto inside = [&](glm::dvec3 p) {
      return inside_square(p + glm::dvec3(towards) * ((2.0 - p.z) / towards.z));
    };
    const ShadowErrors errors = compare_shadow(picture, inside, 2e-3);
    EXPECT_EQ(errors.wrongly_dark, 0);
    EXPECT_EQ(errors.wrongly_lit, 0);
    EXPECT_GT(errors.dark, 500);
    EXPECT_GT(errors.lit, 5000);
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        if (picture["object_id"].at(x, y) == 1.0f) {
          ASSERT_EQ(picture["shadow"].at(x, y), 1.0f);
        }
  }
}

TEST(Capture, PointLightCastsTheShadowOfTheSquare) {
  const glm::vec3 lamp(1.0f, 0.6f, 4.5f);
  const Picture picture = lit_from_above(square_over_ground(), key_lamp(lamp), 200);
  const auto inside = [&](glm::dvec3 p) {
    return inside_square(p + (glm::dvec3(lamp) - p) * ((2.0 - p.z) / (lamp.z - p.z)));
  };
  const ShadowErrors errors = compare_shadow(picture, inside, 2e-3);
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
  EXPECT_GT(errors.lit, 5000);
}

TEST(Capture, EachLightHasItsOwnShadow) {
  Scene scene = square_over_ground();
  const glm::vec3 lamp(1.0f, 0.6f, 4.5f);
  const Light sun = key_light({0.9f, 0.5f, 1.0f});
  Light plain = sun;
  plain.casts_shadow = false;
  const auto shadows = [&](std::vector<Light> lights, int count) {
    scene.lights = std::move(lights);
    return capture_with({.width = 200, .height = 200, .shadows = count}, scene, from_above(12.0f));
  };
  const Picture both = shadows({sun, plain, key_lamp(lamp)}, kMaxShadows);
  EXPECT_EQ(both.planes.find("shadow1"), nullptr) << "a light that casts none has no plane";
  EXPECT_EQ(test::difference(both["shadow"], shadows({sun}, kMaxShadows)["shadow"], 0.0).max, 0.0);
  EXPECT_EQ(test::difference(both["shadow2"], shadows({key_lamp(lamp)}, kMaxShadows)["shadow"], 0.0).max, 0.0);
  const auto inside = [&](glm::dvec3 p) {
    return inside_square(p + (glm::dvec3(lamp) - p) * ((2.0 - p.z) / (lamp.z - p.z)));
  };
  const ShadowErrors errors = compare_shadow(both, inside, 2e-3, "shadow2");
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
  EXPECT_GT(errors.lit, 5000);
  // Traces at most as many lights as requested, and as there are planes.
  const Picture first = shadows({sun, plain, key_lamp(lamp)}, 1);
  EXPECT_EQ(first.planes.find("shadow2"), nullptr);
  EXPECT_EQ(test::difference(first["shadow"], both["shadow"], 0.0).max, 0.0);
  const Picture many = shadows(std::vector<Light>(12, sun), kMaxShadows);
  EXPECT_NE(many.planes.find("shadow7"), nullptr);
  EXPECT_EQ(many.planes.find("shadow8"), nullptr);
  EXPECT_EQ(test::difference(many["shadow7"], both["shadow"], 0.0).max, 0.0);
}

TEST(Capture, EmissionIsCapturedIfAMaterialEmits) {
  Scene scene = square_over_ground();
  scene.materials.push_back({.emission = {3.0f, 0.5f, 0.25f}});
  scene.meshes[1].material = 1;
  const Picture picture = capture(scene, from_above(24.0f), 96, 96);
  long emitting = 0, background = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const float object = picture["object_id"].at(x, y);
      ASSERT_EQ(picture["emission.r"].at(x, y), object == 1.0f ? 3.0f : 0.0f);
      ASSERT_EQ(picture["emission.g"].at(x, y), object == 1.0f ? 0.5f : 0.0f);
      ASSERT_EQ(picture["emission.b"].at(x, y), object == 1.0f ? 0.25f : 0.0f);
      emitting += object == 1.0f;
      background += object == -1.0f;
    }
  EXPECT_GT(emitting, 30);
  EXPECT_GT(background, 1000);
  EXPECT_EQ(capture(square_over_ground(), from_above(24.0f), 8, 8).planes.find("emission.r"), nullptr);
}

TEST(Capture, EmissionIsTextured) {
  // White on the left; two texels each, so that their centres are not blended.
  Texture halves{"halves", 4, 1, {255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255}};
  Material lamp;
  lamp.emission = {4, 2, 0};
  lamp.emission_texture = 0;
  Scene scene;
  scene.meshes = {square(1.0f)};
  scene.materials = {lamp};
  scene.textures = {halves};
  ASSERT_EQ(finish_scene(scene), 0u);
  constexpr int kSize = 150;  // above capture_with's limit for GPU comparison, since blends differ in the last bit
  const CaptureSettings settings{kSize, kSize};
  const Camera camera = from_above(2.0f);
  std::vector<Image> pictures = {capture_with(settings, scene, camera).planes};
  for (const VulkanCapture how : test::kGpuCaptures)
    if (Device* const gpu = test::capturing_device(how)) {
      const test::NoMessages no_messages;
      pictures.push_back(test::captured(*gpu, scene, camera, settings));
    }
  for (const Image& picture : pictures)
    for (int y = 5; y < kSize; y += 10) {
      EXPECT_NEAR(picture.plane("emission.r").at(30, y), 4.0f, 1e-4f);
      EXPECT_NEAR(picture.plane("emission.g").at(30, y), 2.0f, 1e-4f);
      EXPECT_NEAR(picture.plane("emission.r").at(120, y), 0.0f, 1e-4f);
      EXPECT_EQ(picture.plane("albedo.r").at(30, y), picture.plane("albedo.r").at(120, y)) << "it has no texture";
    }
}

TEST(Capture, SurfacesBehindAPointLightCastNoShadow) {
  const Light lamp = key_lamp({3.0f, -0.2f, 1.0f});  // lower than the square, which would otherwise shadow x > 4.7
  const Picture picture = lit_from_above(square_over_ground(), lamp, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float object = picture["object_id"].at(x, y);
      if (object == 0.0f) {
        ASSERT_EQ(picture["shadow"].at(x, y), 1.0f) << x << ',' << y;
      }
      if (object == 1.0f) {
        ASSERT_EQ(picture["shadow"].at(x, y), 0.0f) << "the upper side is turned away";
      }
    }
}

/// Returns a sphere of radius 1 with smooth normals.
Mesh sphere_of_rings(int rings) {
  Mesh ball;
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= 2 * rings; ++i) {
      const double polar = std::numbers::pi * j / rings, turn = std::numbers::pi * i / rings;
      const glm::dvec3 at(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
      ball.positions.push_back(glm::vec3(at));
      ball.normals.push_back(glm::vec3(at));
    }
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < 2 * rings; ++i) {
      const std::uint32_t a = std::uint32_t(j * (2 * rings + 1) + i), b = a + 2 * rings + 1;
      if (j > 0) ball.indices.insert(ball.indices.end(), {a, a + 1, b});
      if (j + 1 < rings) ball.indices.insert(ball.indices.end(), {b, a + 1, b + 1});
    }
  return ball;
}

/// Returns the same with an octahedron's faces, each divided into four `times` times; vertices are not shared.
Mesh sphere_of_facets(int times) {
  Mesh ball;
  const std::function<void(glm::dvec3, glm::dvec3, glm::dvec3, int)> add = [&](const glm::dvec3& a, const glm::dvec3& b,
                                                                               const glm::dvec3& c, int level) {
    if (level == 0) {
      for (const glm::dvec3& p : {a, b, c}) {
        ball.indices.push_back(std::uint32_t(ball.positions.size()));
        ball.positions.push_back(glm::vec3(p));
        ball.normals.push_back(glm::vec3(p));
      }
      return;
    }
    const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
    for (const auto& [p, q, r] : {std::tuple(a, ab, ca), {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      add(p, q, r, level - 1);
  };
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        const glm::dvec3 first(x, 0, 0), second(0, y, 0), third(0, 0, z);
        x* y* z > 0.0 ? add(first, second, third, times) : add(first, third, second, times);
      }
  return ball;
}

/// Captures a sphere under a light parallel to none of its edges. Returns the number of pixels whose shadow differs
/// from that of a sphere with these normals, as a fraction.
double wrong_shadows(const Mesh& ball, bool smooth) {
  Scene scene = scene_of({ball});
  const glm::dvec3 towards = glm::normalize(glm::dvec3(1.0, 0.37, 0.21));
  scene.lights = {key_light(glm::vec3(towards))};
  const Picture planes = capture(scene, from_above(1.2f), 140, 140);
  int lit = 0, dark = 0, wrong = 0;
  for (int y = 0; y < 140; ++y)
    for (int x = 0; x < 140; ++x) {
      if (!std::isfinite(planes.depth(x, y))) continue;
      const double facing = glm::dot(planes.normal(x, y), towards);  // the camera's axes are those of the world
      if (smooth && std::fabs(facing) < 0.02) continue;              // one degree
      const bool shines = planes["shadow"].at(x, y) > 0.5f;
      (facing > 0.0 ? lit : dark) += 1;
      wrong += shines != (facing > 0.0);
    }
  EXPECT_GT(lit, 2000);
  EXPECT_GT(dark, 2000);
  return double(wrong) / (lit + dark);
}

TEST(Capture, ShadowsOfACoarseSphereBeginWhereItsNormalsTurnAway) {
  // Where light grazes a sphere of few triangles with smooth normals, its triangles occlude each other. The shadow must
  // begin where that of a smooth sphere does, and not along the edges of triangles.
  EXPECT_LT(wrong_shadows(sphere_of_rings(16), false), 0.005);
  for (const int times : {1, 2, 3, 6}) EXPECT_LT(wrong_shadows(sphere_of_facets(times), true), 0.002) << times;
}

TEST(Capture, TrianglesOfAFlatShadedSphereAreLitIfTheyFaceTheLight) {
  for (const int times : {1, 2, 3}) {
    Mesh ball = sphere_of_facets(times);
    for (std::size_t v = 0; v < ball.positions.size(); v += 3)
      for (std::size_t k = 0; k < 3; ++k)
        ball.normals[v + k] = glm::normalize(
            glm::cross(ball.positions[v + 1] - ball.positions[v], ball.positions[v + 2] - ball.positions[v]));
    EXPECT_EQ(wrong_shadows(ball, false), 0.0) << times;
  }
}

TEST(Capture, LightFromBelowLeavesTheUpperSideInShadow) {
  Scene scene = scene_of({square(8.0f)});
  scene.lights = {key_light({0.3f, 0.1f, -1.0f})};
  const Picture picture = capture(scene, from_above(4.0f), 8, 8);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(picture["shadow"].at(x, 5), 0.0f);
  // The lower side is lit.
  const Camera below = orthographic_camera({0, 0, -10}, {0, 0, 0}, {0, 1, 0}, 4.0f, 1.0f);
  const Picture other = capture(scene, below, 8, 8);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(other["shadow"].at(x, 5), 1.0f);
}

TEST(Capture, OnlyAShadowCastingKeyLightHasAShadow) {
  Scene scene = square_over_ground();
  Light light = key_light({0.9f, 0.5f, 1.0f});
  const auto darkest = [&](const std::vector<Light>& lights) {
    scene.lights = lights;
    const Picture picture = capture(scene, from_above(10.0f), 64, 64);
    float min = 1.0f;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) min = std::min(min, picture["shadow"].at(x, y));
    return min;
  };
  EXPECT_EQ(darkest({light}), 0.0f);
  Light plain = light;
  plain.casts_shadow = false;
  EXPECT_EQ(darkest({plain}), 1.0f);
  EXPECT_EQ(darkest({plain, light}), 1.0f);
  EXPECT_EQ(darkest({}), 1.0f);
  EXPECT_EQ(darkest({{.kind = LightKind::kHead, .casts_shadow = true}}), 1.0f);
}

TEST(Capture, ShadowsCanBeDisabled) {
  Scene scene = square_over_ground();
  scene.lights = {key_light({0.9f, 0.5f, 1.0f})};
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto frame = device->capture(from_above(10.0f), {32, 32, false});
  const Image image = *device->download(*frame, {"shadow"});
  EXPECT_EQ(test::difference(image.planes[0], Plane(32, 32, 1.0f), 0.0).max, 0.0);
}

TEST(Capture, MasksCutHoles) {
  const Picture picture = capture(holed_square_over_ground(), from_above(4.0f), 128, 128);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const glm::dvec3 p = ray_of(picture.info, x, y).origin;
      const double square = inside_square(p), hole = square - 0.5;
      if (std::fabs(square) < 0.02 || std::fabs(hole) < 0.04) continue;  // a texel is 1/32 wide
      const bool solid = square > 0.0 && hole < 0.0;
      ASSERT_EQ(picture["object_id"].at(x, y), solid ? 1.0f : 0.0f) << x << ',' << y;
      ASSERT_NEAR(picture.depth(x, y), solid ? 8.0 : 10.0, 1e-4);
      if (solid) {
        ASSERT_NEAR(picture["albedo.r"].at(x, y), linear(200), 0.01);
      }
    }
}

TEST(Capture, MasksCutHolesIntoShadows) {
  const glm::vec3 towards(0.9f, 0.5f, 1.0f);
  const Picture picture = lit_from_above(holed_square_over_ground(), key_light(towards), 256);
  const auto inside = [&](glm::dvec3 p) {
    const double square = inside_square(p + glm::dvec3(towards) * ((2.0 - p.z) / towards.z));
    return std::min(square, 0.5 - square);
  };
  const ShadowErrors errors = compare_shadow(picture, inside, 0.04);
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
}

TEST(Capture, AMaskWithoutAlphaOrCoordinatesCutsNothing) {
  Scene scene = holed_square_over_ground();
  scene.meshes[1].uvs.clear();
  const Picture picture = capture(scene, from_above(4.0f), 64, 64);
  EXPECT_EQ(picture["object_id"].at(36, 35), 1.0f);  // the centre of the square
}

struct ScaleAndOffset {
  float scale, offset;  // offset from the origin, relative to the size of the scene
};

class ShadowAcne : public testing::TestWithParam<ScaleAndOffset> {};

TEST_P(ShadowAcne, OpenGroundIsLitEverywhere) {
  const auto [scale, offset] = GetParam();
  // A tilted ground of many triangles, whose vertices are rounded to floats at that offset.
  const glm::vec3 middle = offset * scale * glm::normalize(glm::vec3(0.6f, 0.3f, -0.8f));
  const glm::vec3 u1(2.0f, 0.1f, 0.3f), v1(-0.2f, 1.9f, 0.4f);
  Mesh ground = shapes::quad(-0.5f * (u1 + v1), 0.5f * (u1 - v1), 0.5f * (u1 + v1), 0.5f * (v1 - u1), 40, 40);
  for (glm::vec3& p : ground.positions) p = p * scale + middle;
  const glm::vec3 normal = glm::normalize(glm::cross(u1, v1));
  const glm::vec3 along = glm::normalize(u1);
  for (const float lamp : {0.0f, 0.5f, 2.0f, 6.0f, 30.0f})  // distance; 0: the sun
    for (const float sine : {0.06f, 0.3f, 1.0f}) {
      Scene scene = scene_of({ground});
      const glm::vec3 towards = sine * normal + std::sqrt(1.0f - sine * sine) * along;
      scene.lights = {lamp > 0.0f ? key_lamp(middle + lamp * scale * towards) : key_light(towards)};
      for (const float elevation : {0.15f, 0.9f}) {
        const glm::vec3 eye = middle + scale * (4.0f * elevation * normal - 3.0f * glm::normalize(v1));
        const Picture picture = capture(scene, perspective_camera(eye, middle, normal, 35.0f, 1.0f), 160, 160);
        long dark = 0, hits = 0;
        for (int y = 0; y < 160; ++y)
          for (int x = 0; x < 160; ++x) {
            if (!std::isfinite(picture.depth(x, y))) continue;
            ++hits;
            dark += picture["shadow"].at(x, y) != 1.0f;
          }
        EXPECT_EQ(dark, 0) << "of " << hits << (lamp > 0.0f ? ", lamp " : ", sun ") << lamp << " at " << sine
                           << ", seen from " << elevation;
        EXPECT_GT(hits, 1000);
      }
    }
}

TEST_P(ShadowAcne, ObjectsOnTheGroundCastShadows) {
  const auto [scale, offset] = GetParam();
  // A box on the ground casts a shadow as long as its height, which begins at its base.
  const glm::vec3 middle = offset * scale * glm::normalize(glm::vec3(0.6f, 0.3f, -0.8f));
  Mesh ground = square(2.0f), box = shapes::box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 0.5f});
  for (Mesh* mesh : {&ground, &box})
    for (glm::vec3& p : mesh->positions) p = p * scale + middle;
  Scene scene = scene_of({ground, box});
  scene.lights = {key_light({-1.0f, 0.0f, 1.0f})};
  const Camera camera =
      orthographic_camera(middle + glm::vec3(0, 0, 5.0f * scale), middle, {0, 1, 0}, 4.0f * scale, 1.0f);
  const Picture picture = capture(scene, camera, 100, 100);
  // Row 50 crosses the centre of the box; the shadow extends from x = 0.5 to 1, which is pixels 62 to 74.
  long dark = 0;
  for (int x = 0; x < 100; ++x) dark += picture["object_id"].at(x, 50) == 0.0f && picture["shadow"].at(x, 50) == 0.0f;
  EXPECT_NEAR(dark, 12, 2);
  EXPECT_EQ(picture["shadow"].at(66, 50), 0.0f);
  EXPECT_EQ(picture["shadow"].at(80, 50), 1.0f);
  EXPECT_EQ(picture["shadow"].at(30, 50), 1.0f);
}

INSTANTIATE_TEST_SUITE_P(Scales, ShadowAcne,
                         testing::Values(ScaleAndOffset{1e-12f, 0.0f}, ScaleAndOffset{1e12f, 0.0f},
                                         ScaleAndOffset{1e-3f, 0.0f}, ScaleAndOffset{1.0f, 0.0f},
                                         ScaleAndOffset{1e4f, 0.0f}, ScaleAndOffset{1e-3f, 1e3f},
                                         ScaleAndOffset{1.0f, 1e3f}, ScaleAndOffset{1e4f, 1e3f}),
                         [](const auto& info) {
                           const long power = std::lround(std::log10(info.param.scale));
                           return fmt::format("Scale{}1e{}{}", power < 0 ? "Minus" : "", std::abs(power),
                                              info.param.offset > 0.0f ? "Far" : "AtOrigin");
                         });

}  // namespace

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
