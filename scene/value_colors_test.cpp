// Tests of values as colours: maps, scales, ranges, missing values, and fields through the changes of a mesh.
#include "scene/value_colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/color.h"
#include "file_folder.h"
#include "scene/fields.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

ColorMap map_named(const std::string& name) {
  auto map = color_map(name);
  EXPECT_TRUE(map) << (map ? "" : map.error().message);
  return map ? *map : ColorMap{"", {{0, 0, 0}, {1, 1, 1}}, false};
}

/// A finished strip of squares in the plane z = 0, with these values at the vertices of its lower and upper side.
Scene strip_with(std::vector<float> values, int components = 1) {
  Scene scene;
  scene.name = "strip";
  Mesh& mesh = scene.meshes.emplace_back();
  const auto count = std::uint32_t(values.size()) / std::uint32_t(components);
  for (std::uint32_t k = 0; k < count; ++k) mesh.positions.emplace_back(float(k / 2), float(k % 2), 0.0f);
  for (std::uint32_t k = 0; k + 3 < count; k += 2)
    mesh.indices.insert(mesh.indices.end(), {k, k + 2, k + 1, k + 1, k + 2, k + 3});
  mesh.fields.push_back({.name = "p", .components = components, .values = std::move(values)});
  finish_scene(scene);
  return scene;
}

ValueSettings settings_of(std::string map = "gray") {
  return {.field = "p", .map = map_named(map), .missing = {0.5f, 0.25f, 0.0f}};
}

ValueColors colors_of(const Scene& scene, const ValueSettings& settings) {
  const Scene* const scenes[] = {&scene};
  std::vector<std::string> warnings;
  const auto colors = value_colors(settings, scenes, warnings);
  EXPECT_TRUE(colors) << (colors ? "" : colors.error().message);
  return colors ? *colors : ValueColors();
}

std::string error_of(const Scene& scene, const ValueSettings& settings) {
  const Scene* const scenes[] = {&scene};
  std::vector<std::string> warnings;
  const auto colors = value_colors(settings, scenes, warnings);
  return colors ? "" : colors.error().message;
}

struct ColorMapFiles : test::FileFolder {};

TEST(ColorMaps, AreWithinTwoStepsOfThePublishedTables) {
  // Entries 0, 64, 128 and 255 of the tables of 256 colours, rounded.
  const std::pair<const char*, std::array<std::array<int, 3>, 4>> kTables[] = {
      {"viridis", {{{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {253, 231, 37}}}},
      {"cividis", {{{0, 34, 78}, {67, 78, 108}, {125, 124, 120}, {254, 232, 56}}}},
      {"magma", {{{0, 0, 4}, {81, 18, 124}, {183, 55, 121}, {252, 253, 191}}}},
      {"inferno", {{{0, 0, 4}, {87, 16, 110}, {188, 55, 84}, {252, 255, 164}}}},
      {"plasma", {{{13, 8, 135}, {126, 3, 168}, {204, 71, 120}, {240, 249, 33}}}},
      {"turbo", {{{48, 18, 59}, {40, 188, 235}, {164, 252, 60}, {122, 4, 3}}}},
      {"coolwarm", {{{59, 76, 192}, {141, 176, 254}, {221, 220, 220}, {180, 4, 38}}}},
      {"RdBu", {{{103, 0, 31}, {229, 131, 104}, {246, 247, 247}, {5, 48, 97}}}},
      {"Spectral", {{{158, 1, 66}, {249, 142, 82}, {255, 255, 190}, {94, 79, 162}}}},
      {"gray", {{{0, 0, 0}, {64, 64, 64}, {128, 128, 128}, {255, 255, 255}}}}};
  ASSERT_EQ(std::size(kTables), color_map_names().size());
  for (const auto& [name, colors] : kTables)
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const float position = float(std::array{0, 64, 128, 255}[k]) / 255.0f;
        EXPECT_NEAR(map_named(name).at(position)[c] * 255.0f, float(colors[k][c]), 2.5f) << name << " " << k;
        EXPECT_NEAR(map_named(name + std::string("_r")).at(1.0f - position)[c], map_named(name).at(position)[c], 1e-5f);
      }
  EXPECT_EQ(map_named("viridis").at(-5.0f), map_named("viridis").at(0.0f));
  EXPECT_EQ(map_named("viridis").at(7.0f), map_named("viridis").at(1.0f));
}

TEST_F(ColorMapFiles, HoldAColourPerLine) {
  const auto map_of = [&](const std::string& text) { return color_map(write("map.csv", text).string()); };
  const auto bytes = map_of("r,g,b\n0,0,255\n\n255; 127.5; 0\r\n");
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_EQ(bytes->colors, (std::vector<std::array<float, 3>>{{0, 0, 1}, {1, 0.5f, 0}}));
  EXPECT_EQ(bytes->at(0.5f), (std::array<float, 3>{0.5f, 0.25f, 0.5f}));
  const auto fractions = map_of("0 0 1\n1 0.5 0\n");
  ASSERT_TRUE(fractions);
  EXPECT_EQ(fractions->colors, bytes->colors);
  const auto names = map_of("#ff0000\nwhite\n");
  ASSERT_TRUE(names);
  EXPECT_EQ(names->colors, (std::vector<std::array<float, 3>>{{1, 0, 0}, {1, 1, 1}}));
  for (const auto& [text, part] : {std::pair("0,0,0\n1,2\n", "line 2"),
                                   {"0,0,0\n0,0,300\n", "line 2"},
                                   {"", "no colours"},
                                   {"1,1,1\n", "one colour"},
                                   {"0,0,0\nx\n1,1,1", "line 2"}}) {
    const auto broken = map_of(text);
    ASSERT_FALSE(broken) << text;
    EXPECT_NE(broken.error().message.find(part), std::string::npos) << broken.error().message;
  }
  EXPECT_NE(map_of(std::string(2 << 20, '\n')).error().message.find("too many"), std::string::npos);
  EXPECT_NE(color_map("nowhere.csv").error().message.find("cannot be opened"), std::string::npos);
  EXPECT_NE(color_map("virdis").error().message.find("did you mean 'viridis'?"), std::string::npos);
}

TEST(ValueColors, ScalesAreInverted) {
  for (const auto& [scale, low, high] : {std::tuple(ValueColors::Scale::kLinear, -2.0f, 6.0f),
                                         {ValueColors::Scale::kLog, 1e-3f, 1e4f},
                                         {ValueColors::Scale::kSymlog, -100.0f, 1e4f}}) {
    ValueColors colors{.low = low, .high = high, .scale = scale, .linear_threshold = 10.0f};
    EXPECT_NEAR(position_on_scale(colors, low), 0.0f, 1e-6f);
    EXPECT_NEAR(position_on_scale(colors, high), 1.0f, 1e-6f);
    for (const float position : {0.0f, 0.1f, 0.37f, 0.9f, 1.0f})
      EXPECT_NEAR(position_on_scale(colors, value_on_scale(colors, position)), position, 1e-5f) << int(scale);
    EXPECT_TRUE(std::isnan(position_on_scale(colors, kNaN)));
    EXPECT_TRUE(std::isnan(position_on_scale(colors, kInfinity)));
  }
  const ValueColors log{.low = 1.0f, .high = 100.0f, .scale = ValueColors::Scale::kLog};
  EXPECT_NEAR(position_on_scale(log, 10.0f), 0.5f, 1e-6f);
  EXPECT_TRUE(std::isnan(position_on_scale(log, 0.0f)));
  const ValueColors symlog{
      .low = -100.0f, .high = 100.0f, .scale = ValueColors::Scale::kSymlog, .linear_threshold = 1.0f};
  EXPECT_NEAR(position_on_scale(symlog, 0.0f), 0.5f, 1e-6f);
  EXPECT_NEAR(position_on_scale(symlog, 1.0f) - 0.5f, 0.5f / (1.0f + std::log(100.0f)), 1e-6f);
}

TEST(ValueColors, RangesAreThoseOfFiniteValuesOfAllScenes) {
  const Scene a = strip_with({1, 2, 3, kNaN, kInfinity, 4}), b = strip_with({-5, 0, 0, 0});
  const Scene* const both[] = {&a, &b};
  std::vector<std::string> warnings;
  const auto colors = value_colors(settings_of(), both, warnings);
  ASSERT_TRUE(colors);
  EXPECT_EQ(colors->low, -5.0f);
  EXPECT_EQ(colors->high, 4.0f);
  EXPECT_TRUE(warnings.empty());
  ValueSettings log = settings_of();
  log.scale = ValueColors::Scale::kLog;
  EXPECT_EQ(colors_of(strip_with({-1, 0, 2, 8}), log).low, 2.0f);
  EXPECT_NE(error_of(strip_with({-1, 0, -2, 0}), log).find("no value above 0"), std::string::npos);
  EXPECT_NE(error_of(strip_with({kNaN, kNaN, kNaN, kNaN}), settings_of()).find("no finite value"), std::string::npos);
  const Scene flat = strip_with({3, 3, 3, 3});
  const Scene* const one[] = {&flat};
  const auto widened = value_colors(settings_of(), one, warnings);
  ASSERT_TRUE(widened);
  EXPECT_LT(widened->low, 3.0f);
  EXPECT_GT(widened->high, 3.0f);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("all values of 'p' are 3"), std::string::npos);
  ValueSettings elsewhere = settings_of();
  elsewhere.range = {10.0f, 20.0f};
  EXPECT_EQ(value_colors(elsewhere, one, warnings)->low, 10.0f);
  EXPECT_NE(warnings.back().find("outside of `color_range` 10,20"), std::string::npos);
  const Scene coarse = strip_with({1e9f, 1e9f + 64.0f, 1e9f + 128.0f, 1e9f});
  const Scene* const far[] = {&coarse};
  ASSERT_TRUE(value_colors(settings_of(), far, warnings));
  EXPECT_NE(warnings.back().find("kept as floats"), std::string::npos) << warnings.back();
}

TEST(ValueColors, ErrorsNameTheFieldsAndComponentsThereAre) {
  Scene scene = strip_with({1, 2, 3, 4});
  ValueSettings settings = settings_of();
  settings.field = "q";
  scene.meshes[0].fields[0].name = "pressure";
  EXPECT_NE(error_of(scene, settings).find("available: pressure"), std::string::npos) << error_of(scene, settings);
  settings.field = "presure";
  EXPECT_NE(error_of(scene, settings).find("did you mean 'pressure'?"), std::string::npos);
  scene.meshes[0].fields.clear();
  EXPECT_NE(error_of(scene, settings).find("'strip' has no fields of values"), std::string::npos);
  ValueSettings component = settings_of();
  component.component = 2;
  EXPECT_NE(error_of(strip_with({1, 2, 3, 4, 5, 6, 7, 8}, 2), component).find("0 to 1"), std::string::npos);
}

TEST(ValueColors, VectorsAreShownByLengthOrComponent) {
  const Scene scene = strip_with({3, 4, 0, 1, 5, 12, 8, 6}, 2);
  EXPECT_EQ(colors_of(scene, settings_of()).low, 1.0f);
  EXPECT_EQ(colors_of(scene, settings_of()).high, 13.0f);
  ValueSettings settings = settings_of();
  settings.component = 1;
  EXPECT_EQ(colors_of(scene, settings).high, 12.0f);
  EXPECT_EQ(colors_of(scene, settings).name, "p.y");
}

TEST(ValueColors, ShownTrianglesHaveTheirPositionOnTheScaleAsTextureCoordinate) {
  Scene scene = strip_with({0, 10, 2.5f, 7.5f, 20, -20});
  ValueSettings settings = settings_of();
  settings.range = {0.0f, 10.0f};
  ASSERT_TRUE(show_values(settings, scene));
  ASSERT_EQ(scene.meshes.size(), 1u);
  std::vector<float> positions;
  for (const glm::vec2& uv : scene.meshes[0].uvs) positions.push_back(uv.x);
  std::sort(positions.begin(), positions.end());
  EXPECT_EQ(positions, (std::vector<float>{-2.0f, 0.0f, 0.25f, 0.75f, 1.0f, 2.0f}));
  const Texture& texture = scene.textures.at(std::size_t(scene.materials[0].texture));
  EXPECT_TRUE(texture.clamped);
  EXPECT_EQ(texture.height, 1);
  EXPECT_TRUE(scene.meshes[0].fields.empty());
  ASSERT_TRUE(scene.value_colors);
  EXPECT_EQ(scene.value_colors->at(0.0f), (std::array<float, 3>{0, 0, 0}));
  EXPECT_EQ(scene.value_colors->at(1.0f), (std::array<float, 3>{1, 1, 1}));
  EXPECT_EQ(scene.value_colors->missing_count, 0u);
}

TEST(ValueColors, BandsHaveOneColourEach) {
  Scene scene = strip_with({0, 1, 2, 3});
  ValueSettings settings = settings_of();
  settings.bands = 3;
  ASSERT_TRUE(show_values(settings, scene));
  EXPECT_EQ(scene.value_colors->bands, 3);
  for (const float f : {0.0f, 0.3f, 0.34f, 0.66f, 0.67f, 1.0f})
    EXPECT_EQ(scene.value_colors->at(f)[1], f < 0.33f ? 0.0f : f > 0.667f ? 1.0f : 0.5f) << f;
  EXPECT_EQ(scene.textures.at(0).width, 3);
  EXPECT_TRUE(scene.textures.at(0).nearest);
}

TEST(ValueColors, TrianglesWithoutAValueHaveTheMissingColourAndAreCounted) {
  Scene scene = strip_with({0, 1, 2, 3, 4, kNaN, 6, 7});
  ASSERT_EQ(scene.triangle_count(), 6u);
  ASSERT_TRUE(show_values(settings_of(), scene));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].indices.size() / 3, 3u);
  EXPECT_EQ(scene.meshes[1].indices.size() / 3, 3u);
  EXPECT_EQ(scene.meshes[1].positions.size(), scene.meshes[1].normals.size());
  EXPECT_EQ(scene.meshes[1].object, scene.meshes[0].object);
  const glm::vec3 albedo = scene.materials.at(std::size_t(scene.meshes[1].material)).albedo;
  EXPECT_NEAR(albedo.r, linear_from_srgb(0.5f), 1e-6f);
  EXPECT_EQ(scene.value_colors->missing_count, 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "3 of 6 triangles have no finite 'p' and are drawn in `missing_color` #804000");
}

TEST(ValueColors, PointsHaveColours) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.points = true;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5f, 0.2f, 0}};
  mesh.fields.push_back({.name = "p", .values = {0, 1, 2, kNaN, 4}});
  finish_scene(scene);
  // finish_scene reorders points.
  const Mesh& finished = scene.meshes[0];
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(finished.fields[0].values[k] == 1.0f, finished.positions[k] == glm::vec3(1, 0, 0));
  ASSERT_TRUE(show_values(settings_of(), scene));
  for (std::size_t k = 0; k < 5; ++k) {
    const glm::vec3 color = scene.meshes[0].colors[k], p = scene.meshes[0].positions[k];
    if (p == glm::vec3(0, 1, 0)) {
      EXPECT_NEAR(color.g, linear_from_srgb(0.5f), 1e-5f);
    }
    if (p == glm::vec3(1, 1, 0)) {
      EXPECT_NEAR(color.g, linear_from_srgb(0.25f), 1e-5f);
    }
  }
  EXPECT_NE(scene.warnings.at(0).find("1 of 5 points"), std::string::npos);
}

TEST(ValueColors, TakeTheRangeThatTheSceneHas) {
  Scene scene = strip_with({0, 1, 2, 3});
  scene.value_colors = std::make_shared<const ValueColors>(
      ValueColors{.name = "p", .low = -10.0f, .high = 10.0f, .map = map_named("gray")});
  ASSERT_TRUE(show_values(settings_of(), scene));
  EXPECT_EQ(scene.value_colors->low, -10.0f);
  const auto& uvs = scene.meshes[0].uvs;
  EXPECT_TRUE(std::any_of(uvs.begin(), uvs.end(), [](glm::vec2 uv) { return uv.x == 0.5f; }));
}

TEST(Fields, ValuesOfTrianglesLeaveNormalsSmooth) {
  // A fold of 20 degrees, smoothed by one normal per vertex, with an unused vertex and a degenerate triangle.
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.36f}};
  mesh.indices = {1, 1, 2, 1, 3, 2, 1, 2, 4};
  mesh.fields.push_back({.name = "cell", .on_triangles = true, .values = {7, 8, 9}});
  mesh.fields.push_back({.name = "vertex", .values = {0, 1, 2, 3, 4}});
  mesh.fields.push_back({.name = "short", .values = {0, 1}});
  finish_scene(scene, 180.0f);
  const Mesh& out = scene.meshes.at(0);
  ASSERT_EQ(out.fields.size(), 2u) << "a field with too few values is dropped";
  ASSERT_EQ(out.indices.size(), 6u);
  ASSERT_EQ(out.positions.size(), 6u);
  for (std::size_t corner = 0; corner < 6; ++corner) {
    const std::uint32_t v = out.indices[corner];
    EXPECT_EQ(out.fields[0].values[v], corner < 3 ? 8.0f : 9.0f);
    const float number = out.positions[v].y == 1.0f    ? 2.0f
                         : out.positions[v].x == 1.0f  ? 3.0f
                         : out.positions[v].x == -1.0f ? 4.0f
                                                       : 1.0f;
    EXPECT_EQ(out.fields[1].values[v], number);
    if (number == 2.0f) {
      EXPECT_NEAR(std::abs(out.normals[v].x), std::abs(out.normals[out.indices[2]].x), 1e-6f);
    }
  }
  // The corners at the common edge have one normal, though not one vertex.
  glm::vec3 left(0.0f), right(0.0f);
  for (std::size_t corner = 0; corner < 6; ++corner)
    if (out.positions[out.indices[corner]] == glm::vec3(0, 1, 0))
      (corner < 3 ? left : right) = out.normals[out.indices[corner]];
  EXPECT_EQ(left, right);
  EXPECT_NE(left.x, 0.0f);
}

TEST(Fields, VerticesAtOnePlaceStayApartIfTheirValuesDiffer) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 3, 4, 5};
  mesh.fields.push_back({.name = "p", .values = {0, 1, 2, 5, 4, 2}});
  finish_scene(scene);
  const Mesh& out = scene.meshes.at(0);
  EXPECT_EQ(out.positions.size(), 5u) << "those of value 2 are joined, those of 1 and 5 are not";
  for (std::size_t v = 0; v < out.positions.size(); ++v)
    if (out.positions[v] == glm::vec3(0, 1, 0)) {
      EXPECT_EQ(out.fields[0].values[v], 2.0f);
    }
}

}  // namespace
}  // namespace umbrage
