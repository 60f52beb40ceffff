#include "readers.h"

#include <sys/mman.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "../archives.h"
#include "../layered_files.h"
#include "core/base64.h"
#include "io/image_file.h"
#include "scene/readers/transfer.h"

namespace umbrage::fuzz {
namespace {

namespace fs = std::filesystem;
using std::string_literals::operator""s;

static_assert(std::endian::native == std::endian::little, "the binary seeds are copies of memory");

template <class... T>
std::string bytes_of(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

std::string from_hex(std::string_view digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes += char(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
  return bytes;
}

/// Returns the bytes of the file that write_image writes for an image.
std::string image_bytes(const std::string& extension, const Image& image, const WriteSettings& settings = {}) {
  std::string folder = (fs::temp_directory_path() / "umbrage-seed-XXXXXX").string();
  if (!::mkdtemp(folder.data())) return {};
  const fs::path file = fs::path(folder) / ("seed." + extension);
  std::ostringstream text;
  if (write_image(file, image, settings)) text << std::ifstream(file, std::ios::binary).rdbuf();
  fs::remove_all(folder);
  return text.str();
}

Image small_image(std::initializer_list<std::string_view> planes) {
  Image image(3, 2);
  float value = 0.0f;
  for (const std::string_view name : planes) {
    Plane& plane = image.add(name);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 3; ++x) plane.at(x, y) = (value += 0.03f);
  }
  return image;
}

std::string two_texels_tga() {
  std::string file(18, '\0');
  file[2] = 2, file[12] = 2, file[14] = 1, file[16] = 32, file[17] = 0x28;
  file.append("\0\0\xff\xff\0\xff\0\0", 8);
  return file;
}

/// Returns the positions, texture coordinates and indices of one triangle. triangle_json() refers to them.
const std::string& triangle_buffer() {
  static const std::string buffer = bytes_of(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) +
                                    bytes_of(0.f, 0.f, 1.f, 0.f, 0.f, 1.f) +
                                    bytes_of(std::uint16_t(0), std::uint16_t(1), std::uint16_t(2), std::uint16_t(0));
  return buffer;
}

std::string triangle_json(const std::string& uri) {
  const std::string tga = "data:image/x-tga;base64," + base64(two_texels_tga());
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"scale":[1,2,1]},
{"mesh":0,"translation":[0,0,1],"rotation":[0,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},
"indices":2,"material":0}]}],"materials":[{"name":"m","pbrMetallicRoughness":{"baseColorTexture":{"index":0},
"baseColorFactor":[1,0.5,0,1],"metallicFactor":0.5,"roughnessFactor":0.5},"alphaMode":"MASK","emissiveFactor":[1,1,1]}],
"textures":[{"source":0}],"images":[{"uri":")" +
         tga + R"("}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},
{"buffer":0,"byteOffset":60,"byteLength":6}],"buffers":[{"byteLength":68)" +
         uri + "}]}";
}

std::string chunk_of_3ds(std::uint16_t kind, const std::string& content) {
  return bytes_of(kind, std::uint32_t(content.size() + 6)) + content;
}

}  // namespace

Seeds ply_seeds() {
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string positions = bytes_of(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f);
  return {
      "ply\nformat ascii 1.0\n" + vertices + faces + "0 0 0\n1 0 0\n0 1e0 -.5\n3 0 1 2\n",
      "ply\nformat binary_little_endian 1.0\ncomment a\n" + vertices + faces + positions + "\3"s + bytes_of(0, 1, 2),
      "ply\r\nformat ascii 1.0\r\ncomment TextureFile a b.png\r\nelement vertex 4\r\nproperty double x\r\n"
      "property double y\r\nproperty double z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n"
      "property float s\r\nproperty float t\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
      "element tristrips 1\r\nproperty list int int vertex_indices\r\nend_header\r\n"
      "0 0 0 0 0 1 0 0 255 0 0\r\n1 0 0 0 0 1 1 0 0 255 0\r\n0 1 0 0 0 1 0 1 0 0 255\r\n1 1 0 0 0 1 1 1 9 9 9\r\n"
      "6 0 1 2 -1 1 3\r\n",
      "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b.png\n" + vertices +
          "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
          "property int texnumber\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
          "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1 1 255 0 0\n4 0 1 2 1 8 0 0 1 0 1 1 0 1 0 0 0 255\n",
      "ply\nformat ascii 1.0\n" + vertices +
          "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\n"
          "property float scale_0\nproperty float scale_1\nproperty float scale_2\nproperty float rot_0\n"
          "property float rot_1\nproperty float rot_2\nproperty float rot_3\nend_header\n"
          "0 0 0 1 0 -1 9 -4 -4 -4 1 0 0 0\n1 0 0 0 0 0 1 -4 -5 -9 1 1 0 0\n0 1 0 0 0 0 -9 -4 -4 -4 0 0 0 0\n",
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\nproperty uint y\nproperty char z\n"
      "property list ushort float other\nend_header\n" +
          from_hex("0001"
                   "00000002"
                   "03"
                   "0001"
                   "3f800000")};
}

Seeds off_seeds() {
  return {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
          "OFF\n4 2 0\n0 0 0\n2 0 0\n.5 .5 0\n0 2 0\n4 0 1 2 3 255 0 0\n3 0 1 2 7\n",
          "STCNOFF # a comment\n4 1 0\n0 0 0 0 0 1 1 0 0 1 0 0\n1 0 0 0 0 1 0 1 0 1 1 0\n1 1 0 0 0 1 0 0 1 1 1 1\n"
          "0 1 0 0 0 1 .5 .5 .5 1 0 1\n4 0 1 2 3 255 0 0\n"};
}

Seeds gzip_seeds() {
  return {test::gzip_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
          test::gzip_of("v 0 0 0\n") + test::gzip_of(std::string(5000, 'x'))};
}

Seeds three_mf_seeds() {
  return {test::three_mf_of(test::object_3mf(test::cube_3mf(1.0))),
          test::three_mf_of(
              "<resources><basematerials id=\"5\"><base displaycolor=\"#FF000080\"/></basematerials><m:colorgroup "
              "id=\"7\"><m:color color=\"#00FF00\"/></m:colorgroup><object id=\"1\" pid=\"5\" pindex=\"0\">" +
                  test::cube_3mf(1.0, {}, [](int k) { return std::string(k % 2 ? "pid=\"7\" p1=\"0\"" : ""); }) +
                  "</object><object id=\"2\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 -1 "
                  "4 0 0\"/></components></object></resources><build><item objectid=\"2\"/></build>",
              "inch"),
          test::three_mf_of(test::object_3mf(test::cube_3mf(1.0)), "millimeter",
                            {{"Metadata/model_settings.config",
                              "<config><object id=\"1\"><metadata key=\"extruder\" value=\"2\"/><part id=\"1\" "
                              "subtype=\"normal_part\"/><volume firstid=\"0\" lastid=\"5\"><metadata key=\"modifier\" "
                              "value=\"1\"/></volume></object></config>"},
                             {"Metadata/project_settings.config", R"({"filament_colour":["#FF0000","#00FF00"]})"},
                             {"Metadata/Slic3r_PE.config",
                              "; extruder_colour = #FF0000;\"\"\n; filament_colour = #00FF00;#0000FF\n"}}),
          test::three_mf_of(test::object_3mf(
              "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"9\"/></vertices>"
              "<b:beamlattice radius=\".5\" ballmode=\"all\" ballradius=\"1\"><b:beams><b:beam v1=\"0\" v2=\"1\" "
              "r1=\".2\" r2=\".3\"/></b:beams><b:balls><b:ball vindex=\"1\" r=\"2\"/></b:balls></b:beamlattice>"
              "</mesh>"))};
}

Seeds vtk_seeds() {
  const std::string
      text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ",
      points = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n",
      data = "<CellData Scalars=\"c\"><DataArray type=\"Float32\" Name=\"c\" ",
      cells =
          "</CellData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 "
          "1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" "
          "format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
          "format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
          "format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid>",
      root = "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"",
      piece = "><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">";
  const std::string block(20, '\0'), zlib = test::zlib_of(block);
  return {
      text + "POLYDATA\nPOINTS 8 float\n" + points +
          "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 4 5 7 6\nPOINT_DATA 8\n"
          "SCALARS s float 1\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 nan\nNORMALS n float\n" +
          points +
          "METADATA\nINFORMATION 0\n\nCELL_DATA 4\nCOLOR_SCALARS c 3\n1 0 0 1 0 0 1 0 0 1 0 0\nFIELD f 1\na 2 4 int\n"
          "1 2 3 4 5 6 7 8\n",
      text + "UNSTRUCTURED_GRID\nPOINTS 8 double\n" + points +
          "CELLS 3 12\nOFFSETS vtktypeint64\n0 8 12\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 5 6 7 0 1 2 3\nCELL_TYPES "
          "2\n12\n9\n",
      "# vtk DataFile Version 3.0\n\nBINARY\nDATASET POLYDATA\nPOINTS 3 char\n"s +
          "\0\0\0\1\0\0\0\1\0\nPOLYGONS 1 4\n"s +
          "\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\nPOINT_DATA 3\nSCALARS s bit\nLOOKUP_TABLE d\n\x60\n"s,
      root + piece + data + "format=\"binary\">" + base64(bytes_of(4u, 1.5f)) + "</DataArray>" + cells + "</VTKFile>",
      root + " header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"" + piece + data +
          "NumberOfComponents=\"5\" format=\"appended\" offset=\"0\"/>" + cells + "<AppendedData encoding=\"raw\">_" +
          bytes_of(std::uint64_t(1), std::uint64_t(32), std::uint64_t(20), std::uint64_t(zlib.size())) + zlib +
          "</AppendedData></VTKFile>"};
}

Seeds obj_seeds() {
  return {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
          "# a\nmtllib none.mtl\no a b\ng g\nv 0 0 0 1 0 0\nv 1 0 0\nv .5 1 0\nv -1 -1e-3 2\nvt 0 0\nvt 1 0\nvt 1 1\n"
          "vn 0 0 1\nusemtl m\ns 1\nf 1/1/1 2/2/1 3/3/1\nf 1//1 2//1 3//1 4//1\nf -1 -2 -3\nl 1 2\np 1\n",
          "\xef\xbb\xbfv 0 0 0\rv 500000.25 1e3 .5\rv 9 \\\r 9 9\rv 3 3 nan\ro a\rs off\rf 1 2 3\r\nf 1 2 9\n# C:\\\nf "
          "3 1 2\n"};
}

Seeds mtl_seeds() {
  return {
      "newmtl a\nKa 0 0 0\nKd 0.5 .5 1\nKs 0.2\nNs 30\nKe 3 2 1\nd 0.5\nTr 0.5\nTf 1 1 1\nNi 1.5\nillum 4\nPr 0.3\nPm "
      "1\n",
      "newmtl b c\nmap_Kd -s 4 4 1 -o 0.5 0 0 \"my tex.png\" -mm 0.1 2 -clamp on\nmap_d -imfchan m d.png\n"
      "bump -bm 2 b.png\nnorm n.png\nmap_Ke e.png\nd -halo 0.3\ndisp -t 1 1 1 x.png\nfoo\nPc 1\n"};
}

Seeds stl_seeds() {
  return {
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n",
      "SOLID a\nFACET\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDFACET\nENDSOLID\nsolid\nendsolid\n",
      std::string(80, ' ') + bytes_of(1u) + bytes_of(0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) +
          "\0\0"s};
}

Seeds gltf_seeds() {
  return {triangle_json(R"(,"uri":"data:application/octet-stream;base64,)" + base64(triangle_buffer()) + "\""),
          triangle_json(R"(,"uri":"none.bin")")};
}

Seeds glb_seeds() {
  std::string json = triangle_json(""), binary = triangle_buffer();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint32_t size = std::uint32_t(12 + 8 + json.size() + 8 + binary.size());
  return {"glTF" + bytes_of(2u, size, std::uint32_t(json.size())) + "JSON" + json +
          bytes_of(std::uint32_t(binary.size())) + "BIN\0"s + binary};
}

Seeds seeds_of_3ds() {
  const auto chunk = chunk_of_3ds;
  const std::string vertices = chunk(0x4110, bytes_of(std::uint16_t(3), 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f));
  const std::string uvs = chunk(0x4140, bytes_of(std::uint16_t(3), 0.f, 0.f, 1.f, 0.f, 0.f, 1.f));
  const std::string material_of_faces = chunk(0x4130, "m\0"s + bytes_of(std::uint16_t(1), std::uint16_t(0)));
  const std::string faces =
      chunk(0x4120, bytes_of(std::uint16_t(1), std::uint16_t(0), std::uint16_t(1), std::uint16_t(2), std::uint16_t(7)) +
                        material_of_faces);
  const std::string color = chunk(0xa020, chunk(0x0011, "\x80\x40\x20"));
  const std::string material = chunk(0xafff, chunk(0xa000, "m\0"s) + color + chunk(0xa200, chunk(0xa300, "a.png\0"s)));
  const std::string object = chunk(0x4000, "o\0"s + chunk(0x4100, vertices + uvs + faces));
  return {chunk(0x4d4d, chunk(0x0002, bytes_of(3u)) + chunk(0x3d3d, material + object))};
}

Seeds dae_seeds() {
  return {R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong><diffuse><color>1 0 0 1</color></diffuse></phong>
</technique></profile_COMMON></effect></library_effects><library_materials><material id="m"><instance_effect url="#e"/>
</material></library_materials><library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source="#a" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
</source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1" material="s">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>1 2 3</translate><instance_geometry url="#g">
<bind_material><technique_common><instance_material symbol="s" target="#m"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"};
}

namespace {

/// A quadrilateral with layers, a shape key, a joint and a texture, in a node with levels of detail.
constexpr const char* kPosedFbx = R"(FBXHeaderExtension: { FBXVersion: 7400 }
Definitions: { ObjectType: "Model" { PropertyTemplate: "FbxNode" { Properties70: { P: "Visibility", "", "", "A",1 } } } }
Objects: { Geometry: 1, "Geometry::g", "Mesh" { Vertices: *12 { a: 0,0,0,1,0,0,1,1,0,0,1,0 }
PolygonVertexIndex: *4 { a: 0,1,2,-4 }
LayerElementNormal: 0 { MappingInformationType: "ByPolygonVertex"
Normals: *12 { a: 0,0,1,0,0,1,0,0,1,0,0,1 } }
LayerElementUV: 0 { MappingInformationType: "ByPolygonVertex"
ReferenceInformationType: "IndexToDirect"
UV: *4 { a: 0,0,1,1 } UVIndex: *4 { a: 0,1,0,1 } }
LayerElementMaterial: 0 { MappingInformationType: "ByPolygon"
Materials: *1 { a: 0 } }
LayerElementHole: 0 { Hole: *1 { a: 0 } } }
Geometry: 2, "Geometry::s", "Shape" { Indexes: *1 { a: 1 } Vertices: *3 { a: 0,0,2 } }
Deformer: 3, "", "BlendShape" { }
Deformer: 4, "", "BlendShapeChannel" { DeformPercent: 50
FullWeights: *1 { a: 100 } }
Deformer: 5, "", "Skin" { }
Deformer: 6, "", "Cluster" { Indexes: *2 { a: 2,3 } Weights: *2 { a: 0.5,1 }
TransformLink: *16 { a: 1,0,0,0,0,1,0,0,0,0,1,0,1,0,0,1 } }
Model: 7, "Model::j", "LimbNode" { Properties70: { P: "Lcl Rotation", "", "", "A",0,0,30
P: "RotationOrder", "", "", "",3 P: "InheritType", "", "", "",2 } }
Model: 8, "Model::m", "Mesh" { }
NodeAttribute: 9, "", "LodGroup" { }
Material: 10, "Material::t", "" { ShadingModel: "phong"
}
Texture: 11, "Texture::t", "" { RelativeFilename: "t.tga"
}
Video: 12, "Video::t", "Clip" { Content: "AAACAAAAAAAAAAAAAgABACAo//8AAP//AAD/"
} }
Connections: { C: "OO",1,8 C: "OO",3,1 C: "OO",4,3 C: "OO",2,4 C: "OO",5,1 C: "OO",6,5 C: "OO",7,6 C: "OO",7,8
C: "OO",9,8 C: "OO",8,0 C: "OO",10,8 C: "OP",11,10,"DiffuseColor" C: "OO",12,11 }
)";

}  // namespace

Seeds fbx_seeds() {
  return {R"(; FBX 7.3.0 project file
FBXHeaderExtension: { FBXHeaderVersion: 1003
FBXVersion: 7300 }
GlobalSettings: { Version: 1000
Properties70: { P: "UpAxis", "int", "Integer", "",2 P: "UpAxisSign", "int", "Integer", "",1 } }
Objects: { Geometry: 11, "Geometry::", "Mesh" { Vertices: *9 { a: 0,0,0,1,0,0,0,1,0 }
PolygonVertexIndex: *3 { a: 0,1,-3 }
GeometryVersion: 124 }
Model: 12, "Model::m", "Mesh" { Version: 232
Properties70: { P: "Lcl Translation", "Lcl Translation", "", "A",1,2,3 } }
Material: 13, "Material::m", "" { Version: 102
ShadingModel: "phong"
Properties70: { P: "DiffuseColor", "Color", "", "A",0.5,0.25,1 } } }
Connections: { C: "OO",12,0 C: "OO",11,12 C: "OO",13,12 }
)",
          kPosedFbx, test::binary_fbx_triangle()};
}

Seeds png_seeds() {
  const Image color = small_image({"color.r", "color.g", "color.b", "color.a"});
  return {image_bytes("png", color), image_bytes("png", small_image({"grey"}), {.bits = 16})};
}

Seeds exr_seeds() {
  Camera camera;
  return {image_bytes("exr", small_image({"depth", "normal.x", "id"}), {.camera = &camera}),
          image_bytes("exr", small_image({"color.r", "color.g", "color.b"}), {.half = true})};
}

Seeds tiff_seeds() {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18};
  const std::string bytes = test::memory_of(values);
  const fs::path folder = fs::temp_directory_path();
  return {test::tiff_of(folder, 3, 6, bytes, {}),
          test::tiff_of(folder, 3, 2, bytes, {.samples = 3, .compression = COMPRESSION_LZW, .predictor = 3}),
          test::tiff_of(folder, 3, 2, bytes, {.samples = 3, .planar = PLANARCONFIG_SEPARATE, .tile = 16}),
          test::tiff_of(folder, 6, 4, bytes,
                        {.samples = 3,
                         .bits = 8,
                         .format = SAMPLEFORMAT_UINT,
                         .compression = COMPRESSION_ADOBE_DEFLATE,
                         .is_big = true})};
}

Seeds array_seeds() {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  const std::string array = test::npy_of("<f4", "2, 3", test::memory_of(values));
  return {array, test::npy_of(">u2", "1, 2, 3, 2", test::memory_of(values)),
          test::npy_of("<f4", "2, 3", test::memory_of(values), true),
          test::zip_of({{"depth.npy", array}, {"k.npy", test::npy_of("<f4", "2,", test::memory_of(values))}})};
}

Seeds gbuffer_seeds() {
  constexpr int kWidth = 16, kHeight = 12;
  std::vector<float> depth, points;
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float z = 2.0f + 0.01f * float(x) + (x > 9 ? 1.0f : 0.0f);
      const auto packed = std::uint32_t(z * 1e6f);
      depth.push_back(z);
      points.insert(points.end(), {(float(x) - 7.5f) * z / 16.0f, (float(y) - 5.5f) * z / 16.0f, z});
      bytes.insert(bytes.end(), {std::uint8_t(packed >> 16), std::uint8_t(packed >> 8), std::uint8_t(packed)});
    }
  // The first byte is the packing.
  return {"\0"s + test::npy_of("<f4", "12, 16", test::memory_of(depth)),
          "\0"s + test::npy_of("<f4", "12, 16, 3", test::memory_of(points)),
          "\1"s + test::npy_of("|u1", "12, 16, 3", test::memory_of(bytes)),
          "\3"s + test::npy_of("|u1", "12, 16, 4", test::memory_of(depth)),
          "\0"
          "16&12&1&"s +
              test::memory_of(depth),
          "\0"
          "16&12&3&"s +
              test::memory_of(points)};
}

Seeds content_seeds() {
  const std::string usda = "PK\3\4" + std::string(26, ' ') + "a.usda";
  return {"<!DOCTYPE html><html>",
          "version https://git-lfs\n",
          "\xff\xfev\0 \0"s,
          usda,
          "# a\nv 1 2 3\n",
          "ATOM 1 2 3\n",
          "0,5 1,5 2\n"};
}

Seeds picture_seeds() {
  const Image color = small_image({"color.r", "color.g", "color.b"});
  return {image_bytes("png", color),
          image_bytes("pfm", color),
          image_bytes("jpg", color),
          image_bytes("webp", color),
          "P2 # one\n2 2 9\n1 2 3 4\n",
          "P6 1 1 65535\nabcdef",
          "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 2\nnodata_value -1\n1.5 -1\n",
          test::hdr_of(1, 2, "abcdefgh"),
          test::hdr_of(8, 1, "\2\2\0\10\210a\210b\210c\10abcdefgh"s)};
}

Seeds pdb_seeds() {
  return {
      "ATOM      1  CA  GLY A   1       0.000   1.000   2.000  1.00  0.00           C  \n"
      "HETATM    2 CA    CA A   2       3.000   1.000   2.000  1.00  0.00          CA  \nEND\n",
      "MODEL        1\nATOM      1  N  AGLY A   1       0.000   1.000   2.000\n"
      "ATOM      1  N  BGLY A   1       0.500   1.000   2.000\nENDMDL\nMODEL        2\nENDMDL\n"};
}

Seeds xyz_seeds() {
  return {"0 0 0\n1 0 0\n0 1 0\n", "3\n# x y z r g b\n0;0;0;255;0;0\n1;0;0;0;255;0\n0;1;.5;0;0;255\n",
          "// normals\n0,0,0,0,0,1\n1e-3,2E2,-3,1,0,0\n", "id,y,x,z\n1,2,3,4\n5,6,7,8\n",
          "2\na molecule\nC 0 0 0\nFe2+ 1.5 0 -.5e1\n1\n\nH 0 0 0\n"};
}

Seeds radiance_seeds() {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2.0\n\n";
  std::string rows;
  for (int row = 0; row < 4; ++row) {
    rows += "\x02\x02\0\x08"s;  // eight pixels, channel by channel: a run of four, then four literal values
    for (int color = 0; color < 4; ++color) rows += "\x84\x80\x04\x10\x20\x30\x81"s;
  }
  return {head + "-Y 4 +X 8\n" + rows, head + "-Y 1 +X 2\n" + "\x80\x40\x20\x81\x10\x20\x30\x84"s};
}

Seeds pfm_seeds() { return {image_bytes("pfm", small_image({"grey"})), "PF\n1 1\n1.0\n" + bytes_of(1.f, 2.f, 3.f)}; }

Seeds info_seeds() {
  Seeds all;
  for (const auto seeds : {exr_seeds, tiff_seeds, array_seeds, picture_seeds})
    for (std::string& seed : seeds()) all.push_back(std::move(seed));
  return all;
}

Seeds texture_seeds() {
  const std::string bmp = "BM" +
                          bytes_of(58u, 0u, 54u, 40u, 1, 1, std::uint16_t(1), std::uint16_t(24), 0u, 4u, 0, 0, 0u, 0u) +
                          "\xff\x80\x40\0"s;
  return {image_bytes("png", small_image({"color.r", "color.g", "color.b"})),
          two_texels_tga(),
          bmp,
          "P6\n2 1\n255\nabcdef",
          "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x40\x40\x40\x80",
          from_hex("47494638376102000200810000ff000000ff000000000000002c000000000200020000080700010408002020003b"),
          from_hex("ffd8ffe000104a46494600010100000100010000ffdb0043" + std::string(130, 'f') +
                   "c0000b080002000201011100ffc40014000100000000000000000000000000000001ffc400161000030000000000000000"
                   "000000000000000131ffda0008010100003f00543fffd9")};
}

Seeds setting_seeds() { return {"\0-1.25"s, "\1-3"s, "\2yes"s, "\3zero"s, "\0045%"s, "\0040.5"s, "\0051e-3"s}; }

Seeds scene_name_seeds() { return {"scene:atrium?detail=1e6x", "scene:rooms", "scene:?", "room"}; }

Seeds transfer_seeds() {
  Scene scene;
  scene.textures.push_back({"t", 1, 1, {1, 2, 3, 4}});
  scene.materials.push_back({.name = "m", .texture = 0});
  scene.meshes.push_back({.name = "a", .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
  scene.lights.emplace_back();
  scene.warnings.push_back("w");
  Seeds seeds;
  for (const Result<Scene>& imported : {Result<Scene>(scene), Result<Scene>(file_error("a sentence"))}) {
    const int file = ::memfd_create("seed", 0);
    if (!send_import(file, imported)) continue;
    std::string& bytes = seeds.emplace_back(std::size_t(::lseek(file, 0, SEEK_END)), '\0');
    if (::pread(file, bytes.data(), bytes.size(), 0) < 0) bytes.clear();
    ::close(file);
  }
  return seeds;
}

Seeds baseline_seeds() {
  return {R"([{"bias":0.1,"camera":"auto","device":"cpu","falloff":"none","flip":0.1,"format":2,"guard":"0%","height":8,
"ms":1.5,"normal":"face","p99":0.3,"psnr":20.0,"quantity":"occlusion","radius":"20%","rmse":0.1,"samples":64,
"scene":"room","setting":"","settings":"","ssim":0.9,"technique":"hbao","view":"0 0 1","width":8}])"};
}

Seeds page_message_seeds() {
  return {R"({"type":"state","id":17,"moving":true,"size":[1280,720],"model":0,"views":[{"options":{"look":"studio",
"set":["bitmask.slices=8"]},"show":"picture"},{"options":{},"show":"normal","device":"cpu"}]})",
          R"({"type":"open","file":"a1/bunny.obj","as":"gbuffer"})", R"({"type":"ack","frame":5})",
          R"({"type":"pick","id":17,"at":[0.25,0.75]})",
          R"({"options":{"camera-position":"1,2,3"},"model":0,"format":"png","width":640,"height":480})"};
}

Seeds page_bytes_seeds() {
  return {
      "POST /0/files?drop=a1&name=a%20b HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin: http://[::1]\r\nContent-Length: "
      "2\r\n\r\n",
      "\x01\x82mask\x01\x02\x89\x81mask\x03\x80\x80mask\x81\xfe" + std::string("\0\x7e", 2) + "mask" +
          std::string(126, 'x') + "\x88\x82mask" + std::string("\x6e\x89", 2)};
}

}  // namespace umbrage::fuzz
