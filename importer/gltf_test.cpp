// glTF: images; geometry of all kinds of accessors, primitives, nodes, skins and animations, and bad files.
#include <tbb/task_arena.h>

#include "core/color.h"
#include "importer/decode_image.h"
#include "importer/gltf_accessor.h"
#include "importer/gltf_test_support.h"
#include "importer/readers.h"
#include "io/format.h"
#include "scene/finish.h"

#include <glm/common.hpp>

namespace umbrage::test {
namespace {

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "axis " << c;
}

TEST_F(GltfTest, ReadsQuantizedPositionsAndNormalisedIntegers) {
  GltfBuilder b = GltfBuilder::triangle();
  auto& attributes = b.primitive()["attributes"];
  attributes["POSITION"] = b.add(std::vector<std::uint16_t>{0, 0, 0, 1000, 0, 0, 0, 2000, 0}, "VEC3", 3);
  attributes["NORMAL"] = b.add(std::vector<std::int8_t>{0, 0, 127, 0, 0, 127, 0, 0, -128}, "VEC3", 3, true);
  attributes["TEXCOORD_0"] = b.add(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 65535}, "VEC2", 2, true);
  attributes["COLOR_0"] = b.add(std::vector<std::uint8_t>{255, 0, 51, 255, 0, 51, 255, 0, 51}, "VEC3", 3, true);
  b.json["nodes"][0]["scale"] = {0.001, 0.001, 0.001};
  const Scene scene = read(b);
  EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
  expect_near(scene.bounds_max, {1, 2, 0});
  const Mesh& mesh = scene.meshes.at(0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(mesh.uvs[i], glm::vec2(mesh.positions[i].x, 1.0f - 0.5f * mesh.positions[i].y));
    expect_near(mesh.colors[i], {1.0f, 0.0f, 0.2f});
    EXPECT_EQ(std::abs(mesh.normals[i].z), 1.0f);
  }
}

TEST_F(GltfTest, ReadsAttributesOfTheApplicationAsFields) {
  GltfBuilder b = GltfBuilder::triangle();
  auto& attributes = b.primitive()["attributes"];
  attributes["_PRESSURE"] = b.add(std::vector<float>{1, 2, 3}, "SCALAR", 1);
  attributes["_FLOW"] = b.add(std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9}, "VEC3", 3);
  attributes["_SHORT"] = b.add(std::vector<float>{1, 2}, "SCALAR", 1);
  EXPECT_TRUE(read(b).meshes.at(0).fields.empty());
  ImportSettings settings;
  settings.field = "_FLOW";
  const auto flow = try_read("flow.gltf", b.gltf(), settings);
  ASSERT_TRUE(flow);
  ASSERT_EQ(flow->meshes.at(0).fields.size(), 1u);
  const Field& field = flow->meshes[0].fields[0];
  EXPECT_EQ(field.components, 3);
  for (std::size_t v = 0; v < 3; ++v) {
    const glm::vec3 p = flow->meshes[0].positions[v];
    EXPECT_EQ(field.values[3 * v], p.x == 0.0f && p.y == 0.0f ? 1.0f : p.y == 0.0f ? 4.0f : 7.0f);
  }
  settings.field = "";
  const auto all = try_read("all.gltf", b.gltf(), settings);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->meshes.at(0).fields.size(), 2u);
  EXPECT_TRUE(warns(*all, "_SHORT of the mesh")) << warnings_of(*all);
}

TEST_F(GltfTest, ModelsFaceAlongZ) {
  const Scene scene = read(GltfBuilder::triangle());
  EXPECT_TRUE(scene.has_front);
  EXPECT_EQ(scene.up, glm::vec3(0, 1, 0));
}

TEST(GltfAccessor, NormalizedIntegersReachOne) {
  constexpr int kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125;
  for (const auto& [type, max] :
       {std::pair(kInt8, 127.0), {kUint8, 255.0}, {kInt16, 32767.0}, {kUint16, 65535.0}, {kUint32, 4294967295.0}}) {
    EXPECT_EQ(normalized(0.0, type), 0.0f) << type;
    EXPECT_EQ(normalized(max, type), 1.0f) << type;
    EXPECT_EQ(normalized(std::floor(max / 2.0), type), float(std::floor(max / 2.0) / max)) << type;
  }
  // The lowest integer and the one above it are both -1.
  for (const auto& [type, max] : {std::pair(kInt8, 127.0), {kInt16, 32767.0}}) {
    EXPECT_EQ(normalized(-max, type), -1.0f) << type;
    EXPECT_EQ(normalized(-max - 1.0, type), -1.0f) << type;
  }
}

TEST_F(GltfTest, ReadsSparseAccessors) {
  GltfBuilder b = GltfBuilder::triangle();
  const int indices = b.add_view(std::vector<std::uint8_t>{2}), values = b.add_view(std::vector<float>{0, 7, 0});
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(read(b).bounds_max, glm::vec3(1, 7, 0));
  b.json["accessors"][0]["sparse"]["count"] = 2;
  EXPECT_FALSE(try_read("b.gltf", b.gltf()));
}

TEST_F(GltfTest, ReadsStripsFansAndPointsAndWarnsOfLines) {
  const auto triangles_of = [&](int mode) {
    GltfBuilder b;
    const int positions = b.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0.5f, 2, 0}, "VEC3", 3);
    b.add_primitive({{"attributes", {{"POSITION", positions}}}, {"mode", mode}});
    return b;
  };
  const Scene strip = read(triangles_of(5));
  EXPECT_EQ(strip.triangle_count(), 3u);
  for (const glm::vec3& n : strip.meshes.at(0).normals) EXPECT_EQ(n, glm::vec3(0, 0, 1)) << "one winding";
  EXPECT_EQ(read(triangles_of(6)).triangle_count(), 3u);
  EXPECT_EQ(read(triangles_of(0)).point_count(), 5u);
  const auto lines = try_read("l.gltf", triangles_of(3).gltf());
  ASSERT_FALSE(lines);
  GltfBuilder mixed = GltfBuilder::triangle();
  mixed.add_primitive({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  const Scene scene = read(mixed);
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_TRUE(warns(scene, "lines")) << warnings_of(scene);
}

TEST_F(GltfTest, FlatWithoutNormalsUnlessACreaseAngleIsGiven) {
  // Two triangles at an angle of 20 degrees share two vertices.
  GltfBuilder b;
  const int positions = b.add(std::vector<float>{0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0.35f}, "VEC3", 3),
            indices = b.add(std::vector<std::uint16_t>{0, 2, 1, 0, 1, 3}, "SCALAR", 1);
  b.add_primitive({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const auto smoothing = [&](const ImportSettings& settings) {
    const auto scene = read_gltf(write("a.gltf", b.gltf()), settings);
    return scene && *scene ? (*scene)->meshes.at(0).smoothing : std::vector<std::uint32_t>{9};
  };
  EXPECT_EQ(smoothing({}), (std::vector<std::uint32_t>{0, 0})) << "two flat triangles";
  ImportSettings smooth;
  smooth.crease_angle_deg = 80.0f;
  EXPECT_TRUE(smoothing(smooth).empty());
}

TEST_F(GltfTest, KeepsAMeshSharpFarFromTheOrigin) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["nodes"][0]["scale"] = {0.25, 0.25, 0.25};
  const Scene near = read(b);
  b.json["nodes"][0]["translation"] = {500000.125, 4200000.0, 100.0};
  const Scene far = read(b);
  const glm::vec3 offset(glm::dvec3(500000.125, 4200000.0, 100.0) - far.origin);
  for (std::size_t i = 0; i < 3; ++i)
    expect_near(far.meshes.at(0).positions[i], near.meshes.at(0).positions[i] + offset, 1e-6f);
  for (int k = 1; k < 8; ++k) {
    b.json["nodes"][k] = b.json["nodes"][0];
    b.json["scenes"][0]["nodes"].push_back(k);
  }
  b.json["nodes"][8] = {{"mesh", 0}, {"translation", {0, 0, 0}}};
  b.json["scenes"][0]["nodes"].push_back(8);
  EXPECT_EQ(read(b).origin, far.origin) << "a mesh far from the rest";
}

TEST_F(GltfTest, AppliesMorphTargets) {
  GltfBuilder b = GltfBuilder::triangle();
  const int up = b.add(std::vector<float>{0, 0, 0, 0, 0, 0, 0, 2, 0}, "VEC3", 3),
            right = b.add(std::vector<float>{0, 0, 0, 3, 0, 0, 0, 0, 0}, "VEC3", 3);
  b.primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", right}}};
  EXPECT_EQ(read(b).bounds_max, glm::vec3(1, 1, 0));
  b.json["meshes"][0]["weights"] = {0.5, 0};
  EXPECT_EQ(read(b).bounds_max, glm::vec3(1, 2, 0));
  b.json["nodes"][0]["weights"] = {0, 1};
  EXPECT_EQ(read(b).bounds_max, glm::vec3(4, 1, 0));
}

TEST_F(GltfTest, MorphsWhiteColors) {
  GltfBuilder b = GltfBuilder::triangle();
  b.primitive()["attributes"]["COLOR_0"] = b.add(std::vector<float>(9, 1.0f), "VEC3", 3);
  const int darker = b.add(std::vector<float>{0, -1, -1, 0, -1, -1, 0, -1, -1}, "VEC3", 3);
  b.primitive()["targets"] = {{{"COLOR_0", darker}}};
  EXPECT_TRUE(read(b).meshes.at(0).colors.empty());
  b.json["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(read(b).meshes.at(0).colors.at(0), glm::vec3(1.0f, 0.5f, 0.5f));
}

/// The triangle, skinned by node 1, which is at (0, 0, 5) and twice as large; the mesh's own node is elsewhere.
GltfBuilder skinned() {
  GltfBuilder b = GltfBuilder::triangle();
  auto& attributes = b.primitive()["attributes"];
  attributes["JOINTS_0"] = b.add(std::vector<std::uint8_t>(12, 0), "VEC4", 4);
  attributes["WEIGHTS_0"] = b.add(std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, "VEC4", 4, true);
  b.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                     {{"translation", {0, 0, 5}}, {"scale", {2, 2, 2}}}};
  b.json["scenes"][0]["nodes"] = {0, 1};
  b.json["skins"] = {{{"joints", {1}}}};
  return b;
}

TEST_F(GltfTest, SkinsAtTheFilesPose) {
  const Scene scene = read(skinned());
  EXPECT_EQ(scene.bounds_min, glm::vec3(0, 0, 5));
  EXPECT_EQ(scene.bounds_max, glm::vec3(2, 2, 5));
  EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST_F(GltfTest, SkinsFromThePoseOfTheMatrices) {
  GltfBuilder b = skinned();
  // Columns: the mesh is moved by (-1, 0, -3), then placed by the joint.
  b.json["skins"][0]["inverseBindMatrices"] =
      b.add(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, -3, 1}, "MAT4", 16);
  const Scene scene = read(b);
  EXPECT_EQ(scene.bounds_min, glm::vec3(2 * -1, 0, 2 * -3 + 5));
  EXPECT_EQ(scene.bounds_max, glm::vec3(0, 2, 2 * -3 + 5));
  EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

/// Adds an animation of node `node`.
void add_animation(GltfBuilder& b, const char* path, int node, const std::vector<float>& values, const char* type,
                   int width, const char* interpolation) {
  const int times = b.add(std::vector<float>{0, 2}, "SCALAR", 1), output = b.add(values, type, width);
  b.json["animations"].push_back(
      {{"name", path},
       {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}},
       {"samplers", {{{"input", times}, {"output", output}, {"interpolation", interpolation}}}}});
}

/// Returns the box of the vertices, which a pose of an animation need not have as its bounds.
SceneBox box_of(const Scene& scene) {
  SceneBox box;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) box = {glm::min(box.low, p), glm::max(box.high, p)};
  return box;
}

TEST_F(GltfTest, AnimatesNodesSkinsAndWeights) {
  GltfBuilder b = skinned();
  b.json["animations"] = Json::array();
  const int up = b.add(std::vector<float>{0, 0, 0, 0, 0, 0, 0, 2, 0}, "VEC3", 3);
  b.primitive()["targets"] = {{{"POSITION", up}}};
  add_animation(b, "translation", 1, {0, 0, 0, 8, 0, 0}, "VEC3", 3, "LINEAR");
  add_animation(b, "scale", 1, {1, 1, 1, 4, 4, 4}, "VEC3", 3, "STEP");
  add_animation(b, "rotation", 1, {0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4, "LINEAR");
  // From 0 to 1, with tangents of 0.
  add_animation(b, "weights", 0, {0, 0, 0, 0, 1, 0}, "SCALAR", 1, "CUBICSPLINE");
  const auto at = [&](int animation, float time) {
    ImportSettings settings;
    settings.animation_index = animation;
    settings.animation_time = time;
    return read(b, settings);
  };
  const Scene pose = read(b);
  ASSERT_EQ(pose.animation_names, (std::vector<std::string>{"translation", "scale", "rotation", "weights"}));
  EXPECT_EQ(pose.animation_durations_s, std::vector<float>(4, 2.0f));
  EXPECT_EQ(pose.bounds_max, glm::vec3(2, 2, 5));
  EXPECT_TRUE(pose.motion.empty());
  EXPECT_EQ(box_of(at(0, 0.5f)).low.x, 2.0f);
  EXPECT_EQ(box_of(at(0, 9.0f)).low.x, 8.0f) << "after its end";
  EXPECT_EQ(at(0, 2.0f).warnings, std::vector<std::string>());
  EXPECT_EQ(at(0, 9.0f).warnings, std::vector<std::string>{"the animation ends after 2 s; its last pose is drawn"});
  EXPECT_EQ(box_of(at(1, 1.9f)).high.x, 1.0f);
  EXPECT_EQ(box_of(at(1, 2.0f)).high.x, 4.0f);
  EXPECT_NEAR(box_of(at(2, 1.0f)).high.y, 2.0f, 1e-5f) << "a quarter turn: x becomes y";
  EXPECT_NEAR(box_of(at(2, 1.0f)).low.x, -2.0f, 1e-5f);
  EXPECT_NEAR(box_of(at(3, 1.0f)).high.y, 2.0f * (1.0f + 2.0f * 0.5f), 1e-5f);
  EXPECT_NEAR(box_of(at(3, 0.5f)).high.y, 2.0f * (1.0f + 2.0f * (3.0f / 16.0f - 2.0f / 64.0f)), 1e-5f);
  // The bounds are those of all poses, and do not depend on the time.
  for (int animation = 0; animation < 4; ++animation) {
    const Scene start = at(animation, 0.0f);
    SceneBox all;
    for (const float time : {0.0f, 0.3f, 0.5f, 1.0f, 1.4f, 2.0f, 9.0f}) {
      const Scene scene = at(animation, time);
      EXPECT_EQ(scene.motion, start.motion) << animation << ' ' << time;
      EXPECT_EQ(scene.bounds_min, start.bounds_min);
      EXPECT_EQ(scene.bounds_max, start.bounds_max);
      const SceneBox box = box_of(scene);
      all = {glm::min(all.low, box.low), glm::max(all.high, box.high)};
    }
    constexpr float kBetweenPoses = 0.01f;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(start.bounds_min[axis], all.low[axis] + kBetweenPoses) << animation;
      EXPECT_GE(start.bounds_max[axis], all.high[axis] - kBetweenPoses) << animation;
    }
  }
  EXPECT_EQ(at(0, 0.5f).bounds_max.x, 10.0f);
}

TEST_F(GltfTest, RefusesAnAnimationThatIsNotThere) {
  ImportSettings settings;
  settings.animation_index = 1;
  GltfBuilder b = skinned();
  add_animation(b, "scale", 1, {1, 1, 1, 4, 4, 4}, "VEC3", 3, "STEP");
  for (const std::string& bytes : {b.gltf(), GltfBuilder::triangle().gltf()}) {
    const auto scene = try_read("a.gltf", bytes, settings);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().kind, ErrorKind::kUsage);
    EXPECT_NE(scene.error().message.find("animation"), std::string::npos);
  }
}

TEST_F(GltfTest, FindsBuffersByEscapedNames) {
  GltfBuilder b = GltfBuilder::triangle();
  std::filesystem::create_directories(folder / "my data");
  write("my data/a b.bin", b.bytes);
  Json json = b.json;
  json["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", "my%20data/a%20b.bin"}}};
  EXPECT_TRUE(try_read("e.gltf", json.dump()));
  json["buffers"][0]["uri"] = "gone.bin";
  const auto scene = try_read("e.gltf", json.dump());
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("gone.bin"), std::string::npos) << scene.error().message;
}

TEST_F(GltfTest, RefusesEveryTruncatedGlb) {
  const std::string whole = GltfBuilder::triangle().glb();
  ASSERT_TRUE(try_read("a.glb", whole));
  for (std::size_t size = 1; size < whole.size(); size += 3) {
    const auto scene = try_read("a.glb", whole.substr(0, size));
    ASSERT_FALSE(scene) << size;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
    EXPECT_NE(scene.error().message.find("a.glb"), std::string::npos);
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
  }
}

TEST_F(GltfTest, WarnsOfValuesOfWrongTypeAndOutOfRange) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["materials"][0]["pbrMetallicRoughness"] = {{"metallicFactor", "a lot"}, {"roughnessFactor", 7}};
  b.json["nodes"][0]["translation"] = {1, 2};
  const Scene scene = read(b);
  EXPECT_EQ(scene.bounds_max, glm::vec3(1, 1, 0));
  ASSERT_EQ(scene.warnings.size(), 1u) << warnings_of(scene);
  EXPECT_TRUE(warns(scene, "3 values")) << warnings_of(scene);
  EXPECT_TRUE(warns(scene, "nodes[0].translation")) << warnings_of(scene);
  EXPECT_EQ(scene.materials.at(0).roughness, 1.0f);
}

TEST_F(GltfTest, SurvivesNodesThatAreTheirOwnAncestors) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}, {"translation", {0, 0, 1}}}};
  const Scene scene = read(b);
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_TRUE(warns(scene, "children")) << warnings_of(scene);
}

TEST_F(GltfTest, RefusesCountsWithoutData) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json["accessors"][0]["count"] = 2000000000;
  EXPECT_FALSE(try_read("a.gltf", b.gltf()));
  b.json["accessors"][0].erase("bufferView");
  EXPECT_FALSE(try_read("a.gltf", b.gltf()));
}

TEST_F(GltfTest, DrawsFilesWithoutScenes) {
  GltfBuilder b = GltfBuilder::triangle();
  b.json.erase("scenes");
  b.json.erase("scene");
  EXPECT_EQ(read(b).triangle_count(), 1u);
  b.json.erase("nodes");
  EXPECT_EQ(read(b).triangle_count(), 1u);
}

// ---- images

/// Returns a smooth picture with a steep edge.
Image pattern(int width, int height) {
  Image image = picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const float phase = float(c) + 0.21f * float(x) + 0.13f * float(y);
        image.planes[c].at(x, y) = 0.5f + 0.2f * std::sin(phase) + (x > width / 3 ? 0.25f : -0.25f);
      }
  return image;
}

std::string jpeg(int width, int height) { return *encode_fast_jpeg("a.jpg", pattern(width, height), 95); }
std::string png(int width, int height) { return *encode_png("a.png", pattern(width, height)); }

Result<Texture> decoded(const std::string& bytes, const ImageUse& use = {}) {
  return decode_texture_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "an image", use);
}

/// Returns the largest and the mean difference of a reduced texture from the means of blocks of the whole one.
std::array<double, 2> differences(const Texture& whole, const Texture& reduced, bool linear) {
  const int side = whole.width / reduced.width;
  double max = 0.0, sum = 0.0;
  for (int y = 0; y < reduced.height; ++y)
    for (int x = 0; x < reduced.width; ++x)
      for (int c = 0; c < 4; ++c) {
        const bool is_srgb = !linear && c < 3;
        float mean = 0.0f;
        for (int k = 0; k < side * side; ++k) {
          const int from = 4 * ((y * side + k / side) * whole.width + x * side + k % side) + c;
          const float value = float(whole.rgba[std::size_t(from)]) / 255.0f;
          mean += (is_srgb ? linear_from_srgb(value) : value) / float(side * side);
        }
        const double expected = 255.0 * double(is_srgb ? srgb_from_linear(mean) : mean);
        const double off = std::abs(expected - double(reduced.rgba[std::size_t(4 * (y * reduced.width + x) + c)]));
        max = std::max(max, off), sum += off;
      }
  return {max, sum / double(reduced.rgba.size())};
}

TEST(TextureImage, ReducesToMeansOfBlocks) {
  const int width = 96, height = 64;
  const Texture whole_jpeg = *decoded(jpeg(width, height)), whole_png = *decoded(png(width, height));
  ASSERT_EQ(whole_jpeg.rgba.size(), 4u * std::size_t(width * height));
  ASSERT_EQ(whole_png.rgba.size(), 4u * std::size_t(width * height));
  for (const int side : {2, 4, 8})
    for (const bool linear : {false, true}) {
      SCOPED_TRACE(std::to_string(side) + (linear ? " linear" : " colour"));
      const ImageUse use{.footprint = float(side) / float(height), .linear = linear};
      const Texture of_jpeg = *decoded(jpeg(width, height), use), of_png = *decoded(png(width, height), use);
      ASSERT_EQ(of_jpeg.width, width / side);
      ASSERT_EQ(of_jpeg.height, height / side);
      ASSERT_EQ(of_png.rgba.size(), of_jpeg.rgba.size());
      EXPECT_LE(differences(whole_png, of_png, linear)[0], 1.0);
      // Linear values of JPEG are averaged as coefficients, before they are rounded and clamped.
      const auto [max, mean] = differences(whole_jpeg, of_jpeg, linear);
      EXPECT_LE(max, linear ? 8.0 : 1.0);
      EXPECT_LE(mean, 1.0);
    }
}

TEST(TextureImage, ReducesOnlyByDivisorsThatAreNotWiderThanTheFootprint) {
  EXPECT_EQ(block_side(64, 64, 0.0f), 1);
  EXPECT_EQ(block_side(64, 64, 3.99f / 64.0f), 2);
  EXPECT_EQ(block_side(64, 32, 4.0f / 64.0f), 2) << "the shorter side has fewer texels in a footprint";
  EXPECT_EQ(block_side(64, 64, 1.0f), 8);
  EXPECT_EQ(block_side(62, 64, 1.0f), 2);
  EXPECT_EQ(block_side(63, 64, 1.0f), 1);
}

/// A triangle with maps of colour, normals and reflection in files named by `uris`.
GltfBuilder with_maps(const std::vector<std::string>& uris) {
  GltfBuilder b = GltfBuilder::triangle();
  Json& material = b.json["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  material["normalTexture"] = {{"index", 1}};
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 2}};
  for (std::size_t k = 0; k < uris.size(); ++k) {
    b.json["textures"].push_back({{"source", k}});
    b.json["images"].push_back({{"uri", uris[k]}});
  }
  return b;
}

TEST_F(GltfTest, DecodesTheSameTexturesWithAnyNumberOfThreads) {
  const GltfBuilder b = with_maps({"a.jpg", "b.jpg", "c.png"});
  write("a.jpg", jpeg(64, 64)), write("b.jpg", jpeg(32, 32)), write("c.png", png(48, 16));
  const auto read_with = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return read(b); });
  };
  const Scene one = read_with(1), four = read_with(4);
  EXPECT_TRUE(one.warnings.empty()) << warnings_of(one);
  ASSERT_EQ(one.textures.size(), 3u);
  ASSERT_EQ(four.textures.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(one.textures[k].name, four.textures[k].name);
    EXPECT_EQ(one.textures[k].rgba, four.textures[k].rgba);
  }
}

TEST_F(GltfTest, WarnsOnceOfABrokenImageAmongOthers) {
  const GltfBuilder b = with_maps({"a.jpg", "b.jpg", "c.png"});
  write("a.jpg", jpeg(64, 64)), write("b.jpg", jpeg(64, 64).substr(0, 40)), write("c.png", png(16, 16));
  const Scene scene = read(b);
  ASSERT_EQ(scene.warnings.size(), 1u) << warnings_of(scene);
  const std::string file = (folder / "b.jpg").string();
  EXPECT_TRUE(warns(scene, "'" + file + "' is not an image of a known format")) << warnings_of(scene);
  EXPECT_TRUE(warns(scene, "; it is left out"));
  EXPECT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.materials.at(0).normal_texture, kNoTexture);
}

TEST_F(GltfTest, ReducesTexturesToWhatAFittedPictureShows) {
  write("a.png", png(256, 256)), write("b.jpg", jpeg(256, 256)), write("c.png", png(64, 64));
  GltfBuilder b = with_maps({"a.png", "b.jpg", "c.png"});
  const auto widths = [&](int fitted_px) {
    std::vector<int> all;
    for (const Texture& texture : read(b, {.fitted_px = fitted_px}).textures) all.push_back(texture.width);
    std::sort(all.begin(), all.end());
    return all;
  };
  const std::vector<int> whole = {64, 256, 256};
  EXPECT_EQ(widths(0), whole);
  EXPECT_EQ(widths(512), whole);
  // The triangle, whose sides span the texture, is about 50 pixels wide: 5 and 1.3 texels per pixel.
  EXPECT_EQ(widths(64), (std::vector<int>{64, 128, 128}));
  // About 6 pixels wide: 64 texels are 7 per pixel with the margin, so blocks are of 4; 256 are 28, and blocks end
  // at 8.
  EXPECT_EQ(widths(8), (std::vector<int>{16, 32, 32}));
  b.json["materials"][0]["alphaMode"] = "MASK";
  EXPECT_EQ(widths(8), whole) << "thin parts of a mask would vanish";
}

}  // namespace
}  // namespace umbrage::test
