// Import: small files of every format that the test writes, the created normals, and bad files.
#include "scene/readers/import.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "file_folder.h"
#include "scene/finish.h"
#include "scene/readers/texture_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

struct Import : test::FileFolder {
  Scene read(const std::string& name, const std::string& text, const ImportSettings& settings = {}) const {
    Result<Scene> scene = import_scene(write(name, text), settings);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }

  void expect_error(const fs::path& file, const std::string& reason) const {
    const Result<Scene> scene = import_scene(file);
    ASSERT_FALSE(scene) << file;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
    EXPECT_NE(scene.error().message.find(file.string()), std::string::npos) << scene.error().message;
    EXPECT_NE(scene.error().message.find(reason), std::string::npos) << scene.error().message;
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
  }
};

constexpr const char* kCubeVertices =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
constexpr const char* kCubeFaces = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
std::string cube_obj() { return std::string(kCubeVertices) + kCubeFaces; }

std::string bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// Returns a glTF file that contains the triangle (0,0,0) (1,0,0) (0,1,0), without normals, under one node.
std::string triangle_gltf(const std::string& node, const std::string& material) {
  const std::string bytes = bytes_of({0, 0, 0, 1, 0, 0, 0, 1, 0, /* texture coordinates */ 0, 0, 1, 0, 0, 1});
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
"materials":[)" +
         material +
         R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
         base64(bytes) + R"("}],
"textures":[{"source":0}],"images":[{"uri":"dots.tga"}]})";
}

/// Returns a glTF file that contains the same triangle with vertex colours.
std::string colored_gltf() {
  std::string text = triangle_gltf("", "{}");
  const std::string bytes = bytes_of({0, 0, 0, 1, 0, 0, 0, 1, 0, .5f, .25f, 1, .5f, .25f, 1, .5f, .25f, 1});
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("TEXCOORD_0", "COLOR_0");
  replace(R"("count":3,"type":"VEC2")", R"("count":3,"type":"VEC3")");
  replace(R"("byteLength":24)", R"("byteLength":36)");
  replace(R"("byteLength":60)", R"("byteLength":72)");
  const std::size_t data = text.find("base64,") + 7;
  text.replace(data, text.find('"', data) - data, base64(bytes));
  return text;
}

/// Returns a glTF file that contains three points, the corners of the same triangle.
std::string points_gltf() {
  std::string text = triangle_gltf("", "{}");
  const std::string from = R"("material":0})";
  return text.replace(text.find(from), from.size(), R"("material":0,"mode":0})");
}

/// Returns an uncompressed TGA file of 2 x 1 texels: opaque red, transparent green.
std::string two_texels_tga() {
  std::string file(18, '\0');
  file[2] = 2;      // colours, not compressed
  file[12] = 2;     // width
  file[14] = 1;     // height
  file[16] = 32;    // bits
  file[17] = 0x28;  // 8 bits of alpha, top row first
  return file + std::string("\0\0\xff\xff\0\xff\0\0", 8);
}

glm::vec3 face_normal(const Mesh& mesh, std::size_t triangle) {
  const std::uint32_t* corner = &mesh.indices[3 * triangle];
  return glm::normalize(glm::cross(mesh.positions[corner[1]] - mesh.positions[corner[0]],
                                   mesh.positions[corner[2]] - mesh.positions[corner[0]]));
}

TEST_F(Import, NamesTheCauseOfAFileThatCannotBeOpened) {
  write("square.ply", "ply\n");
  rlimit old{};
  ::getrlimit(RLIMIT_NOFILE, &old);
  const rlimit none{0, old.rlim_max};
  ::setrlimit(RLIMIT_NOFILE, &none);
  const auto scene = import_scene(folder / "square.ply", {});
  ::setrlimit(RLIMIT_NOFILE, &old);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
  EXPECT_NE(scene.error().message.find("square.ply' cannot be opened: Too many open files"), std::string::npos)
      << scene.error().message;
}

TEST_F(Import, ReadsObj) {
  const Scene scene = read("cube.OBJ", cube_obj());
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.triangle_count(), 12u);
  EXPECT_EQ(scene.bounds_min, glm::vec3(-1.0f));
  EXPECT_EQ(scene.bounds_max, glm::vec3(1.0f));
  EXPECT_NEAR(scene.radius(), std::sqrt(3.0f), 1e-6f);
  EXPECT_EQ(scene.up, glm::vec3(0, 1, 0));
  EXPECT_EQ(scene.materials.at(std::size_t(scene.meshes[0].material)).albedo, glm::vec3(0.8f));
}

TEST_F(Import, ReadsNumbersWithoutLeadingZero) {
  const Scene scene = read("point.obj", "v .5 -.25 0\nv 1 0 0\nv 0 .75e0 +.5\nf 1 2 3\n");
  EXPECT_EQ(scene.bounds_min, glm::vec3(0.0f, -0.25f, 0.0f));
  EXPECT_EQ(scene.bounds_max, glm::vec3(1.0f, 0.75f, 0.5f));
}

TEST_F(Import, ReadsMaterialsOfObj) {
  write("m.mtl",
        "newmtl shiny\nKd 0.2 0.4 0.6\nKs 0.5 0.5 0.5\nNs 40\nillum 2\n"
        "newmtl lamp\nKd 0 0 0\nKe 3 2 1\nnewmtl matt\nKd 1 1 1\nKs 1 1 1\nNs 9\nillum 1\n");
  const Scene scene = read("m.obj",
                           "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl shiny\nf 1 2 3\n"
                           "usemtl lamp\nf 1 2 4\nusemtl matt\nf 1 3 4\n");
  std::map<std::string, Material> by_name;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials.at(std::size_t(mesh.material));
    by_name[material.name] = material;
  }
  ASSERT_EQ(by_name.size(), 3u);
  EXPECT_EQ(by_name["shiny"].albedo, glm::vec3(0.2f, 0.4f, 0.6f));
  EXPECT_FLOAT_EQ(by_name["shiny"].specular_strength, 0.5f);
  EXPECT_FLOAT_EQ(by_name["shiny"].specular_exponent, 40.0f);
  EXPECT_EQ(by_name["lamp"].emission, glm::vec3(3, 2, 1));
  EXPECT_EQ(by_name["matt"].specular_strength, 0.0f) << "illum 1 has no highlight";
  EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(Import, WarnsAboutMissingLibraryAndTexture) {
  const Scene without_library = read("a.obj", "mtllib gone.mtl\nusemtl x\n" + cube_obj());
  ASSERT_EQ(without_library.warnings.size(), 1u);
  EXPECT_NE(without_library.warnings[0].find("gone.mtl"), std::string::npos);
  write("b.mtl", "newmtl x\nKd 0.1 0.1 0.1\nmap_Kd gone.png\nnewmtl y\nmap_Kd gone.png\n");
  const Scene scene = read("b.obj", std::string("mtllib b.mtl\n") + kCubeVertices +
                                        "vt 0 0\nusemtl x\nf 1/1 2/1 3/1\nusemtl y\nf 5/1 6/1 7/1\n");
  ASSERT_EQ(scene.warnings.size(), 1u) << "one texture, one warning";
  EXPECT_NE(scene.warnings[0].find("gone.png"), std::string::npos);
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials.at(std::size_t(mesh.material));
    EXPECT_EQ(material.texture, kNoTexture);
    EXPECT_EQ(material.albedo, glm::vec3(0.8f));
  }
}

TEST_F(Import, FindsTexturesOnceByAnyCaseAndBareName) {
  fs::create_directories(folder / "maps");
  write("maps/Wood.TGA", two_texels_tga());
  write("Stone.tga", two_texels_tga());
  write("t.mtl",
        "newmtl a\nKd 0 0 0\nmap_Kd maps\\wood.tga\nnewmtl b\nKd 0.5 0.5 0.5\nmap_Kd maps\\wood.tga\n"
        "newmtl c\nmap_Kd C:\\art\\stone.tga\n");
  const Scene scene = read("t.obj", std::string("mtllib t.mtl\n") + kCubeVertices +
                                        "vt 0.25 0.75\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 5/1 6/1 7/1\n"
                                        "usemtl c\nf 2/1 3/1 4/1\n");
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.textures[0].width, 2);
  EXPECT_EQ(scene.textures[0].height, 1);
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 0}));
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials.at(std::size_t(mesh.material));
    EXPECT_NE(material.texture, kNoTexture);
    EXPECT_TRUE(material.alpha_mask) << "each texel is transparent or opaque";
    EXPECT_EQ(mesh.uvs.at(0), glm::vec2(0.25f, 0.75f));
    if (material.name == "a") {
      EXPECT_EQ(material.albedo, glm::vec3(1.0f));
    }
    if (material.name == "b") {
      EXPECT_EQ(material.albedo, glm::vec3(0.5f));
    }
  }
}

TEST_F(Import, ReadsTheMaskOfObjFromASeparateFile) {
  write("color.tga", two_texels_tga());
  std::string mask = two_texels_tga();
  for (std::size_t i = 18; i < 22; ++i) mask[i] = 0;           // the first texel black
  for (std::size_t i = 22; i < 26; ++i) mask[i] = char(0xff);  // the second white
  mask[21] = char(0xff);                                       // both opaque: the brightness is the mask
  write("mask.tga", mask);
  write("d.mtl", "newmtl a\nKd 1 1 1\nmap_Kd color.tga\nmap_d mask.tga\n");
  const Scene scene =
      read("d.obj", std::string("mtllib d.mtl\n") + kCubeVertices + "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  const Material& material = scene.materials.at(std::size_t(scene.meshes.at(0).material));
  ASSERT_NE(material.texture, kNoTexture);
  EXPECT_TRUE(material.alpha_mask);
  EXPECT_EQ(scene.textures[std::size_t(material.texture)].rgba,
            (std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255, 0, 255}));
}

TEST_F(Import, ReadsPlyAsTextAndBinaryAndStrips) {
  const std::string body = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const Scene text = read("a.ply", "ply\nformat ascii 1.0\ncomment made by hand\n" + body +
                                       "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                       "0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n");
  EXPECT_EQ(text.triangle_count(), 2u);
  EXPECT_EQ(text.bounds_max, glm::vec3(2, 1, 0));

  std::string binary = "ply\nformat binary_little_endian 1.0\n" + body +
                       "element face 1\nproperty list uchar uint vertex_index\nend_header\n" +
                       bytes_of({0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0});
  binary += std::string("\x03\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  EXPECT_EQ(read("b.ply", binary).triangle_count(), 1u);

  const Scene strips = read("c.ply", "ply\nformat ascii 1.0\n" + body +
                                         "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                                         "0 0 0\n2 0 0\n0 1 0\n2 1 0\n8 0 1 2 3 -1 0 1 3\n");
  ASSERT_EQ(strips.triangle_count(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(face_normal(strips.meshes[0], i), glm::vec3(0, 0, 1)) << i;
}

/// The linear value of sRGB 0.5.
constexpr float kHalfLinear = 0.21404114f;

void expect_near(const glm::vec3& a, const glm::vec3& b, const char* what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f) << what << ", channel " << c;
}

TEST_F(Import, ReadsColorsOfVertices) {
  // Red, sRGB 0.5 grey, and blue.
  const glm::vec3 wanted[3] = {{1, 0, 0}, glm::vec3(kHalfLinear), {0, 0, 1}};
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float red\nproperty float green\nproperty float blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 1 0 0\n1 0 0 0.5 0.5 0.5\n0 1 0 0 0 1\n3 0 1 2\n";
  const Scene scenes[] = {read("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 0 0 1\nf 1 2 3\n"),
                          read("a.ply", ply),
                          read("a.off", "COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0.5 0.5 0.5 1\n0 1 0 0 0 1 1\n3 0 1 2\n")};
  for (const Scene& scene : scenes) {
    ASSERT_EQ(scene.triangle_count(), 1u) << scene.name;
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.colors.size(), 3u) << scene.name;
    EXPECT_TRUE(scene.warnings.empty()) << scene.name;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t corner = mesh.positions[k].x == 1.0f ? 1 : mesh.positions[k].y == 1.0f ? 2 : 0;
      const glm::vec3 product = mesh.colors[k] * scene.materials[std::size_t(mesh.material)].albedo;
      if (scene.name != "a.obj") expect_near(product, wanted[corner], scene.name.c_str());
      expect_near(mesh.colors[k], wanted[corner], scene.name.c_str());
    }
  }

  // Bytes are multiples of 1 / 255; glTF has linear light, in several types.
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0 51 0 0\n1 0 0 51 0 0\n0 1 0 51 0 0\n3 0 1 2\n";
  expect_near(read("b.ply", bytes).meshes.at(0).colors.at(0), {0.03310477f, 0, 0}, "bytes");
  expect_near(
      read("b.off", "COFF\n3 1 0\n0 0 0 51 0 0\n1 0 0 255 0 0\n0 1 0 0 0 0\n3 0 1 2\n").meshes.at(0).colors.at(0),
      {0.03310477f, 0, 0}, "bytes of OFF");
  const Mesh linear = read("c.gltf", colored_gltf()).meshes.at(0);
  ASSERT_EQ(linear.colors.size(), 3u);
  expect_near(linear.colors[0], {0.5f, 0.25f, 1.0f}, "glTF");

  // Colours that are white everywhere are dropped.
  EXPECT_TRUE(read("w.obj", "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n").meshes.at(0).colors.empty());
}

TEST_F(Import, DifferentColorsSplitVertices) {
  // Two triangles share an edge; one is red, the other blue. Normals are averaged across the edge, colours are not.
  const Scene scene = read("seam.obj",
                           "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\n"
                           "v 1 0 0 0 0 1\nv 1 1 0 0 0 1\nv 0 1 0 0 0 1\nf 1 2 3\nf 4 5 6\n");
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.positions.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(mesh.colors[mesh.indices[i]], i < 3 ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[mesh.indices[i]], glm::vec3(0, 0, 1));
  }
}

TEST_F(Import, ReadsPoints) {
  const std::string header =
      " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nend_header\n";
  std::string big = bytes_of({0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2, 0, 1, 0, 0, 0, 2});
  const std::string little = big;
  for (std::size_t i = 0; i < big.size(); i += 4)
    std::reverse(big.begin() + std::ptrdiff_t(i), big.begin() + std::ptrdiff_t(i) + 4);
  const Scene scenes[] = {read("t.ply", "ply\nformat ascii" + header + "0 0 0 0 0 2\n1 0 0 0 0 2\n0 1 0 0 0 2\n"),
                          read("l.ply", "ply\nformat binary_little_endian" + header + little),
                          read("b.ply", "ply\nformat binary_big_endian" + header + big),
                          read("p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 0 2\nvn 0 0 2\np 1 2 3\n"),
                          read("p.off", "NOFF\n3 0 0\n0 0 0 0 0 2\n1 0 0 0 0 2\n0 1 0 0 0 2\n"),
                          read("p.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n"),
                          read("p.gltf", points_gltf())};
  for (const Scene& scene : scenes) {
    EXPECT_EQ(scene.triangle_count(), 0u) << scene.name;
    ASSERT_EQ(scene.point_count(), 3u) << scene.name;
    const Mesh& mesh = scene.meshes[0];
    EXPECT_FALSE(mesh.spheres) << scene.name;
    ASSERT_EQ(mesh.normals.size(), 3u) << scene.name;
    ASSERT_EQ(mesh.radii.size(), 3u) << scene.name;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(std::abs(mesh.normals[i].z), 1.0f) << scene.name;
      EXPECT_GT(mesh.radii[i], 0.3f) << scene.name;
      EXPECT_LT(mesh.radii[i], 2.0f) << scene.name;
    }
    EXPECT_TRUE(scene.warnings.empty());
  }
}

TEST_F(Import, ReadsColumnsAfterPositions) {
  const auto mesh_of = [&](const std::string& text) { return read("a.xyz", text).meshes.at(0); };
  const Mesh colored = mesh_of("# a scan\n0 0 0 255 0 0\n1,0,0,255,0,0\n0;1;0;51;0;0\n");
  ASSERT_EQ(colored.colors.size(), 3u);
  const Mesh both = mesh_of("3\n0 0 0 17 255 0 0 0 0 1\n1 0 0 18 255 0 0 0 0 1\n0 1 0 19.5 255 0 0 0 0 1\n");
  ASSERT_EQ(both.colors.size(), 3u) << "after an intensity";
  EXPECT_EQ(both.colors[0], glm::vec3(1, 0, 0));
  EXPECT_EQ(both.normals.size(), 3u);
  EXPECT_TRUE(mesh_of("0 0 0 0.5\n1 0 0 0.25\n0 1 0 1\n").colors.empty()) << "an intensity alone";
}

TEST_F(Import, PointSettingsOverrideTheFile) {
  const std::string text = "0 0 0\n2 0 0\n0 2 0\n2 2 0\n1 1 0\n";
  ImportSettings settings;
  settings.points = {PointShape::kSpheres, {0.5f, 0}};
  const Mesh spheres = read("a.xyz", text, settings).meshes.at(0);
  EXPECT_TRUE(spheres.spheres);
  EXPECT_TRUE(spheres.normals.empty());
  for (const float radius : spheres.radii) EXPECT_EQ(radius, 0.25f);
  settings.points = {PointShape::kDiscs, {10.0f, 1}};
  const Mesh discs = read("a.xyz", text, settings).meshes.at(0);
  EXPECT_EQ(discs.radii.size(), 5u);
  for (const float radius : discs.radii)
    EXPECT_NEAR(radius, 0.05f * std::numbers::sqrt2_v<float>, 1e-6f) << "5 % of the bounding-sphere radius";
}

TEST_F(Import, ReadsStlWithUpAlongZ) {
  const Scene text = read("a.stl",
                          "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                          "endloop\nendfacet\nendsolid a\n");
  EXPECT_EQ(text.triangle_count(), 1u);
  EXPECT_EQ(text.up, glm::vec3(0, 0, 1));
  EXPECT_EQ(text.meshes[0].normals.at(0), glm::vec3(0, 0, 1));

  std::string binary(80, ' ');
  binary += std::string("\2\0\0\0", 4);
  for (int i = 0; i < 2; ++i) {
    binary += bytes_of({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, float(i)}) + std::string(2, '\0');
  }
  ImportSettings settings;
  settings.up = {0.0f, 3.0f, 0.0f};
  const Scene scene = read("b.stl", binary, settings);
  EXPECT_EQ(scene.triangle_count(), 2u);
  EXPECT_EQ(scene.up, glm::vec3(0, 1, 0)) << "the setting has priority over the format";
}

TEST_F(Import, ReadsOff) {
  const Scene scene =
      read("a.off", "OFF # a comment\n4 1 0\n0 0 0\n1 0 0 255 0 0\n1 1 0\n0 1 0 # here too\n4 0 1 2 3 0.5 0.5 0.5\n");
  EXPECT_EQ(scene.triangle_count(), 2u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
}

TEST_F(Import, ReadsDaeAndTurnsItUp) {
  const auto dae = [](const std::string& up, const std::string& last_index) {
    return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>)" +
           up + R"(</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="pa" count="9">0 0 0 1 0 0 0 0 5</float_array><technique_common><accessor source="#pa" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 )" +
           last_index + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  };
  const Scene z_up = read("z.dae", dae("Z_UP", "2")), y_up = read("y.dae", dae("Y_UP", "2"));
  EXPECT_NEAR(glm::dot(z_up.bounds_max, z_up.up), 5.0f, 1e-5f);
  EXPECT_NEAR(glm::dot(y_up.bounds_max, y_up.up), 0.0f, 1e-5f);
  expect_error(write("bad.dae", dae("Y_UP", "two")), "<p>");
  std::string text = dae("Y_UP", "2");
  text.replace(text.find("count=\"3\""), 9, "count=\"7\"");
  expect_error(write("more.dae", text), "<accessor>");
}

TEST_F(Import, BakesTransformsAndTurnsMirroredFaces) {
  const std::string plain =
      R"({"pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,1,1],"roughnessFactor":0.5,"metallicFactor":0}})";
  const Scene moved = read("a.gltf", triangle_gltf(R"(,"translation":[10,20,30],"scale":[2,4,1])", plain));
  EXPECT_EQ(moved.bounds_min, glm::vec3(10, 20, 30));
  EXPECT_EQ(moved.bounds_max, glm::vec3(12, 24, 30));
  const Material& material = moved.materials.at(std::size_t(moved.meshes.at(0).material));
  EXPECT_EQ(material.albedo, glm::vec3(0.25f, 0.5f, 1.0f));
  EXPECT_NEAR(material.specular_exponent, 30.0f, 1e-3f) << "2 / 0.5^4 - 2";
  EXPECT_NEAR(material.specular_strength, 0.04f * 30.0f / 8.0f, 1e-4f);

  // Mirroring reverses the winding, but the face must still point to +z.
  const Scene mirrored = read("b.gltf", triangle_gltf(R"(,"scale":[-1,1,1])", plain));
  EXPECT_EQ(mirrored.bounds_min.x, -1.0f);
  EXPECT_EQ(face_normal(mirrored.meshes.at(0), 0), glm::vec3(0, 0, 1));
  EXPECT_EQ(mirrored.meshes[0].normals.at(0), glm::vec3(0, 0, 1));
}

TEST_F(Import, GivesEachNodeItsObject) {
  std::string text = triangle_gltf("", "{}");
  text.replace(text.find(R"("nodes":[0])"), 11, R"("nodes":[0,1])");
  text.replace(text.find(R"([{"mesh":0}])"), 12, R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]}])");
  const Scene scene = read("two.gltf", text);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_NE(scene.meshes[0].object, scene.meshes[1].object);
  EXPECT_EQ(scene.bounds_max.x, 6.0f);
}

TEST_F(Import, ReadsAlphaMaskOfGltf) {
  write("dots.tga", two_texels_tga());
  const auto material_of = [&](const std::string& name, const std::string& mode, const std::string& factor = "") {
    const std::string color = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0})" + factor + "}";
    const Scene scene = read(name, triangle_gltf("", "{" + mode + color + "}"));
    return scene.materials.at(std::size_t(scene.meshes.at(0).material));
  };
  const Material mask = material_of("m.gltf", R"("alphaMode":"MASK","alphaCutoff":0.25,)");
  EXPECT_TRUE(mask.alpha_mask);
  EXPECT_EQ(mask.alpha_cutoff, 0.25f);
  EXPECT_NE(mask.texture, kNoTexture);
  // The cutoff is for the product of the texture's alpha and the factor's; alpha_cutoff is for the texture's alone.
  const std::string half = R"(,"baseColorFactor":[1,1,1,0.5])";
  EXPECT_EQ(material_of("h.gltf", R"("alphaMode":"MASK","alphaCutoff":0.25,)", half).alpha_cutoff, 0.5f);
  EXPECT_EQ(material_of("d.gltf", R"("alphaMode":"MASK",)", half).alpha_cutoff, 1.0f) << "0.5 by default";
  const Material opaque = material_of("o.gltf", "");
  EXPECT_FALSE(opaque.alpha_mask);
  EXPECT_NE(opaque.texture, kNoTexture);
}

TEST_F(Import, ReadsColorAndHighlightOfGltf) {
  const auto material_of = [&](const std::string& material) {
    const Scene scene = read("a.gltf", triangle_gltf("", "{" + material + "}"));
    return scene.materials.at(std::size_t(scene.meshes.at(0).material));
  };
  const std::string color = R"("pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.25,1],"roughnessFactor":0.5,)";
  const Material metal = material_of(color + R"("metallicFactor":1})");
  EXPECT_EQ(metal.albedo, glm::vec3(1, 0.5f, 0.25f));
  EXPECT_NEAR(metal.specular_exponent, 30.0f, 1e-3f) << "2 / 0.5^4 - 2";
  EXPECT_NEAR(metal.specular_strength, 1.0f, 1e-4f);
  const Material plastic = material_of(color + R"("metallicFactor":0})");
  EXPECT_NEAR(plastic.specular_strength, 0.04f * 30.0f / 8.0f, 1e-4f);
  const Material unlit = material_of(R"("extensions":{"KHR_materials_unlit":{}},)" + color + R"("metallicFactor":1})");
  EXPECT_EQ(unlit.albedo, metal.albedo);
  EXPECT_EQ(unlit.specular_strength, 0.0f);
  for (const char* sides : {"true", "false"})
    EXPECT_EQ(material_of(std::string("\"doubleSided\":") + sides).albedo, glm::vec3(1.0f));
}

TEST_F(Import, ReadsEmissionOfGltf) {
  write("dots.tga", two_texels_tga());
  const auto material_of = [&](const std::string& material) {
    const Scene scene = read("a.gltf", triangle_gltf("", "{" + material + "}"));
    return scene.materials.at(std::size_t(scene.meshes.at(0).material));
  };
  const std::string factor = R"("emissiveFactor":[1,0.5,0])";
  EXPECT_EQ(material_of("").emission, glm::vec3(0.0f));
  EXPECT_EQ(material_of(factor).emission, glm::vec3(1, 0.5f, 0));
  EXPECT_EQ(material_of(factor).emission_texture, kNoTexture);
  const std::string strong = R"(,"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}})";
  EXPECT_EQ(material_of(factor + strong).emission, glm::vec3(4, 2, 0));
  const Material textured = material_of(factor + R"(,"emissiveTexture":{"index":0})" + strong);
  EXPECT_EQ(textured.emission, glm::vec3(4, 2, 0));
  EXPECT_NE(textured.emission_texture, kNoTexture);
  EXPECT_EQ(textured.texture, kNoTexture);
  EXPECT_EQ(material_of(R"("emissiveTexture":{"index":0})").emission_texture, kNoTexture) << "times 0";
}

TEST_F(Import, AppliesGltfTextureTransforms) {
  write("dots.tga", two_texels_tga());
  // The triangle's texture coordinates are its x and y, with v measured from the top.
  const auto expect_uvs = [&](const std::string& use, auto wanted) {
    const Scene scene =
        read("a.gltf", triangle_gltf("", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0)" + use + "}}}"));
    const Mesh& mesh = scene.meshes.at(0);
    ASSERT_EQ(mesh.uvs.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec2 uv = wanted(mesh.positions[k].x, mesh.positions[k].y);
      EXPECT_NEAR(mesh.uvs[k].x, uv.x, 1e-5f) << use;
      EXPECT_NEAR(mesh.uvs[k].y, 1.0f - uv.y, 1e-5f) << use;
    }
  };
  const auto transform = [](const std::string& what) {
    return R"(,"extensions":{"KHR_texture_transform":{)" + what + "}}";
  };
  expect_uvs("", [](float x, float y) { return glm::vec2(x, y); });
  expect_uvs(transform(R"("offset":[0.25,0.5],"scale":[2,3])"),
             [](float x, float y) { return glm::vec2(2 * x + 0.25f, 3 * y + 0.5f); });
  expect_uvs(transform(R"("rotation":1.5707963)"), [](float x, float y) { return glm::vec2(y, -x); });
  expect_uvs(transform(R"("rotation":1.5707963,"scale":[2,1],"offset":[0,1])"),
             [](float x, float y) { return glm::vec2(y, 1.0f - 2.0f * x); });
  expect_uvs(R"(,"texCoord":1)", [](float x, float y) { return glm::vec2(x, y); });  // a missing set
}

TEST_F(Import, SkipsTransparentMeshes) {
  const auto two_of = [&](const std::string& other) {
    std::string text = triangle_gltf("", R"({"name":"wall"},{"name":"pane",)" + other + "}");
    text.replace(text.find(R"("nodes":[0])"), 11, R"("nodes":[0,1])");
    text.replace(text.find(R"([{"mesh":0}])"), 12, R"([{"mesh":0},{"mesh":1,"translation":[5,0,0]}])");
    const std::string primitive = R"({"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":1}]})";
    text.insert(text.find(R"(],
"materials")"),
                "," + primitive);
    return read("two.gltf", text);
  };
  const std::string alpha = R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)";
  const Scene blended = two_of(alpha + R"(0.2]},"alphaMode":"BLEND")");
  ASSERT_EQ(blended.meshes.size(), 2u);
  EXPECT_TRUE(blended.warnings.empty());
  EXPECT_TRUE(blended.materials.at(1).blended);
  EXPECT_EQ(blended.materials[1].opacity, 0.2f);
  const Scene clear = two_of(alpha + R"(0]},"alphaMode":"BLEND")");
  EXPECT_EQ(clear.meshes.size(), 1u);
  ASSERT_EQ(clear.warnings.size(), 1u);
  EXPECT_NE(clear.warnings[0].find("pane"), std::string::npos);
  EXPECT_EQ(two_of(alpha + R"(0.2]},"alphaMode":"MASK")").meshes.size(), 1u);
  EXPECT_EQ(two_of(alpha + R"(0.2]},"alphaMode":"MASK","alphaCutoff":0.1)").meshes.size(), 2u);
  EXPECT_EQ(two_of(alpha + R"(0.8]},"alphaMode":"BLEND")").meshes.size(), 2u);
  EXPECT_EQ(two_of(alpha + R"(0.2]})").meshes.size(), 2u) << "opaque, whatever its alpha";
  // A transparent mesh is drawn if it is the only mesh.
  const Scene glass = read("glass.gltf", triangle_gltf("", "{" + alpha + R"(0]},"alphaMode":"BLEND"})"));
  EXPECT_EQ(glass.triangle_count(), 1u);
}

TEST_F(Import, ReadsCamerasAndScenesOfGltf) {
  std::string text = triangle_gltf("", "{}");
  // The second scene is the default: the triangle and, under a translated and rotated node, two cameras.
  text.replace(text.find(R"("scene":0,"scenes":[{"nodes":[0]}])"), 34,
               R"("scene":1,"scenes":[{"nodes":[]},{"nodes":[0,1]}],"cameras":[
{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}},
{"name":"plan","type":"orthographic","orthographic":{"xmag":3,"ymag":2,"znear":0.1,"zfar":9}}])");
  // Rotated by 90 degrees about y: -z becomes -x.
  text.replace(text.find(R"([{"mesh":0}])"), 12,
               R"([{"mesh":0},{"translation":[5,0,0],"rotation":[0,0.70710678,0,0.70710678],"children":[2,3]},
{"name":"front","camera":0,"translation":[0,1,0]},{"camera":1,"scale":[2,2,2]}])");
  const Scene scene = read("cameras.gltf", text);
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_TRUE(scene.views.empty()) << "cameras of the file are used on request";
  ASSERT_EQ(scene.cameras.size(), 2u);
  const View &front = scene.cameras[0], &plan = scene.cameras[1];
  EXPECT_EQ(front.name, "front");
  EXPECT_NEAR(front.angle_deg, glm::degrees(0.5f), 1e-4f);
  expect_near(front.eye, {5, 1, 0}, "eye");
  expect_near(front.target, {4, 1, 0}, "target");
  expect_near(front.up, {0, 1, 0}, "up");
  EXPECT_EQ(plan.name, "plan");
  EXPECT_EQ(plan.height, 4.0f);
  expect_near(plan.eye, {5, 0, 0}, "eye");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("2 scenes"), std::string::npos);
}

TEST_F(Import, ReadsEmbeddedTextures) {
  std::string text = triangle_gltf("", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})");
  const std::string uri = "data:image/x-tga;base64," + base64(two_texels_tga());
  text.replace(text.find("dots.tga"), 8, uri);
  const Scene scene = read("e.gltf", text);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 0}));
}

TEST_F(Import, BadFilesGiveOneSentence) {
  expect_error(folder / "none.obj", "does not exist");
  expect_error(folder, "folder");
  fs::create_directories(folder / "f.obj");
  expect_error(folder / "f.obj", "folder");
  expect_error(write("notes.txt", "hello"), ".obj, .ply, .stl");
  expect_error(write("noending", "hello"), ".obj, .ply, .stl");
  for (const std::string& format : import_formats()) {
    SCOPED_TRACE(format);
    expect_error(write("empty." + format, ""), "is empty");
    expect_error(write("text." + format, "This is a letter, not a model.\n"), "");
    std::mt19937 random(1);
    std::string noise(5000, '\0');
    for (char& c : noise) c = char(random());
    expect_error(write("noise." + format, noise), "");
  }
  expect_error(write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n"), "no triangles");
  expect_error(write("nan.obj", "v nan nan nan\nv nan 0 0\nv 0 nan 0\nf 1 2 3\n"), "");
  expect_error(write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "degenerate");
  expect_error(write("x.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
               "without 'y'");
  expect_error(write("nan.xyz", "nan 0 0\nnan 1 0\n"), "not finite");
  expect_error(write("words.xyz", "1 2 3\n1 two 3\n"), "line 2");
  expect_error(write("many.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n0\n"),
               "cut short");
  expect_error(write("head.ply", "ply\nformat ascii 1.0\nelement vertex"), "end_header");
  expect_error(write("type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n0\n"), "real");
  expect_error(write("short.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), "cut short");
  expect_error(write("many.off", "OFF\n4000000000 1 0\n0 0 0\n"), "cut short");
  const std::string gltf = triangle_gltf("", "{}");
  expect_error(write("cut.gltf", gltf.substr(0, gltf.size() / 2)), "");
}

TEST_F(Import, DropsWhatCannotBeDrawn) {
  const Scene scene = read("a.ply",
                           "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
                           "property float z\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n0 1 0\nnan 0 0\n900 0 0\ninf 5 5\n"
                           "3 0 1 2\n3 0 0 1\n3 0 1 3\n3 0 1 77\n3 0 5 2\n");
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
  EXPECT_EQ(scene.bounds_max, glm::vec3(1, 1, 0)) << "vertices that no triangle uses do not count";
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_EQ(scene.warnings[0], "1 of 5 triangles have vertex indices out of range and are left out");
  EXPECT_EQ(scene.warnings[1], "2 of 5 triangles have coordinates that are not finite or above 1e15 and are left out");
}

TEST_F(Import, ReportsIndicesOutOfRange) {
  std::string text = triangle_gltf("", "{}");
  const std::string indices = std::string("\0\0\1\0\2\0\0\0\1\0\x63\0", 12);
  text.replace(text.find(R"("TEXCOORD_0":1})"), 15, R"("TEXCOORD_0":1},"indices":2)");
  text.replace(text.find(R"("type":"VEC2"})"), 14,
               R"("type":"VEC2"},{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"})");
  text.replace(text.find(R"("byteLength":24})"), 16, R"("byteLength":24},{"buffer":1,"byteLength":12})");
  text.replace(text.find(R"("}],
"textures")"),
               15, R"("},{"byteLength":12,"uri":"data:application/octet-stream;base64,)" + base64(indices) + R"("}],
"textures")");
  const Scene scene = read("astray.gltf", text);
  EXPECT_EQ(scene.triangle_count(), 1u);
  ASSERT_FALSE(scene.warnings.empty());
  EXPECT_NE(scene.warnings[0].find("have vertex indices out of range"), std::string::npos) << scene.warnings[0];
}

// ---- normals and removal of unusable triangles, without files

Mesh cube_mesh() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return mesh;
}

/// Returns the same triangles with three separate vertices each, and with zeros of both signs.
Mesh with_separate_vertices(const Mesh& mesh) {
  Mesh separate;
  for (std::uint32_t index : mesh.indices) {
    separate.indices.push_back(std::uint32_t(separate.positions.size()));
    glm::vec3 p = mesh.positions[index];
    if (separate.positions.size() % 2) {
      for (int k = 0; k < 3; ++k) p[k] = p[k] == 0.0f ? -0.0f : p[k];
    }
    separate.positions.push_back(p);
  }
  return separate;
}

Mesh sphere_mesh(int rings, int sectors, float radius, glm::vec3 center) {
  Mesh mesh;
  for (int i = 0; i <= rings; ++i) {
    for (int k = 0; k < sectors; ++k) {
      const double theta = std::numbers::pi * i / rings, phi = 2.0 * std::numbers::pi * k / sectors;
      const double out = i == rings ? 0.0 : std::sin(theta);  // all vertices of a pole are at one position
      mesh.positions.push_back(center + radius * glm::vec3(out * std::cos(phi), std::cos(theta), out * std::sin(phi)));
    }
  }
  const auto at = [&](int i, int k) { return std::uint32_t(i * sectors + k % sectors); };
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < sectors; ++k) {
      mesh.indices.insert(mesh.indices.end(), {at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      mesh.indices.insert(mesh.indices.end(), {at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  }
  return mesh;
}

TEST(Normals, CreaseAngleSplitsACube) {
  for (const Mesh& source : {cube_mesh(), with_separate_vertices(cube_mesh())}) {
    Mesh sharp = source, smooth = source, just_below = source, just_above = source;
    make_normals(sharp, 60.0f);
    make_normals(smooth, 180.0f);
    make_normals(just_below, 89.5f);
    make_normals(just_above, 90.5f);
    EXPECT_EQ(sharp.positions.size(), 24u);
    EXPECT_EQ(smooth.positions.size(), 8u);
    EXPECT_EQ(just_below.positions.size(), 24u);
    EXPECT_EQ(just_above.positions.size(), 8u);
    for (std::size_t i = 0; i < sharp.indices.size(); ++i) {
      EXPECT_LT(glm::distance(sharp.normals[sharp.indices[i]], face_normal(sharp, i / 3)), 1e-6f);
      EXPECT_EQ(sharp.positions[sharp.indices[i]], source.positions[source.indices[i]]);
    }
    // Because of the weights by angle, a corner's normal is its diagonal, however its faces are triangulated.
    for (std::size_t v = 0; v < 8; ++v) {
      const glm::vec3 diagonal = glm::normalize(smooth.positions[v] - 0.5f);
      EXPECT_LT(glm::distance(smooth.normals[v], diagonal), 1e-5f);
    }
  }
}

TEST(Normals, KeepTextureSeams) {
  Mesh mesh = with_separate_vertices(cube_mesh());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.uvs.emplace_back(v < 18 ? 0.0f : 1.0f, 0.0f);
  make_normals(mesh, 180.0f);
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  EXPECT_GT(mesh.positions.size(), 8u) << "where the texture coordinates differ, vertices stay apart";
  EXPECT_LE(mesh.positions.size(), 16u);
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) EXPECT_EQ(mesh.uvs[mesh.indices[i]].x, i < 18 ? 0.0f : 1.0f);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_LT(glm::distance(mesh.normals[v], glm::normalize(mesh.positions[v] - 0.5f)), 1e-5f) << "and share a normal";
  }
}

TEST(Normals, OfASphereAreRadialAtAnyScale) {
  struct Case {
    float radius;
    glm::vec3 center;
    float tolerance_deg;
  };
  // In the last case adjacent floats differ by 0.008, which is 1e-4 of the radius and tilts a face by 0.2 degrees.
  for (const Case& c : {Case{1.0f, glm::vec3(0.0f), 1.0f}, Case{1e-6f, glm::vec3(0.0f), 1.0f},
                        Case{1e-15f, glm::vec3(0.0f), 1.0f}, Case{1e6f, glm::vec3(0.0f), 1.0f},
                        Case{1e15f, glm::vec3(0.0f), 1.0f}, Case{80.0f, glm::vec3(1e5f, 0.0f, 0.0f), 1.0f}}) {
    Scene scene;
    scene.meshes.push_back(sphere_mesh(48, 96, c.radius, c.center));
    const std::size_t dropped = finish_scene(scene);
    ASSERT_EQ(scene.meshes.size(), 1u) << c.radius;
    EXPECT_LE(dropped, 192u) << "at most the triangles at the poles";
    const Mesh& mesh = scene.meshes[0];
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const glm::dvec3 radial = glm::normalize(glm::dvec3(mesh.positions[v]) - glm::dvec3(c.center));
      const double cosine = glm::dot(radial, glm::dvec3(mesh.normals[v]));
      ASSERT_GT(cosine, std::cos(glm::radians(double(c.tolerance_deg)))) << c.radius << " vertex " << v;
      ASSERT_NEAR(glm::length(mesh.normals[v]), 1.0f, 1e-5f);
    }
  }
}

TEST(Normals, AreUnitWhereFacesCancel) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 1};
  make_normals(mesh, 180.0f);
  for (const glm::vec3& normal : mesh.normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-6f);
}

TEST(Finish, RepairsBadNormals) {
  Scene scene;
  Mesh mesh = sphere_mesh(8, 16, 1.0f, glm::vec3(0.0f));
  mesh.normals = mesh.positions;
  for (glm::vec3& normal : mesh.normals) normal *= 3.0f;
  mesh.normals[40] = glm::vec3(0.0f);
  mesh.normals[50] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
  scene.meshes.push_back(mesh);
  finish_scene(scene);
  const Mesh& finished = scene.meshes.at(0);
  for (std::size_t v = 0; v < finished.positions.size(); ++v) {
    EXPECT_NEAR(glm::length(finished.normals[v]), 1.0f, 1e-5f);
    EXPECT_GT(glm::dot(finished.normals[v], glm::normalize(finished.positions[v])), 0.95f) << v;
  }
}

TEST(Finish, DropsByShapeAndNotBySize) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 0}, {1, 0, 0}, {1, 1e-3f, 0}, {0.5f, 0, 0}};
  mesh.indices = {0, 1, 2, /* a sliver */ 0, 3, 4, /* without area */ 0, 5, 3, /* half a triangle */ 0, 1};
  scene.meshes = {mesh, Mesh{}};
  EXPECT_EQ(finish_scene(scene), 2u);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.triangle_count(), 2u);
  EXPECT_EQ(scene.materials.size(), 1u) << "every mesh has a material";
}

TEST(Finish, TakesAnEmptyScene) {
  Scene scene;
  EXPECT_EQ(finish_scene(scene), 0u);
  EXPECT_EQ(scene.radius(), 0.0f);
}

TEST(TextureFile, RejectsOtherData) {
  const std::vector<std::uint8_t> noise(100, 7);
  const Result<Texture> texture = decode_texture(noise, "noise.png");
  ASSERT_FALSE(texture);
  EXPECT_EQ(texture.error().kind, ErrorKind::kFile);
  EXPECT_NE(texture.error().message.find("noise.png"), std::string::npos);
  EXPECT_FALSE(decode_texture({}, "empty.png"));
  EXPECT_FALSE(read_texture("/nowhere/at/all.png"));
}

}  // namespace
}  // namespace umbrage
