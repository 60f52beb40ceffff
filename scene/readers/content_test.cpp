// Formats that are detected by content, and rows and headers of text files: each file is compared with another one that
// says the same plainly.
#include "scene/readers/content.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "file_folder.h"
#include "scene/readers/import.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage {
namespace {

struct Content : test::FileFolder {
  Scene read(const std::string& name, const std::string& text) const {
    Result<Scene> scene = import_scene(write(name, text));
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene && !scene->meshes.empty() ? *scene : Scene{.meshes = std::vector<Mesh>(1)};
  }
  std::string error_of(const std::string& name, const std::string& text) const {
    const Result<Scene> scene = import_scene(write(name, text));
    EXPECT_FALSE(scene) << name;
    return scene ? "" : scene.error().message;
  }
  void expect_error(const std::string& name, const std::string& text, const std::string& part) const {
    const std::string error = error_of(name, text);
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }
  /// Expects that two files become the same meshes, the first with `warnings` warnings.
  void expect_same(const std::string& name, const std::string& text, const std::string& plain_name,
                   const std::string& plain, std::size_t warnings = 0) const {
    const Scene scene = read(name, text), right = read("plain-" + plain_name, plain);
    EXPECT_EQ(scene.warnings.size(), warnings) << name << (scene.warnings.empty() ? "" : ": " + scene.warnings[0]);
    ASSERT_EQ(scene.meshes.size(), right.meshes.size()) << name;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh &a = scene.meshes[m], &b = right.meshes[m];
      EXPECT_EQ(a.positions, b.positions) << name;
      EXPECT_EQ(a.indices, b.indices) << name;
      EXPECT_EQ(a.colors, b.colors) << name;
      EXPECT_EQ(a.radii, b.radii) << name;
    }
  }
};

const std::string kStl =
    "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "x\n";
const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string kAtoms = "C 0 0 0\nO 1.2 0 0\nN 0 1.5 0.0000012\n";

TEST_F(Content, OfAnotherFormatThanTheNameIsRead) {
  const std::pair<const char*, std::string> kFiles[] = {{"stl", kStl}, {"obj", kObj}, {"off", kOff}, {"ply", kPly}};
  for (const auto& [format, text] : kFiles)
    for (const auto& [name, other] : kFiles) {
      const Scene scene = read(fmt::format("{}.{}", format, name), text);
      EXPECT_EQ(scene.triangle_count(), 1u);
      ASSERT_EQ(scene.warnings.size(), format == std::string(name) ? 0u : 1u);
      if (!scene.warnings.empty()) {
        EXPECT_EQ(scene.warnings[0],
                  fmt::format("the file ends in .{}, but its content is .{}, which is read", name, format));
      }
    }
  EXPECT_EQ(read("model.", kPly).warnings.at(0), "the file has no ending, but its content is .ply, which is read");
  EXPECT_EQ(read("model.txt", kPly).triangle_count(), 1u) << "a name that is not known";
  EXPECT_EQ(read("points.ply", "0 0 0\n1 0 0\n0 1 1\n").point_count(), 3u);
  expect_error("a.off", "3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "its first word is not OFF");
  expect_error("a.off", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n9 9 9\n", "more rows than it counts");
  EXPECT_TRUE(read("m.xyz", "2\nv\nO 0 0 0\no 1 0 0\n").warnings.empty());
}

TEST_F(Content, ThatIsNoModelIsNamed) {
  std::string utf16;
  for (const char c : kStl) utf16 += {c, '\0'};
  expect_error("a.stl", utf16, "UTF-16 text");
  expect_error("a.ply", "\xff\xfep\0l\0y\0", "UTF-16 text");
  expect_error("b.obj", "version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 7\n", "Git LFS");
  expect_error("c.3mf", "\n<!doctype HTML>\n<html></html>", "a web page");
  expect_error("c.glb", "<html><body>404</body></html>", "a web page");
  expect_error("d.vtk", "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">", "save its surface as .vtp");
  expect_error("d.pvtu", "<VTKFile type=\"PUnstructuredGrid\">", "ParaView");
  expect_error("e.obj", "#usda 1.0\n", "convert it to .glb");
  expect_error("e.nii", "x", "3D Slicer");
  expect_error("f.stl", "PK\3\4" + std::string(26, ' ') + "model.stl", "an archive");
}

TEST_F(Content, DecimalCommasAreNamedInEveryTextFormat) {
  expect_error("a.obj", "v 0 0 0\nv 1 0 0\nv 0,5 1 0\nf 1 2 3\n", "decimal commas, as in line 3");
  expect_error("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0,5 0,5\nvt 1 0,5\nf 1/1 2/1 3/2\n",
               "decimal commas, as in line 4");
  EXPECT_EQ(read("u.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0,5 1\nf 1/1 2/1 3/1\n").warnings.at(0),
            "numbers with decimal commas are not read, the first in line 4");
  const auto with_comma = [](std::string text) {
    const std::size_t at = text.rfind("0 1 0\n");
    return text.replace(at, 5, "0 1,5 0");
  };
  expect_error("a.stl", with_comma(kStl), "decimal commas, as in line 6");
  expect_error("a.off", with_comma(kOff), "decimal commas, as in line 5");
  expect_error("a.ply", with_comma(kPly), "decimal commas, as in line 12");
  expect_error("a.xyz", "1;2;3\n1,5;2,5;3,0\n", "decimal commas, as in line 2");
  expect_error("b.xyz", "0 0 0\n0 0 1\n0,5 0 1\n", "decimal commas, as in line 3");
  expect_error("m.xyz", "C 0,0 0,5 0,0\n", "decimal commas, as in line 1");
  EXPECT_EQ(read("s.xyz", "1,2,3;255,0,0\n4,5,6;0,255,0\n").point_count(), 2u) << "commas between numbers";
}

TEST_F(Content, CommentsMayStandAnywhere) {
  expect_same("a.obj", "mtllib a.mtl # library\nv 0 0 0 # a\nv 1 0 0# b\nv 0 1 0\nusemtl red # x\nf 1 2 3# c\n",
              "a.obj", kObj, 1);
  write("b.mtl", "newmtl red # the body\nKd 0.5 0 0 # sRGB\nnewmtl Material #25\nKd 0 0.5 0\n");
  const Scene scene = read("b.obj",
                           "mtllib b.mtl # library\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red #  paint\nf 1 2 3\n"
                           "usemtl Material #25\nf 3 2 1\n");
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].albedo, glm::vec3(0.5f, 0, 0));
  EXPECT_EQ(scene.materials[1].albedo, glm::vec3(0, 0.5f, 0));
  std::string stl = "; made by x\n# facet 2\n" + kStl;
  stl.insert(stl.find("endfacet"), "// vertex\n");
  expect_same("a.stl", stl, "a.stl", kStl);
  std::string ply = kPly;
  ply.insert(ply.find("1 0 0"), "comment 2 of 3\n# x\n");
  expect_same("a.ply", ply, "a.ply", kPly);
  expect_same("a.off", "OFF # x\n3 1 # counts\n0 0 0# y\n1 0 0\n# z\n0 1 0\n3 0 1 2\n", "a.off", kOff);
}

TEST_F(Content, CountsOfOffEndWithTheirLine) {
  for (const char* head :
       {"OFF\n3 1\n", "OFF3 1 0\n", "OFF 3 1\n", "OFF3 1\n", "OFF\n3\n1\n0\n", "3 1 0\n", "\xef\xbb\xbf# x\n3 1\n"})
    expect_same("a.off", head + kOff.substr(kOff.find("0 0 0")), "a.off", kOff);
}

TEST_F(Content, VerticesOfOffMayHaveColorsWithoutSayingSo) {
  const std::string rows = "0 0 0 255 0 51\n1 0 0 51 102 0\n0 1 0 204 255 0\n3 0 1 2\n";
  expect_same("a.off", "OFF\n3 1 0\n" + rows, "a.off", "COFF\n3 1 0\n" + rows);
  EXPECT_TRUE(read("n.off", "OFF\n3 1\n0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n").meshes[0].colors.empty());
}

TEST_F(Content, ColumnsOfMoleculesAreThoseOfTheFile) {
  expect_same("a.xyz",
              "3\nProperties=id:I:1:pos:R:3:species:S:1 pbc=\"F F F\"\n1 0 0 0 C\n2 1.2 0 0 O\n3 0 1.5 0.0000012 N\n",
              "a.xyz", kAtoms);
  expect_same("b.xyz", "3\nLattice=\"1 0 0\" properties=\"Z:I:1:pos:R:3\"\n6 0 0 0\n8 1.2 0 0\n7 0 1.5 0.0000012\n",
              "b.xyz", kAtoms);
  expect_error("c.xyz", "1\nProperties=pos:R:3:charge:R:1\n0 0 0 1\n", "species");
  expect_same("q.xyz",
              "3\ngdb 1 157.7\nC 0 0 0 -0.5\nO 1.2 0 0 0.1\nN 0 1.5 1.2*^-6 0.4\n1341.3 2.5\nCCO C\nInChI=1S/x\n",
              "q.xyz", kAtoms);
  expect_same("d.xyz", "3\n\nC 0 0 0\nO 12D-1 0 0\nN 0 1.5 1.2d-06\n", "d.xyz", kAtoms);
}

TEST_F(Content, AtomsMayHaveAnIndexAndLengthsInBohr) {
  expect_same("i.xyz", "3\nx\n1 C 0 0 0\n2 O 1.2 0 0\n3 N 0 1.5 0.0000012\n", "i.xyz", kAtoms);
  const Scene bohr = read("b.xyz", "2\nunits=Bohr\nC 0 0 0\nO 2 0 0\n");
  EXPECT_NEAR(bohr.meshes.at(0).positions.at(1).x - bohr.meshes[0].positions[0].x, 1.058354f, 1e-5f);
  EXPECT_EQ(bohr.warnings.at(0), "positions are in bohr, as line 2 says; they are converted to angstrom");
  const auto has_doubt = [&](const std::string& text) {
    const Scene scene = read("n.xyz", text);
    return !scene.warnings.empty() && scene.warnings[0].find("probably in nm") != std::string::npos;
  };
  EXPECT_TRUE(has_doubt("3\nwater\nO 0 0 0\nH 0.096 0 0\nH -0.024 0.093 0\n"));
  EXPECT_FALSE(has_doubt("4\nwater of four points\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\nX 0.1 0.1 0\n"));
  EXPECT_FALSE(has_doubt("1\nx\nO 0 0 0\n"));
}

TEST_F(Content, GhostsAndDummiesAreNoElements) {
  const Scene scene = read("g.xyz", "3\nx\nBq 0 0 0\nDu 2 0 0\nB 4 0 0\n");
  EXPECT_EQ(scene.warnings.at(0), "atoms of no known element are drawn in pink: 'Bq', 'Du'");
  EXPECT_NE(scene.meshes.at(0).colors.at(0), scene.meshes[0].colors.at(2));
}

TEST_F(Content, AColumnThatCountsIsNamed) {
  const auto warnings = [&](const std::string& head, int step) {
    std::string text = head;
    for (int i = 0; i < 12; ++i) text += fmt::format("{} 2.5 {}.5 7.5\n", i * step, i * i);
    return fmt::format("{}", fmt::join(read("c.xyz", text).warnings, "; "));
  };
  EXPECT_NE(warnings("", 1).find("column 1 counts the lines and is drawn as x"), std::string::npos);
  EXPECT_EQ(warnings("", 2).find("counts"), std::string::npos);
  EXPECT_EQ(warnings("i x y z\n", 1), "not drawn: 'i'; `color_by` shows values as colours");
}

std::string atom_line(int serial, const char* name, double x, const std::string& end) {
  return fmt::format("ATOM  {:>5} {:<4} ALA A   1    {:8.3f}{:8.3f}{:8.3f}  1.00 10.00{}\n", serial, name, x, 0.0, 0.0,
                     end);
}

TEST_F(Content, PdbOfBefore1996HasNumbersInPlaceOfElements) {
  const auto file = [](const char* a, const char* b) {
    return atom_line(1, " CA", 0.0, a) + atom_line(2, " N", 1.5, b) + "END\n";
  };
  const std::string plain = file("           C", "           N");
  expect_same("a.pdb", file("      1ABC  87", "      1ABC1234"), "a.pdb", plain);
  expect_same("c.pdb", file("      SEG1 C2+", "      SEG1 N1-"), "c.pdb", plain);
  std::string shifted = plain;
  shifted.insert(30, " ");
  expect_same("s.pdb", shifted, "s.pdb", atom_line(2, " N", 1.5, "           N"), 1);
  shifted = plain;
  shifted.erase(plain.find("ATOM  ", 6) + 12, 1);
  EXPECT_NE(read("l.pdb", shifted).warnings.at(0).find("shifted, since their numbers do not end in columns"),
            std::string::npos);
  expect_error("m.pdb", atom_line(1, " N", 1.5, "").insert(28, "  "), "its columns are shifted, first in line 1");
}

TEST_F(Content, ColorsOfPointsHaveTheirScale) {
  const std::string bytes = "0 0 0 255 0 51\n1 0 0 51 102 0\n0 1 0 204 255 0\n";
  expect_same("a.xyz", "0 0 0 1 0 0.2\n1 0 0 0.2 0.4 0\n0 1 0 0.8 1 0\n", "a.xyz", bytes);
  expect_same("b.xyz", "0 0 0 65535 0 13107\n1 0 0 13107 26214 0\n0 1 0 52428 65535 0\n", "b.xyz", bytes);
  expect_same("c.pts", "3\n0 0 0 200 255 0 51\n1 0 0 9 51 102 0\n0 1 0 0 204 255 0\n", "c.xyz", bytes);
  expect_same("d.xyz", "//X Y Z I R G B\n0 0 0 7 255 0 51\n1 0 0 8 51 102 0\n0 1 0 9 204 255 0\n", "d.xyz", bytes);
  expect_same("e.xyz", "0 0 0 255.0 0 51\n1 0 0 51 102 .0\n0 1 0 204.0000001 255 0\n", "e.xyz", bytes);
  expect_same("f.xyz", "0 0 0 0 0 1 2e2 30.5 12.0\n1 0 0 0 1 0 0 1 2\n", "f.xyz",
              "x y z r g b\n0 0 0 200 30.5 12\n1 0 0 0 1 2");
  EXPECT_TRUE(read("g.xyz", "0 0 0 200.5 30 12 0.5\n1 0 0 0 1 2 7\n").meshes[0].colors.empty()) << "which three?";
  EXPECT_FALSE(read("n.xyz", "0 0 0 1 0 0\n1 0 0 0 0.6 0.8\n").meshes[0].colors.size() > 0) << "normals";
  EXPECT_TRUE(read("o.xyz", "0 0 0 -1 0.5 0\n1 0 0 0 0.5 0.5\n").meshes[0].colors.empty());
}

TEST_F(Content, ValuesOfPointsThatAreNotDrawnAreNamed) {
  const auto warning = [&](const char* name, const std::string& text) {
    const Scene scene = read(name, text);
    EXPECT_EQ(scene.warnings.size(), 1u) << text;
    return scene.warnings.empty() ? "" : scene.warnings[0];
  };
  const std::string advice = "; a first line such as 'x y z r g b nx ny nz' names the columns";
  const std::string hint = "; `color_by` shows values as colours";
  EXPECT_EQ(warning("a.xyz", "0 0 0 0.5\n1 0 0 7\n"), "not drawn: column 4" + advice + hint);
  EXPECT_EQ(warning("b.xyz", "0 0 0 5.5 0 0 -1 9\n1 0 0 6 0 1 0 9\n"), "not drawn: column 4, 8" + advice + hint);
  EXPECT_EQ(warning("c.xyz", "x y z class r g b time\n0 0 0 5 0 0 1 9\n1 0 0 6 0 1 0 9\n"),
            "not drawn: 'class', 'time'" + hint);
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n", end = "end_header\n";
  const std::string vertices = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz,
                    faces = "element face 1\nproperty list uchar int vertex_indices\n" + end,
                    rows = "0 0 0 1 5\n1 0 0 2 6\n0 1 0 3 7\n";
  EXPECT_EQ(warning("a.ply", vertices + "property float quality\nproperty int flags\n" + faces + rows + "3 0 1 2\n"),
            "not drawn: 'quality', 'flags'" + hint);
  EXPECT_EQ(read("b.ply", vertices + "property float scalar_A\nproperty float scalar_B\n" + end + rows).warnings.at(0),
            "not drawn: 'scalar_B'" + hint);
}

TEST_F(Content, PlyMayHaveCapitalsAndIndicesFromOne) {
  const auto ply = [](const char* xyz, const char* faces) {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float {}\nproperty float {}\nproperty float {}\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n{}\n",
        xyz[0], xyz[1], xyz[2], faces);
  };
  expect_same("c.ply", ply("XYZ", "3 0 1 2\n3 0 2 3"), "c.ply", ply("xyz", "3 0 1 2\n3 0 2 3"));
  EXPECT_EQ(read("o.ply", ply("xyz", "3 1 2 3\n3 2 3 4")).warnings.at(1),
            "vertex indices seem to count from 1; the format counts from 0");
}

TEST_F(Content, ColorsOfPlyMayBePackedIntoOneNumber) {
  const auto ply = [](const std::string& properties, const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n" +
           properties + "end_header\n" + rows;
  };
  const std::string plain =
      ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", "0 0 0 255 128 3\n1 0 0 1 2 200\n");
  expect_same("a.ply", ply("property uint rgba\n", "0 0 0 4294934531\n1 0 0 66248\n"), "a.ply", plain);
  expect_same("b.ply", ply("property int rgb\n", "0 0 0 -32765\n1 0 0 66248\n"), "b.ply", plain);
  expect_same(
      "c.ply", ply("property float rgb\n", "0 0 0 2.34639735e-38\n1 0 0 9.28332207e-41\n"), "c.ply",
      ply("property uchar red\nproperty uchar green\nproperty uchar blue\n", "0 0 0 255 128 3\n1 0 0 1 2 200\n"));
  std::string binary = ply("property float rgb\n", "");
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  const float x[] = {0, 0, 0, 0, 1, 0, 0, 0};
  const std::uint32_t colors[] = {0xffff8003u, 0xff0102c8u};
  for (int i = 0; i < 2; ++i) {
    binary.append(reinterpret_cast<const char*>(x + 4 * i), 12);
    binary.append(reinterpret_cast<const char*>(colors + i), 4);
  }
  expect_same("d.ply", binary, "d.ply", plain);
}

TEST_F(Content, FlatGaussiansHaveTwoScales) {
  const auto splats = [](const char* third, const char* value) {
    return std::string(
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
               "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
               "property float scale_0\nproperty float scale_1\n") +
           third +
           "property float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n" +
           "0 0 0 1 0 -1 5 -2 -3 " + value + "0.8 0.6 0 0\n";
  };
  const Scene flat = read("a.ply", splats("", "")), right = read("b.ply", splats("property float scale_2\n", "-30 "));
  EXPECT_EQ(flat.meshes[0].normals, right.meshes[0].normals);
  EXPECT_EQ(flat.meshes[0].radii, right.meshes[0].radii);
  EXPECT_EQ(flat.meshes[0].colors, right.meshes[0].colors);
}

TEST_F(Content, ManyPointsAtZeroOutsideOfTheRestAreLeftOut) {
  std::string points, zeros, inside;
  for (int i = 0; i < 40; ++i) {
    points += fmt::format("{} {} {}\n", i % 7, i % 5, 2 + i % 3);
    inside += fmt::format("{} {} {}\n", i % 7 - 3, i % 5 - 2, i % 3 - 1);
    zeros += "0 0 0\n";
  }
  expect_same("a.xyz", points + zeros, "a.xyz", points, 1);
  EXPECT_EQ(read("w.xyz", points + zeros).warnings.at(0),
            "40 of 80 points are at exactly 0 0 0, outside of all others, and are left out");
  EXPECT_TRUE(read("b.xyz", inside + zeros).warnings.empty());
  EXPECT_TRUE(read("c.xyz", points + "0 0 0\n").warnings.empty());
}

TEST_F(Content, MissingFacesOfObjAreNamed) {
  const auto warning = [&](const std::string& text) {
    const Scene scene = read("a.obj", text);
    return scene.warnings.empty() ? "" : scene.warnings.back();
  };
  EXPECT_EQ(warning(kObj), "");
  EXPECT_EQ(warning("p 1 2\n" + kObj.substr(0, kObj.find("f "))), "") << "points by their statement";
  EXPECT_EQ(warning(kObj.substr(0, kObj.find("f "))), "") << "points";
  for (const std::string& text : {"o a\n" + kObj.substr(0, kObj.find("f ")), kObj.substr(0, kObj.find("f ") - 2)})
    EXPECT_EQ(warning(text), "the file has vertices and no faces, as if it were cut short; they are drawn as points");
  EXPECT_EQ(warning(kObj + "o next\nv 2 0 0\nv 3 0 0\n"),
            "the last 2 vertices belong to no face: faces are missing, as if the file were cut short");
  EXPECT_EQ(warning("f 1 2 3\n" + kObj.substr(0, kObj.find("f "))), "") << "faces before their vertices";
}

TEST_F(Content, TexturesMayLieBesideTheLibrary) {
  std::filesystem::create_directories(folder / "sub");
  write("sub/a.mtl", "newmtl a\nmap_Kd missing.png\nmap_Ke beside.png\n");
  write("sub/beside.png", "no image");
  const Scene scene = read("a.obj", "mtllib sub/a.mtl\nvt 0 0\nusemtl a\n" + kObj);
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_NE(scene.warnings[0].find("sub/beside.png"), std::string::npos) << scene.warnings[0];
  EXPECT_EQ(scene.warnings[0].find("does not exist"), std::string::npos) << scene.warnings[0];
  EXPECT_NE(scene.warnings[1].find("'missing.png' does not exist"), std::string::npos) << scene.warnings[1];
}

}  // namespace
}  // namespace umbrage
