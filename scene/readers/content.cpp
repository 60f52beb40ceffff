#include "scene/readers/content.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <system_error>
#include <vector>

#include "core/lists.h"
#include "core/lowercase.h"
#include "scene/readers/import.h"
#include "scene/readers/molecule.h"
#include "scene/readers/read_number.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

using namespace std::string_view_literals;
namespace fs = std::filesystem;

/// What files of a format begin with.
struct Signature {
  std::string_view bytes, format;
};
constexpr Signature kSignatures[] = {{"ply\n", "ply"},
                                     {"ply\r", "ply"},
                                     {"ply ", "ply"},
                                     {"glTF", "glb"},
                                     {"Kaydara FBX", "fbx"},
                                     {"; FBX", "fbx"},
                                     {"#usda", "usda"},
                                     {"PXR-USDC", "usdc"},
                                     {"ISO-10303-21", "step"},
                                     {"# vtk DataFile", "vtk"},
                                     {"BLENDER", "blend"},
                                     {"LASF", "las"},
                                     {"ASTM-E57", "e57"},
                                     {"# .PCD", "pcd"},
                                     {"#VRML", "wrl"},
                                     {"#X3D", "x3dv"},
                                     {"version https://git-lfs", "lfs"},
                                     {"BZh", "bz2"},
                                     {"7z\xbc\xaf\x27\x1c", "7z"},
                                     {"Rar!\x1a", "rar"},
                                     {"\xfd"
                                      "7zXZ",
                                      "xz"},
                                     {"\x28\xb5\x2f\xfd", "zst"}};

/// The root elements of XML files.
constexpr Signature kRoots[] = {
    {"<COLLADA", "dae"}, {"<X3D", "x3d"}, {"<amf", "amf"}, {"<html", "html"}, {"<HTML", "html"}};

std::uint32_t uint32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Returns the format of VTK's XML files, which may hold binary data, by what the root names; else nothing.
std::string_view format_of_vtk(std::string_view start) {
  constexpr Signature kTypes[] = {{"\"PolyData\"", "vtp"},
                                  {"\"UnstructuredGrid\"", "vtu"},
                                  {"\"ImageData\"", "vti"},
                                  {"\"StructuredGrid\"", "vts"},
                                  {"\"RectilinearGrid\"", "vtr"}};
  const std::size_t root = start.starts_with('<') ? start.substr(0, 1024).find("<VTKFile") : std::string_view::npos;
  if (root == std::string_view::npos) return "";
  start = start.substr(root, start.find('>', root) - root);
  for (const Signature& type : kTypes)
    if (start.find(type.bytes) != std::string_view::npos) return type.format;
  return "";
}

std::string format_of_binary(std::string_view start, std::size_t size) {
  // A binary STL file has a header of 80 bytes, a 32-bit count and 50 bytes per triangle.
  constexpr std::size_t kStlHeader = 84, kStlTriangle = 50, kNiftiHeader = 348, kChunkHeader = 6;
  if (start.size() >= kStlHeader && size == kStlHeader + kStlTriangle * uint32_at(start, kStlHeader - 4)) return "stl";
  for (const Signature& each : kSignatures)
    if (start.starts_with(each.bytes)) return std::string(each.format);
  if (start.starts_with("MM") && start.size() > kChunkHeader && (size == 0 || uint32_at(start, 2) <= size))
    return "3ds";
  if (start.starts_with("PK\3\4")) {
    constexpr std::size_t kName = 30;  // place of the first entry's name
    if (const auto dot = start.find(".usd", kName); dot < start.find('/', kName) && dot < kName + 256) return "usdz";
    for (const char* part : {"3D/", "[Content_Types].xml", "_rels/"})
      if (start.find(part) != std::string_view::npos) return "3mf";
    return "zip";
  }
  if (start.size() >= kNiftiHeader)
    for (const std::string_view magic : {"n+1\0"sv, "ni1\0"sv})
      if (start.substr(kNiftiHeader - 4, 4) == magic) return "nii";
  return "";
}

/// Returns whether a text has two bytes for each character: by its mark, or its zeros.
bool is_utf16(std::string_view start) {
  if (start.starts_with("\xff\xfe") || start.starts_with("\xfe\xff")) return true;
  constexpr std::size_t kTested = 32;
  if (start.size() < kTested) return false;
  std::size_t zeros[2] = {};
  for (std::size_t i = 0; i < kTested; ++i) zeros[i % 2] += start[i] == '\0';
  return std::max(zeros[0], zeros[1]) == kTested / 2 && std::min(zeros[0], zeros[1]) == 0;
}

/// Removes the first line of a text and returns its words, at most kMaxWords.
std::vector<std::string_view> take_words(std::string_view& text) {
  constexpr std::size_t kMaxWords = 5;
  const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  std::vector<std::string_view> words;
  while (words.size() < kMaxWords) {
    line.remove_prefix(std::min(line.find_first_not_of(kColumnBlank), line.size()));
    if (line.empty()) break;
    words.push_back(line.substr(0, line.find_first_of(kColumnBlank)));
    line.remove_prefix(words.back().size());
  }
  return words;
}

/// Returns whether the words from `first` are three numbers.
bool are_numbers(const std::vector<std::string_view>& words, std::size_t first) {
  return words.size() >= first + 3 &&
         std::all_of(words.begin() + std::ptrdiff_t(first), words.begin() + std::ptrdiff_t(first + 3),
                     [](std::string_view word) { return number_of(word).has_value(); });
}

/// Returns whether columns 73 to 80 of the first line are those of IGES: S, and 1 after blanks or zeros.
bool is_iges(std::string_view text) {
  constexpr std::size_t kSection = 72, kLine = 80;
  if (text.size() <= kLine || text[kSection] != 'S' || text[kLine - 1] != '1') return false;
  return text.substr(kSection + 1, kLine - kSection - 2).find_first_not_of(" 0") == std::string_view::npos;
}

std::string format_of_text(std::string_view text) {
  const std::string_view whole = text = without_mark(text);
  if (is_iges(text)) return "iges";
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with('{')) return text.find("\"asset\"") != std::string_view::npos ? "gltf" : "";
  if (text.starts_with('<')) {
    if (lowercase(text.substr(0, 14)) == "<!doctype html") return "html";
    for (const Signature& root : kRoots)
      if (text.find(root.bytes) != std::string_view::npos) return std::string(root.format);
    return "";
  }
  text = text.substr(0, kContentBytes);
  std::vector<std::string_view> first;  // the words of the first line that is not a comment
  while (!text.empty()) {
    const std::vector<std::string_view> words = take_words(text);
    if (words.empty() || words[0].starts_with('#') || words[0].starts_with("//")) continue;
    if (first.empty()) first = words;
    const std::string word = lowercase(words[0]);
    if (word == "endsolid" || (word == "facet" && words.size() > 1 && lowercase(words[1]) == "normal")) return "stl";
    if ((words[0] == "ATOM" || words[0].starts_with("HETATM")) && words.size() > 3) return "pdb";
    if (words[0] == "v" && are_numbers(words, 1)) return "obj";
  }
  if (first.empty()) return "";
  const std::string_view word = first[0], after_off = word.substr(std::min(word.find("OFF"), word.size()));
  if (!after_off.empty() && word.find_first_not_of("STCN4nOF0123456789") == std::string_view::npos) return "off";
  if (first[0] == "solid" || first[0] == "SOLID") return "stl";
  for (const char* record : {"HEADER", "TITLE", "REMARK", "CRYST1", "MODEL"})
    if (word == record) return "pdb";
  for (const char* statement : {"vn", "vt", "mtllib", "usemtl"})
    if (word == statement) return "obj";
  return is_molecule(whole) || are_numbers(first, 0) || (first.size() == 1 && number_of(word)) ? "xyz" : "";
}

/// Returns one name for extensions of one format.
std::string_view family_of(std::string_view format) {
  return format == "glb"   ? "gltf"
         : format == "pts" ? "xyz"
         : format == "ent" ? "pdb"
         : format == "stp" ? "step"
         : format == "igs" ? "iges"
                           : format;
}

struct Unread {
  std::initializer_list<std::string_view> formats;
  const char *what, *how;
};

}  // namespace

std::string format_of_content(std::string_view start, std::size_t size) {
  if (std::string binary = format_of_binary(start, size); !binary.empty()) return binary;
  if (const std::string_view vtk = format_of_vtk(without_mark(start)); !vtk.empty()) return std::string(vtk);
  if (is_utf16(start)) return start.substr(0, 4).find('<') == std::string_view::npos ? "utf16" : "";  // XML may be
  constexpr std::size_t kTested = 4096;
  if (start.substr(0, kTested).find('\0') != std::string_view::npos) return "";
  return format_of_text(start);
}

std::string format_of_file(const fs::path& file) {
  std::string named = import_format(file);
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return named;
  const std::size_t size = is_gzip_file(file) ? 0 : std::size_t(fs::file_size(file, error));
  std::string found = format_of_content(read_file_start(file, kContentBytes), error ? 0 : size);
  const auto& formats = import_formats();
  const bool is_known_name = contains(formats, named);
  if (found.empty() || family_of(found) == family_of(named) || (found == "zip" && named == "3mf")) return named;
  // Rows of numbers may be anything: an OFF file without its first line, a table.
  if (found == "xyz" && (!is_known_name || named == "off")) return named;
  return is_known_name || contains(formats, found) || conversion_advice(named).empty() ? found : named;
}

bool is_cad(std::string_view format) {
  return contains(std::initializer_list<std::string_view>{"step", "stp", "iges", "igs"}, format);
}

std::string units_of(const std::string& format) {
  if (format == "3mf" || is_cad(format)) return "mm";
  if (format == "gltf" || format == "glb") return "m";
  return "";
}

std::string conversion_advice(std::string_view format) {
  // Assimp 5.2 reads some of these, but wrongly: it misplaces rotated instances of AMF and blackens objects without a
  // colour, refuses textures of X3D and mixes up its colours of faces, and has no reader for VRML in Debian.
  static const Unread kUnread[] = {
      {{"brep", "fcstd"}, "a CAD format", "export .step, for example with FreeCAD"},
      {{"ifc"}, "a format of buildings", "convert it to .glb, for example with IfcConvert"},
      {{"usd", "usda", "usdc", "usdz", "abc"}, "a scene format", "convert it to .glb, for example with Blender"},
      {{"blend"}, "Blender's own format", "export .glb from Blender"},
      {{"amf"}, "a print format", "export .3mf or .stl"},
      {{"x3d", "x3db", "x3dv", "wrl", "vrml"},
       "a scene format",
       "convert it to .glb or .obj, for example with Blender"},
      {{"max", "ma", "mb", "c4d", "lwo", "lws", "skp", "3dm", "dwg", "dxf", "ztl", "x_t", "sldprt", "ipt", "jt"},
       "the format of a program",
       "export .glb, .obj or .stl from that program"},
      {{"las", "laz", "e57", "pcd", "ptx"}, "a point cloud", "convert it to .ply, for example with CloudCompare"},
      {{"cif", "mol", "mol2", "sdf", "gro"}, "a molecule", "convert it to .pdb or .xyz, for example with Open Babel"},
      {{"vti", "vts", "vtr", "vtm", "pvd", "pvtp", "pvtu", "vtkhdf"},
       "a format of simulations",
       "save its surface as .vtp, for example with ParaView"},
      {{"nii", "nrrd", "mha", "mhd", "dcm"},
       "a volume",
       "save a surface of it as .stl or .obj, for example with 3D Slicer"},
      {{"csv"}, "a table", "points in text form are read from files that end in .xyz"},
      {{"zip", "rar", "7z", "tar", "tgz", "bz2", "xz", "zst"}, "an archive", "unpack it"},
      {{"html", "htm"}, "a web page", "download the model itself"},
      {{"lfs"}, "a pointer of Git LFS", "fetch the file itself with `git lfs pull`"},
      {{"utf16"}, "UTF-16 text", "save it as UTF-8"},
  };
  for (const Unread& each : kUnread)
    if (contains(each.formats, format)) return std::string(each.what) + " that is not read; " + each.how;
  return {};
}

}  // namespace umbrage
