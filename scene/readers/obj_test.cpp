// OBJ files as programs write them: line ends, indices, groups, smoothing, damaged faces, libraries.
#include "scene/readers/obj.h"

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <glm/geometric.hpp>

#include "file_folder.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSquare = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";

struct Obj : test::FileFolder {
  Scene read(const std::string& text, const std::string& name = "a.obj") const {
    Result<Scene> scene = import_scene(write(name, text));
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }
  /// Returns the scene before finish_scene.
  Scene raw(const std::string& text, bool threads = false) const {
    const auto file = open_obj(write("raw.obj", text));
    EXPECT_TRUE(file);
    Result<ObjScene> obj = read_obj(*file, threads);
    EXPECT_TRUE(obj) << (obj ? "" : obj.error().message);
    return obj ? obj->scene : Scene{};
  }
  void expect_error(const std::string& text, const std::string& reason) const {
    const Result<Scene> scene = import_scene(write("bad.obj", text));
    ASSERT_FALSE(scene) << text;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
    EXPECT_NE(scene.error().message.find(reason), std::string::npos) << scene.error().message;
  }
  /// Expects one warning that contains these words.
  static void expect_warning(const Scene& scene, const std::vector<std::string>& words) {
    ASSERT_EQ(scene.warnings.size(), 1u) << fmt::format("'{}'", fmt::join(scene.warnings, "', '"));
    for (const std::string& word : words)
      EXPECT_NE(scene.warnings[0].find(word), std::string::npos) << scene.warnings[0];
  }
};

double area_of(const Scene& scene) {
  double area = 0.0;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::vec3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                      &c = mesh.positions[mesh.indices[i + 2]];
      area += 0.5 * double(glm::length(glm::cross(b - a, c - a)));
    }
  return area;
}

TEST_F(Obj, ReadsLinesOfAnyKind) {
  write("red.mtl", "\xef\xbb\xbfnewmtl red\r\nKd 1 0 0\r\n");
  const std::string plain = std::string("mtllib red.mtl\nusemtl red\n") + kSquare + "f 1 2 3 4\n";
  const auto with_ends = [&](const std::string& end) {
    std::string text;
    for (const char c : plain) text += c == '\n' ? end : std::string(1, c);
    return text;
  };
  for (const std::string& text :
       {plain, with_ends("\r\n"), with_ends("\r"), "\xef\xbb\xbf" + plain, plain.substr(0, plain.size() - 1),
        "# saved to C:\\models\\\n" + plain, "  " + plain,
        std::string("mtllib red.mtl\nusemtl red\nv 0 0 \\\n 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2\\\r\n 3 \\\n4\n"),
        std::string(
            "mtllib red.mtl\nusemtl red\nv\t0\t0\t0\nv 2. 0. +0\nv 2e0 .2e1 -0\nv 0 20E-1 0 1.0\nf 1 2 3 4\n")}) {
    SCOPED_TRACE(text);
    const Scene scene = read(text);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_EQ(scene.triangle_count(), 2u);
    EXPECT_NEAR(area_of(scene), 4.0, 1e-6);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].albedo, glm::vec3(1, 0, 0));
  }
  expect_error("\xff\xfev\0 \0", "UTF-16");
}

TEST_F(Obj, SplitsConcavePolygons) {
  const Scene scene = read(
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8\n"
      "v 0 0 5\nv 2 1 5\nv 0 2 5\nv 1 1 5\nf -4 -3 -2 -1\n");
  EXPECT_EQ(scene.triangle_count(), 8u);
  EXPECT_NEAR(area_of(scene), 7.0 + 1.0, 1e-5);
}

TEST_F(Obj, KeepsSmoothingGroups) {
  const std::string faces = "f 1 2 3\ns 7\nf 2 3 4\nf 1 3 4\ns off\nf 1 2 4\ns 1\nf 1 2 3 4\n";
  const Scene scene = raw(std::string(kSquare) + "vn 0 0 1\n" + faces);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].smoothing, (std::vector<std::uint32_t>{0, 7, 7, 0, 1, 1}));
  EXPECT_TRUE(raw(std::string(kSquare) + "f 1 2 3\n").meshes.at(0).smoothing.empty()) << "no statement s";
  const Scene with_normals = raw(std::string(kSquare) + "vn 0 0 1\ns 1\nf 1//1 2//1 3//1\n");
  EXPECT_TRUE(with_normals.meshes.at(0).smoothing.empty()) << "the file has normals";
}

TEST_F(Obj, CountsIndicesFromEitherEndInAnyBlock) {
  // More than one block of text.
  std::string absolute, relative;
  constexpr int kQuads = 20000;
  for (int i = 0; i < kQuads; ++i) {
    const std::string vertices =
        fmt::format("v {} 0 0\nv {} 0 0\nv {} 1 0\nv {} 1 0\nvt 0 {}\nvn 0 0 1\n", i, i + 1, i + 1, i, i);
    const int v = 4 * i;
    absolute += vertices + fmt::format("f {}/{}/{} {}/{}/{} {}/{}/{} {}/{}/{}\n", v + 1, i + 1, i + 1, v + 2, i + 1,
                                       i + 1, v + 3, i + 1, i + 1, v + 4, i + 1, i + 1);
    relative += vertices + "f -4/-1/-1 -3/-1/-1 -2/-1/-1 -1/-1/-1\n";
  }
  absolute += "f 1//1 2//1 3//1\n";
  relative += fmt::format("f -{}//1 2//-{} 3//1\n", 4 * kQuads, kQuads);
  const Scene a = raw(absolute), b = raw(relative), c = raw(relative, true);
  ASSERT_EQ(a.meshes.size(), 2u) << "with and without texture coordinates";
  for (const Scene& other : {b, c})
    for (std::size_t m = 0; m < 2; ++m) {
      EXPECT_EQ(a.meshes[m].indices, other.meshes.at(m).indices);
      EXPECT_EQ(a.meshes[m].positions, other.meshes[m].positions);
      EXPECT_EQ(a.meshes[m].uvs, other.meshes[m].uvs);
    }
  EXPECT_EQ(a.triangle_count(), 2u * kQuads + 1);
  EXPECT_NEAR(area_of(a), kQuads + 0.5, 1e-3);
}

TEST_F(Obj, LeavesOutDamagedFaces) {
  const std::string good = std::string(kSquare) + "f 1 2 3\nf 1 3 4\n";
  EXPECT_TRUE(read(good).warnings.empty());
  for (const char* bad :
       {"f 1 2 9999", "f 1 0 3", "f 1 2 -7", "f 1 2 x", "f 1 2", "f", "f 1 2 99999999999999999999", "f 1.5 2 3"}) {
    SCOPED_TRACE(bad);
    const Scene scene = read(good + bad + "\nf 1 2 77\n");
    EXPECT_EQ(scene.triangle_count(), 2u);
    expect_warning(scene, {"2 of 4 faces", "line 7"});
  }
  for (const char* bad : {"v nan 0 0", "v 1 inf 0", "v 1 zwei 3", "v 1 2", "v", "v 1e999 0 0", "v 1,5 0 0"}) {
    SCOPED_TRACE(bad);
    const Scene scene = read(good + bad + "\nf 1 2 5\n");
    EXPECT_EQ(scene.triangle_count(), 2u);
    expect_warning(scene, {"1 of 3 faces", "line 8", "line 7 is not a vertex"});
  }
  expect_error(std::string(kSquare) + "f 1 2 9\nf 5 6 7\n", "all 2 faces");
  expect_error("o thing\n# nothing else\n", "no vertices");
  expect_error(std::string(kSquare) + "l 1 2 3\n", "no triangles");
  // Indices of texture coordinates and normals that do not exist.
  expect_warning(read(good + "f 1/5 2/5 3/5\n"), {"1 of 3 faces", "texture"});
  EXPECT_TRUE(read(good + "f 1//5 2//5 3//5\nf 1/0/0 2/0/0 3/0/0\n").warnings.empty()) << "normals are created";
}

TEST_F(Obj, NamesWhatItDoesNotDraw) {
  const std::string good = std::string(kSquare) + "f 1 2 3\n";
  expect_warning(read(good + "l 1 2\nl 2 3\n"), {"lines", "line 6"});
  expect_warning(read(good + "p 1\n"), {"points", "line 6"});
  expect_warning(read(good + "cstype bezier\ndeg 3\ncurv 0 1 1 2 3\nend\n"), {"free-form", "line 8"});
  expect_warning(read(good + "call other.obj\nlod 3\n"), {"'call'"});
}

TEST_F(Obj, ReadsPoints) {
  const Scene scene = read("v 0 0 0 1 0 0\rv 1 0 0 1 0 0\rv 0 1 0 1 0 0\rvn 0 0 1\rvn 0 0 1\rvn 0 0 1\rp 1 2 3\r");
  EXPECT_EQ(scene.point_count(), 3u);
  EXPECT_EQ(scene.meshes.at(0).colors.at(1), glm::vec3(1, 0, 0));
  EXPECT_TRUE(scene.warnings.empty());
  expect_warning(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 nan 1\n"), {"1 of 4 points", "line 4"});
}

TEST_F(Obj, SubtractsAFarOrigin) {
  const auto text = [](double x, double y) {
    return fmt::format("v {} {} 0\nv {} {} 0\nv {} {} 0.125\nf 1 2 3\nv 0 0 0\n", x, y, x + 0.25, y, x, y + 0.125);
  };
  const Scene near = raw(text(0.0, 0.0)), far = raw(text(500000.0, 4649776.0));
  EXPECT_EQ(near.origin, glm::dvec3(0.0));
  EXPECT_NEAR(glm::length(far.origin - glm::dvec3(500000.0, 4649776.0, 0.0)), 0.0, 1.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 there =
        glm::dvec3(far.meshes.at(0).positions.at(i)) + far.origin - glm::dvec3(500000.0, 4649776.0, 0.0);
    EXPECT_LT(glm::length(there - glm::dvec3(near.meshes.at(0).positions.at(i))), 1e-7) << i;
  }
  EXPECT_EQ(raw(text(500000.0, 4649776.0) + "f 1 1 2\nf 1 1 4\n").origin, far.origin) << "a corner far from the rest";
}

TEST_F(Obj, SeparatesObjectsMaterialsAndVertexData) {
  write("m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nnewmtl unused\nKd 0 0 1\n");
  const Scene scene =
      raw(std::string("mtllib m.mtl\n") + kSquare +
          "vn 0 0 1\nvt 0 0\no one\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\no two\nf 2 3 4\no one\nusemtl a\nf 1 2 4\n"
          "f 1//1 2//1 3//1\ng part\nf 1/1 2/1 3/1\n");
  ASSERT_EQ(scene.meshes.size(), 5u);
  EXPECT_EQ(scene.materials.size(), 2u) << "only materials that faces use";
  EXPECT_EQ(scene.meshes[0].indices.size(), 6u) << "faces of `one` with `a`, from two places";
  EXPECT_EQ(scene.meshes[0].object, scene.meshes[1].object) << "with and without normals";
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_EQ(scene.meshes[1].normals.size(), 3u);
  EXPECT_EQ(scene.meshes[2].object, scene.meshes[0].object);
  EXPECT_NE(scene.meshes[2].material, scene.meshes[0].material);
  EXPECT_NE(scene.meshes[3].object, scene.meshes[0].object);
  EXPECT_EQ(scene.meshes[4].uvs.size(), 3u);
  EXPECT_NE(scene.meshes[4].object, scene.meshes[0].object);
}

TEST_F(Obj, FindsLibraries) {
  fs::create_directories(folder / "My Parts");
  write("one.mtl", "newmtl a\nKd 1 0 0\n");
  write("two b.mtl", "newmtl b\nKd 0 1 0\n");
  write("My Parts/Three.MTL", "newmtl c\nKd 0 0 1\n");
  const std::string faces = std::string(kSquare) + "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 2 3 4\n";
  for (const char* lines : {"mtllib one.mtl two b.mtl My Parts/Three.MTL\n",
                            "mtllib one.mtl\nmtllib two b.mtl\nmtllib my parts\\three.mtl\n",
                            "mtllib \"two b.mtl\" C:\\art\\one.mtl \"My Parts/Three.MTL\"\n"}) {
    SCOPED_TRACE(lines);
    const Scene scene = read(lines + faces);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    ASSERT_EQ(scene.materials.size(), 3u);
    for (int m = 0; m < 3; ++m) EXPECT_EQ(scene.materials[std::size_t(m)].albedo[m], 1.0f);
  }
  expect_warning(read("mtllib one.mtl no such.mtl two b.mtl\n" + faces), {"'no such.mtl' does not exist"});
  expect_warning(read("mtllib one.mtl\n" + faces), {"'b' and 'c'", "does not define them"});
  expect_warning(read("mtllib one.mtl\n" + std::string(kSquare) + "usemtl B\nf 1 2 3\nusemtl A\nf 1 3 4\n"),
                 {"'B' and 'A'", "does not define them (it defines 'a')"});
  expect_warning(read(std::string(kSquare) + "usemtl x\nf 1 2 3\n"), {"'x'", "no material library"});
}

TEST_F(Obj, LooksForLibrariesInLimitedTime) {
  for (int i = 0; i < 300; ++i) write(fmt::format("{}.txt", i), "");
  write("a.mtl", "newmtl a\nKd 1 0 0\n");
  std::string line = "mtllib a.mtl";
  for (int i = 0; i < 400; ++i) line += fmt::format(" x/{}.mtl", i);
  const auto started = std::chrono::steady_clock::now();
  const Scene scene = raw(line + "\n" + kSquare + "usemtl a\nf 1 2 3\n");
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(5));
  EXPECT_EQ(scene.materials.at(0).albedo, glm::vec3(1, 0, 0));
}

TEST_F(Obj, ShowsSomethingOfInvisibleMaterials) {
  write("t.mtl", "newmtl a\nd 0\nnewmtl b\nKd 1 1 1\nnewmtl c\nTr 1\n");
  const std::string start = std::string("mtllib t.mtl\n") + kSquare + "usemtl a\nf 1 2 3\n";
  const Scene one = read(start + "usemtl b\nf 1 3 4\n"), all = read(start), other = read(start + "usemtl c\nf 1 3 4\n");
  expect_warning(one, {"'a' is fully transparent and not seen"});
  EXPECT_EQ(one.materials[0].opacity, 0.0f);
  expect_warning(all, {"'a' would be fully transparent and is drawn opaque"});
  EXPECT_FALSE(all.materials[0].blended);
  EXPECT_EQ(other.warnings.size(), 2u);
  EXPECT_FALSE(other.materials[1].blended);
}

TEST_F(Obj, TakesLimitedTimeForAnyText) {
  std::string many_normals = kSquare, continued = kSquare, polygon = kSquare;
  for (int i = 1; i <= 60000; ++i) {
    many_normals += fmt::format("vn 0 {} 1\nf 1//{} 2//{} 3//{}\n", i, i, i, i);
    continued += "\\\n";
  }
  polygon += "f";
  for (int i = 0; i < 100000; ++i) polygon += fmt::format(" {}", 1 + i % 4);
  std::string names = kSquare, long_name = kSquare + ("o " + std::string(1000000, 'n') + "\n"), library;
  for (int i = 0; i < 60000; ++i) {
    library += fmt::format("newmtl m{}\n", i);
    names += fmt::format("usemtl m{}\nf 1 2 3\n", 59999 - i);
    long_name += fmt::format("g {}\nf 1 2 3\n", i % 7);
  }
  write("many.mtl", library);
  for (const std::string& text :
       {many_normals, continued + "\nf 1 2 3\n", polygon + "\n", "mtllib many.mtl\n" + names, long_name}) {
    const auto started = std::chrono::steady_clock::now();
    const Scene scene = raw(text);
    EXPECT_GT(scene.triangle_count(), 0u);
    EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(10));
  }
}

}  // namespace
}  // namespace umbrage
