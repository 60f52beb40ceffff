// glTF: every ratified extension changes the scene, or a warning names it.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#include <webp/encode.h>

#include <glm/geometric.hpp>

#include "importer/gltf_test_support.h"

namespace umbrage::test {
namespace {

/// Returns what a picture depends on, as text.
std::string digest(const Scene& scene) {
  std::string text;
  const auto add = [&](const auto&... values) { ((text += fmt::format("{} ", values)), ...); };
  for (const Mesh& mesh : scene.meshes) {
    for (const glm::vec3& p : mesh.positions) add(p.x, p.y, p.z);
    for (const glm::vec2& t : mesh.uvs) add(t.x, t.y);
    add(mesh.indices.size(), mesh.object);
  }
  for (const Material& m : scene.materials)
    add(m.albedo.x, m.albedo.y, m.texture, m.emission.x, m.metallic, m.roughness, m.blended, m.opacity, m.tint.x);
  for (const Texture& texture : scene.textures)
    for (const std::uint8_t byte : texture.rgba) add(byte);
  return text;
}

/// A file for an extension of materials.
GltfBuilder with_material(const char* name, const Json& properties) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["materials"][0]["extensions"][name] = properties;
  return b;
}

GltfBuilder with_texture_extension(const char* name, const std::string& uri) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  b.json["textures"] = {{{"extensions", {{name, {{"source", 0}}}}}}};
  b.json["images"] = {{{"uri", uri}}};
  return b;
}

GltfBuilder with_instances() {
  GltfBuilder b = GltfBuilder::triangle();
  const int places = b.add(std::vector<float>{0, 0, 0, 5, 0, 0, 0, 5, 0}, "VEC3", 3);
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"TRANSLATION", places}}}};
  return b;
}

GltfBuilder with_draco(bool damaged = false) {
  GltfBuilder b = GltfBuilder::triangle();
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const float corners[3][3] = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  builder.SetAttributeValuesForFace(id, draco::FaceIndex(0), corners[0], corners[1], corners[2]);
  const auto mesh = builder.Finalize();
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(draco::Encoder().EncodeMeshToBuffer(*mesh, &buffer).ok());
  std::vector<char> bytes(buffer.data(), buffer.data() + buffer.size());
  if (damaged) bytes.resize(bytes.size() / 2);
  const int view = b.add_view(bytes);
  b.json["accessors"][0].erase("bufferView");
  b.primitive()["attributes"].erase("TEXCOORD_0");
  const int unique = int(mesh->attribute(id)->unique_id());
  b.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                               {"attributes", {{"POSITION", unique}}}};
  return b;
}

GltfBuilder with_meshopt(const char* name, std::size_t count = 3) {
  GltfBuilder b = GltfBuilder::triangle();
  const std::vector<float> positions = {0, 0, 0, 6, 0, 0, 0, 8, 0};
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(3, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), positions.data(), 3, 12));
  const int view = b.add_view(bytes);
  Json compression = b.json["bufferViews"][std::size_t(view)];
  compression.update({{"byteStride", 12}, {"count", count}, {"mode", "ATTRIBUTES"}});
  // The buffer without data that the extension describes.
  b.json["bufferViews"][0] = {
      {"buffer", 1}, {"byteLength", 36}, {"byteStride", 12}, {"extensions", {{name, compression}}}};
  return b;
}

GltfBuilder with_root(const char* name, const Json& properties) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["extensions"][name] = properties;
  return b;
}

GltfBuilder with_quantization() {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["POSITION"] = b.add(std::vector<std::int8_t>{0, 0, 0, 100, 0, 0, 0, 50, 0}, "VEC3", 3);
  return b;
}

GltfBuilder with_pointer() {
  GltfBuilder b = GltfBuilder::triangle();
  const int times = b.add(std::vector<float>{0, 1}, "SCALAR", 1);
  b.json["animations"] = {
      {{"channels",
        {{{"sampler", 0},
          {"target",
           {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/materials/0"}}}}}}}}}},
       {"samplers", {{{"input", times}, {"output", times}}}}}};
  return b;
}

GltfBuilder with_transform() {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["images"] = {{{"uri", "a.tga"}}};
  return b;
}

GltfBuilder with_visibility() {
  GltfBuilder b = with_quantization();
  b.json["nodes"].push_back({{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  b.json["scenes"][0]["nodes"] = {0, 1};
  return b;
}

TEST_F(GltfTest, EveryExtensionChangesTheSceneOrIsNamed) {
  const std::vector<std::uint8_t> pixel = {10, 200, 30, 255};
  std::uint8_t* webp = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixel.data(), 1, 1, 4, &webp);
  ASSERT_GT(size, 0u);
  write("a.webp", std::string(reinterpret_cast<const char*>(webp), size));
  WebPFree(webp);
  write("a.ktx2", "\xABKTX 20\xBB\r\n\x1A\n and more");
  write("a.tga", tga({{10, 20, 30, 255}}));
  const std::pair<const char*, GltfBuilder> files[] = {
      {"EXT_mesh_gpu_instancing", with_instances()},
      {"EXT_meshopt_compression", with_meshopt("EXT_meshopt_compression")},
      {"KHR_meshopt_compression", with_meshopt("KHR_meshopt_compression")},
      {"EXT_texture_webp", with_texture_extension("EXT_texture_webp", "a.webp")},
      {"EXT_texture_avif", with_texture_extension("EXT_texture_avif", "a.avif")},
      {"KHR_texture_basisu", with_texture_extension("KHR_texture_basisu", "a.ktx2")},
      {"KHR_texture_transform", with_transform()},
      {"KHR_animation_pointer", with_pointer()},
      {"KHR_draco_mesh_compression", with_draco()},
      {"KHR_mesh_quantization", with_quantization()},
      {"KHR_node_visibility", with_visibility()},
      {"KHR_lights_punctual", with_root("KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}})},
      {"KHR_materials_variants", with_root("KHR_materials_variants", {{"variants", {{{"name", "red"}}}}})},
      {"KHR_materials_anisotropy", with_material("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}})},
      {"KHR_materials_clearcoat", with_material("KHR_materials_clearcoat", {{"clearcoatFactor", 1}})},
      {"KHR_materials_dispersion", with_material("KHR_materials_dispersion", {{"dispersion", 1}})},
      {"KHR_materials_diffuse_transmission",
       with_material("KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 1}})},
      {"KHR_materials_emissive_strength", with_material("KHR_materials_emissive_strength", {{"emissiveStrength", 3}})},
      {"KHR_materials_ior", with_material("KHR_materials_ior", {{"ior", 1.8}})},
      {"KHR_materials_iridescence", with_material("KHR_materials_iridescence", {{"iridescenceFactor", 1}})},
      {"KHR_materials_sheen", with_material("KHR_materials_sheen", {{"sheenColorFactor", {1, 0, 0}}})},
      {"KHR_materials_specular", with_material("KHR_materials_specular", {{"specularFactor", 0.1}})},
      {"KHR_materials_transmission", with_material("KHR_materials_transmission", {{"transmissionFactor", 0.9}})},
      {"KHR_materials_unlit", with_material("KHR_materials_unlit", Json::object())},
      {"KHR_materials_pbrSpecularGlossiness",
       with_material("KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.5, 0.1, 1}}})},
      {"VENDOR_unknown", GltfBuilder::triangle()}};
  for (auto [name, file] : files) {
    SCOPED_TRACE(name);
    GltfBuilder plain = GltfBuilder::triangle();
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) file.json[list] = {name};
    if (std::string(name) == "KHR_materials_emissive_strength")
      for (GltfBuilder* each : {&file, &plain}) each->json["materials"][0]["emissiveFactor"] = {1, 1, 1};
    if (std::string(name) == "KHR_animation_pointer") {
      ImportSettings moving;
      moving.animation_index = 0;
      EXPECT_TRUE(warns(read(file, moving), name));
      continue;
    }
    const Scene scene = read(file);
    const std::string kPrefix = "KHR_materials_", full = name;
    const bool named = warns(scene, full) || (full.starts_with(kPrefix) && warns(scene, full.substr(kPrefix.size())));
    const bool changed = digest(scene) != digest(read(plain));
    EXPECT_TRUE(named || changed) << warnings_of(scene);
  }
}

TEST_F(GltfTest, ReadsCompressedMeshes) {
  EXPECT_EQ(read(with_draco()).bounds_max, glm::vec3(3, 4, 0));
  EXPECT_EQ(read(with_meshopt("EXT_meshopt_compression")).bounds_max, glm::vec3(6, 8, 0));
  EXPECT_EQ(read(with_instances()).meshes.size(), 3u);
  const auto damaged = try_read("d.gltf", with_draco(true).gltf());
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message.find("KHR_draco_mesh_compression"), std::string::npos) << damaged.error().message;
  const auto bomb = try_read("b.gltf", with_meshopt("EXT_meshopt_compression", 1 << 29).gltf());
  ASSERT_FALSE(bomb);
  EXPECT_NE(bomb.error().message.find("cannot be in"), std::string::npos) << bomb.error().message;
}

TEST_F(GltfTest, ReadsGlass) {
  GltfBuilder b = with_material("KHR_materials_transmission", {{"transmissionFactor", 1}});
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 1, 1};
  b.json["materials"][0]["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 2}, {"attenuationDistance", 1}, {"attenuationColor", {1, 0.5, 1}}};
  const Material pane = read(b).materials.at(0);
  EXPECT_TRUE(pane.blended);
  EXPECT_FLOAT_EQ(pane.opacity, 0.1f) << "a pane stays visible";
  EXPECT_EQ(pane.tint, glm::vec3(0.5f, 0.25f, 1.0f));
  // A map: the first texel is opaque, the second transmits.
  write("t.tga", tga({{0, 0, 0, 255}, {255, 0, 0, 255}}));
  b.json["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = {{"index", 0}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["images"] = {{{"uri", "t.tga"}}};
  const Scene scene = read(b);
  ASSERT_EQ(scene.textures.size(), 1u) << "the map itself is not kept";
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint8_t>{255, 255, 255, 255, 255, 255, 255, 26}));
  EXPECT_EQ(scene.materials.at(0).opacity, 1.0f);
}

TEST_F(GltfTest, ReadsBlendedMaterials) {
  write("soft.tga", tga({{255, 255, 255, 128}, {255, 255, 255, 200}}));
  write("leaf.tga", tga({{255, 255, 255, 0}, {255, 255, 255, 255}}));
  write("solid.tga", tga({{255, 255, 255, 255}}));
  const auto blended = [&](const char* image, double alpha) {
    GltfBuilder b = GltfBuilder::triangle();
    b.json["materials"][0] = {
        {"alphaMode", "BLEND"},
        {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}, {"baseColorTexture", {{"index", 0}}}}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["images"] = {{{"uri", image}}};
    return read(b).materials.at(0);
  };
  EXPECT_TRUE(blended("soft.tga", 1.0).blended);
  EXPECT_EQ(blended("soft.tga", 1.0).opacity, 1.0f);
  EXPECT_EQ(blended("soft.tga", 0.25).opacity, 0.25f);
  EXPECT_TRUE(blended("solid.tga", 0.25).blended);
  EXPECT_FALSE(blended("solid.tga", 1.0).blended);
  EXPECT_FALSE(blended("leaf.tga", 1.0).blended);
  EXPECT_TRUE(blended("leaf.tga", 1.0).alpha_mask) << "a cut-out";
}

TEST_F(GltfTest, ConvertsSpecularGlossiness) {
  constexpr const char* kName = "KHR_materials_pbrSpecularGlossiness";
  const Material plain =
      read(with_material(kName, {{"diffuseFactor", {0.1, 0.5, 0.1, 1}}, {"glossinessFactor", 0.2}})).materials.at(0);
  EXPECT_EQ(plain.metallic, 0.0f);
  EXPECT_NEAR(plain.roughness, 0.8f, 1e-6f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(plain.albedo[c], c == 1 ? 0.5f : 0.1f, 1e-3f);
  const Material gold =
      read(with_material(kName, {{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {1, 0.8, 0.3}}})).materials.at(0);
  EXPECT_GT(gold.metallic, 0.95f);
  EXPECT_NEAR(gold.albedo.z, 0.3f, 0.05f);
  // Two texels of the specular map: gold and black plastic.
  write("s.tga", tga({{255, 230, 150, 255}, {0, 0, 0, 0}}));
  GltfBuilder b = with_material(
      kName,
      {{"diffuseFactor", {0, 0, 0.5, 1}}, {"specularGlossinessTexture", {{"index", 0}}}, {"glossinessFactor", 1}});
  b.json["textures"] = {{{"source", 0}}};
  b.json["images"] = {{{"uri", "s.tga"}}};
  const Scene scene = read(b);
  ASSERT_EQ(scene.textures.size(), 2u);
  const Texture& surface = scene.textures.at(std::size_t(scene.materials.at(0).surface_texture));
  EXPECT_EQ(surface.rgba[1], 0) << "smooth";
  EXPECT_GT(surface.rgba[2], 240) << "metal";
  EXPECT_EQ(surface.rgba[5], 255) << "rough";
  EXPECT_EQ(surface.rgba[6], 0) << "no metal";
}

TEST_F(GltfTest, ReadsLightsOnRequest) {
  GltfBuilder b = with_root("KHR_lights_punctual", {{"lights",
                                                     {{{"type", "point"}, {"intensity", 8}, {"color", {1, 0, 0}}},
                                                      {{"type", "directional"}, {"intensity", 6}},
                                                      {{"type", "spot"}, {"intensity", 0.001}}}}});
  for (int k = 0; k < 3; ++k) {
    b.json["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", k}}}}}, {"translation", {0, 0, 2}}});
    b.json["scenes"][0]["nodes"].push_back(k + 1);
  }
  EXPECT_TRUE(read(b).lights.empty());
  ImportSettings settings;
  settings.file_lights = true;
  const Scene scene = read(b, settings);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].direction, glm::vec3(0, 0, 1)) << "the brightest at the centre";
  EXPECT_EQ(scene.lights[1].position, glm::vec3(0, 0, 2));
  EXPECT_EQ(scene.lights[1].color.y, 0.0f);
  const float distance = glm::distance(scene.lights[1].position, scene.center()), reach = scene.lights[1].reach;
  EXPECT_NEAR(scene.lights[1].color.x * reach * reach / (distance * distance) / scene.lights[0].color.x,
              8.0f / (distance * distance) / 6.0f, 1e-4f);
  EXPECT_TRUE(warns(scene, "spot"));
}

TEST_F(GltfTest, WarnsOfTexturesThatDoNotRepeat) {
  write("a.tga", tga({{10, 20, 30, 255}}));
  GltfBuilder b = with_transform();
  b.json["samplers"] = {{{"wrapS", 33648}}};
  b.json["textures"][0]["sampler"] = 0;
  EXPECT_TRUE(warns(read(b), "mirrored")) << "coordinates are up to 2";
  b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].erase("extensions");
  EXPECT_TRUE(read(b).warnings.empty());
}

TEST_F(GltfTest, ReadsSamplersOfSharpTexels) {
  write("a.tga", tga({{10, 20, 30, 255}}));
  GltfBuilder b = with_transform();
  b.json["textures"][0]["sampler"] = 0;
  for (const int filter : {9728, 9729}) {
    b.json["samplers"] = {{{"magFilter", filter}}};
    EXPECT_EQ(read(b).textures.at(0).nearest, filter == 9728);
  }
}

TEST_F(GltfTest, UsesTheFallbackOfATexture) {
  write("a.tga", tga({{10, 20, 30, 255}}));
  GltfBuilder b = with_texture_extension("KHR_texture_basisu", "a.ktx2");
  b.json["images"].push_back({{"uri", "a.tga"}});
  b.json["textures"][0]["source"] = 1;
  const Scene scene = read(b);
  EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].rgba[1], 20);
}

TEST_F(GltfTest, NamesEveryTextureThatCannotBeDecoded) {
  write("a.ktx2", "\xABKTX 20\xBB\r\n\x1A\n and more");
  write("b.webp", "RIFF....WEBPVP8 and so on");
  GltfBuilder b = GltfBuilder::triangle();
  b.json["textures"] = Json::array();
  b.json["images"] = Json::array();
  b.json["materials"] = Json::array();
  const char* kUris[] = {"a.ktx2", "b.webp", "c.png", "data:image/png;base64,AAAA"};
  for (int k = 0; k < 4; ++k) {
    b.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", k}}}}}});
    b.json["textures"].push_back({{"source", k}});
    b.json["images"].push_back({{"uri", kUris[k]}});
  }
  const Scene scene = read(b);
  EXPECT_EQ(scene.warnings.size(), 4u) << warnings_of(scene);
  for (const char* name : {"a.ktx2", "b.webp", "c.png", "image 3"}) EXPECT_TRUE(warns(scene, name)) << name;
}

}  // namespace
}  // namespace umbrage::test
