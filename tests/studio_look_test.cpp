// Tests of the pictures of the look `studio`: brightness, contrast, light, background and composition.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/color.h"
#include "draw_picture.h"
#include "generators/builtin.h"
#include "hue.h"
#include "looks/looks.h"
#include "renderer/draw.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "scene/ground.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kSide = 160;

/// Returns a closed surface of revolution about the y axis that stands on height 0; `radius_at` takes the height, 0 to
/// 1, and the angle.
template <class Radius>
Scene turned_body(Radius radius_at, float height = 1.0f) {
  constexpr int kRows = 60, kColumns = 90;
  Mesh mesh;
  for (int row = 0; row <= kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const float v = float(row) / kRows, angle = 6.2831853f * float(column) / kColumns;
      const float radius = radius_at(v, angle);
      mesh.positions.emplace_back(radius * std::cos(angle), height * v, -radius * std::sin(angle));
    }
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const auto at = [&](int r, int c) { return std::uint32_t(r * kColumns + c % kColumns); };
      const std::uint32_t a = at(row, column), b = at(row, column + 1), c = at(row + 1, column),
                          d = at(row + 1, column + 1);
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  Scene scene;
  scene.name = "body";
  scene.materials.resize(1);
  scene.meshes = {mesh};
  finish_scene(scene);
  return scene;
}

struct NamedScene {
  std::string name;
  Scene scene;
};

/// Models of different shape: round, bumpy, a vessel, flat, tall.
std::vector<NamedScene> models() {
  const auto sphere = [](float v, float) { return std::sqrt(std::max(v * (1.0f - v), 0.0f)); };
  const auto bumpy = [&](float v, float angle) {
    return sphere(v, angle) * (1.0f + 0.12f * std::sin(7.0f * angle) * std::sin(20.0f * v));
  };
  const auto vase = [](float v, float) { return 0.3f + 0.12f * std::sin(6.0f * v); };
  std::vector<NamedScene> all = {{"sphere", turned_body(sphere)},
                                 {"bumpy", turned_body(bumpy)},
                                 {"vase", turned_body(vase)},
                                 {"disc", turned_body(bumpy, 0.3f)},
                                 {"tall", turned_body(bumpy, 3.0f)}};
  for (const char* name : {"claw", "tank", "solids"})
    all.push_back({name, *make_builtin_scene(fmt::format("scene:{}?detail=8000", name))});
  return all;
}

struct Picture {
  Image image;
  PictureInfo info;
  bool is_model(int x, int y) const { return std::isfinite(image.plane("depth").at(x, y)); }
  /// The value that a file of 8 bits holds, without rounding; luma for a whole colour.
  double value(int x, int y) const {
    return 255.0 *
           (0.2126 * image.planes[0].at(x, y) + 0.7152 * image.planes[1].at(x, y) + 0.0722 * image.planes[2].at(x, y));
  }
};

Picture studio(Scene scene, Request request = {}, int side = kSide) {
  request.look = "studio";
  request.width = request.height = side;
  const auto picture =
      test::drawn_picture(std::move(scene), request, {"color.r", "color.g", "color.b", "color.a", "depth"});
  return {picture.image, picture.info};
}

std::vector<double> model_values(const Picture& picture) {
  std::vector<double> values;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (picture.is_model(x, y)) values.push_back(picture.value(x, y));
  std::sort(values.begin(), values.end());
  return values;
}

double percentile(const std::vector<double>& sorted, double percent) {
  return sorted[std::size_t(percent / 100.0 * double(sorted.size() - 1))];
}

TEST(StudioLook, ModelsAreMiddleGreyWithDarkAndLightParts) {
  Request fine;
  fine.quality = "ultra";
  for (const auto& [name, scene] : models()) {
    const auto values = model_values(studio(scene));
    ASSERT_GT(values.size(), 1000u) << name;
    EXPECT_GE(percentile(values, 50), 142.0) << name;
    EXPECT_LE(percentile(values, 50), 168.0) << name;
    EXPECT_LE(percentile(values, 1), 100.0) << name;
    // The noise of fewer rays makes the darkest parts darker.
    EXPECT_GE(percentile(model_values(studio(scene, fine)), 1), 5.0) << name;
    EXPECT_GE(percentile(values, 99), 170.0) << name;
    EXPECT_LE(percentile(values, 99), 248.0) << name;
    EXPECT_LT(values.back(), 255.0) << name;
  }
}

TEST(StudioLook, DarkModelsAreDarker) {
  const auto median = [](float albedo) {
    Scene scene = turned_body([](float v, float) { return std::sqrt(std::max(v * (1.0f - v), 0.0f)); });
    scene.materials[0].albedo = glm::vec3(albedo);
    return percentile(model_values(studio(scene)), 50);
  };
  const double white = median(0.8f), grey = median(0.2f), black = median(0.02f);
  EXPECT_LT(grey, white - 3.0);
  EXPECT_GT(grey, white - 40.0);
  EXPECT_LT(black, grey - 30.0);
}

TEST(StudioLook, HighlightsEndSmoothlyAtTheTerminator) {
  // A red sphere, as of a molecule: its green is that of the highlights, which the rim light adds beside dark parts.
  Scene scene;
  scene.materials = {{.albedo = {0.8f, 0.01f, 0.01f}}};
  scene.meshes = {{.positions = {glm::vec3(0.0f)}, .points = true, .spheres = true, .radii = {1.0f}}};
  finish_scene(scene);
  constexpr int kLarge = 600;
  const Picture picture = studio(scene, {.ground = "off"}, kLarge);
  const auto is_inside = [&](int x, int y) {
    constexpr int kRim = 4;  // pixels in which the normal turns by more than 10 degrees
    for (const int step : {-kRim, kRim})
      if (!picture.is_model(x + step, y) || !picture.is_model(x, y + step)) return false;
    return true;
  };
  double largest = 0.0, brightest = 0.0;
  for (int y = 4; y < kLarge - 4; ++y)
    for (int x = 4; x < kLarge - 4; ++x) {
      if (!is_inside(x, y) || !is_inside(x + 1, y)) continue;
      const double here = 255.0 * picture.image.planes[1].at(x, y);
      largest = std::max(largest, std::fabs(255.0 * picture.image.planes[1].at(x + 1, y) - here));
      brightest = std::max(brightest, here);
    }
  EXPECT_LT(largest, 12.0);
  EXPECT_GT(brightest, 60.0);
}

TEST(StudioLook, BackgroundIsAGradientAndPlainOnRequest) {
  const Scene scene = turned_body([](float, float) { return 0.3f; });
  const Picture picture = studio(scene, {.ground = "off"});
  for (const int x : {0, kSide - 1}) {
    for (int y = 1; y < kSide; ++y) EXPECT_GT(picture.value(x, y), picture.value(x, y - 1)) << x << ' ' << y;
    EXPECT_NEAR(picture.value(x, 0), 200.0, 8.0);
    EXPECT_NEAR(picture.value(x, kSide - 1), 233.0, 3.0);
  }
  const Picture white = studio(scene, {.ground = "off", .background = Vector3{1.0f, 1.0f, 1.0f}});
  for (const int y : {0, kSide / 2, kSide - 1}) EXPECT_EQ(white.image.planes[1].at(0, y), 1.0f);
}

TEST(StudioLook, OnlyTheBackgroundIsDithered) {
  const Scene scene = turned_body([](float, float) { return 0.3f; });
  const Picture plain = studio(scene, {.ground = "off"}),
                dithered = studio(scene, {.ground = "off", .values = PictureValues::kDisplay8});
  int background = 0;
  for (int y = 1; y < kSide - 1; ++y)
    for (int x = 1; x < kSide - 1; ++x) {
      bool inside = true;
      for (int k = 0; k < 9; ++k) inside = inside && plain.is_model(x + k % 3 - 1, y + k / 3 - 1);
      if (inside) {
        ASSERT_EQ(dithered.value(x, y), plain.value(x, y)) << x << ' ' << y;
      }
      background += !plain.is_model(x, y) && dithered.value(x, y) != plain.value(x, y);
    }
  EXPECT_GT(background, kSide * kSide / 4);
}

TEST(StudioLook, ShadowsEndBeforeTheBorder) {
  for (const auto& [name, scene] : models()) {
    if (!scene.views.empty()) continue;  // cameras of their own, which a model may fill to the border
    const Picture with = studio(scene), without = studio(scene, {.ground = "off"});
    double worst = 0.0;
    long shaded = 0;
    for (int y = 0; y < kSide; ++y) {
      const double empty = without.value(0, y);  // the background depends on the row alone
      for (const int x : {0, kSide - 1}) worst = std::max(worst, empty - with.value(x, y));
      for (int x = 0; x < kSide; ++x) {
        if (y == 0 || y == kSide - 1) worst = std::max(worst, empty - with.value(x, y));
        shaded += !with.is_model(x, y) && with.value(x, y) < empty - 40.0;
      }
    }
    EXPECT_LT(worst, 1.0) << name;
    EXPECT_GT(shaded, 150) << name;
  }
}

TEST(StudioLook, ModelsFillThreeQuartersOfTheHeight) {
  const Picture picture = studio(turned_body([](float v, float) { return 0.2f + 0.02f * v; }));
  int first = kSide, last = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (picture.is_model(x, y)) first = std::min(first, y), last = y;
  EXPECT_GE(last - first + 1, 0.75 * kSide);
  EXPECT_LE(last - first + 1, 0.80 * kSide);
  const Camera& camera = picture.info.camera;
  EXPECT_NEAR(2.0 * std::atan(0.5 * (camera.top - camera.bottom)) * 180.0 / 3.14159265, 35.0, 1.0);
}

TEST(StudioLook, LightIsWarmAgainstCool) {
  const Camera camera = perspective_camera({1, 2, 5}, {0, 0, 0}, {0, 1, 0}, 35.0f, 1.0f);
  const Lighting lighting = studio_lighting(camera, {0, 1, 0});
  ASSERT_EQ(lighting.lights.size(), 3u);
  const auto luminance = [](const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); };
  const Light& key = lighting.lights[0];
  const Light& fill = lighting.lights[1];
  const Light& rim = lighting.lights[2];
  EXPECT_GT(key.color.r, 1.1f * key.color.b);
  EXPECT_GT(fill.color.b, 1.1f * fill.color.r);
  // What faces the key light is about three times as bright as what only the fill light and ambient light reach.
  const glm::vec3 level(0, 0, 1);
  const float filled = luminance(fill.color + lighting.ambient + lighting.ambient_shape.at(level));
  const float lit = luminance(key.color + lighting.ambient + lighting.ambient_shape.at(key.direction));
  EXPECT_GT(lit / filled, 2.5f);
  EXPECT_LT(lit / filled, 6.0f);
  // The rim light is behind the model, and does not reach level ground.
  EXPECT_LT(glm::dot(rim.direction, camera.eye()), 0.0f);
  EXPECT_LT(rim.direction.y, 0.0f);
  EXPECT_GT(rim.direction.y, -0.1f);
  // Ambient light comes from above.
  for (const glm::vec3& up : {glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
    const AmbientShape shape = studio_lighting(camera, up).ambient_shape;
    EXPECT_NEAR(luminance(shape.at(up)), 0.074f, 0.003f);
    EXPECT_NEAR(luminance(shape.at(up) + shape.at(-up)), 0.0f, 1e-6f);
  }
}

TEST(StudioLook, FacesOfOtherDirectionsDiffer) {
  Scene scene;
  scene.name = "box";
  scene.materials.resize(1);
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? 0.5f : -0.5f, k & 2 ? 1.0f : 0.0f, k & 4 ? 0.5f : -0.5f);
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  scene.meshes = {mesh};
  finish_scene(scene);
  const Picture picture = studio(scene, {.ground = "off"});
  // The mean of each visible face, by the pixel's position on the box.
  double sum[3] = {};
  long count[3] = {};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      if (!picture.is_model(x, y)) continue;
      const test::PixelRay ray = test::ray_of(picture.info, x, y);
      const glm::dvec3 p = ray.at(picture.image.plane("depth").at(x, y));
      for (int axis = 0; axis < 3; ++axis)
        if (std::fabs(p[axis] - (axis == 1 ? 1.0 : 0.5)) < 0.01) sum[axis] += picture.value(x, y), ++count[axis];
    }
  for (int axis = 0; axis < 3; ++axis) ASSERT_GT(count[axis], 300) << axis;
  const double right = sum[0] / double(count[0]), top = sum[1] / double(count[1]), front = sum[2] / double(count[2]);
  EXPECT_GT(std::fabs(top - front), 15.0);
  EXPECT_GT(std::fabs(top - right), 15.0);
  EXPECT_GT(std::fabs(front - right), 15.0);
}

TEST(StudioLook, LeavesAWiderMarginThanOtherLooks) {
  const Scene scene = turned_body([](float v, float) { return std::sqrt(std::max(v * (1.0f - v), 0.0f)); });
  for (const Look* look : scene_looks()) {
    Request request;
    request.look = look->name;
    const auto recipe = make_recipe(request, kMaxStripPixels);
    ASSERT_TRUE(recipe) << look->name;
    const Camera camera = frame_scene(scene, recipe->framing, 400, 400);
    double extent = 0.0;  // 1: the model reaches the border of the picture
    for (const glm::vec3& p : scene.meshes[0].positions) {
      const glm::vec3 at(camera.view_from_world * glm::vec4(p, 1.0f));
      const float depth = camera.projection == Projection::kPerspective ? -at.z : 1.0f;
      extent = std::max(
          {extent, std::fabs(double(at.x / depth / camera.right)), std::fabs(double(at.y / depth / camera.top))});
    }
    EXPECT_NEAR(extent, 1.0 - 2.0 * double(look->margin), 0.005) << look->name;
  }
  EXPECT_EQ(find_look("studio")->margin, 0.11f);
  EXPECT_EQ(find_look("ao")->margin, 0.06f);
}

TEST(StudioLook, SaturatedColoursStaySaturated) {
  for (const glm::vec3& color : {glm::vec3(0.75f, 0.005f, 0.005f),
                                 {0.005f, 0.75f, 0.005f},
                                 {0.01f, 0.01f, 0.75f},
                                 {0.75f, 0.75f, 0.005f},
                                 {0.75f, 0.005f, 0.75f}}) {
    Scene scene = turned_body([](float v, float) { return std::sqrt(std::max(v * (1.0f - v), 0.0f)); });
    scene.materials[0].albedo = color;
    Request request{.look = "studio", .width = kSide, .height = kSide, .anti_aliasing = 1};
    request.passes = {"lit"};
    const Image image = test::drawn_picture(std::move(scene), request,
                                            {"color.r", "color.g", "color.b", "lit.r", "lit.g", "lit.b", "depth"})
                            .image;
    std::vector<double> turns, kept;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (!std::isfinite(image.plane("depth").at(x, y))) continue;
        glm::dvec3 shown, light;
        for (int c = 0; c < 3; ++c) {
          shown[c] = image.planes[std::size_t(c)].at(x, y);
          light[c] = srgb_from_linear(image.planes[std::size_t(c + 3)].at(x, y));
        }
        const auto before = test::hue_and_saturation(light), after = test::hue_and_saturation(shown);
        turns.push_back(test::angle_between_deg(after.hue_deg, before.hue_deg));
        kept.push_back(after.saturation / before.saturation);
      }
    std::sort(turns.begin(), turns.end());
    std::sort(kept.begin(), kept.end());
    EXPECT_LT(percentile(turns, 99), 5.0) << color.r << color.g << color.b;
    EXPECT_GT(percentile(kept, 5), 0.85) << color.r << color.g << color.b;
  }
}

/// Returns a court of dark walls with two storeys of galleries, over which the sky is open in the middle.
Scene court() {
  Scene scene;
  scene.name = "court";
  scene.materials.resize(2);
  scene.materials[0].albedo = glm::vec3(0.06f, 0.05f, 0.04f);
  scene.materials[1].albedo = glm::vec3(0.5f, 0.45f, 0.4f);
  const auto add = [&](const glm::vec3& low, const glm::vec3& high, int material) {
    Mesh mesh;
    mesh.material = material;
    mesh.object = int(scene.meshes.size());
    for (int k = 0; k < 8; ++k)
      mesh.positions.emplace_back(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    scene.meshes.push_back(std::move(mesh));
  };
  add({-10, -0.2f, -4}, {10, 0, 4}, 1);
  for (const float side : {-1.0f, 1.0f}) {
    const auto add_beside = [&](float x0, float x1, float y0, float y1, float z0, float z1) {
      add({x0, y0, std::min(side * z0, side * z1)}, {x1, y1, std::max(side * z0, side * z1)}, 0);
    };
    add_beside(-10, 10, 0, 8, 4, 4.2f);
    for (const float height : {3.6f, 7.6f}) add_beside(-10, 10, height, height + 0.4f, 1.5f, 4);
    for (float x = -8; x < 9; x += 4) add_beside(x - 0.3f, x + 0.3f, 0, 7.6f, 1.5f, 1.9f);
    add({std::min(10 * side, 10.2f * side), 0, -4.2f}, {std::max(10 * side, 10.2f * side), 8, 4.2f}, 0);
  }
  finish_scene(scene);
  return scene;
}

TEST(StudioLook, ShadeBesideSunlightIsReadable) {
  Request request;
  request.camera = {
      .position = std::array{-9.0, 1.7, 0.0}, .focal_point = std::array{5.0, 2.5, 0.0}, .view_angle_deg = 60.0f};
  const auto values = model_values(studio(court(), request));
  ASSERT_GT(values.size(), 0.8 * kSide * kSide);
  const auto below = [&](double value) {
    return double(std::lower_bound(values.begin(), values.end(), value) - values.begin()) / double(values.size());
  };
  EXPECT_GT(percentile(values, 50), 50.0);
  EXPECT_LT(below(20.0), 0.03);
  EXPECT_LT(1.0 - below(250.0), 0.03);
  EXPECT_GT(percentile(values, 99), 200.0) << "the sun shines";
}

}  // namespace
}  // namespace umbrage
