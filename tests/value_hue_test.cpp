// Values as colours in pictures of all looks: light changes their lightness, not their hue.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/color.h"
#include "draw_picture.h"
#include "generators/builtin.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

/// Returns the a and b of a linear colour in OKLab [Ottosson 2020].
glm::dvec2 oklab_ab(const glm::dvec3& c) {
  const double l = std::cbrt(0.4122214708 * c.r + 0.5363325363 * c.g + 0.0514459929 * c.b),
               m = std::cbrt(0.2119034982 * c.r + 0.6806995451 * c.g + 0.1073969566 * c.b),
               s = std::cbrt(0.0883024619 * c.r + 0.2817188376 * c.g + 0.6299787005 * c.b);
  return {1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

glm::dvec3 linear_of(const Image& image, std::size_t first, int x, int y, bool display) {
  glm::dvec3 c;
  for (int k = 0; k < 3; ++k) {
    const float v = image.planes[first + std::size_t(k)].at(x, y);
    c[k] = display ? double(linear_from_srgb(v)) : double(v);
  }
  return c;
}

/// A built-in scene whose surfaces have a value p that changes by their place.
Scene scene_with_values() {
  Scene scene = *make_builtin_scene("scene:solids?detail=3000");
  for (Mesh& mesh : scene.meshes) {
    Field& field = mesh.fields.emplace_back();
    field.name = "p";
    for (const glm::vec3& p : mesh.positions)
      field.values.push_back(std::sin(3.0f * p.x / scene.radius()) + std::cos(4.0f * p.z / scene.radius()));
  }
  return scene;
}

Request request_of(const std::string& look, const std::string& map) {
  Request request;
  request.look = look;
  request.color_by = "p";
  request.color_map = map;
  request.width = 240;
  request.height = 180;
  request.anti_aliasing = 1;
  request.passes = {"color", "albedo", "depth"};
  return request;
}

/// Returns the 99th percentile of the angle, in degrees, between the hues of surfaces in a picture and of their colours
/// in the map, where both are clear: beside edges and lines pixels have several colours.
double hue_change_deg(const Request& request, std::size_t& count) {
  const auto drawn = test::drawn_picture(
      scene_with_values(), request, {"color.r", "color.g", "color.b", "albedo.r", "albedo.g", "albedo.b", "depth"});
  const Image& image = drawn.image;
  constexpr double kMinChroma = 0.03;  // less is near grey, whose hue is rounding
  std::vector<double> angles;
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 240; ++x) {
      if (!std::isfinite(image.planes[6].at(x, y))) continue;
      const glm::dvec2 shown = oklab_ab(linear_of(image, 0, x, y, true)),
                       map = oklab_ab(linear_of(image, 3, x, y, false));
      if (std::hypot(shown.x, shown.y) < kMinChroma || std::hypot(map.x, map.y) < kMinChroma) continue;
      const double angle = std::atan2(shown.y, shown.x) - std::atan2(map.y, map.x);
      angles.push_back(std::abs(std::remainder(angle * 180.0 / M_PI, 360.0)));
    }
  count = angles.size();
  std::sort(angles.begin(), angles.end());
  return angles.empty() ? 180.0 : angles[std::size_t(0.99 * double(angles.size() - 1))];
}

TEST(ValueHues, LightChangesThemByLessThanThreeDegreesInEveryLook) {
  for (const Look* look : looks()) {
    if (look->needs_beauty || look->is_colorless) continue;
    for (const char* map : {"viridis", "turbo"}) {
      std::size_t count = 0;
      const double change = hue_change_deg(request_of(std::string(look->name), map), count);
      EXPECT_LT(change, 3.0) << look->name << " " << map;
      EXPECT_GT(count, 4000u) << look->name << " " << map;
      RecordProperty(std::string(look->name) + "_" + map, std::to_string(change));
    }
  }
}

TEST(ValueHues, StayUnderExposureContrastAndStrongLight) {
  Request request = request_of("studio", "turbo");
  request.exposure = 1.5f;
  request.contrast = 1.4f;
  request.key = 2.0f;
  std::size_t count = 0;
  EXPECT_LT(hue_change_deg(request, count), 3.0);
  request.settings = {"output.tone=none"};
  EXPECT_GT(hue_change_deg(request, count), 3.0) << "without the tone curve channels are clipped";
}

TEST(ValueHues, LooksWithoutColoursAreRefused) {
  const auto recipe = make_recipe(request_of("hatching", "viridis"));
  ASSERT_FALSE(recipe);
  EXPECT_NE(recipe.error().message.find("hatching"), std::string::npos);
}

TEST(ValueHues, ExposureDoesNotDependOnTheColours) {
  const auto mean = [](const std::string& map, const char* range) {
    Request request = request_of("studio", map);
    if (range) request.color_range = {-100.0f, 100.0f};
    const auto drawn = test::drawn_picture(scene_with_values(), request, {"color.r", "depth", "albedo.r"});
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 240; ++x)
        if (std::isfinite(drawn.image.planes[1].at(x, y))) {
          sum += double(linear_from_srgb(drawn.image.planes[0].at(x, y)) / drawn.image.planes[2].at(x, y));
          ++count;
        }
    return sum / count;
  };
  EXPECT_NEAR(mean("gray", "wide"), mean("coolwarm", "wide"), 0.01) << "grey is darker than the middle of coolwarm";
}

}  // namespace
}  // namespace umbrage
