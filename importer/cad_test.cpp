// STEP and IGES, through umbrage-import-cad: places, names and colours of parts; triangles and normals against exact
// shapes; damaged files; a missing program. tests/cad has the files, which OpenCASCADE wrote.
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "importer/importer.h"
#include "run_program.h"
#include "scene/readers/content.h"
#include "scene/readers/import_in_child_process.h"

namespace umbrage::test {
namespace {

constexpr double kPi = 3.14159265358979;
constexpr double kRadius = 20.0, kHole = 8.0, kHeight = 30.0;  // of ring.step and ring.igs, mm

class Cad : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    if (import_program("step").empty()) GTEST_SKIP() << "umbrage-import-cad is not built";
  }
  static std::string file(const std::string& name) { return text_of(fs::path(kSourceFolder) / "tests/cad" / name); }
  Result<Scene> result(const std::string& name, const std::string& text, const ImportSettings& settings = {}) {
    write(name, text);
    return import_scene(folder_ / name, settings);
  }
  Scene read(const std::string& name, const std::string& text, const ImportSettings& settings = {}) {
    Result<Scene> scene = result(name, text, settings);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene();
  }
  void expect_error(const std::string& name, const std::string& text, const std::string& part) {
    const Result<Scene> scene = result(name, text);
    ASSERT_FALSE(scene) << name;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
    for (const std::string& each : {name, part})
      EXPECT_NE(scene.error().message.find(each), std::string::npos) << scene.error().message;
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t count = 0;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()), ++count)
    text.replace(at, from.size(), to);
  EXPECT_GT(count, 0u) << from;
  return text;
}

/// Returns the volume of an object, and checks that its surface is closed, with its outer side outwards: each edge
/// occurs once in both directions, where vertices at one position are one.
double closed_volume(const Scene& scene, int object) {
  const auto key = [](const glm::vec3& p) { return std::array{p.x, p.y, p.z}; };
  using Key = std::array<float, 3>;
  std::map<std::pair<Key, Key>, int> edges;
  double volume = 0.0;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.object != object) continue;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      std::array<glm::vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.positions[mesh.indices[i + k]];
      for (std::size_t k = 0; k < 3; ++k) ++edges[{key(p[k]), key(p[(k + 1) % 3])}];
      volume += glm::dot(glm::dvec3(p[0]), glm::cross(glm::dvec3(p[1]), glm::dvec3(p[2]))) / 6.0;
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  return volume;
}

TEST_F(Cad, ReadsPartsWithPlacesNamesAndColors) {
  const Scene scene = read("stack.step", file("stack.step"));
  EXPECT_EQ(scene.up, glm::vec3(0.0f, 0.0f, 1.0f));
  EXPECT_EQ(scene.bounds_max, glm::vec3(40.0f, 30.0f, 25.0f));
  EXPECT_TRUE(scene.warnings.empty());
  struct Part {
    std::string name;
    float x, z;  ///< its lowest corner
    double volume;
    std::map<std::array<int, 3>, std::size_t> triangles;  ///< by sRGB colour, in tenths
  };
  const std::array<int, 3> red{8, 2, 2}, green{2, 6, 2}, blue{2, 2, 8};
  const std::vector<Part> parts{{"base plate", 0, 0, 12000, {{red, 12}}},
                                {"left block", 0, 15, 1000, {{green, 10}, {blue, 2}}},
                                {"right block", 30, 15, 1000, {{green, 10}, {blue, 2}}}};
  for (int object = 0; object < int(parts.size()); ++object) {
    const Part& part = parts[std::size_t(object)];
    SCOPED_TRACE(part.name);
    EXPECT_NEAR(closed_volume(scene, object), part.volume, 1e-3);
    std::map<std::array<int, 3>, std::size_t> triangles;
    glm::vec3 low(1e9f);
    for (const Mesh& mesh : scene.meshes) {
      if (mesh.object != object) continue;
      EXPECT_EQ(mesh.name, part.name);
      for (const glm::vec3& p : mesh.positions) low = glm::min(low, p);
      std::array<int, 3> color;
      for (int k = 0; k < 3; ++k) {  // sRGB by the definition
        const double linear = scene.materials[std::size_t(mesh.material)].albedo[k];
        color[std::size_t(k)] = int(std::lround(10.0 * (1.055 * std::pow(linear, 1.0 / 2.4) - 0.055)));
      }
      triangles[color] += mesh.indices.size() / 3;
    }
    EXPECT_EQ(triangles, part.triangles);
    EXPECT_EQ(low, glm::vec3(part.x, 0.0f, part.z));
  }
  for (const Mesh& mesh : scene.meshes) EXPECT_LT(mesh.object, 3);
}

TEST_F(Cad, TrianglesAndNormalsFollowTheSurface) {
  for (const std::string name : {"ring.step", "ring.igs"})
    for (const int pixels : {256, 4096}) {
      SCOPED_TRACE(fmt::format("{} {}", name, pixels));
      const Scene scene = read(name, file(name), {.picture_px = pixels});
      const double diagonal = std::sqrt(2.0 * 4.0 * kRadius * kRadius + kHeight * kHeight);
      const double allowed = 0.25 * diagonal / pixels;  // a quarter of a pixel
      const double exact = kPi * (kRadius * kRadius - kHole * kHole) * kHeight;
      EXPECT_NEAR(closed_volume(scene, 0), exact, 2.0 * kPi * (kRadius + kHole) * kHeight * allowed);
      std::size_t round = 0;
      for (const Mesh& mesh : scene.meshes) {
        for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
          const std::size_t a = mesh.indices[i], b = mesh.indices[i - i % 3 + (i + 1) % 3];
          const glm::dvec3 p(mesh.positions[a]), q(mesh.positions[b]), n(mesh.normals[a]);
          if (std::abs(n.z) > 0.5) {  // the top and the bottom
            EXPECT_NEAR(n.z, p.z > 0.5 * kHeight ? 1.0 : -1.0, 1e-6);
            continue;
          }
          const double r = std::hypot(p.x, p.y), side = r < 0.5 * (kRadius + kHole) ? -1.0 : 1.0;
          EXPECT_NEAR(r, side < 0.0 ? kHole : kRadius, 1e-5);
          EXPECT_NEAR(glm::length(n - side * glm::dvec3(p.x, p.y, 0.0) / r), 0.0, 1e-6);
          const glm::dvec3 middle = 0.5 * (p + q);
          EXPECT_LT(r - std::hypot(middle.x, middle.y), 1.1 * allowed);
          ++round;
        }
      }
      EXPECT_GT(round, 100u);
    }
  const auto count = [&](int pixels) {
    return read("ring.step", file("ring.step"), {.picture_px = pixels}).triangle_count();
  };
  EXPECT_LT(2 * count(256), count(8192));
}

TEST_F(Cad, ConvertsUnitsToMillimetres) {
  const std::string text = replaced(file("ring.step"), "SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.CENTI.,.METRE.)");
  EXPECT_NEAR(read("ring.stp", text).bounds_max.z, 10.0 * kHeight, 1e-3);
  EXPECT_EQ(units_of("stp"), "mm");
  EXPECT_EQ(units_of("igs"), "mm");
}

TEST_F(Cad, FilesAreKnownByTheirContent) {
  EXPECT_EQ(format_of_content(file("ring.igs"), 0), "iges");
  EXPECT_EQ(format_of_content(file("ring.step"), 0), "step");
  const std::size_t triangles = read("ring.stp", file("ring.step")).triangle_count();
  EXPECT_EQ(read("ring.stl", file("ring.step")).triangle_count(), triangles);
  ASSERT_EQ(std::system(("gzip -k " + quoted((folder_ / "ring.stp").string())).c_str()), 0);
  const Result<Scene> packed = import_scene(folder_ / "ring.stp.gz");
  ASSERT_TRUE(packed) << packed.error().message;
  EXPECT_EQ(packed->triangle_count(), triangles);
}

TEST_F(Cad, DamagedFilesGiveOneSentence) {
  const std::string step = file("ring.step"), iges = file("ring.igs");
  expect_error("cut.step", step.substr(0, step.size() / 2), "cut short");
  expect_error("cut.igs", iges.substr(0, iges.size() / 2), "cut short");
  expect_error("head.step", replaced(step, "ISO-10303-21;", "SOMETHING;"), "ISO-10303-21");
  expect_error("text.igs", "Dear Sir,\n", "column 73");
  expect_error("none.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", "damaged");
  expect_error("shell.step", replaced(step, "#16 = CLOSED_SHELL('',(", "#16 = CLOSED_SHELL('',(#9999,((("),
               "no surfaces");
  const Scene scene =
      read("lost.step", replaced(file("stack.step"), "CLOSED_SHELL('',(#43", "CLOSED_SHELL('',(#99999"));
  ASSERT_FALSE(scene.warnings.empty());
  EXPECT_NE(scene.warnings[0].find("errors"), std::string::npos) << scene.warnings[0];
}

TEST_F(Cad, NoDamageEndsTheProgram) {
  std::mt19937 random(7);
  for (const std::string name : {"ring.step", "ring.igs", "stack.step"}) {
    const std::string text = file(name);
    for (int i = 0; i < 6; ++i) {
      std::string changed = text;
      for (int k = 0; k < 5 << i; ++k) changed[random() % changed.size()] = char('0' + random() % 64);
      const Result<Scene> scene = result(name, changed);
      if (!scene) {
        EXPECT_EQ(scene.error().kind, ErrorKind::kFile) << scene.error().message;
      }
    }
  }
}

TEST_F(Cad, MissingProgramIsNamed) {
  write("ring.step", file("ring.step"));
  bad("ring.step -o out.png", 3, {"'/nowhere/x' does not start"}, "UMBRAGE_IMPORT_CAD=/nowhere/x");
  fs::copy_file(kProgram, root_ / "umbrage");  // alone
  const fs::path message = root_ / "message";
  const std::string line =
      fmt::format("cd {} && PATH=/usr/bin:/bin {} ring.step -o out.png 2>{}", quoted(folder_.string()),
                  quoted((root_ / "umbrage").string()), quoted(message.string()));
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 3);
  EXPECT_EQ(text_of(message),
            "umbrage: 'ring.step' cannot be read: the program umbrage-import-cad is missing; install the package "
            "umbrage-import-cad, or set UMBRAGE_IMPORT_CAD to its path\n");
}

}  // namespace
}  // namespace umbrage::test
