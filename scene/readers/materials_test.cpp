// Import of metalness, roughness and maps from glTF and OBJ, and their damage in broken files.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "scene/readers/import.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

/// Writes models and images to a folder of the test.
struct ImportMaterials : testing::Test {
  fs::path folder = fs::path(testing::TempDir()) / ("umbrage_materials_" + std::to_string(std::random_device{}()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  /// Writes a row of RGB texels.
  void write_row(const std::string& name, const std::vector<std::array<int, 3>>& texels) const {
    std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
    tga += {char(texels.size()), 0, 1, 0, 24, 32};
    for (const auto& t : texels) tga += {char(t[2]), char(t[1]), char(t[0])};
    write(name, tga);
  }
  Scene read(const std::string& name) const {
    Result<Scene> scene = import_scene(folder / name);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }

  /// Reads a triangle with this material and these images.
  Scene gltf(const std::string& material, const std::vector<std::string>& images = {}) const {
    std::string textures, sources;
    for (std::size_t k = 0; k < images.size(); ++k) {
      textures += (k ? "," : "") + std::string(R"({"source":)") + std::to_string(k) + "}";
      sources += (k ? "," : "") + std::string(R"({"uri":")") + images[k] + "\"}";
    }
    write("a.gltf",
          R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"materials":[{)" +
              material + R"(}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
              std::string("AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/") +
              R"("}],"textures":[)" + textures + R"(],"images":[)" + sources + "]}");
    return read("a.gltf");
  }

  Scene obj(const std::string& material) const {
    write("a.mtl", "newmtl m\n" + material);
    write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n");
    return read("a.obj");
  }

  static const Material& material_of(const Scene& scene) {
    return scene.materials.at(std::size_t(scene.meshes.at(0).material));
  }
  /// Expects a linear texture with these texels.
  static void expect_texture(const Scene& scene, int index, const Bytes& rgba) {
    ASSERT_GE(index, 0);
    const Texture& texture = scene.textures.at(std::size_t(index));
    EXPECT_TRUE(texture.linear);
    EXPECT_EQ(texture.rgba, rgba);
  }
};

const std::string kRough = R"("pbrMetallicRoughness":{"metallicFactor":0.25,"roughnessFactor":0.5)";

TEST_F(ImportMaterials, FactorsOfGltf) {
  const Material given = material_of(gltf(kRough + "}"));
  EXPECT_EQ(given.metallic, 0.25f);
  EXPECT_EQ(given.roughness, 0.5f);
  const Material initial = material_of(gltf(R"("pbrMetallicRoughness":{})"));
  EXPECT_EQ(initial.metallic, 1.0f);
  EXPECT_EQ(initial.roughness, 1.0f);
  const Material out_of_range =
      material_of(gltf(R"("pbrMetallicRoughness":{"metallicFactor":7,"roughnessFactor":-1})"));
  EXPECT_EQ(out_of_range.metallic, 1.0f);
  EXPECT_EQ(out_of_range.roughness, 0.0f);
  EXPECT_EQ(material_of(gltf("")).roughness, kNoRoughness) << "a file that says nothing";
  EXPECT_EQ(material_of(gltf(R"("extensions":{"KHR_materials_unlit":{}},)" + kRough + "}")).roughness, kNoRoughness);
}

TEST_F(ImportMaterials, MapsOfGltf) {
  write_row("orm.tga", {{{10, 20, 30}}, {{40, 50, 60}}});
  write_row("n.tga", {{{128, 128, 255}}});
  const Scene scene = gltf(kRough + R"(,"metallicRoughnessTexture":{"index":0}},"occlusionTexture":{"index":0,
"strength":0.75},"normalTexture":{"index":1,"scale":2})",
                           {"orm.tga", "n.tga"});
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.textures.size(), 2u) << "one image for both maps";
  const Material& material = material_of(scene);
  expect_texture(scene, material.surface_texture, {10, 20, 30, 255, 40, 50, 60, 255});
  EXPECT_EQ(material.roughness, 0.5f);
  EXPECT_EQ(material.occlusion_strength, 0.75f);
  expect_texture(scene, material.normal_texture, {128, 128, 255, 255});
  EXPECT_EQ(material.normal_scale, 2.0f);
}

TEST_F(ImportMaterials, CombinesAnOcclusionMapOfAnotherSize) {
  write_row("mr.tga", {{{1, 20, 30}}});
  write_row("o.tga", {{{70, 2, 3}}, {{80, 2, 3}}});
  const Scene both =
      gltf(kRough + R"(,"metallicRoughnessTexture":{"index":0}},"occlusionTexture":{"index":1})", {"mr.tga", "o.tga"});
  expect_texture(both, material_of(both).surface_texture, {70, 20, 30, 255, 80, 20, 30, 255});
  const Scene alone = gltf(kRough + R"(},"occlusionTexture":{"index":0})", {"o.tga"});
  expect_texture(alone, material_of(alone).surface_texture, {70, 255, 255, 255, 80, 255, 255, 255});
  const Scene none = gltf(kRough + R"(,"metallicRoughnessTexture":{"index":0}})", {"mr.tga"});
  EXPECT_EQ(material_of(none).occlusion_strength, 0.0f);
}

TEST_F(ImportMaterials, WarnsOncePerMissingMap) {
  const Scene scene = gltf(kRough + R"(,"metallicRoughnessTexture":{"index":0}},"occlusionTexture":{"index":0},
"normalTexture":{"index":0})",
                           {"gone.png"});
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("gone.png"), std::string::npos) << scene.warnings[0];
  const Material& material = material_of(scene);
  EXPECT_EQ(material.surface_texture, kNoTexture);
  EXPECT_EQ(material.normal_texture, kNoTexture);
  EXPECT_EQ(material.roughness, kNoRoughness) << "the factors alone mean nothing";
}

TEST_F(ImportMaterials, NamesWhatIsNotDrawn) {
  write_row("n.tga", {{{128, 128, 255}}});
  const Scene scene = gltf(R"("extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":1},
"KHR_materials_ior":{"ior":1.3},"KHR_materials_emissive_strength":{"emissiveStrength":2}},)" +
                               kRough + R"(},"emissiveTexture":{"index":0},"normalTexture":{"index":0,"texCoord":1})",
                           {"n.tga"});
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("clearcoat, ior, normalTexture with other texture coordinates"), std::string::npos)
      << scene.warnings[0];
  EXPECT_EQ(material_of(scene).ignored.size(), 3u);
  EXPECT_EQ(material_of(scene).normal_texture, kNoTexture);
  const Scene usual = gltf(R"("extensions":{"KHR_materials_ior":{"ior":1.5}},)" + kRough + "}");
  EXPECT_TRUE(usual.warnings.empty()) << "the index of refraction that is drawn";
}

TEST_F(ImportMaterials, SurvivesMalformedProperties) {
  for (const char* broken : {R"("pbrMetallicRoughness":{"metallicFactor":[]})", R"("extensions":[1])",
                             R"("extensions":{"KHR_materials_ior":3})"}) {
    gltf("");
    std::ifstream stream(folder / "a.gltf");
    std::string text(std::istreambuf_iterator<char>(stream), {});
    const std::string empty = R"("materials":[{}])";
    ASSERT_NE(text.find(empty), std::string::npos);
    text.replace(text.find(empty), empty.size(), std::string(R"("materials":[{)") + broken + "}]");
    write("broken.gltf", text);
    const Result<Scene> scene = import_scene(folder / "broken.gltf");  // a scene or one error
    if (scene) {
      EXPECT_FALSE(scene->meshes.empty()) << broken;
    } else {
      EXPECT_EQ(scene.error().kind, ErrorKind::kFile) << broken;
    }
  }
}

TEST_F(ImportMaterials, NumbersOfObj) {
  const Material material = material_of(obj("Kd 0.5 0.5 0.5\nPr 0.3\nPm 0.7\n"));
  EXPECT_FLOAT_EQ(material.roughness, 0.3f);
  EXPECT_FLOAT_EQ(material.metallic, 0.7f);
  const Material metal = material_of(obj("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 30\nillum 2\nPm 1\n"));
  EXPECT_NEAR(metal.roughness, 0.5f, 1e-5f) << "of the highlight: (2 / (30 + 2))^(1/4)";
  EXPECT_EQ(material_of(obj("Kd 0.5 0.5 0.5\nKs 1 1 1\nNs 30\n")).roughness, kNoRoughness);
}

TEST_F(ImportMaterials, MapsOfObj) {
  write_row("r.tga", {{{20, 0, 0}}, {{40, 0, 0}}});
  write_row("m.tga", {{{200, 0, 0}}});
  write_row("n.tga", {{{100, 128, 250}}});
  write_row("e.tga", {{{255, 0, 0}}});
  const Scene scene = obj("Kd 1 1 1\nPr 0.3\nPm 0.7\nmap_Pr r.tga\nmap_Pm m.tga\nnorm n.tga\nKe 0 0 0\nmap_Ke e.tga\n");
  EXPECT_TRUE(scene.warnings.empty());
  const Material& material = material_of(scene);
  expect_texture(scene, material.surface_texture, {255, 20, 200, 255, 255, 40, 200, 255});
  EXPECT_EQ(material.roughness, 1.0f) << "a map replaces its number";
  EXPECT_EQ(material.metallic, 1.0f);
  expect_texture(scene, material.normal_texture, {100, 128, 250, 255});
  EXPECT_EQ(material.emission, glm::vec3(1.0f));
  EXPECT_NE(material.emission_texture, kNoTexture);
}

TEST_F(ImportMaterials, ConvertsHeightsToNormals) {
  write_row("h.tga", {{{0, 0, 0}}, {{255, 255, 255}}, {{255, 255, 255}}, {{0, 0, 0}}});
  for (const char* key : {"bump h.tga", "map_Bump h.tga", "map_bump -bm 1 h.tga"}) {
    const Scene scene = obj(std::string("Kd 1 1 1\n") + key + "\n");
    const Material& material = material_of(scene);
    ASSERT_NE(material.normal_texture, kNoTexture) << key;
    const Texture& normals = scene.textures.at(std::size_t(material.normal_texture));
    // Uphill to the right at the first two texels, where the difference over two texels is the whole range.
    const glm::vec3 uphill = glm::vec3(-0.5f, 0.0f, 1.0f) / std::sqrt(1.25f);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(normals.rgba[std::size_t(c)] / 255.0f, 0.5f * uphill[c] + 0.5f, 0.003f) << key;
    EXPECT_NEAR(normals.rgba[4 * 2] / 255.0f, 1.0f - normals.rgba[0] / 255.0f, 0.005f) << "downhill";
  }
  const Scene deeper = obj("Kd 1 1 1\nmap_bump -bm 4 h.tga\n");
  EXPECT_LT(deeper.textures.at(std::size_t(material_of(deeper).normal_texture)).rgba[0], 40);
}

TEST_F(ImportMaterials, AppliesOptionsOfMapsOfObj) {
  write_row("t.tga", {{{10, 100, 200}}, {{0, 0, 0}}});
  const Scene scene = obj("map_Kd -s 4 2 1 -o 0.5 -1 0 t.tga\nmap_Bump -bm 2 -s 4 2 -o 0.5 -1 t.tga\n");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.meshes.at(0).uvs, (std::vector<glm::vec2>{{0.5f, -1}, {4.5f, -1}, {0.5f, 1}}));
  EXPECT_EQ(material_of(scene).albedo, glm::vec3(1.0f));
  EXPECT_NE(material_of(scene).normal_texture, kNoTexture);
  const Scene changed = obj("Kd 1 1 1\nmap_Kd -imfchan g -mm 0.1 0.5 t.tga\n");
  EXPECT_EQ(changed.textures.at(std::size_t(material_of(changed).texture)).rgba,
            (Bytes{76, 76, 76, 255, 26, 26, 26, 255}));

  const Scene apart = obj("Kd 1 1 1\nmap_Kd -s 2 2 t.tga\nmap_Bump t.tga\n");
  EXPECT_EQ(material_of(apart).normal_texture, kNoTexture);
  ASSERT_EQ(apart.warnings.size(), 1u);
  EXPECT_NE(apart.warnings[0].find("map_Bump"), std::string::npos) << apart.warnings[0];
  EXPECT_TRUE(obj("map_Kd -clamp on t.tga\n").warnings.empty()) << "no coordinate is outside";
  const Scene clamped = obj("map_Kd -s 2 2 -clamp on t.tga\n");
  ASSERT_EQ(clamped.warnings.size(), 1u);
  EXPECT_NE(clamped.warnings[0].find("-clamp"), std::string::npos) << clamped.warnings[0];
}

TEST_F(ImportMaterials, FindsAndNamesMapsOfObj) {
  fs::create_directories(folder / "Maps");
  write_row("Maps/My Wood.tga", {{{1, 2, 3}}});
  for (const char* name : {"Maps/My Wood.tga", "\"maps\\my wood.TGA\"", "C:\\art\\Maps\\..\\maps\\My Wood.tga"}) {
    const Scene scene = obj(std::string("map_Kd ") + name + "\n");
    EXPECT_NE(material_of(scene).texture, kNoTexture) << name;
    EXPECT_TRUE(scene.warnings.empty()) << name;
  }
  const Scene dark = obj("Kd 1 1 1\nKe 1 1 1\nmap_Ke gone.png\n");
  ASSERT_EQ(dark.warnings.size(), 1u);
  EXPECT_NE(dark.warnings[0].find("'gone.png' does not exist; its surfaces do not glow"), std::string::npos)
      << dark.warnings[0];
  EXPECT_EQ(material_of(dark).emission, glm::vec3(0.0f));
}

TEST_F(ImportMaterials, NamesObjMaterialsWithoutTextureCoordinates) {
  write_row("t.tga", {{{1, 2, 3}}});
  write("a.mtl", "newmtl m\nmap_Kd t.tga\n");
  write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  const Scene scene = read("a.obj");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("'m' have no texture coordinates"), std::string::npos) << scene.warnings[0];
}

TEST_F(ImportMaterials, BlendsGradedMasksOfObj) {
  write_row("graded.tga", {{{64, 64, 64}}, {{128, 128, 128}}, {{200, 200, 200}}, {{255, 255, 255}}});
  write_row("cut.tga", {{{0, 0, 0}}, {{255, 255, 255}}});
  const Scene graded = obj("Kd 1 0 0\nmap_d graded.tga\n"), cut = obj("Kd 1 0 0\nmap_d cut.tga\n"),
              both = obj("Kd 1 0 0\nd 0.5\nmap_d cut.tga\n");
  EXPECT_TRUE(material_of(graded).blended);
  EXPECT_EQ(material_of(graded).opacity, 1.0f) << "times the alpha of the texture";
  EXPECT_FALSE(material_of(graded).alpha_mask);
  EXPECT_FALSE(material_of(cut).blended);
  EXPECT_TRUE(material_of(cut).alpha_mask);
  EXPECT_TRUE(material_of(both).blended && material_of(both).alpha_mask);
  EXPECT_EQ(material_of(both).opacity, 0.5f);
}

}  // namespace
}  // namespace umbrage
