// Triangles, normals and colours of the faces of a CAD document.
#include <fmt/core.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <RWMesh_FaceIterator.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFPrs_DocumentExplorer.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>

#include "importer/cad/cad_mesh.h"
#include "importer/common/placed_mesh.h"

namespace umbrage {
namespace {

using Color = std::array<float, 4>;  ///< linear, with opacity

glm::dvec3 vector_of(const gp_XYZ& v) { return {v.X(), v.Y(), v.Z()}; }

/// Makes triangles for all faces of the parts, of which `whole` are assembled: within a quarter of a pixel of a picture
/// that they fill.
void make_triangles(const TDF_LabelSequence& whole, const TDF_LabelSequence& parts, int picture_px) {
  Bnd_Box box;
  for (const TDF_Label& label : whole) BRepBndLib::Add(XCAFDoc_ShapeTool::GetShape(label), box, false);
  if (box.IsVoid()) return;
  box = box.FinitePart();
  constexpr double kPixels = 0.25, kAngle = 0.2, kMinDeflection = 1e-6;  // radians; millimetres
  const double diagonal = box.IsVoid() ? 0.0 : std::sqrt(box.SquareExtent());
  IMeshTools_Parameters rules;
  rules.Deflection = std::max(kMinDeflection, kPixels * diagonal / double(std::max(1, picture_px)));
  rules.Angle = kAngle;
  rules.MinSize = rules.Deflection;  // a hole that is smaller than a pixel needs no 31 sides
  for (const TDF_Label& label : parts)
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) BRepMesh_IncrementalMesh(XCAFDoc_ShapeTool::GetShape(label), rules);
}

/// Adds the triangles of a face to a mesh. `is_mirrored`: by the place of the part. Faces of IGES that are mirrored
/// within their part are already turned for that, which RWMesh_FaceIterator::TriangleOriented does not know.
void add_face(const RWMesh_FaceIterator& face, bool is_mirrored, PlacedMesh& to) {
  Mesh& mesh = to.mesh;
  const Poly_Triangulation& triangles = *face.Triangulation();
  const auto first = std::uint32_t(mesh.normals.size());
  const auto node_count = std::size_t(face.NbNodes());
  constexpr double kResolution = 1e-9;
  std::optional<BRepLProp_SLProps> surface;
  if (triangles.HasUVNodes() && !BRep_Tool::Surface(face.Face()).IsNull())
    surface.emplace(BRepAdaptor_Surface(face.Face(), false), 1, kResolution);
  std::vector<glm::dvec3> positions(node_count), normals(node_count, glm::dvec3(0.0)), flat(normals);
  std::vector<bool> is_tip(node_count);  // the surface has no normal there, as at the tip of a cone
  for (std::size_t i = 0; i < node_count; ++i) {
    const int node = int(i) + 1;
    positions[i] = vector_of(face.NodeTransformed(node).XYZ());
    if (!surface) continue;
    const gp_Pnt2d uv = triangles.UVNode(node);
    surface->SetParameters(uv.X(), uv.Y());
    is_tip[i] = !surface->IsNormalDefined();
    if (!is_tip[i]) normals[i] = vector_of(surface->Normal().XYZ());
  }
  double outward = 0.0;  // how far the normals agree with the order of the triangles' corners
  for (int t = face.ElemLower(); t <= face.ElemUpper(); ++t) {
    Poly_Triangle triangle = triangles.Triangle(t);
    if ((face.Face().Orientation() == TopAbs_REVERSED) != is_mirrored)
      triangle.Set(triangle.Value(1), triangle.Value(3), triangle.Value(2));
    std::array<std::size_t, 3> corners;
    for (int k = 0; k < 3; ++k) corners[std::size_t(k)] = std::size_t(triangle.Value(k + 1) - 1);
    const glm::dvec3 area =
        glm::cross(positions[corners[1]] - positions[corners[0]], positions[corners[2]] - positions[corners[0]]);
    for (std::size_t k = 0; k < 3; ++k) {
      std::size_t& corner = corners[k];
      flat[corner] += area;
      outward += glm::dot(area, normals[corner]);
      if (!is_tip[corner]) continue;
      positions.push_back(glm::dvec3(positions[corner]));  // each triangle has its own normal there
      normals.emplace_back(0.0);
      flat.push_back(area);
      corner = normals.size() - 1;
    }
    for (const std::size_t corner : corners) mesh.indices.push_back(first + std::uint32_t(corner));
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const bool is_flat = normals[i] == glm::dvec3(0.0);
    const double length = glm::length(flat[i]);
    const glm::dvec3 normal = is_flat ? (length > 0.0 ? flat[i] / length : glm::dvec3(0.0, 0.0, 1.0))
                                      : (outward < 0.0 ? -normals[i] : normals[i]);
    mesh.normals.emplace_back(normal);
    to.positions.push_back(positions[i]);
  }
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return "";
  const TCollection_ExtendedString& text = name->Get();
  std::string utf8(std::size_t(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter buffer = utf8.data();
  utf8.resize(std::size_t(text.ToUTF8CString(buffer)));
  return utf8;
}

/// Returns the name of the place of a part, else that of the part, else that of the assembly around it. Programs that
/// have no name for a place write NAUO and a number, or => and a label of OpenCASCADE.
std::string name_of(const XCAFPrs_DocumentExplorer& at) {
  for (int depth = at.CurrentDepth(); depth >= 0; --depth) {
    const XCAFPrs_DocumentNode& node = at.Current(depth);
    for (const TDF_Label& label : {node.Label, node.RefLabel})
      if (std::string name = name_of(label); !name.empty() && !name.starts_with("NAUO") && !name.starts_with("=>"))
        return name;
  }
  return "";
}

/// Returns the index of the material of a colour; of faces without a colour, the default.
int material_of(const RWMesh_FaceIterator& face, const SurfaceColors& colors,
                std::map<std::optional<Color>, int>& known, Scene& scene) {
  std::optional<Color> color;
  const auto known_color = face.HasFaceColor() ? colors.end() : colors.find(surface_of(face.Face()));
  if (face.HasFaceColor() || known_color != colors.end()) {
    const Quantity_ColorRGBA from = face.HasFaceColor() ? face.FaceColor() : Quantity_ColorRGBA(known_color->second);
    color = Color{float(from.GetRGB().Red()), float(from.GetRGB().Green()), float(from.GetRGB().Blue()), from.Alpha()};
  }
  const auto [found, is_new] = known.emplace(color, int(scene.materials.size()));
  if (!is_new) return found->second;
  Material material;
  if (color) {
    material.albedo = {(*color)[0], (*color)[1], (*color)[2]};
    material.opacity = (*color)[3];
    material.blended = material.opacity < kOpaque;
  }
  scene.materials.push_back(std::move(material));
  return found->second;
}

}  // namespace

const void* surface_of(const TopoDS_Face& face) {
  TopLoc_Location location;
  return BRep_Tool::Surface(face, location).get();
}

Scene scene_of_document(const Handle(TDocStd_Document) & document, const SurfaceColors& colors, int picture_px) {
  Scene scene;
  scene.up = {0.0f, 0.0f, 1.0f};
  TDF_LabelSequence whole, parts;
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  shapes->GetFreeShapes(whole);
  shapes->GetShapes(parts);
  make_triangles(whole, parts, picture_px);
  std::map<std::optional<Color>, int> materials;
  std::vector<PlacedMesh> meshes;
  std::size_t faces = 0, missing = 0, hidden = 0;
  int objects = 0;
  std::optional<int> object_of_faces;  // a surface model of IGES is one object, not one per face
  bool has_curves = false;
  for (XCAFPrs_DocumentExplorer part(document, XCAFPrs_DocumentExplorerFlags_OnlyLeafNodes); part.More(); part.Next()) {
    const XCAFPrs_DocumentNode& node = part.Current();
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(node.RefLabel);
    if (shape.IsNull()) continue;
    if (!node.Style.IsVisible()) {
      ++hidden;
      continue;
    }
    has_curves = has_curves || TopExp_Explorer(shape, TopAbs_EDGE, TopAbs_FACE).More();
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      TopLoc_Location location;
      ++faces;
      missing += BRep_Tool::Triangulation(TopoDS::Face(face.Current()), location).IsNull();
    }
    const bool is_face = shape.ShapeType() == TopAbs_FACE;
    const int object = is_face ? object_of_faces.value_or(objects) : objects;
    const std::size_t first = meshes.size();
    const bool is_mirrored = node.Location.Transformation().VectorialPart().Determinant() < 0.0;
    constexpr bool kColors = true;
    for (RWMesh_FaceIterator face(node.RefLabel, node.Location, kColors, node.Style); face.More(); face.Next()) {
      if (!face.FaceStyle().IsVisible()) continue;
      const int material = material_of(face, colors, materials, scene);
      auto mesh = std::find_if(meshes.begin() + std::ptrdiff_t(first), meshes.end(),
                               [&](const PlacedMesh& each) { return each.mesh.material == material; });
      if (mesh == meshes.end()) {
        mesh = meshes.insert(meshes.end(), PlacedMesh{});
        mesh->mesh.name = name_of(part);
        mesh->mesh.material = material;
        mesh->mesh.object = object;
      }
      add_face(face, is_mirrored, *mesh);
    }
    if (meshes.size() == first) continue;
    objects = std::max(objects, object + 1);
    if (is_face) object_of_faces = object;
  }
  move_to_scene(std::move(meshes), scene);
  const auto warn = [&](std::size_t count, const std::string& what) {
    if (count > 0) scene.warnings.push_back(fmt::format("{} {}", count, what));
  };
  warn(missing, fmt::format("of {} faces are damaged and are left out", faces));
  warn(hidden, "parts are hidden in the file and are left out");
  if (has_curves) scene.warnings.push_back("curves that bound no surface are not drawn");
  return scene;
}

}  // namespace umbrage
