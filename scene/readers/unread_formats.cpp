#include "scene/readers/unread_formats.h"

#include <initializer_list>

#include "core/lists.h"

namespace umbrage {
namespace {

struct Unread {
  std::initializer_list<std::string_view> formats;
  const char *what, *how;
};

}  // namespace

std::string conversion_advice(std::string_view format) {
  // Assimp 5.2 reads some of these, but wrongly: it misplaces rotated instances of AMF and blackens objects without a
  // colour, refuses textures of X3D and mixes up its colours of faces, and has no reader for VRML in Debian.
  static const Unread kUnread[] = {
      {{"step", "stp", "iges", "igs", "brep", "fcstd"},
       "a CAD format",
       "export .3mf, .stl or .obj, for example with FreeCAD"},
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
      {{"csv"}, "a table", "points in text form are read from files that end in .xyz"},
      {{"zip", "rar", "7z", "tar", "tgz", "bz2", "xz", "zst"}, "an archive", "unpack it"},
  };
  for (const Unread& each : kUnread)
    if (contains(each.formats, format)) return std::string(each.what) + " that is not read; " + each.how;
  return {};
}

}  // namespace umbrage
