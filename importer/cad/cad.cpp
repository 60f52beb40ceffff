// Reads the documents of STEP and IGES files: shapes, assemblies, names and colours. cad_mesh.cpp makes their
// triangles.
#include "importer/cad/cad.h"

#include <sys/mman.h>
#include <unistd.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESGraph_Color.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "importer/cad/cad_mesh.h"
#include "importer/common/serve_import.h"
#include "scene/readers/content.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/whole_file.h"
#include "system/child_process.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// Returns what is wrong with the text of a file, as OpenCASCADE reads what there is of a file that is cut short; else
/// an empty string.
std::string fault_of(std::string_view text, bool is_step) {
  if (is_step) {
    constexpr std::string_view kEnd = "END-ISO-10303-21";
    if (without_mark(text).substr(0, kContentBytes).find("ISO-10303-21") == std::string_view::npos)
      return "it does not begin with ISO-10303-21";
    return text.find(kEnd) == std::string_view::npos ? "it is cut short: END-ISO-10303-21 is missing" : "";
  }
  constexpr std::size_t kSection = 72, kLine = 80;  // columns
  const std::size_t end = text.find_last_not_of("\r\n") + 1, first = text.find('\n');
  if (first == std::string_view::npos || first < kLine || text[kSection] != 'S')
    return "the first line has no S in column 73";
  return end >= kLine && text[end - kLine + kSection] == 'T' ? ""
                                                             : "it is cut short: the last line has no T in column 73";
}

/// Returns a sentence about entities that the reader could not use; empty if there are none.
std::string faults_of(const Handle(XSControl_WorkSession) & session) {
  std::size_t count = 0;
  std::string first;
  constexpr bool kComplete = false;  // what reading has found, without a second check of all entities
  for (Interface_CheckIterator list : {session->ModelCheckList(kComplete), session->TransferReader()->LastCheckList()})
    for (list.Start(); list.More(); list.Next()) {
      if (!list.Value()->HasFailed()) continue;
      if (count++ == 0) first = list.Value()->CFail(1);
    }
  if (count == 0) return "";
  return fmt::format("{} errors and may be missing from the picture; the first: {}",
                     count == 1 ? "an entity of the file has" : fmt::format("{} entities of the file have", count),
                     first);
}

/// Reads a STEP or IGES file into a document and adds faults_of to the warnings. Returns false if the text is damaged.
template <class Reader>
bool read_document(Reader& reader, const Handle(XSControl_WorkSession) & session, const char* path,
                   Handle(TDocStd_Document) & document, std::vector<std::string>& warnings) {
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetLayerMode(true);  // whether a layer is shown
  if (reader.ReadFile(path) != IFSelect_RetDone) return false;
  reader.Transfer(document);
  if (std::string faults = faults_of(session); !faults.empty()) warnings.push_back(std::move(faults));
  return true;
}

/// Does this for a STEP file. Other files that it refers to and that cannot be read are warned of.
bool read_step(const char* path, Handle(TDocStd_Document) & document, std::vector<std::string>& warnings) {
  STEPCAFControl_Reader reader;
  reader.SetPropsMode(false);
  if (!read_document(reader, reader.ChangeReader().WS(), path, document, warnings)) return false;
  for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator each(
           reader.ExternFiles());
       each.More(); each.Next())
    if (each.Value()->GetLoadStatus() != IFSelect_RetDone)
      warnings.push_back(fmt::format("a part is missing: its file '{}' cannot be read", each.Key().ToCString()));
  return true;
}

/// Returns the colour of an entity of IGES; nothing if it has none.
std::optional<Quantity_Color> color_of(const IGESData_IGESEntity& entity) {
  if (entity.DefColor() == IGESData_DefValue) return IGESCAFControl::DecodeColor(entity.RankColor());
  const Handle(IGESGraph_Color) color = Handle(IGESGraph_Color)::DownCast(entity.Color());
  if (entity.DefColor() != IGESData_DefReference || color.IsNull()) return std::nullopt;
  constexpr double kPercent = 100.0;
  double r = 0.0, g = 0.0, b = 0.0;
  color->RGBIntensity(r, g, b);
  const auto part = [](double percent) { return std::clamp(percent / kPercent, 0.0, 1.0); };
  return Quantity_Color(part(r), part(g), part(b), Quantity_TOC_sRGB);
}

/// Returns the colours of faces by their surface. OpenCASCADE looks for the faces that it has read, but repaired and
/// sewn ones have only their surfaces in common with these.
SurfaceColors colors_of(const IGESCAFControl_Reader& reader) {
  SurfaceColors colors;
  const Handle(Interface_InterfaceModel) model = reader.WS()->Model();
  const Handle(Transfer_TransientProcess) results = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto entity = Handle(IGESData_IGESEntity)::DownCast(model->Value(i));
    const auto color = entity.IsNull() ? std::nullopt : color_of(*entity);
    const TopoDS_Shape shape = color ? TransferBRep::ShapeResult(results->Find(entity)) : TopoDS_Shape();
    if (!shape.IsNull() && shape.ShapeType() == TopAbs_FACE) colors.emplace(surface_of(TopoDS::Face(shape)), *color);
  }
  return colors;
}

/// Joins the faces of each part along their edges, which files of IGES have twice: else there are cracks between faces.
/// Closed surfaces get their outer side.
void sew_faces(const Handle(TDocStd_Document) & document) {
  constexpr double kTolerance = 1e-5;  // of the part's size
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence labels;
  shapes->GetShapes(labels);
  for (const TDF_Label& label : labels) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) continue;
    Bnd_Box box;
    BRepBndLib::Add(shape, box, false);
    if (XCAFDoc_ShapeTool::IsAssembly(label) || shape.ShapeType() == TopAbs_FACE || box.IsVoid() || box.IsOpen())
      continue;
    BRepBuilderAPI_Sewing sewing(kTolerance * std::sqrt(box.SquareExtent()));
    sewing.Add(shape);
    sewing.Perform();
    if (sewing.SewedShape().IsNull()) continue;
    TopoDS_Compound whole;
    const BRep_Builder builder;
    builder.MakeCompound(whole);
    builder.Add(whole, sewing.SewedShape());
    for (TopExp_Explorer curve(shape, TopAbs_EDGE, TopAbs_FACE); curve.More(); curve.Next())
      builder.Add(whole, curve.Current());
    shapes->SetShape(label, whole);
  }
}

/// Does this for an IGES file. Entities that it declares blank are not read.
bool read_iges(const char* path, Handle(TDocStd_Document) & document, SurfaceColors& colors,
               std::vector<std::string>& warnings) {
  IGESCAFControl_Reader reader;
  reader.SetReadVisible(true);
  if (!read_document(reader, reader.WS(), path, document, warnings)) return false;
  colors = colors_of(reader);
  sew_faces(document);
  return true;
}

}  // namespace

Result<Scene> import_cad(const fs::path& file, const ImportSettings& settings) {
  const std::string format = format_of_file(file);
  if (auto error = check_model_file(file, format)) return std::move(*error);
  const bool is_step = format == "step" || format == "stp";
  const auto unreadable = [&](const std::string& why) {
    return file_error("'{}' cannot be read as {} ({})", file.string(), is_step ? "STEP" : "IGES", why);
  };
  Result<std::string> text = read_whole_file(file);
  if (!text) return text.error();
  if (const std::string fault = fault_of(*text, is_step); !fault.empty()) return unreadable(fault);
  std::string path = file.string();
  Descriptor inflated;
  if (is_gzip_file(file)) {  // OpenCASCADE reads files only
    raise_limits_by(double(text->size()));
    inflated = Descriptor(::memfd_create("umbrage-cad", MFD_CLOEXEC));
    for (std::size_t done = 0; done < text->size();) {
      const ssize_t count = ::write(inflated.file(), text->data() + done, text->size() - done);
      if (count <= 0) return too_large_to_read(file);
      done += std::size_t(count);
    }
    path = fmt::format("/proc/self/fd/{}", inflated.file());
  }
  *text = std::string();  // OpenCASCADE reads the file once more
  try {
    Handle(TDocStd_Document) document;
    XCAFDoc_ShapeTool::SetAutoNaming(false);  // else parts without a name are called SOLID
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
    std::vector<std::string> warnings;
    SurfaceColors colors;
    if (!(is_step ? read_step(path.c_str(), document, warnings) : read_iges(path.c_str(), document, colors, warnings)))
      return unreadable("its text is damaged");
    Scene scene = scene_of_document(document, colors, settings.picture_px);
    if (scene.meshes.empty())
      return file_error("'{}' has no surfaces that can be drawn{}", file.string(),
                        warnings.empty() ? "" : fmt::format(" ({})", warnings[0]));
    scene.warnings.insert(scene.warnings.begin(), warnings.begin(), warnings.end());
    return scene;
  } catch (const Standard_OutOfMemory&) {
    return too_large_to_read(file);
  } catch (const Standard_Failure& e) {
    return unreadable(e.DynamicType()->Name());
  }
}

}  // namespace umbrage
