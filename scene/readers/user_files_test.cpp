// Files as users have them, of the formats with readers of their own: what other programs write beyond the basics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "core/printable.h"
#include "file_folder.h"
#include "scene/readers/import.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

struct UserFiles : test::FileFolder {
  Scene read(const std::string& name, const std::string& text, const ImportSettings& settings = {}) const {
    Result<Scene> scene = import_scene(write(name, text), settings);
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene && !scene->meshes.empty() ? *scene : Scene{.meshes = std::vector<Mesh>(1)};
  }

  std::string error_of(const std::string& name, const std::string& text) const {
    const Result<Scene> scene = import_scene(write(name, text));
    EXPECT_FALSE(scene);
    return scene ? "" : scene.error().message;
  }
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

template <class... T>
std::string bytes_of(T... values) {
  std::string bytes;
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  (add(values), ...);
  return bytes;
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string ply(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

/// Returns the area of a mesh's triangles.
float area_of(const Mesh& mesh) {
  float area = 0.0f;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                    &c = mesh.positions[mesh.indices[i + 2]];
    area += 0.5f * glm::length(glm::cross(b - a, c - a));
  }
  return area;
}

// An L of area 3 whose first corner does not see all others.
const std::string kL = "0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n";
const std::string kLFace = "6 2 3 4 5 0 1";

TEST_F(UserFiles, ConcavePolygonsHaveTheirShape) {
  const Scene scene =
      read("l.ply", ply("element vertex 6\n" + kXyz + "element face 1\nproperty list uchar int vertex_indices\n",
                        kL + kLFace + "\n"));
  EXPECT_FLOAT_EQ(area_of(scene.meshes[0]), 3.0f);
  EXPECT_FLOAT_EQ(area_of(read("l.off", "OFF\n6 1 0\n" + kL + kLFace + "\n").meshes[0]), 3.0f);
}

TEST_F(UserFiles, FacesOfPlyHaveTextureCoordinatesAndColors) {
  const std::string vertices = "element vertex 4\n" + kXyz;
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const Scene textured = read("t.ply", ply("comment TextureFile none.png\n" + vertices +
                                               "element face 2\nproperty list uchar int vertex_indices\n"
                                               "property list uchar float texcoord\n",
                                           points + "3 0 1 2 6 0 0 .5 0 .5 1\n3 0 2 3 6 .5 0 1 1 0 1\n"));
  const Mesh& mesh = textured.meshes[0];
  ASSERT_EQ(mesh.uvs.size(), 6u) << "no corner of the two triangles has an equal texture coordinate";
  EXPECT_EQ(mesh.uvs[mesh.indices[1]], glm::vec2(0.5f, 0.0f));
  EXPECT_EQ(mesh.uvs[mesh.indices[3]], glm::vec2(0.5f, 0.0f));
  EXPECT_EQ(mesh.positions[mesh.indices[3]], glm::vec3(0.0f));

  const Scene colored = read("c.ply", ply(vertices + "element face 2\nproperty list uchar int vertex_indices\n"
                                                     "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                                          points + "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n"));
  const Mesh& faces = colored.meshes[0];
  ASSERT_EQ(faces.colors.size(), faces.positions.size());
  EXPECT_EQ(faces.colors[faces.indices[0]], glm::vec3(1, 0, 0));
  EXPECT_EQ(faces.colors[faces.indices[3]], glm::vec3(0, 0, 1));
  EXPECT_EQ(colored.materials[0].albedo, glm::vec3(1.0f));

  const Scene off = read("c.off", "OFF\n4 2 0\n" + points + "3 0 1 2 255 0 0 # red\n3 0 2 3 0 0 255 255\n");
  ASSERT_EQ(off.meshes[0].colors.size(), off.meshes[0].positions.size());
  EXPECT_EQ(off.meshes[0].colors[off.meshes[0].indices[3]], glm::vec3(0, 0, 1));
}

TEST_F(UserFiles, PlyHasSeveralTextures) {
  const Scene scene =
      read("t.ply", ply("comment TextureFile a.png\ncomment TextureFile b.png\nelement vertex 3\n" + kXyz +
                            "element face 3\nproperty list uchar int vertex_indices\n"
                            "property list uchar float texcoord\nproperty int texnumber\n",
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1 1\n3 0 2 1 6 0 0 1 0 0 1 0\n"
                        "3 1 0 2 0 -1\n"));
  ASSERT_EQ(scene.meshes.size(), 3u);
  EXPECT_EQ(scene.meshes[0].material, 1);
  EXPECT_EQ(scene.meshes[1].material, 0);
  EXPECT_EQ(scene.meshes[2].material, 2) << "the material without a texture";
  ASSERT_EQ(scene.warnings.size(), 2u) << "both textures are missing";
}

TEST_F(UserFiles, PlyHasATextureAfterALongHeader) {
  std::string comments;
  for (int i = 0; i < 3000; ++i) comments += "comment of the program that wrote the file\n";
  const Scene scene = read("a.ply", "ply\nformat ascii 1.0\n" + comments + "comment TextureFile gone.png\n" +
                                        "element vertex 1\n" + kXyz + "end_header\n0 0 0\n");
  EXPECT_TRUE(std::any_of(scene.warnings.begin(), scene.warnings.end(),
                          [](const std::string& warning) { return contains(warning, "'gone.png' does not exist"); }));
}

TEST_F(UserFiles, FarFromTheOriginKeepTheirPrecision) {
  const glm::dvec3 far(512345.0, 4212345.0, 101.0);
  const auto at = [&](double x, double y, double z) {
    return fmt::format("{:.6f} {:.6f} {:.6f}\n", far.x + x, far.y + y, far.z + z);
  };
  const std::string rows = at(0, 0, 0) + at(0.001, 0, 0) + at(0, 0.002, 0);
  std::string doubles = "element vertex 3\n" + kXyz;
  for (std::size_t at = doubles.find("float"); at != std::string::npos; at = doubles.find("float"))
    doubles.replace(at, 5, "double");
  const Scene scenes[] = {
      read("f.ply", ply(doubles + "element face 1\nproperty list uchar int vertex_indices\n", rows + "3 0 1 2\n")),
      read("f.off", "OFF\n3 1 0\n" + rows + "3 0 1 2\n"), read("f.xyz", rows),
      read("f.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex " + at(0, 0, 0) + "vertex " + at(0.001, 0, 0) +
                        "vertex " + at(0, 0.002, 0) + "endloop\nendfacet\nendsolid\n")};
  for (const Scene& scene : scenes) {
    const std::vector<glm::vec3>& p = scene.meshes[0].positions;
    ASSERT_EQ(p.size(), 3u) << scene.name;
    float longest = 0.0f;
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, glm::distance(p[std::size_t(i)], p[std::size_t((i + 1) % 3)]));
    EXPECT_NEAR(longest, std::sqrt(5e-6), 2e-6) << scene.name;
    EXPECT_LT(glm::length(scene.origin - far), 1.0) << scene.name;
  }
}

TEST_F(UserFiles, GaussianSplatsAreDiscsAndSpheres) {
  std::string elements = "element vertex 3\n" + kXyz;
  for (const char* name :
       {"f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    elements += "property float " + std::string(name) + "\n";
  // The first is flat along z, turned by 90 degrees about x; the second is round; the third is transparent.
  const Scene scene = read("s.ply", ply(elements,
                                        "0 0 0 1.77245 -1.77245 0 9 -2 -2 -9 1 1 0 0\n"
                                        "1 0 0 0 0 0 9 -2 -2 -2 1 0 0 0\n0 1 0 0 0 0 -5 -2 -2 -2 1 0 0 0\n"));
  ASSERT_EQ(scene.meshes.size(), 2u);
  const Mesh &discs = scene.meshes[0], &spheres = scene.meshes[1];
  EXPECT_FALSE(discs.spheres);
  ASSERT_EQ(discs.normals.size(), 1u);
  EXPECT_NEAR(std::abs(discs.normals[0].y), 1.0f, 1e-6f);
  EXPECT_NEAR(discs.radii.at(0), 1.5f * std::exp(-2.0f), 1e-6f);
  EXPECT_NEAR(discs.colors.at(0).x, 1.0f, 1e-4f);
  EXPECT_NEAR(discs.colors.at(0).y, 0.0f, 1e-4f);
  EXPECT_TRUE(spheres.spheres);
  ASSERT_EQ(spheres.radii.size(), 1u);
  EXPECT_NEAR(spheres.radii[0], 1.5f * std::exp(-2.0f), 1e-6f);
  EXPECT_EQ(spheres.colors.at(0), linear_color(glm::vec3(0.5f)));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(contains(scene.warnings[0], "without 1 of low opacity")) << scene.warnings[0];
}

TEST_F(UserFiles, ScalarsColorPointsWithoutColors) {
  const std::string elements = "element vertex 3\n" + kXyz + "property float intensity\n";
  const std::string rows = "0 0 0 5\n1 0 0 6\n0 1 0 9\n";
  const Scene points = read("i.ply", ply(elements, rows));
  ASSERT_EQ(points.meshes[0].colors.size(), 3u);
  EXPECT_TRUE(std::any_of(points.warnings.begin(), points.warnings.end(),
                          [](const std::string& w) { return contains(w, "'intensity', 5 to 9"); }));
  const Scene mesh =
      read("m.ply", ply(elements + "element face 1\nproperty list uchar int vertex_indices\n", rows + "3 0 1 2\n"));
  EXPECT_TRUE(mesh.meshes[0].colors.empty()) << "surfaces of scans keep one colour";
  const Scene floats =
      read("f.ply", ply("element vertex 2\n" + kXyz + "property float red\nproperty float green\nproperty float blue\n",
                        "0 0 0 255 0 0\n1 0 0 0 51 0\n"));
  const std::vector<glm::vec3>& colors = floats.meshes[0].colors;
  EXPECT_EQ(glm::max(colors.at(0), colors.at(1)), glm::vec3(1.0f, linear_color(glm::vec3(0.2f)).x, 0.0f));
}

TEST_F(UserFiles, AFewBadRowsAreLeftOut) {
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += i == 7 ? "1 n/a 0\n" : i == 9 ? "2 2\n" : fmt::format("{} {} 0\n", i % 5, i / 5);
  const Scene text = read("a.ply", ply("element vertex 20\n" + kXyz, rows));
  EXPECT_EQ(text.point_count(), 18u);
  ASSERT_EQ(text.warnings.size(), 1u);
  EXPECT_EQ(text.warnings[0], "2 of 20 entries of 'vertex' lack a number and are left out, first in line 15");
  const Scene xyz = read("a.xyz", rows);
  EXPECT_EQ(xyz.point_count(), 18u);
  ASSERT_EQ(xyz.warnings.size(), 1u);
  EXPECT_EQ(xyz.warnings[0], "2 of 20 lines have fewer than three numbers and are left out, first line 8");
  EXPECT_TRUE(contains(error_of("b.ply", ply("element vertex 2\n" + kXyz, "0 0 0\n0 x 0\n")), "line 9"));
  EXPECT_TRUE(contains(error_of("c.ply", ply("element vertex 2\n" + kXyz, "0 0 0\n0 1")), "cut short"));
}

TEST_F(UserFiles, WrongCountsInPlyEndWithTheirRow) {
  const std::string elements = "element vertex 3\n" + kXyz + "element face 5\nproperty list uchar int vertex_indices\n",
                    face = "3 0 1 2\n";
  const Scene scene =
      read("count.ply", ply(elements, "0 0 0\n1 0 0\n0 1 0\n" + face + face + "400000000000 0 1 2\n" + face + face));
  EXPECT_EQ(scene.triangle_count(), 4u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(contains(scene.warnings[0], "1 of 5 entries of 'face'")) << scene.warnings[0];
}

TEST_F(UserFiles, TwoListsOfVerticesInPlyAreRefused) {
  const std::string elements = "element vertex 1\n" + kXyz + "property uchar red\nproperty uchar green\n" +
                               "property uchar blue\nelement vertex 3\n" + kXyz +
                               "element face 1\nproperty list uchar int vertex_indices\n"
                               "property list uchar float texcoord\n";
  const std::string error =
      error_of("two.ply", ply(elements, "0 0 0 1 2 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n"));
  EXPECT_TRUE(contains(error, "two lists of vertices")) << error;
}

TEST_F(UserFiles, ColumnNamesGivePositionsTheirPlace) {
  const Scene scene = read("a.xyz", "id,x,y,z\n7,1,2,3\n8,4,5,6\n");
  ASSERT_EQ(scene.point_count(), 2u);
  EXPECT_EQ(glm::min(scene.meshes[0].positions[0], scene.meshes[0].positions[1]), glm::vec3(1, 2, 3));
  EXPECT_EQ(read("a.pts", "2\n0 0 0 -12 255 0 0\n1 0 0 -9 0 255 0\n1\n0 1 0 -9 0 255 0\n").meshes[0].colors.size(), 3u);
}

std::string stl_facet(float x, std::uint16_t attribute) {
  return bytes_of(0.f, 0.f, 1.f, x, 0.f, 0.f, x + 1, 0.f, 0.f, x, 1.f, 0.f, attribute);
}

std::string stl_header(std::string text, std::uint32_t count) {
  text.resize(80, ' ');
  return text + bytes_of(count);
}

TEST_F(UserFiles, StlHasColorsOfTwoKinds) {
  // Red in VisCAM's order, blue in that of Magics.
  const std::uint16_t bits = 31 << 10, mark = 0x8000;
  const Scene viscam = read("v.stl", stl_header("solid of binary", 2) + stl_facet(0, bits | mark) + stl_facet(2, bits));
  const Mesh& a = viscam.meshes[0];
  ASSERT_EQ(a.colors.size(), a.positions.size());
  EXPECT_EQ(a.colors[a.indices[0]], glm::vec3(1, 0, 0));
  EXPECT_EQ(a.colors[a.indices[3]], glm::vec3(0.8f)) << "not marked as a colour";
  const Scene magics = read(
      "m.stl", stl_header(std::string("COLOR=\0\xff\0\xff,", 11), 2) + stl_facet(0, bits | mark) + stl_facet(2, bits));
  const Mesh& b = magics.meshes[0];
  ASSERT_EQ(b.colors.size(), b.positions.size());
  EXPECT_EQ(b.colors[b.indices[0]], glm::vec3(0, 1, 0)) << "the colour of the header";
  EXPECT_EQ(b.colors[b.indices[3]], glm::vec3(0, 0, 1));
  EXPECT_TRUE(read("p.stl", stl_header("", 1) + stl_facet(0, 77)).meshes[0].colors.empty());
}

TEST_F(UserFiles, StlIsReadAsItsCountSays) {
  const std::string facets = stl_facet(0, 0) + stl_facet(2, 0);
  const Scene longer = read("l.stl", stl_header("", 2) + facets + "more");
  EXPECT_EQ(longer.triangle_count(), 2u);
  ASSERT_EQ(longer.warnings.size(), 1u);
  EXPECT_EQ(longer.warnings[0], "4 bytes after the last triangle are not read");
  EXPECT_EQ(read("m.stl", stl_header("", 1) + facets).warnings.at(0),
            "50 bytes after the last triangle are not read; the header counts 1 of 2 triangles");
  EXPECT_TRUE(contains(error_of("s.stl", stl_header("", 9) + facets), "counts 9 triangles and has bytes for 2"));
  EXPECT_TRUE(contains(error_of("d.stl", stl_header("", 2) + std::string(110, '\0')), "damaged"));
  EXPECT_EQ(read("z.stl", stl_header("", 0) + facets).triangle_count(), 2u);
}

TEST_F(UserFiles, StlInTextHasCapitalsAndSeveralSolids) {
  const auto solid = [](const std::string& name, int x) {
    return fmt::format(
        "SOLID {}\n  FACET NORMAL 0 0 1\n OUTER LOOP\nVERTEX {} 0 0\nVERTEX {} 0 +0.0E0\nvertex {} 1 0\n"
        "ENDLOOP\nENDFACET\nENDSOLID {}\n",
        name, x, x + 1, x, name);
  };
  const Scene scene = read("a.stl", solid("facet of vertex", 0) + solid("", 3));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "facet of vertex");
  EXPECT_EQ(scene.meshes[1].name, "a");
  EXPECT_NE(scene.meshes[0].object, scene.meshes[1].object);
  const std::string text = solid("a", 0);
  EXPECT_TRUE(contains(error_of("cut.stl", text.substr(0, text.find("ENDLOOP"))), "cut short"));
  EXPECT_TRUE(
      contains(error_of("bad.stl", "solid\nfacet\nvertex 0 0 0\nvertex 1 x 0\nvertex 0 1 0\nendfacet\n"), "line"));
}

TEST_F(UserFiles, OffHasLineEndsOfAnyKind) {
  std::string text = "COFF # colours\n3 1 0\n\n0 0 0 255 0 0 # red\n1 0 0 255 0 0\n# last\n0 1 0 255 0 0\n3 0 1 2\n";
  for (const std::string line_end : {"\n", "\r\n", "\r"}) {
    std::string file;
    for (const char c : text) file += c == '\n' ? line_end : std::string(1, c);
    const Scene scene = read("a.off", file);
    EXPECT_EQ(scene.triangle_count(), 1u);
    ASSERT_EQ(scene.meshes[0].colors.size(), 3u);
    EXPECT_EQ(scene.meshes[0].colors[2], glm::vec3(1, 0, 0));
  }
}

TEST_F(UserFiles, StlInTextMayBeASingleLine) {
  const std::string facet = " facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet ";
  const Scene scene = read("a.stl", "solid my facet model" + facet + facet + "endsolid my facet model solid" + facet +
                                        "endsolid solid empty endsolid empty");
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "my facet model");
  EXPECT_EQ(scene.meshes[0].indices.size(), 6u);
  EXPECT_EQ(scene.meshes[1].name, "a");
  EXPECT_EQ(scene.meshes[1].indices.size(), 3u);
}

TEST_F(UserFiles, AFirstLineThatIsNoPointIsNamed) {
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n";
  for (const char* good : {"3", "x y z", "// a scan"})
    EXPECT_TRUE(read("a.xyz", std::string(good) + "\n" + rows).warnings.empty()) << good;
  for (const char* bad : {"1 2", "1.5 2 lost"}) {
    const Scene scene = read("a.xyz", std::string(bad) + "\n" + rows);
    EXPECT_EQ(scene.point_count(), 3u) << bad;
    ASSERT_EQ(scene.warnings.size(), 1u) << bad;
    EXPECT_TRUE(contains(scene.warnings[0], "first line 1")) << scene.warnings[0];
  }
}

TEST_F(UserFiles, TexturesHaveTheWholeNameOfTheFile) {
  write("wood.png", "");
  const Scene scene = read("a.ply", "ply\nformat ascii 1.0\ncomment TextureFile my wood.png\nelement vertex 1\n" +
                                        kXyz + "end_header\n0 0 0\n");
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_TRUE(contains(scene.warnings[1], "'my wood.png' does not exist")) << scene.warnings[1];
}

TEST_F(UserFiles, MoleculesAreSpheresOfTheirElements) {
  const Scene xyz = read("m.xyz", "2\ncarbon monoxide\nC 0.0 0.0 0.0\nO 1.128 0.0 0.0\n2\nagain\nC 0 0 0\nO 2 0 0\n");
  ASSERT_EQ(xyz.point_count(), 2u);
  const Mesh& mesh = xyz.meshes[0];
  EXPECT_TRUE(mesh.spheres);
  const std::size_t carbon = mesh.positions[0].x == 0.0f ? 0 : 1;
  EXPECT_FLOAT_EQ(mesh.radii.at(carbon), 1.77f);
  EXPECT_FLOAT_EQ(mesh.radii.at(1 - carbon), 1.50f);
  EXPECT_EQ(mesh.colors.at(carbon).x, mesh.colors.at(carbon).y);
  EXPECT_GT(mesh.colors.at(1 - carbon).x, 2.0f * mesh.colors.at(1 - carbon).y);
  ASSERT_EQ(xyz.warnings.size(), 1u);
  EXPECT_EQ(xyz.warnings[0], "the file has more than one frame; the first is drawn");
  EXPECT_TRUE(contains(error_of("s.xyz", "3\n\nC 0 0 0\nO 1 0 0\n"), "counts 3 atoms and has 2"));
  EXPECT_TRUE(contains(read("u.xyz", "2\n\nC 0 0 0\nQq 1 0 0\n").warnings.at(0), "'Qq'"));
  const Scene numbers = read("n.xyz", "2\nAtoms\n6 0.0 0.0 0.0\n8 1.128 0.0 0.0\n");
  ASSERT_EQ(numbers.point_count(), 2u);
  EXPECT_EQ(numbers.meshes[0].radii, mesh.radii) << "atomic numbers";
  EXPECT_FALSE(read("p.xyz", "2\n6 0.0 0.0 0.0\n8 1.128 0.0 0.0\n").meshes[0].positions[0].x < 6.0f) << "points";
  ImportSettings settings;
  settings.points.size = {1.0f, 0};
  const Scene sized = read("m.xyz", "C 0 0 0\nO 1.128 0 0\n", settings);
  for (const float radius : sized.meshes[0].radii) EXPECT_EQ(radius, 0.5f);
}

TEST_F(UserFiles, PdbGivesAtomsOfTheFirstModelOnce) {
  const auto atom = [](const char* record, int serial, const char* name, char place, double x, const char* element) {
    return fmt::format("{:<6}{:>5} {:<4}{}GLY A   {}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00          {:>2}\n", record,
                       serial, name, place, serial == 3 ? 2 : 1, x, 0.0, 0.0, element);
  };
  const Scene scene =
      read("a.pdb", "MODEL        1\n" + atom("ATOM", 1, " CA ", 'A', 0.0, "C") +
                        atom("ATOM", 2, " CA ", 'B', 0.4, "C") + atom("HETATM", 3, "CA  ", ' ', 3.0, "CA") +
                        "ENDMDL\nMODEL        2\n" + atom("ATOM", 1, " CA ", ' ', 9.0, "C") + "ENDMDL\nEND\n");
  ASSERT_EQ(scene.point_count(), 2u);
  const Mesh& mesh = scene.meshes[0];
  const std::size_t carbon = mesh.positions[0].x == 0.0f ? 0 : 1;
  EXPECT_FLOAT_EQ(mesh.radii.at(carbon), 1.77f);
  EXPECT_FLOAT_EQ(mesh.radii.at(1 - carbon), 2.62f) << "calcium, not an alpha carbon";
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "the file has 2 models; the first is drawn");
  EXPECT_TRUE(contains(error_of("e.pdb", "HEADER    NOTHING\nEND\n"), "no atoms"));
}

TEST_F(UserFiles, TextsForTerminalsHaveNoControlCharacters) {
  const std::string evil = "a\x1b[2J\xc2\x9b\x07z", clean = "a [2J   z";
  const std::string square = "v 0 0 0\nv 2 0 0\nv 2 2 0\n", face = "f 1 2 3\n";
  const Scene obj = read("e.obj", square + evil + " 1\no " + evil + "\nusemtl " + evil + "\n" + face);
  EXPECT_EQ(obj.meshes.at(0).name, clean);
  EXPECT_EQ(obj.materials.at(0).name, clean);
  const Scene png = read("e.ply", "ply\nformat ascii 1.0\ncomment TextureFile " + evil + ".png\nelement vertex 1\n" +
                                      kXyz + "end_header\n0 0 0\n");
  for (const Scene* scene : {&obj, &png}) {
    ASSERT_FALSE(scene->warnings.empty());
    for (const std::string& warning : scene->warnings) EXPECT_TRUE(contains(warning, clean)) << warning;
  }
  const std::string error = error_of(
      "e.gltf",
      "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"a\\u001b[2J\\u009b\\u0007z\",\"byteLength\":36}],"
      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
      "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}");
  EXPECT_TRUE(contains(printable(error), clean)) << error;
}

TEST_F(UserFiles, PointsWithDecimalCommasOrAWrongCount) {
  EXPECT_TRUE(contains(error_of("c.xyz", "0,309 1,0 0,951\n1,5 2,5 -3,5\n"), "decimal commas, as in line 1"));
  EXPECT_EQ(read("t.xyz", "0,3,1\n1,5,2\n").point_count(), 2u);
  EXPECT_EQ(read("s.xyz", "0, 3, 1\n1, 5, 2\n").point_count(), 2u);
  const Scene cut = read("n.pts", "9\n0 0 0\n1 0 0\n");
  ASSERT_EQ(cut.warnings.size(), 1u);
  EXPECT_EQ(cut.warnings[0], "the file counts 9 points, but has 2");
  EXPECT_TRUE(read("two.pts", "1\n0 0 0\n2\n1 0 0\n0 1 0\n").warnings.empty());
}

TEST_F(UserFiles, ByteOrderMarksAndLineEndsOfOtherSystems) {
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(read("m.off", "\xef\xbb\xbf" + off).triangle_count(), 1u);
  const std::string atom = "ATOM      1  N   ALA A   1       0.000   0.000   0.000  1.00  0.00           N";
  std::string other = atom;
  other.replace(10, 4, "2  C"), other.replace(33, 5, "1.500"), other.back() = 'C';
  std::string wrong = other;
  wrong.replace(33, 5, "x.500");
  const Scene without = read("w.pdb", atom + "\n" + wrong + "\nEND\n");
  EXPECT_EQ(without.point_count(), 1u);
  ASSERT_EQ(without.warnings.size(), 1u);
  EXPECT_EQ(without.warnings[0], "1 of 2 atoms have no position of three numbers and are left out, first in line 2");
  EXPECT_EQ(read("m.pdb", "\xef\xbb\xbf" + atom + "\r" + other + "\rEND\r").point_count(), 2u);
}

TEST_F(UserFiles, PolesOfStlSpheresAreOneVertex) {
  // Four triangles around a pole whose coordinates are rounding errors.
  std::string text = "solid pole\n";
  for (int k = 0; k < 4; ++k) {
    const double a = 1.5707963267948966 * k, b = 1.5707963267948966 * (k + 1);
    text += fmt::format(
        "facet normal 0 0 1\nouter loop\nvertex {} {} 1\nvertex {} {} 0\nvertex {} {} 0\nendloop\nendfacet\n",
        1e-16 * std::cos(a), 1e-16 * std::sin(a), std::cos(a), std::sin(a), std::cos(b), std::sin(b));
  }
  const Scene scene = read("pole.stl", text + "endsolid pole\n");
  const Mesh& mesh = scene.meshes.at(0);
  for (const glm::vec3& p : mesh.positions) EXPECT_TRUE(p.z != 1.0f || glm::vec2(p) == glm::vec2(0.0f));
}

TEST_F(UserFiles, KnownFormatsThatAreNotReadSayWhatToDo) {
  for (const char* name : {"a.las", "a.laz", "a.e57"})
    EXPECT_TRUE(contains(error_of(name, "LASF"), "convert it to .ply"));
  EXPECT_TRUE(contains(error_of("a.cif", "data_"), "a molecule that is not read; convert it to .pdb"));
  EXPECT_TRUE(contains(error_of("a.csv", "1,2,3"), ".xyz"));
}

}  // namespace
}  // namespace umbrage
