// Compares `lighting` with Lambert and Blinn-Phong shading [Blinn 1977] in double, and with known results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr int kMaxLights = 16;  // as in lighting.h

// ---- the formulas in double

struct Factors {
  double ambient = 1.0, diffuse = 1.0, specular = 1.0, emission = 1.0, gloss = 0.0, shadow = 1.0;
  bool clay = false;
};

/// The expected light of a pixel, and the max error of a result in float.
struct Lit {
  glm::dvec3 direct{0.0}, ambient{0.0};
  double error = 0.0;
};

glm::dvec3 position_of(const PictureInfo& info, int x, int y, double depth) {
  const Camera& c = info.camera;
  const double u = c.left + (x + 0.5) / info.width * (double(c.right) - c.left);
  const double v = c.top - (y + 0.5) / info.height * (double(c.top) - c.bottom);
  const double spread = c.projection == Projection::kPerspective ? depth : 1.0;
  return {u * spread, v * spread, -depth};
}

/// Returns the light of pixel (x, y) by the formulas in double.
Lit shade(const GBuffer& g, const Factors& f, int x, int y) {
  const Image& image = g.layers[0];
  const auto value = [&](const char* name) { return double(image.plane(name).at(x, y)); };
  const bool perspective = g.info.camera.projection == Projection::kPerspective;
  const glm::dvec3 position = position_of(g.info, x, y, value("depth"));
  const glm::dvec3 normal(value("normal.x"), value("normal.y"), value("normal.z"));
  const glm::dvec3 to_eye = perspective ? -glm::normalize(position) : glm::dvec3(0, 0, 1);
  const glm::dvec3 albedo =
      f.clay ? glm::dvec3(1.0) : glm::dvec3(value("albedo.r"), value("albedo.g"), value("albedo.b"));
  const double exponent = value("shininess");
  Lit lit;
  const glm::dvec4 homogeneous(normal, 1.0);
  for (int c = 0; c < 3; ++c)
    lit.ambient[c] = g.info.ambient[c] +
                     glm::dot(homogeneous, glm::dmat4(g.info.ambient_shape.by_color[std::size_t(c)]) * homogeneous);
  lit.ambient = glm::max(lit.ambient, glm::dvec3(0.0)) * albedo * f.ambient;
  lit.error = 1e-6;
  if (image.find("emission.r") && !f.clay)
    lit.direct = f.emission * glm::dvec3(value("emission.r"), value("emission.g"), value("emission.b"));
  lit.error += 2e-7 * std::max({lit.direct.r, lit.direct.g, lit.direct.b});
  for (std::size_t k = 0; k < g.info.lights.size() && k < std::size_t(kMaxLights); ++k) {
    const Light& light = g.info.lights[k];
    glm::dvec3 to_light(light.direction);
    double attenuation = 1.0;
    if (light.kind == LightKind::kHead && !perspective) to_light = {0, 0, 1};
    if (light.kind == LightKind::kPoint || (light.kind == LightKind::kHead && perspective)) {
      const glm::dvec3 where = light.kind == LightKind::kHead ? glm::dvec3(0.0) : glm::dvec3(light.position);
      const double distance = glm::distance(where, position);
      to_light = (where - position) / distance;
      if (light.kind == LightKind::kPoint && light.reach > 0.0f) attenuation = std::pow(light.reach / distance, 2.0);
    }
    const std::string shadow = k == 0 ? "shadow" : fmt::format("shadow{}", k);
    if (k < 8 && image.find(shadow)) attenuation *= 1.0 - (1.0 - value(shadow.c_str())) * f.shadow;
    const double facing = glm::dot(normal, to_light);
    if (facing <= 0.0) continue;
    double highlight = 0.0;
    if (!f.clay) {
      const double cosine = std::max(0.0, glm::dot(normal, glm::normalize(to_light + to_eye)));
      const double strength = value("specular") * f.specular;
      const bool parallel = light.kind == LightKind::kDirectional || (light.kind == LightKind::kHead && !perspective);
      const bool glossy = parallel && strength < f.gloss;
      highlight = glossy ? f.gloss * std::pow(cosine, 10.0) : strength * std::pow(cosine, exponent);
    }
    const glm::dvec3 color = glm::dvec3(light.color) * attenuation;
    lit.direct += color * (albedo * f.diffuse + highlight) * facing;
    // The error of a cosine is a few times 2^-22; that of its power is the exponent times as large.
    const double brightest = std::max({color.r, color.g, color.b});
    lit.error += brightest * 2e-6 * (f.diffuse + exponent * highlight);
  }
  return lit;
}

/// Compares the effect's results on every target with the formulas.
void compare(const GBuffer& g, const Settings& settings, const Factors& factors) {
  test::on_every_target("lighting", g, settings, [&](const Image& image) {
    long compared = 0, wrong = 0, lit_pixels = 0;
    double worst = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
        const Lit expected = shade(g, factors, x, y);
        for (int c = 0; c < 3; ++c) {
          const double direct = std::fabs(image.plane(kDirect[c]).at(x, y) - expected.direct[c]);
          const double ambient = std::fabs(image.plane(kAmbient[c]).at(x, y) - expected.ambient[c]);
          worst = std::max({worst, direct / expected.error, ambient / expected.error});
          wrong += !(direct <= expected.error && ambient <= expected.error);
        }
        lit_pixels += expected.direct.r > 0.01;
        ++compared;
      }
    EXPECT_EQ(wrong, 0) << "max error " << worst << " times the bound";
    EXPECT_GT(compared, 1000);
    if (factors.diffuse > 0.0 && !g.info.lights.empty()) {
      EXPECT_GT(lit_pixels, compared / 20);
    }
  });
}

/// Returns lights of all kinds. The point lights are away from the surfaces, which have depths of 1.7 to 8.
std::vector<Light> mixed_lights() {
  return {{.kind = LightKind::kDirectional,
           .direction = glm::normalize(glm::vec3(-1.0f, 2.0f, 3.0f)),
           .color = {0.7f, 0.6f, 0.5f},
           .casts_shadow = true},
          {.kind = LightKind::kPoint, .position = {0.5f, 1.5f, -0.5f}, .color = {0.1f, 0.4f, 0.9f}, .reach = 3.0f},
          {.kind = LightKind::kPoint, .position = {-2.0f, -1.0f, 0.5f}, .color = {0.3f, 0.2f, 0.1f}, .reach = 0.0f},
          {.kind = LightKind::kHead, .color = {0.2f, 0.25f, 0.3f}}};
}

GBuffer varied(bool perspective) {
  GBuffer g = test::bumpy_gbuffer(61, 47, 5);
  g.info.lights = mixed_lights();
  g.info.ambient = {0.3f, 0.2f, 0.1f};
  if (!perspective) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 61.0f / 47.0f);
  return g;
}

/// Returns a picture whose pixels are all identical.
GBuffer uniform(int width, int height, float depth, glm::vec3 normal, float albedo) {
  GBuffer g = test::empty_gbuffer(width, height);
  g.info.lights.clear();
  g.layers[0].add("depth") = Plane(width, height, depth);
  for (int c = 0; c < 3; ++c) {
    g.layers[0].add(kNormal[c]) = Plane(width, height, normal[c]);
    g.layers[0].add(kAlbedo[c]) = Plane(width, height, albedo);
  }
  for (const char* name : {"specular", "shininess", "shadow"})
    g.layers[0].add(name) = Plane(width, height, name == std::string_view("specular") ? 0.0f : 1.0f);
  return g;
}

// ---- formulas

TEST(Lighting, MatchesTheFormulasInPerspective) { compare(varied(true), {}, {}); }

TEST(Lighting, MatchesTheFormulasInOrthographicProjection) { compare(varied(false), {}, {}); }

TEST(Lighting, MatchesTheFormulasInAnOffCentreWindow) {
  GBuffer g = varied(true);
  g.info.camera.left = -0.1f, g.info.camera.right = 0.6f, g.info.camera.bottom = 0.2f, g.info.camera.top = 0.5f;
  compare(g, {}, {});
}

TEST(Lighting, FactorsScaleTheirParts) {
  const Settings settings = {{"ambient", "0.5"}, {"diffuse", "2"}, {"specular", "0.25"}, {"shadow", "0.6"}};
  compare(varied(true), settings, {.ambient = 0.5, .diffuse = 2.0, .specular = 0.25, .shadow = 0.6});
  compare(varied(true), {{"specular", "0"}}, {.specular = 0.0});
  compare(varied(false), {{"diffuse", "0"}}, {.diffuse = 0.0});
}

/// Returns a picture with ten lights. The first eight have a shadow plane; `shadow8` is not read.
GBuffer with_shadows() {
  GBuffer g = varied(true);
  g.info.lights.clear();
  for (int k = 0; k < 10; ++k)
    g.info.lights.push_back({.kind = k % 2 ? LightKind::kPoint : LightKind::kDirectional,
                             .direction = glm::normalize(glm::vec3(std::cos(1.0f * k), std::sin(1.0f * k), 1.0f)),
                             .position = {std::cos(2.0f * k), std::sin(2.0f * k), 0.5f},
                             .color = glm::vec3(0.05f * float(k + 1), 0.2f, 0.3f / float(k + 1)),
                             .reach = 3.0f});
  for (int k = 1; k <= 8; ++k) {
    Plane& plane = g.layers[0].add(fmt::format("shadow{}", k));
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = float(test::hash(x + 101u * y + 10007u * k) % 5) / 4.0f;
  }
  return g;
}

TEST(Lighting, GlossIsABroadHighlightOfParallelLights) {
  for (const char* gloss : {"0.1", "0.5", "1"}) compare(varied(true), {{"gloss", gloss}}, {.gloss = std::stod(gloss)});
  compare(varied(false), {{"gloss", "0.3"}, {"specular", "0"}}, {.specular = 0.0, .gloss = 0.3f});
  compare(varied(true), {{"gloss", "0.3"}, {"material", "clay"}}, {.clay = true});
}

TEST(Lighting, EachLightHasItsOwnShadow) {
  const GBuffer g = with_shadows();
  compare(g, {}, {});
  compare(g, {{"shadow", "0.4"}}, {.shadow = 0.4});
  compare(g, {{"shadow", "0"}}, {.shadow = 0.0});
  // The shadow of one light does not affect the others.
  const Effect& effect = *find_effect("lighting");
  for (int dark = 0; dark < 8; ++dark) {
    GBuffer lit = uniform(1, 1, 5.0f, {0, 0, 1}, 1.0f);
    double expected = 0.0;
    for (int k = 0; k < 9; ++k) {
      lit.info.lights.push_back({.direction = {0, 0, 1}, .color = glm::vec3(float(1 << k) / 512.0f)});
      if (k != dark) expected += (1 << k) / 512.0;
      if (k > 0 && k < 8) lit.layers[0].add(fmt::format("shadow{}", k)) = Plane(1, 1, 1.0f);
    }
    lit.layers[0].plane(dark == 0 ? std::string("shadow") : fmt::format("shadow{}", dark)) = Plane(1, 1, 0.0f);
    EXPECT_NEAR(test::run_effect(effect, lit, {}, {}).plane("direct.r").at(0, 0), expected, 1e-6) << dark;
  }
}

TEST(Lighting, EmissionIsDirectLight) {
  GBuffer g = varied(true);
  for (const char* name : {"emission.r", "emission.g", "emission.b"}) {
    Plane& plane = g.layers[0].add(name);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.at(x, y) = float(test::hash(x + 977u * y + unsigned(name[9])) % 100) / 20.0f;
  }
  compare(g, {}, {});
  compare(g, {{"emission", "0.5"}}, {.emission = 0.5});
  compare(g, {{"emission", "0"}}, {.emission = 0.0});
  compare(g, {{"material", "clay"}}, {.clay = true});
}

TEST(Lighting, ClayIsWhiteWithoutHighlights) { compare(varied(true), {{"material", "clay"}}, {.clay = true}); }

TEST(Lighting, RigsReplaceLightsAmbientAndShadow) {
  // Light 0.7 and ambient 0.3 [Chamberlin 2011]; the key light is parallel from above and to the left of the camera.
  const glm::vec3 above_left = glm::normalize(glm::vec3(-0.45f, 0.65f, 0.62f));
  for (const bool perspective : {true, false})
    for (const bool head : {true, false}) {
      const GBuffer g = varied(perspective);
      GBuffer expected = g;
      expected.info.ambient = glm::vec3(0.3f);
      expected.info.ambient_shape = {};
      expected.info.lights = {{.kind = head ? LightKind::kHead : LightKind::kDirectional,
                               .direction = above_left,
                               .color = glm::vec3(0.7f)}};
      test::on_every_target("lighting", g, {{"rig", head ? "head" : "key"}}, [&](const Image& image) {
        long wrong = 0;
        for (int y = 0; y < image.height; ++y)
          for (int x = 0; x < image.width; ++x) {
            if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
            const Lit lit = shade(expected, {.shadow = 0.0}, x, y);
            wrong += !(std::fabs(image.plane("direct.g").at(x, y) - lit.direct.g) <= lit.error);
            wrong += !(std::fabs(image.plane("ambient.b").at(x, y) - lit.ambient.b) <= lit.error);
          }
        EXPECT_EQ(wrong, 0) << head;
      });
    }
}

TEST(Lighting, OnlySixteenLightsShine) {
  GBuffer g = varied(true);
  g.info.lights.clear();
  for (int k = 0; k < 20; ++k)
    g.info.lights.push_back({.direction = glm::normalize(glm::vec3(std::cos(1.0f * k), std::sin(1.0f * k), 1.0f)),
                             .color = glm::vec3(0.02f * (k + 1))});
  compare(g, {}, {});  // the expected result also stops at sixteen
  GBuffer first = g;
  first.info.lights.resize(kMaxLights);
  const Effect& effect = *find_effect("lighting");
  const Image twenty = test::run_effect(effect, g, {}, {}), sixteen = test::run_effect(effect, first, {}, {});
  EXPECT_EQ(test::difference(twenty.plane("direct.r"), sixteen.plane("direct.r"), 0.0).max, 0.0);
  first.info.lights.resize(kMaxLights - 1);
  const Image fifteen = test::run_effect(effect, first, {}, {});
  EXPECT_GT(test::difference(fifteen.plane("direct.r"), sixteen.plane("direct.r"), 0.0).max, 0.05);
}

TEST(Lighting, WithoutLightsOnlyAmbientIsLeft) {
  GBuffer g = varied(true);
  g.info.lights.clear();
  compare(g, {}, {});
  test::on_every_target("lighting", g, {}, [](const Image& image) {
    EXPECT_EQ(test::difference(image.plane("direct.r"), Plane(image.width, image.height, 0.0f), 0.0).max, 0.0);
  });
}

// ---- known results

TEST(Lighting, WhiteFacingTheHeadLightIsWhite) {
  GBuffer g = uniform(5, 3, 4.0f, {0, 0, 1}, 1.0f);
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 1.0f);
  test::on_every_target("lighting", g, {{"rig", "head"}}, [](const Image& image) {
    for (int x = 0; x < image.width; ++x) {
      EXPECT_FLOAT_EQ(image.plane("direct.r").at(x, 1), 0.7f);
      EXPECT_FLOAT_EQ(image.plane("ambient.b").at(x, 2), 0.3f);
    }
  });
}

TEST(Lighting, PointLightFallsOffWithTheSquareOfItsDistance) {
  // The light is straight above the middle pixel and has its colour at the distance `reach`.
  for (const float distance : {1.0f, 2.0f, 4.0f, 8.0f}) {
    GBuffer g = uniform(1, 1, 10.0f, {0, 0, 1}, 0.5f);
    g.info.lights = {
        {.kind = LightKind::kPoint, .position = {0, 0, distance - 10.0f}, .color = glm::vec3(0.8f), .reach = 2.0f}};
    const float expected = 0.5f * 0.8f * 4.0f / (distance * distance);
    test::on_every_target("lighting", g, {}, [&](const Image& image) {
      EXPECT_NEAR(image.plane("direct.r").at(0, 0), expected, 2e-6 * expected) << distance;
    });
    g.info.lights[0].reach = 0.0f;
    test::on_every_target("lighting", g, {}, [&](const Image& image) {
      EXPECT_NEAR(image.plane("direct.r").at(0, 0), 0.4f, 1e-6) << distance;
    });
  }
}

TEST(Lighting, ShadowDarkensTheKeyLightAlone) {
  GBuffer g = uniform(4, 1, 5.0f, {0, 0, 1}, 1.0f);
  for (int x = 0; x < 4; ++x) g.layers[0].plane("shadow").at(x, 0) = float(x) / 3.0f;
  g.info.lights = {{.direction = {0, 0, 1}, .color = glm::vec3(0.6f)},
                   {.direction = {0, 0, 1}, .color = glm::vec3(0.2f)}};
  for (const double fraction : {0.0, 0.5, 1.0})
    test::on_every_target("lighting", g, {{"shadow", fmt::format("{}", fraction)}}, [&](const Image& image) {
      for (int x = 0; x < 4; ++x)
        EXPECT_NEAR(image.plane("direct.r").at(x, 0), 0.6 * (1.0 - fraction * (1.0 - x / 3.0)) + 0.2, 1e-6) << fraction;
    });
}

TEST(Lighting, NoHighlightWhereTheLightIsBehindTheSurface) {
  GBuffer g = uniform(1, 1, 5.0f, glm::normalize(glm::vec3(1.0f, 0.0f, 0.3f)), 0.5f);
  g.layers[0].plane("specular") = Plane(1, 1, 1.0f);
  // The halfway vector is in front of the surface, the light is not.
  g.info.lights = {{.direction = glm::normalize(glm::vec3(-0.4f, 0.0f, 1.0f)), .color = glm::vec3(1.0f)}};
  test::on_every_target("lighting", g, {},
                        [](const Image& image) { EXPECT_EQ(image.plane("direct.r").at(0, 0), 0.0f); });
  g.info.lights[0].direction = glm::normalize(glm::vec3(0.4f, 0.0f, 1.0f));
  test::on_every_target("lighting", g, {},
                        [](const Image& image) { EXPECT_GT(image.plane("direct.r").at(0, 0), 0.5f); });
}

TEST(Lighting, ScaleOfTheSceneDoesNotMatter) {
  for (const float scale : {1e-3f, 1e3f}) {
    GBuffer g = varied(true), scaled = g;
    Plane& depth = scaled.layers[0].plane("depth");
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) depth.at(x, y) *= scale;
    for (Light& light : scaled.info.lights) light.position *= scale, light.reach *= scale;
    const Effect& effect = *find_effect("lighting");
    const Image a = test::run_effect(effect, g, {}, {}), b = test::run_effect(effect, scaled, {}, {});
    // Highlights with exponents up to 101 amplify the rounding of positions.
    EXPECT_LE(test::difference(a.plane("direct.g"), b.plane("direct.g"), 0.0).max, 1e-4) << scale;
    EXPECT_LE(test::difference(a.plane("direct.g"), b.plane("direct.g"), 0.0).mean, 2e-6) << scale;
  }
}

TEST(Lighting, BackgroundAndNonFiniteInputsAreBlack) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  GBuffer g = uniform(8, 1, 5.0f, {0, 0, 1}, 0.5f);
  Image& image = g.layers[0];
  image.plane("depth").at(0, 0) = infinity;
  image.plane("depth").at(1, 0) = nan;
  image.plane("albedo.r").at(2, 0) = nan;
  image.plane("albedo.r").at(3, 0) = infinity;
  image.plane("normal.x").at(4, 0) = nan;
  image.plane("shadow").at(5, 0) = nan;
  for (int c = 0; c < 3; ++c) image.planes[1 + 2 * c].at(6, 0) = 0.0f;  // no valid normal
  g.info.lights = {{.direction = {0, 0, 1}, .color = glm::vec3(1.0f)}};
  ASSERT_EQ(image.names[1], "normal.x");
  ASSERT_EQ(image.names[3], "normal.y");
  ASSERT_EQ(image.names[5], "normal.z");
  test::on_every_target("lighting", g, {}, [](const Image& out) {
    for (int x = 0; x < 7; ++x) EXPECT_EQ(out.plane("direct.r").at(x, 0), 0.0f) << x;
    for (int x = 0; x < 4; ++x) EXPECT_EQ(out.plane("ambient.r").at(x, 0), 0.0f) << x;
    for (int x = 2; x < 4; ++x) EXPECT_NEAR(out.plane("direct.g").at(x, 0), 0.5f, 1e-6) << x;
    EXPECT_NEAR(out.plane("direct.r").at(7, 0), 0.5f, 1e-6);
  });
}

}  // namespace
}  // namespace umbrage
