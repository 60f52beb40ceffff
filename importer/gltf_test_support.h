// Small glTF files that tests build.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "importer/importer.h"

namespace umbrage::test {

using Json = nlohmann::json;

/// A glTF file with one buffer.
struct GltfBuilder {
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},  {"nodes", {{{"mesh", 0}}}},
               {"accessors", Json::array()},    {"bufferViews", Json::array()}};
  std::string bytes;

  template <class T>
  int add_view(const std::vector<T>& values) {
    while (bytes.size() % 4) bytes.push_back('\0');
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}});
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return int(json["bufferViews"].size()) - 1;
  }
  /// Adds an accessor and its data. Returns its index.
  template <class T>
  int add(const std::vector<T>& values, const char* type, int width, bool normalized = false) {
    constexpr int kType = std::is_same_v<T, float>           ? 5126
                          : std::is_same_v<T, std::uint32_t> ? 5125
                          : sizeof(T) == 2                   ? (std::is_signed_v<T> ? 5122 : 5123)
                                                             : (std::is_signed_v<T> ? 5120 : 5121);
    Json accessor = {{"bufferView", add_view(values)},
                     {"componentType", kType},
                     {"count", values.size() / std::size_t(width)},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    return int(json["accessors"].size()) - 1;
  }
  /// Adds a primitive of the first mesh.
  Json& add_primitive(Json primitive) {
    if (!json.contains("meshes")) json["meshes"] = {{{"primitives", Json::array()}}};
    json["meshes"][0]["primitives"].push_back(std::move(primitive));
    return json["meshes"][0]["primitives"].back();
  }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  /// The triangle (0,0,0) (1,0,0) (0,1,0) with texture coordinates and the material 0.
  static GltfBuilder triangle() {
    GltfBuilder b;
    const int positions = b.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3),
              uvs = b.add(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2", 2);
    b.add_primitive({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"material", 0}});
    b.json["materials"] = {{{"name", "m"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
    return b;
  }
  std::string gltf() const {
    Json with = json;
    with["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    return with.dump();
  }
  std::string glb() const {
    Json with = json;
    with["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string text = with.dump(), data = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4, '\0');
    std::string file = "glTF";
    const auto word = [&](std::size_t v) {
      const auto bits = std::uint32_t(v);
      file.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    };
    word(2), word(28 + text.size() + data.size());
    word(text.size()), word(0x4E4F534A), file += text;
    word(data.size()), word(0x004E4942), file += data;
    return file;
  }
  static std::string base64(const std::string& plain) {
    constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < plain.size(); i += 3) {
      unsigned three = 0;
      for (std::size_t k = 0; k < 3; ++k)
        three = three << 8 | (i + k < plain.size() ? static_cast<unsigned char>(plain[i + k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k) text += i + k <= plain.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
  }
};

/// A folder for each test.
struct GltfTest : testing::Test {
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("umbrage_gltf_" + std::to_string(std::random_device{}()));
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
  Result<Scene> try_read(const std::string& name, const std::string& bytes, const ImportSettings& settings = {}) const {
    return import_in_process(write(name, bytes), settings);
  }
  Scene read(const GltfBuilder& file, const ImportSettings& settings = {}) const {
    Result<Scene> scene = try_read("a.gltf", file.gltf(), settings);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }
  /// Returns whether a warning contains a text.
  static bool warns(const Scene& scene, const std::string& text) {
    for (const std::string& warning : scene.warnings)
      if (warning.find(text) != std::string::npos) return true;
    return false;
  }
  static std::string warnings_of(const Scene& scene) {
    std::string all;
    for (const std::string& warning : scene.warnings) all += warning + "\n";
    return all;
  }
  /// An uncompressed TGA file of one row of RGBA texels.
  static std::string tga(const std::vector<std::array<int, 4>>& texels) {
    std::string file("\0\0\2\0\0\0\0\0\0\0\0\0", 12);
    file += {char(texels.size()), 0, 1, 0, 32, 0x28};
    for (const auto& t : texels) file += {char(t[2]), char(t[1]), char(t[0]), char(t[3])};
    return file;
  }
};

}  // namespace umbrage::test
