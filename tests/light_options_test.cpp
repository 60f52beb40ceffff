// Tests of the options that change light and colour in every look: each against what it promises.
#include <gtest/gtest.h>

#include <cmath>

#include "draw_picture.h"
#include "generators/builtin.h"
#include "renderer/draw.h"
#include "renderer/hdri.h"
#include "renderer/recipe.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kSide = 96;

/// Returns a model without lights of its own.
Scene model() { return *make_builtin_scene("scene:solids?detail=4000"); }

/// Draws the model; `planes` besides depth.
Image drawn(Request request, std::vector<std::string> planes) {
  request.width = request.height = kSide;
  planes.emplace_back("depth");
  return test::drawn_picture(model(), request, planes).image;
}

/// Returns the mean of a plane over the surfaces whose pixels satisfy `chosen(x, y)`.
template <class Chosen>
double mean(const Image& image, const char* plane, Chosen chosen) {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (std::isfinite(image.plane("depth").at(x, y)) && chosen(x, y)) sum += image.plane(plane).at(x, y), ++count;
  return sum / std::max(count, 1.0);
}
constexpr auto kAll = [](int, int) { return true; };

const std::vector<std::string> kDirect = {"direct.g", "normal.x"};

TEST(LightOptions, TheKeyLightComesFromItsDirection) {
  for (const char* look : {"lit", "studio"}) {
    const auto excess_on_the_right = [&](std::vector<float> direction) {
      const Image image = drawn({.look = look, .anti_aliasing = 1, .light_direction = direction}, kDirect);
      const auto on = [&](float side) {
        return mean(image, "direct.g", [&](int x, int y) { return side * image.plane("normal.x").at(x, y) > 0.5f; });
      };
      return on(1.0f) - on(-1.0f);
    };
    EXPECT_GT(excess_on_the_right({70.0f, 20.0f}), 0.1) << look;
    EXPECT_LT(excess_on_the_right({-70.0f, 20.0f}), -0.1) << look;
    EXPECT_NEAR(
        excess_on_the_right({}),
        excess_on_the_right({look == std::string("lit") ? -35.0f : -50.0f, look == std::string("lit") ? 40.0f : 43.0f}),
        1e-6)
        << look;
  }
}

TEST(LightOptions, FactorsScaleTheirLights) {
  const auto direct = [](Request request) {
    request.look = "studio";
    request.quality = "draft";  // one shadow ray for each light; others give a light more rays if it is the brightest
    request.anti_aliasing = 1;
    return mean(drawn(request, kDirect), "direct.g", kAll);
  };
  const double all = direct({}), none = direct({.key = 0.0f, .fill = 0.0f, .rim = 0.0f});
  EXPECT_EQ(none, 0.0);
  const double key = direct({.fill = 0.0f, .rim = 0.0f}), fill = direct({.key = 0.0f, .rim = 0.0f}),
               rim = direct({.key = 0.0f, .fill = 0.0f});
  EXPECT_GT(key, 2.0 * fill);
  EXPECT_GT(fill, 0.0);
  EXPECT_GT(rim, 0.0);
  EXPECT_NEAR(key + fill + rim, all, 1e-4);
  EXPECT_NEAR(direct({.key = 2.0f, .fill = 0.0f, .rim = 0.0f}), 2.0 * key, 1e-4);
}

TEST(LightOptions, OcclusionHasAStrengthWhateverTheTechnique) {
  for (const std::string technique : {"unsharp", "bitmask", "hbao"}) {
    const auto value = [&](const char* look, float strength) {
      Request request{.look = look, .occlusion = technique, .anti_aliasing = 1, .occlusion_strength = strength};
      if (technique == "unsharp") request.settings = {"unsharp.strength=8"};  // nothing is black
      return mean(drawn(request, {"color.g"}), "color.g", kAll);
    };
    EXPECT_EQ(value("ao", 0.0f), 1.0) << technique;
    const double darkness = 1.0 - value("ao", 1.0f);
    EXPECT_GT(darkness, 0.005) << technique;
    EXPECT_NEAR(1.0 - value("ao", 0.5f), 0.5 * darkness, 1e-3) << technique;
    for (const char* look : {"cartoon", "technical"})
      EXPECT_LT(value(look, 2.0f), value(look, 0.0f)) << look << ' ' << technique;
  }
}

TEST(LightOptions, ShadowsHaveAStrength) {
  const auto light = [](float strength) {
    return mean(drawn({.look = "lit", .anti_aliasing = 1, .shadow_strength = strength}, kDirect), "direct.g", kAll);
  };
  EXPECT_GT(light(0.0f), light(1.0f) + 0.01);
  EXPECT_NEAR(light(0.5f), 0.5 * (light(0.0f) + light(1.0f)), 1e-4);
  const auto cover = [](float strength) {
    const Image image = drawn({.anti_aliasing = 1, .ground = "on", .shadow_strength = strength}, {"shadow_catcher"});
    double sum = 0.0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) sum += image.plane("shadow_catcher").at(x, y);
    return sum;
  };
  // Occlusion on the ground is not a shadow of a light.
  const double without = cover(0.0f), with = cover(1.0f);
  EXPECT_GT(with, without + 10.0);
  EXPECT_NEAR(cover(0.5f), 0.5 * (with + without), 0.1 * (with - without));
}

TEST(LightOptions, ExposureIsInStops) {
  const auto value = [](float stops) {
    return mean(drawn({.look = "lit", .settings = {"output.transfer=none"}, .anti_aliasing = 1, .exposure = stops},
                      {"color.g"}),
                "color.g", kAll);
  };
  EXPECT_NEAR(value(1.0f), 2.0 * value(0.0f), 1e-4);
  EXPECT_NEAR(value(-2.0f), 0.25 * value(0.0f), 1e-4);
}

TEST(LightOptions, ContrastIsAboutMiddleGrey) {
  // lit.r and color.r of one picture without exposure, as linear values.
  const Image drawn_once = drawn(
      {.look = "lit", .settings = {"output.transfer=none", "output.tone=none"}, .anti_aliasing = 1, .contrast = 2.0f},
      {"lit.r", "color.r"});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float light = std::max(drawn_once.plane("lit.r").at(x, y), 0.0f);  // ao below 0 gives less than none
      if (!std::isfinite(drawn_once.plane("depth").at(x, y))) continue;
      ASSERT_NEAR(drawn_once.plane("color.r").at(x, y), light * light / 0.18f, 1e-4f * (1.0f + light * light));
    }
  // Averaging changes pixels at edges, which mix with the background, by as much as without contrast.
  const auto value = [](int frames, float contrast) {
    return mean(drawn({.look = "studio", .anti_aliasing = frames, .ground = "off", .contrast = contrast}, {"color.g"}),
                "color.g", kAll);
  };
  EXPECT_NEAR(value(4, 1.6f) - value(1, 1.6f), value(4, 1.0f) - value(1, 1.0f), 0.015);
  EXPECT_GT(std::abs(value(1, 1.6f) - value(1, 1.0f)), 0.01);
}

TEST(LightOptions, AKeyFactorHoldsForEveryFrameOfATurntable) {
  const auto key_of = [](float factor) {
    Request request{.hdri_file = "sky:", .key = factor};
    auto recipe = make_recipe(request);
    EXPECT_TRUE(read_hdri(recipe->hdri, {}));
    Scene scene = model();
    EXPECT_TRUE(complete_scene(scene, *recipe));
    const auto plan = make_plan(*recipe, scene, 1);
    return std::pair(plan->lighting().lights.at(0).color.g,
                     turned(*plan, scene, 90.0f).lighting().lights.at(0).color.g);
  };
  const auto [first, turned_first] = key_of(1.0f);
  const auto [doubled, turned_doubled] = key_of(2.0f);
  EXPECT_FLOAT_EQ(doubled, 2.0f * first);
  EXPECT_FLOAT_EQ(turned_doubled, 2.0f * turned_first);
}

TEST(LightOptions, ClayReplacesMaterials) {
  const std::vector<std::string> planes = {"albedo.r", "albedo.g", "albedo.b", "specular"};
  const Image clay = drawn({.anti_aliasing = 1, .ground = "off", .material = "clay"}, planes);
  const Image colored = drawn({.anti_aliasing = 1, .ground = "off", .color = Vector3{1.0f, 0.5f, 0.0f}}, planes);
  const Image file = drawn({.anti_aliasing = 1, .ground = "off"}, planes);
  bool differs = false;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      if (!std::isfinite(clay.plane("depth").at(x, y))) continue;
      for (int c = 0; c < 3; ++c) ASSERT_EQ(clay.planes[c].at(x, y), 0.8f);
      ASSERT_EQ(clay.plane("specular").at(x, y), 0.0f);
      ASSERT_EQ(colored.planes[0].at(x, y), 1.0f);
      ASSERT_NEAR(colored.planes[1].at(x, y), 0.21404f, 1e-4f);
      ASSERT_EQ(colored.planes[2].at(x, y), 0.0f);
      differs |= file.planes[0].at(x, y) != 0.8f;
    }
  EXPECT_TRUE(differs);
}

TEST(LightOptions, MetalsMirrorAStudioInEveryLook) {
  Scene scene = model();
  for (const auto& [look, metallic, mirrors] :
       {std::tuple("studio", 0.0f, true), {"lit", 0.0f, false}, {"lit", 1.0f, true}}) {
    scene.materials[0].roughness = 0.2f;
    scene.materials[0].metallic = metallic;
    auto plan = make_plan(*make_recipe({.look = look}), scene, 0);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->lighting().reflections != nullptr, mirrors) << look << metallic;
  }
}

TEST(LightOptions, StylesAreOverriddenByOptions) {
  const auto corner = [](Request request) {
    request.ground = "off";
    request.anti_aliasing = 1;
    return drawn(request, {"color.r", "color.b"}).planes[1].at(1, 1);
  };
  EXPECT_EQ(corner({.style = "white"}), 1.0f);
  EXPECT_LT(corner({.style = "dark"}), 0.2f);
  EXPECT_NEAR(corner({.look = "cartoon", .style = "blueprint"}), 0.36f, 1e-5f);
  EXPECT_EQ(corner({.background = Vector3{0.5f, 0.5f, 0.25f}, .style = "white"}), 0.25f);
  EXPECT_FALSE(make_recipe({.material = "file", .style = "clay"})->clay);
  EXPECT_FALSE(make_recipe({.material = "file", .color = Vector3{1.0f, 0.0f, 0.0f}}));
  const auto refused = make_recipe({.style = "whit"});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("`style` cannot be 'whit' (did you mean 'white'?)"), std::string::npos)
      << refused.error().message;
}

TEST(LightOptions, DirectionsAreTwoAngles) {
  Request request;
  const Option& option = option_of("light_direction");
  for (const char* text : {"", "30", "30,40,50", "181,0", "0,91", "a,b", "nan,0"})
    EXPECT_FALSE(set_option(option, text, request)) << text;
  EXPECT_TRUE(request.light_direction.empty());
  EXPECT_TRUE(set_option(option, "-180,90", request));
  EXPECT_EQ(request.light_direction, (std::vector<float>{-180.0f, 90.0f}));
  request.light_direction = {0.0f, 100.0f};
  EXPECT_FALSE(make_recipe(request));
}

TEST(LightOptions, WhatDoesNothingIsReported) {
  const auto warnings = [](const Request& request, const Scene& scene) {
    return setting_warnings(request, *make_recipe(request), &scene, [](std::string_view) { return true; });
  };
  const Scene scene = model();
  EXPECT_EQ(warnings({.look = "unsharp", .key = 2.0f}, scene),
            (std::vector<std::string>{"`key` does nothing: the look unsharp has its own light"}));
  EXPECT_TRUE(warnings({.light_direction = {10.0f, 20.0f}, .key = 2.0f, .fill = 0.5f, .rim = 0.5f}, scene).empty());
  EXPECT_EQ(warnings({.look = "lit", .rim = 0.5f}, scene),
            (std::vector<std::string>{"`rim` does nothing: the look lit has no such light"}));
  EXPECT_EQ(warnings({.hdri_file = "sky:", .light_direction = {10.0f, 20.0f}}, scene),
            (std::vector<std::string>{"`light_direction` does nothing: an image lights the scene"}));
  Scene lamp = model();
  lamp.lights.resize(1);
  lamp.lights[0].kind = LightKind::kPoint;
  EXPECT_EQ(warnings({.light_direction = {10.0f, 20.0f}}, lamp),
            (std::vector<std::string>{"`light_direction` does nothing: the first light of the scene is a lamp"}));
}

}  // namespace
}  // namespace umbrage
