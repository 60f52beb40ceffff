// VTK files: each encoding of a model gives the same mesh; surfaces of all cells; values; bad files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "archives.h"
#include "core/base64.h"
#include "file_folder.h"
#include "importer/importer.h"
#include "importer/readers.h"
#include "scene/readers/content.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

struct VtkTest : test::FileFolder {
  Result<Scene> result(const std::string& name, const std::string& bytes, std::optional<std::string> field = "") const {
    return read_vtk(write(name, bytes), field);
  }
  Scene read(const std::string& bytes, std::optional<std::string> field = "") const {
    Result<Scene> scene = result("model", bytes, std::move(field));
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene && !scene->meshes.empty() ? *scene : Scene{.meshes = std::vector<Mesh>(1)};
  }
  void expect_error(const std::string& bytes, const std::string& part) const {
    const Result<Scene> scene = result("model", bytes);
    ASSERT_FALSE(scene) << part;
    EXPECT_NE(scene.error().message.find(part), std::string::npos) << scene.error().message;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
  }
};

const std::string kText = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET ";

/// A vertex, a line, a quad and a strip of three triangles.
const std::string kPolygons =
    kText +
    "POLYDATA\nPOINTS 9 float\n0 0 0 1 0 0 2 0 0 3 0 .5\n0 1 0 1 1 0 2 1 0 3 1 1 9 9 9\n"
    "TRIANGLE_STRIPS 1 6\n5 1 5 2 6 3\nPOLYGONS 1 5\n4 0 1 5 4\nLINES 1 3\n2 0 4\nVERTICES 1 2\n1 7\n";
const std::string kValues =
    "POINT_DATA 9\nVECTORS v float\n0 0 1 1 0 1 2 0 1 3 0 1 4 0 1 5 0 1 6 0 1 7 0 1 8 0 1\n"
    "SCALARS p%20s double\nLOOKUP_TABLE default\n0 1 nan 3 4 5 6 7 8\nCELL_DATA 4\nFIELD f 1\nc 1 4 int\n10 11 12 13\n";

/// Returns the number of triangles, and checks that the surface is closed with its outer side outwards: each edge
/// occurs once in both directions, and the volume is positive.
std::size_t closed_triangles(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t* const t = &mesh.indices[i];
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  EXPECT_GT(volume, 0.0);
  return mesh.indices.size() / 3;
}

/// Returns an unstructured grid: points, and cells as their type and corners.
std::string grid_of(const std::string& points, const std::vector<std::pair<int, std::vector<int>>>& cells) {
  std::string lists, types;
  std::size_t size = 0;
  for (const auto& [type, corners] : cells) {
    lists += std::to_string(corners.size());
    for (const int corner : corners) lists += " " + std::to_string(corner);
    lists += "\n";
    types += std::to_string(type) + "\n";
    size += 1 + corners.size();
  }
  const auto count = (std::count(points.begin(), points.end(), ' ') + 1) / 3;
  return fmt::format("{}UNSTRUCTURED_GRID\nPOINTS {} float\n{}\nCELLS {} {}\n{}CELL_TYPES {}\n{}", kText, count, points,
                     cells.size(), size, lists, cells.size(), types);
}

const std::string kCube = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1";

TEST_F(VtkTest, PolygonsAndStripsBecomeTrianglesWithTheirValues) {
  const Scene scene = read(kPolygons + kValues);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_FALSE(mesh.points);
  EXPECT_EQ(mesh.name, "model");
  ASSERT_EQ(mesh.positions.size(), 7u) << "two points are not used";
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 5, 0, 5, 4, 1, 5, 2, 2, 5, 6, 2, 6, 3}));
  EXPECT_EQ(scene.warnings, (std::vector<std::string>{"1 lines are not drawn", "1 vertices are not drawn"}));
  ASSERT_EQ(mesh.fields.size(), 3u);
  EXPECT_EQ(mesh.fields[0].name, "p s") << "the scalars come first";
  EXPECT_FALSE(mesh.fields[0].on_triangles);
  EXPECT_EQ(mesh.fields[0].values[1], 1.0f);
  EXPECT_TRUE(std::isnan(mesh.fields[0].values[2]));
  EXPECT_EQ(mesh.fields[0].values.back(), 6.0f);
  EXPECT_EQ(mesh.fields[1].components, 3);
  EXPECT_EQ(mesh.fields[1].values.size(), 21u);
  EXPECT_EQ(mesh.fields[1].values[18], 6.0f);
  EXPECT_TRUE(mesh.fields[2].on_triangles);
  // Values of cells belong to vertices, lines, polygons and strips in this order, whatever that of the file.
  EXPECT_EQ(mesh.fields[2].values, (std::vector<float>{12, 12, 13, 13, 13}));
}

TEST_F(VtkTest, OnlyTheFieldThatIsAskedForIsRead) {
  const Scene one = read(kPolygons + kValues, "c");
  ASSERT_EQ(one.meshes[0].fields.size(), 1u);
  EXPECT_EQ(one.meshes[0].fields[0].name, "c");
  const Scene none = read(kPolygons + kValues, std::nullopt);
  EXPECT_TRUE(none.meshes[0].fields.empty());
  EXPECT_EQ(none.warnings.back(), "not drawn: 'v', 'p s', 'c'");
}

/// Returns the bytes of numbers, the highest byte first if asked for.
template <class T>
std::string bytes_of(const std::vector<T>& values, bool big_endian) {
  std::string all;
  for (const T value : values) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    all += bytes;
  }
  return all;
}

const std::vector<float> kTriangle{0, 0, 0, 1, 0, 0, 0, 1, .5f};

template <class T>
std::string binary_scalars(const char* type) {
  return "# vtk DataFile Version 4.2\n\nBINARY\nDATASET POLYDATA\nPOINTS 3 float\n" + bytes_of(kTriangle, true) +
         "\nMETADATA\nINFORMATION 0\n\nPOLYGONS 1 4\n" + bytes_of<std::int32_t>({3, 0, 1, 2}, true) +
         "\nPOINT_DATA 3\nSCALARS s " + type + " 1\nLOOKUP_TABLE default\n" +
         bytes_of<T>({T(1), T(2), T(T(0) - T(3))}, true) + "\n";
}

TEST_F(VtkTest, BinaryNumbersOfAllTypes) {
  const auto expect = [&](const std::string& bytes, float last) {
    const Scene scene = read(bytes);
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2}));
    ASSERT_EQ(scene.meshes[0].positions.size(), 3u);
    EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(0, 1, .5f));
    ASSERT_EQ(scene.meshes[0].fields.size(), 1u);
    EXPECT_EQ(scene.meshes[0].fields[0].values, (std::vector<float>{1, 2, last}));
  };
  expect(binary_scalars<std::int8_t>("char"), -3.0f);
  expect(binary_scalars<std::uint8_t>("unsigned_char"), 253.0f);
  expect(binary_scalars<std::int16_t>("short"), -3.0f);
  expect(binary_scalars<std::uint16_t>("unsigned_short"), 65533.0f);
  expect(binary_scalars<std::int32_t>("int"), -3.0f);
  expect(binary_scalars<std::uint32_t>("unsigned_int"), 4294967293.0f);
  expect(binary_scalars<std::int64_t>("vtktypeint64"), -3.0f);
  expect(binary_scalars<std::uint64_t>("unsigned_long"), 18446744073709551613.0f);
  expect(binary_scalars<float>("float"), -3.0f);
  expect(binary_scalars<double>("double"), -3.0f);
  std::string bits = binary_scalars<std::int8_t>("bit");
  bits.replace(bits.size() - 4, 3, "\x60");  // 0 1 1
  EXPECT_EQ(read(bits).meshes[0].fields.at(0).values, (std::vector<float>{0, 1, 1}));
}

TEST_F(VtkTest, OffsetsOfVersion5) {
  const std::string old = kText + "POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\n",
                    now =
                        kText +
                        "POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\n"
                        "CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n";
  EXPECT_EQ(read(old).meshes[0].indices, read(now).meshes[0].indices);
  EXPECT_EQ(read(now).triangle_count(), 2u);
}

TEST_F(VtkTest, SurfaceOfEachVolume) {
  const auto prism = [](int n) {
    std::string points;
    for (int i = 0; i < 2 * n; ++i)
      points += fmt::format("{}{} {} {}", i ? " " : "", std::cos(6.2831853 * (i % n) / n),
                            std::sin(6.2831853 * (i % n) / n), i / n);
    return points;
  };
  const auto expect = [&](int type, const std::string& points, std::size_t triangles) {
    std::vector<int> corners((std::size_t(std::count(points.begin(), points.end(), ' ')) + 1) / 3);
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = int(i);
    EXPECT_EQ(closed_triangles(read(grid_of(points, {{type, corners}})).meshes[0]), triangles) << type;
  };
  expect(10, "0 0 0 1 0 0 0 1 0 0 0 1", 4);
  expect(11, "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1", 12);
  expect(12, kCube, 12);
  expect(13, "0 0 0 0 1 0 1 0 0 0 0 1 0 1 1 1 0 1", 8);
  expect(14, "0 0 0 1 0 0 1 1 0 0 1 0 .5 .5 1", 6);
  expect(15, prism(5), 16);
  expect(16, prism(6), 20);
}

TEST_F(VtkTest, FacesBetweenCellsAreNotDrawn) {
  // A hexahedron, a pyramid on it, a wedge beside it, a tetrahedron on that, and a flat cell on its outside and one
  // inside.
  const std::string points = kCube + " .5 .5 2 2 0 .5 2 1 .5 3 3 0";
  const std::vector<std::pair<int, std::vector<int>>> cells{{12, {0, 1, 2, 3, 4, 5, 6, 7}},
                                                            {14, {4, 5, 6, 7, 8}},
                                                            {13, {1, 9, 5, 2, 10, 6}},
                                                            {9, {0, 3, 2, 1}},
                                                            {9, {4, 5, 6, 7}}};
  const Scene scene = read(grid_of(points, cells) + "CELL_DATA 5\nSCALARS c int\n0 1 2 3 4\n");
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 11u);
  ASSERT_EQ(mesh.fields.size(), 1u);
  std::map<float, int> triangles;
  for (const float cell : mesh.fields[0].values) ++triangles[cell];
  EXPECT_EQ(triangles, (std::map<float, int>{{0.0f, 8}, {1.0f, 4}, {2.0f, 6}, {4.0f, 2}}));
}

TEST_F(VtkTest, PointsInsideAreDroppedAndCollapsedCellsAreClosed) {
  std::string points, values;
  std::vector<std::pair<int, std::vector<int>>> cells;
  for (int i = 0; i < 27; ++i) {
    points += fmt::format("{}{} {} {}", i ? " " : "", i % 3, i / 3 % 3, i / 9);
    values += fmt::format("{}\n", i);
  }
  for (int i = 0; i < 8; ++i) {
    const int at = i % 2 + i / 2 % 2 * 3 + i / 4 * 9;
    cells.push_back({12, {at, at + 1, at + 4, at + 3, at + 9, at + 10, at + 13, at + 12}});
  }
  const Mesh mesh =
      read(grid_of(points, cells) + "POINT_DATA 27\nSCALARS s float 1\nLOOKUP_TABLE default\n" + values).meshes[0];
  EXPECT_EQ(closed_triangles(mesh), 48u);
  ASSERT_EQ(mesh.positions.size(), 26u);
  for (std::size_t i = 0; i < 26; ++i) {
    const glm::vec3 p = mesh.positions[i];
    EXPECT_EQ(mesh.fields.at(0).values[i], p.x + 3 * p.y + 9 * p.z);
  }
  // A hexahedron with two edges of no length is a wedge.
  EXPECT_EQ(closed_triangles(read(grid_of(kCube, {{12, {0, 1, 2, 2, 4, 5, 6, 6}}})).meshes[0]), 8u);
}

TEST_F(VtkTest, CellsOfHigherOrderAndUnknownOnesAreNamed) {
  std::vector<int> nodes(20);
  for (int i = 0; i < 20; ++i) nodes[std::size_t(i)] = i % 8;
  const Scene scene = read(grid_of(kCube, {{25, nodes}, {41, {0, 1, 2}}, {200, {0}}, {12, {0, 1, 2}}, {5, {0, 1, 8}}}));
  EXPECT_EQ(closed_triangles(scene.meshes[0]), 12u);
  EXPECT_EQ(scene.warnings, (std::vector<std::string>{
                                "2 cells refer to points that do not exist, or lack some, and are left out",
                                "1 cells of VTK's type 41 are not drawn", "1 cells of VTK's type 200 are not drawn",
                                "1 cells of higher order are drawn by their corners, with flat faces"}));
  EXPECT_EQ(read(grid_of(kCube, {{36, {0, 1, 2, 3, 4, 5, 6, 7}}, {8, {0, 1, 3, 2}}})).triangle_count(), 4u);
}

TEST_F(VtkTest, WithoutFacesPointsAreDrawn) {
  const std::string points = kText + "POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 2 0 0\n",
                    data = "CELL_DATA 1\nSCALARS c int\n7\n";
  const Mesh all = read(points).meshes[0];
  EXPECT_TRUE(all.points);
  EXPECT_EQ(all.positions.size(), 3u);
  const Mesh vertices = read(points + "VERTICES 1 3\n2 0 2\n" + data).meshes[0];
  EXPECT_TRUE(vertices.points);
  ASSERT_EQ(vertices.positions.size(), 2u);
  EXPECT_EQ(vertices.positions[1].x, 2.0f);
  EXPECT_EQ(vertices.fields.at(0).values, (std::vector<float>{7, 7}));
  EXPECT_FALSE(vertices.fields[0].on_triangles);
  const Scene lines = read(points + "LINES 1 3\n2 0 1\n");
  EXPECT_EQ(lines.point_count(), 2u);
  EXPECT_EQ(lines.warnings.at(0), "1 lines are drawn as their points");
}

TEST_F(VtkTest, TextsAreLeftOut) {
  const Scene scene = read(kPolygons +
                           "POINT_DATA 9\nFIELD f 2\nnames 1 2 string\none%20word\ntwo words\nq 1 9 int\n"
                           "1 2 3 4 5 6 7 8 9\n");
  ASSERT_EQ(scene.meshes[0].fields.size(), 1u);
  EXPECT_EQ(scene.meshes[0].fields[0].values.at(6), 7.0f);
  EXPECT_EQ(scene.warnings.at(0), "the array 'names' has no numbers and is not read");
}

TEST_F(VtkTest, NormalsAndColors) {
  const std::string start =
      kText + "POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\n";
  const Scene scene =
      read(start + "NORMALS n float\n0 0 1 0 0 1 0 1 0\nCOLOR_SCALARS c 4\n1 0 0 1 0 1 0 1 0 0 1 1\n", std::nullopt);
  ASSERT_EQ(scene.meshes[0].normals.size(), 3u);
  EXPECT_EQ(scene.meshes[0].normals[2], glm::vec3(0, 1, 0));
  ASSERT_EQ(scene.meshes[0].colors.size(), 3u);
  EXPECT_EQ(scene.meshes[0].colors[1], glm::vec3(0, 1, 0));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_TRUE(scene.meshes[0].fields.empty());
  EXPECT_EQ(read(start + "SCALARS s int 9\n" + "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9\n")
                .meshes[0]
                .fields.at(0)
                .components,
            9);
  const Scene bytes = read(start + "SCALARS c unsigned_char 3\nLOOKUP_TABLE default\n255 0 0 0 255 0 0 0 255\n");
  EXPECT_EQ(bytes.meshes[0].colors.at(2), glm::vec3(0, 0, 1));
  EXPECT_EQ(bytes.meshes[0].fields.at(0).values.at(0), 255.0f);
}

// ---- XML

/// How an XML file stores its arrays.
struct Encoding {
  std::string format = "ascii";  ///< or "binary", "raw", "base64" of appended data
  bool big_endian = false, wide_header = false, compressed = false;
  std::size_t block = 16;  ///< bytes, if they are compressed
};

/// Writes arrays, then the file that has them.
struct XmlWriter {
  Encoding encoding;
  std::string appended{};

  std::string words(const std::vector<std::uint64_t>& values) const {
    if (encoding.wide_header) return bytes_of(values, encoding.big_endian);
    return bytes_of(std::vector<std::uint32_t>(values.begin(), values.end()), encoding.big_endian);
  }

  template <class T>
  std::string array(const std::string& name, const std::string& type, const std::vector<T>& values,
                    int components = 1) {
    const bool inline_binary = encoding.format == "binary", text = encoding.format == "ascii";
    const std::string tag = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"{}\"",
                                        type, name, components, text || inline_binary ? encoding.format : "appended");
    if (text) {
      std::string numbers;
      for (const T value : values) numbers += fmt::format("{} ", double(value));
      return tag + ">\n" + numbers + "\n</DataArray>";
    }
    const std::string bytes = bytes_of(values, encoding.big_endian);
    std::string header = words({bytes.size()}), data = bytes;
    if (encoding.compressed) {
      std::vector<std::uint64_t> sizes{(bytes.size() + encoding.block - 1) / encoding.block, encoding.block,
                                       bytes.size() % encoding.block};
      data.clear();
      for (std::size_t at = 0; at < bytes.size(); at += encoding.block) {
        const std::string block = test::zlib_of(bytes.substr(at, encoding.block));
        sizes.push_back(block.size());
        data += block;
      }
      header = words(sizes);
    }
    const bool raw = encoding.format == "raw";
    // VTK encodes the header and the data of compressed arrays one by one.
    const std::string stored = raw                   ? header + data
                               : encoding.compressed ? base64(header) + base64(data)
                                                     : base64(header + data);
    if (inline_binary) return tag + ">\n  " + stored + "\n</DataArray>";
    const std::size_t offset = appended.size();
    appended += stored;
    return fmt::format("{} offset=\"{}\"/>", tag, offset);
  }

  std::string file(const std::string& kind, const std::string& pieces) const {
    std::string out = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"{}Endian\"{}{}>\n<{}>{}</{}>\n",
        kind, encoding.big_endian ? "Big" : "Little", encoding.wide_header ? " header_type=\"UInt64\"" : "",
        encoding.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "", kind, pieces, kind);
    if (!appended.empty())
      out += fmt::format("<AppendedData encoding=\"{}\">\n _{}</AppendedData>\n", encoding.format, appended);
    return out + "</VTKFile>\n";
  }
};

std::string tetra_piece(XmlWriter& xml, bool with_values = true, double shift = 0.0) {
  std::string piece = "<Piece NumberOfPoints=\"5\" NumberOfCells=\"1\">";
  if (with_values)
    piece += "<PointData Scalars=\"p\">" + xml.array<double>("a &lt;b", "Float64", {1, 2, 3, 4, 5}) +
             xml.array<std::int16_t>("p", "Int16", {-1, -2, -3, -4, -5}) + "</PointData>";
  piece += "<CellData>" + xml.array<float>("c", "Float32", {1.5f, -2.5f}, 2) + "</CellData>";
  piece +=
      "<Points>" +
      xml.array<double>("Points", "Float64", {0, 0, shift, 9, 9, 9, 1, 0, shift, 0, 1, shift, 0, 0, 1 + shift}, 3) +
      "</Points>";
  return piece + "<Cells>" + xml.array<std::int64_t>("connectivity", "Int64", {0, 2, 3, 4}) +
         xml.array<std::int32_t>("offsets", "Int32", {4}) + xml.array<std::uint8_t>("types", "UInt8", {10}) +
         "</Cells></Piece>";
}

TEST_F(VtkTest, AllEncodingsOfXmlAreEqual) {
  std::size_t files = 0;
  for (const char* const format : {"ascii", "binary", "raw", "base64"})
    for (const bool big_endian : {false, true})
      for (const bool wide_header : {false, true})
        for (const std::size_t block : {0, 7, 1000}) {
          XmlWriter xml{{format, big_endian, wide_header, block > 0, block}};
          const std::string pieces = tetra_piece(xml);
          const Scene scene = read(xml.file("UnstructuredGrid", pieces));
          const Mesh& mesh = scene.meshes[0];
          ASSERT_EQ(mesh.positions.size(), 4u) << format << big_endian << wide_header << block;
          EXPECT_EQ(closed_triangles(mesh), 4u);
          ASSERT_EQ(mesh.fields.size(), 3u);
          EXPECT_EQ(mesh.fields[0].name, "p");
          EXPECT_EQ(mesh.fields[0].values, (std::vector<float>{-1, -3, -4, -5}));
          EXPECT_EQ(mesh.fields[1].name, "a <b");
          EXPECT_EQ(mesh.fields[1].values, (std::vector<float>{1, 3, 4, 5}));
          EXPECT_EQ(mesh.fields[2].components, 2);
          EXPECT_EQ(mesh.fields[2].values, (std::vector<float>{1.5f, -2.5f, 1.5f, -2.5f, 1.5f, -2.5f, 1.5f, -2.5f}));
          EXPECT_TRUE(mesh.fields[2].on_triangles);
          ++files;
        }
  EXPECT_EQ(files, 48u);
}

TEST_F(VtkTest, PiecesAreOneMesh) {
  XmlWriter xml{{.format = "raw"}};
  const std::string pieces = tetra_piece(xml, false) + tetra_piece(xml, true, 5.0);
  const Mesh mesh = read(xml.file("UnstructuredGrid", pieces)).meshes[0];
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(closed_triangles(mesh), 8u);
  ASSERT_EQ(mesh.fields.size(), 3u);
  EXPECT_TRUE(std::isnan(mesh.fields[0].values.at(3))) << "the first piece lacks it";
  EXPECT_EQ(mesh.fields[0].values.at(4), -1.0f);
}

TEST_F(VtkTest, PolygonsOfXml) {
  XmlWriter xml;
  const std::string points = "<Points>" + xml.array<float>("", "Float32", kTriangle, 3) + "</Points>",
                    piece = "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData Normals=\"N\">" +
                            xml.array<float>("N", "Float32", {0, 0, 1, 0, 0, 1, 0, 1, 0}, 3) + "</PointData>" + points +
                            "<Polys>" + xml.array<int>("connectivity", "Int32", {2, 1, 0}) +
                            xml.array<int>("offsets", "Int32", {3}) + "</Polys></Piece>";
  const Mesh mesh = read(xml.file("PolyData", piece), std::nullopt).meshes[0];
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 1, 0}));
  ASSERT_EQ(mesh.normals.size(), 3u);
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 1, 0));
}

// ---- Bad files

TEST_F(VtkTest, BadTextFilesAreNamed) {
  const std::string points = kText + "POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
  const std::pair<std::string, std::string> kBad[] = {
      {"# vtk DataFile Version 3.0\nx\nHDF\n", "its third line is 'HDF', not ASCII or BINARY"},
      {"# vtk DataFile Version 3.0\nx\nASCII\n", "it has no DATASET"},
      {"# DataFile", "it begins neither with # vtk DataFile nor with <VTKFile>"},
      {kText + "STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n", "its DATASET is 'structured_points', not POLYDATA"},
      {kText + "POLYDATA\nPOINTS 4000000000 float\n0 0 0\n", "POINTS has 12000000000 numbers, but the file ends"},
      {kText + "POLYDATA\nPOINTS -1 float\n", "the number of its points is '-1', not 0 to"},
      {kText + "POLYDATA\nPOINTS 1 quaternion\n0 0 0\n", "the type of POINTS is 'quaternion'"},
      {kText + "POLYDATA\nPOINTS 1 float\n0 zero 0\n", "POINTS has 'zero' in the place of number 2 of 3"},
      {kText + "POLYDATA\nPOINTS 1 float\n0,5 1,5 2,5\n", "decimal commas are not read"},
      {points + "POLYGONS 1 4\n4 0 1 2\n", "its cell 1 of 1 has 4 corners"},
      {points + "POLYGONS 2 4\n3 0 1 2\n", "its cell 2 of 2"},
      {points + "POLYGONS 1 4\n3 0 1 9\n", "its 1 cells refer to points that do not exist"},
      {points + "POLYGONS 2 3\nOFFSETS int\n0 9\nCONNECTIVITY int\n0 1 2\n", "an offset of its cells is 9, not 0 to 3"},
      {points + "POLYGONS 2 3\nOFFSETS int\n0 3\nCONNECT int\n0 1 2\n", "'CONNECT' in the place of CONNECTIVITY"},
      {points + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\n", "it has 3 points and values for 4"},
      {points + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS s float\nLOOKUP_TABLE d\n1 2\n",
       "its array 's' has 3 numbers"},
      {points + "SPHERES 3\n", "it has 'SPHERES' in the place of a keyword"},
      {kText + "UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\nCELLS 1 2\n1 0\n",
       "the types of 0 cells, and the corners of 1"}};
  for (const auto& [text, part] : kBad) expect_error(text, part);
}

TEST_F(VtkTest, BadXmlFilesAreNamed) {
  const auto changed = [](const Encoding& encoding, const std::string& from, const std::string& to) {
    XmlWriter xml{encoding};
    const std::string piece = tetra_piece(xml);
    std::string file = xml.file("UnstructuredGrid", piece);
    const std::size_t at = file.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return file.replace(at, from.size(), to);
  };
  const Encoding raw{.format = "raw"}, zlib{.format = "raw", .compressed = true}, text;
  expect_error(changed(zlib, "ZLib", "LZ4"), "it is compressed by 'vtkLZ4DataCompressor'; save it with zlib");
  expect_error(changed(zlib, "ZLib", "LZMA"), "it is compressed by 'vtkLZMADataCompressor'; save it with zlib");
  expect_error(changed(text, "type=\"Unst", "type=\"PUnst"), "its type is 'PUnstructuredGrid'");
  expect_error(changed(text, "</Piece>", ""), "it is cut short, or invalid XML");
  expect_error(changed(text, "NumberOfPoints=\"5\"", "NumberOfPoints=\"6\""),
               "its array 'Points' has 15 numbers, not 18");
  expect_error(changed(text, "NumberOfPoints=\"5\"", "NumberOfPoints=\"many\""), "its NumberOfPoints is 'many'");
  expect_error(changed(text, "NumberOfCells=\"1\"", "NumberOfCells=\"2\""), "it has 1 Cells, not 2");
  expect_error(changed(text, "1.5", "one"), "its array 'c' has 'one");
  expect_error(changed(text, "Int32", "Int33"), "is of type 'Int33'");
  expect_error(changed(text, "format=\"ascii\"", "format=\"hex\""), "has the format 'hex'");
  expect_error(changed(raw, "offset=\"0\"", "offset=\"99999\""), "begins beyond the end");
  expect_error(changed(raw, "offset=\"0\"", "offset=\"30\""), "is cut short");
  expect_error(changed(raw, "version=\"1.0\" byte", "header_type=\"UInt16\" byte"), "its header_type is 'UInt16'");
  std::string damaged = changed(zlib, "VTKFile", "VTKFile");
  damaged[damaged.find(" _") + 2 + 4 * 6 + 8] ^= 0x55;  // within the first block, after three words and its size
  expect_error(damaged, "is damaged");
  XmlWriter bomb{{.format = "raw", .compressed = true, .block = 4}};
  std::string piece = tetra_piece(bomb);
  bomb.appended.replace(4, 4, bytes_of<std::uint32_t>({0x70000000}, false));
  expect_error(bomb.file("UnstructuredGrid", piece), "larger than its number of values");
}

TEST_F(VtkTest, FilesThatAreCutShortAreErrors) {
  XmlWriter raw{{.format = "raw"}}, zlib{{.format = "base64", .compressed = true}}, text;
  const std::string pieces[] = {tetra_piece(raw), tetra_piece(zlib), tetra_piece(text)};
  for (const std::string& whole : {raw.file("UnstructuredGrid", pieces[0]), zlib.file("UnstructuredGrid", pieces[1]),
                                   text.file("UnstructuredGrid", pieces[2])})
    for (std::size_t size = 1; size + 30 < whole.size(); size += 37)
      EXPECT_FALSE(result("cut", whole.substr(0, size))) << size << " of " << whole.size();
  const std::string binary = binary_scalars<double>("double");
  for (std::size_t size = 1; size + 2 < binary.size(); ++size) {
    const Result<Scene> scene = result("cut", binary.substr(0, size));
    EXPECT_TRUE(scene || scene.error().message.find("cannot be read as VTK") != std::string::npos) << size;
  }
}

TEST_F(VtkTest, ContentTellsTheFormat) {
  XmlWriter raw{{.format = "raw"}};
  const std::string piece = tetra_piece(raw), file = raw.file("UnstructuredGrid", piece);
  EXPECT_EQ(format_of_content(file, file.size()), "vtu") << "in spite of binary data";
  EXPECT_EQ(format_of_content(raw.file("PolyData", ""), 0), "vtp");
  EXPECT_EQ(format_of_content(kPolygons, kPolygons.size()), "vtk");
  const Result<Scene> scene = import_in_process(write("a.stl", file), {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->triangle_count(), 4u);
  EXPECT_EQ(scene->warnings.at(0), "the file ends in .stl, but its content is .vtu, which is read");
  const Result<Scene> image = import_in_process(write("b.vtk", raw.file("ImageData", "")), {});
  ASSERT_FALSE(image);
  EXPECT_NE(image.error().message.find("save its surface as .vtp"), std::string::npos) << image.error().message;
}

}  // namespace
}  // namespace umbrage
