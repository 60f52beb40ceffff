// Fields of values in files: which are read, and what belongs to which vertex, face or point.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "file_folder.h"
#include "scene/fields.h"
#include "scene/readers/field_columns.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

struct FileFields : test::FileFolder {
  Scene read(const std::string& name, const std::string& text, std::optional<std::string> field) const {
    ImportSettings settings;
    settings.field = std::move(field);
    const Result<Scene> scene = import_scene(write(name, text), settings);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene && !scene->meshes.empty() ? *scene : Scene{.meshes = std::vector<Mesh>(1)};
  }
  std::vector<std::string> names(const std::string& name, const std::string& text) const {
    std::vector<std::string> found;
    const Scene scene = read(name, text, "");
    for (const Field& field : scene.meshes[0].fields) found.push_back(field.name + std::to_string(field.components));
    return found;
  }
};

// Two squares beside each other, of which the second is a polygon of four corners, and a vertex without faces.
const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\nproperty float z\n"
    "property float pressure\nproperty float v_x\nproperty float v_y\nproperty float v_z\nproperty list uchar int "
    "near\n"
    "element face 3\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
    "5 5 5 99 0 0 0 0\n0 0 0 1 1 2 2 0\n1 0 0 2 0 0 1 1 7\n0 1 0 3 0 0 0 0\n1 1 0 nan 0 0 0 0\n2 0 0 5 0 0 0 0\n"
    "2 1 0 6 0 3 4 0\n3 1 2 3 10\n3 2 4 3 20\n4 2 5 6 4 30\n";

TEST_F(FileFields, OfPlyFollowTheirVerticesAndFaces) {
  EXPECT_EQ(names("a.ply", kPly), (std::vector<std::string>{"pressure1", "v3", "part1"}));
  const Scene scene = read("a.ply", kPly, "");
  EXPECT_TRUE(scene.warnings.empty() || scene.warnings[0] == "not drawn: 'near'") << scene.warnings[0];
  const Mesh& mesh = scene.meshes[0];
  const Field &pressure = mesh.fields[0], &v = mesh.fields[1], &part = mesh.fields[2];
  ASSERT_EQ(mesh.indices.size(), 12u);
  ASSERT_EQ(pressure.values.size(), mesh.positions.size());
  ASSERT_EQ(v.values.size(), 3 * mesh.positions.size());
  EXPECT_FALSE(part.on_triangles) << "values of triangles are values of positions after finish_scene";
  for (std::size_t corner = 0; corner < 12; ++corner) {
    const std::uint32_t at = mesh.indices[corner];
    const glm::vec3 p = mesh.positions[at];
    EXPECT_EQ(part.values[at], corner < 3 ? 10.0f : corner < 6 ? 20.0f : 30.0f);
    if (p == glm::vec3(1, 1, 0))
      EXPECT_TRUE(std::isnan(pressure.values[at]));
    else
      EXPECT_EQ(pressure.values[at], 1.0f + p.x + 2.0f * p.y - (p.x == 2.0f ? (p.y == 1.0f ? -1.0f : -2.0f) : 0.0f));
    if (p == glm::vec3(0, 0, 0)) {
      EXPECT_EQ(v.values[3 * at + 1], 2.0f);
    }
    if (p == glm::vec3(2, 1, 0)) {
      EXPECT_EQ(v.values[3 * at + 1], 3.0f);
    }
  }
}

TEST_F(FileFields, AreReadOnlyIfTheyAreAskedFor) {
  EXPECT_TRUE(read("a.ply", kPly, std::nullopt).meshes[0].fields.empty());
  const Scene one = read("a.ply", kPly, "part");
  ASSERT_EQ(one.meshes[0].fields.size(), 1u);
  EXPECT_EQ(one.meshes[0].fields[0].name, "part");
  for (const char* name : {"v", "v_y", "z"}) {
    const Scene other = read("a.ply", kPly, name);
    ASSERT_EQ(other.meshes[0].fields.size(), 1u) << name;
    EXPECT_EQ(other.meshes[0].fields[0].components, name == std::string("v") ? 3 : 1) << name;
  }
  for (const char* name : {"near", "vertex_indices", "q"})
    EXPECT_TRUE(read("a.ply", kPly, name).meshes[0].fields.empty()) << name;
  const std::vector<std::string> warnings = read("a.ply", kPly, std::nullopt).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "not drawn: 'pressure', 'v_x', 'v_y', 'v_z', 'near'");
}

TEST_F(FileFields, OfFacesStayWithTheTexturesOfCorners) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "p\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty float q\nend_header\n"
      "0 0 0 1\n1 0 0 2\n0 1 0 3\n1 1 0 4\n3 0 1 2 255 0 0 10\n3 1 3 2 0 255 0 20\n";
  const Mesh mesh = read("a.ply", ply, "").meshes[0];
  ASSERT_EQ(mesh.fields.size(), 2u);
  ASSERT_EQ(mesh.fields[0].values.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_EQ(mesh.fields[0].values[v], 1.0f + mesh.positions[v].x + 2.0f * mesh.positions[v].y);
    EXPECT_EQ(mesh.fields[1].values[v], mesh.colors[v].r > 0.5f ? 10.0f : 20.0f);
  }
}

TEST_F(FileFields, OfPointsFollowTheirPlaces) {
  std::string named = "x y z Heat nx ny nz\n", plain;
  for (int k = 0; k < 12; ++k) {
    named += fmt::format("{} {} 0 {} 0 0 1\n", (7 * k) % 12, k % 3, 100 + (7 * k) % 12);
    plain += fmt::format("{} {} 0 {} -1.5\n", (7 * k) % 12, k % 3, 100 + (7 * k) % 12);
  }
  EXPECT_EQ(names("a.xyz", named), (std::vector<std::string>{"heat1"}));
  EXPECT_EQ(names("b.xyz", plain), (std::vector<std::string>{"column 41", "column 51"}));
  for (const Scene& scene : {read("a.xyz", named, "heat"), read("b.xyz", plain, "column 4")}) {
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.fields.size(), 1u);
    ASSERT_EQ(mesh.fields[0].values.size(), 12u);
    for (std::size_t k = 0; k < 12; ++k)
      EXPECT_EQ(mesh.fields[0].values[k], 100.0f + std::round(mesh.positions[k].x + float(scene.origin.x)));
  }
}

TEST_F(FileFields, OfPointsInPlyReplaceTheGreysOfAnIntensity) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "property float intensity\nend_header\n";
  for (int k = 0; k < 5; ++k) ply += fmt::format("{} {} 0 {}\n", k, k % 2, 10 * k);
  EXPECT_FALSE(read("a.ply", ply, std::nullopt).meshes[0].colors.empty());
  const Scene scene = read("a.ply", ply, "intensity");
  EXPECT_TRUE(scene.meshes[0].colors.empty());
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(scene.meshes[0].fields.at(0).values[k], 10.0f * scene.meshes[0].positions[k].x);
}

TEST_F(FileFields, OfAtomsAreThoseOfPdb) {
  const auto atom = [](int number, char chain, int residue, float x, float occupancy, float b, const char* element,
                       const char* charge) {
    return fmt::format("ATOM  {:5d} {:>3}  ALA {}{:4d}    {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}          {:>2}{:2}\n",
                       number, element, chain, residue, x, 0.0f, 0.0f, occupancy, b, element, charge);
  };
  const std::string pdb = atom(1, 'A', 3, 0.0f, 1.0f, 20.5f, "C", "  ") +
                          atom(2, 'A', 4, 5.0f, 0.5f, 30.25f, "O", "1-") +
                          atom(3, 'B', 1, 9.0f, 1.0f, 12.0f, "N", "  ") + "END\n";
  const std::pair<const char*, std::vector<float>> kFields[] = {{"b_factor", {20.5f, 30.25f, 12}},
                                                                {"occupancy", {1, 0.5f, 1}},
                                                                {"charge", {0, -1, 0}},
                                                                {"chain", {1, 1, 2}},
                                                                {"residue", {3, 4, 1}},
                                                                {"element", {6, 8, 7}}};
  EXPECT_EQ(read("a.pdb", pdb, "").meshes[0].fields.size(), std::size(kFields));
  for (const auto& [name, values] : kFields) {
    const Scene scene = read("a.pdb", pdb, name);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.fields.size(), 1u) << name;
    for (std::size_t k = 0; k < 3; ++k) {
      const float x = mesh.positions[k].x + float(scene.origin.x);
      EXPECT_EQ(mesh.fields[0].values[k], values[x < 1.0f ? 0 : x < 6.0f ? 1 : 2]) << name;
    }
  }
}

TEST_F(FileFields, NamesOfPlyKeepTheirCase) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float X\nproperty float Y\nproperty float Z\n"
      "property float T\nproperty float P\nproperty float p\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 1 4 7\n1 0 0 2 5 8\n0 1 0 3 6 9\n3 0 1 2\n";
  EXPECT_EQ(names("case.ply", ply), (std::vector<std::string>{"T1", "P1", "p1"}));
  const Scene scene = read("case.ply", ply, "P");
  EXPECT_EQ(scene.meshes[0].fields.at(0).values, (std::vector<float>{4, 5, 6}));
}

TEST(FieldColumns, JoinVectorsByTheEndingsOfTheirNames) {
  std::vector<FileColumn> columns;
  for (const char* name : {"x", "y", "z", "u.x", "u.y", "u.z", "w_0", "w_1", "w_2", "vx", "vy", "vz", "", "max", "a_x"})
    columns.push_back({name});
  columns[0].is_value = columns[1].is_value = columns[2].is_value = false;
  std::vector<std::string> names;
  for (const FieldColumns& each : field_columns(columns, ""))
    names.push_back(fmt::format("{}{}", each.field.name, each.columns.size()));
  EXPECT_EQ(names, (std::vector<std::string>{"u3", "w3", "v3", "max1", "a_x1"}));
  EXPECT_EQ(field_columns(columns, "w").at(0).columns, (std::vector<std::size_t>{6, 7, 8}));
  EXPECT_EQ(field_columns(columns, "w_2").at(0).columns, (std::vector<std::size_t>{8}));
  EXPECT_TRUE(field_columns(columns, "b").empty());
  EXPECT_TRUE(field_columns(columns, std::nullopt).empty());
}

}  // namespace
}  // namespace umbrage
