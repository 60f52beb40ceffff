// Reads the documents of STEP and IGES files: shapes, assemblies, names and colours. cad_mesh.cpp makes their
// triangles.
#include "importer/cad/cad.h"

#include <sys/mman.h>
#include <unistd.h>
#include <IGESCAFControl_Reader.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <XCAFApp_Application.hxx>

#include <algorithm>
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
  bool has_start = false, has_end = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end - at >= kLine) {
      has_start = has_start || text[at + kSection] == 'S';
      has_end = has_end || text[at + kSection] == 'T';
    }
    at = end + 1;
  }
  if (!has_start) return "no line has an S in column 73";
  return has_end ? "" : "it is cut short: its last line, with a T in column 73, is missing";
}

/// Reads a STEP file into a document. Returns false if its text is damaged. Adds warnings for files that it refers to
/// and that are not read.
bool read_step(const char* path, Handle(TDocStd_Document) & document, std::vector<std::string>& warnings) {
  STEPCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetLayerMode(true);
  reader.SetPropsMode(false);
  if (reader.ReadFile(path) != IFSelect_RetDone) return false;
  reader.Transfer(document);
  for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator each(
           reader.ExternFiles());
       each.More(); each.Next())
    if (each.Value()->GetLoadStatus() != IFSelect_RetDone)
      warnings.push_back(fmt::format("a part is missing: its file '{}' cannot be read", each.Key().ToCString()));
  return true;
}

/// Does the same for an IGES file. Entities that it declares blank are not read.
bool read_iges(const char* path, Handle(TDocStd_Document) & document) {
  IGESCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetReadVisible(true);
  if (reader.ReadFile(path) != IFSelect_RetDone) return false;
  reader.Transfer(document);
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
  const Result<std::string> text = read_whole_file(file);
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
  try {
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
    std::vector<std::string> warnings;
    if (!(is_step ? read_step(path.c_str(), document, warnings) : read_iges(path.c_str(), document)))
      return unreadable("its text is damaged");
    Scene scene = scene_of_document(document, settings.picture_px);
    if (scene.meshes.empty()) return file_error("'{}' has no surfaces that can be drawn", file.string());
    scene.warnings.insert(scene.warnings.begin(), warnings.begin(), warnings.end());
    return complete_import(std::move(scene), file, settings);
  } catch (const Standard_OutOfMemory&) {
    return too_large_to_read(file);
  } catch (const Standard_Failure& e) {
    return unreadable(e.DynamicType()->Name());
  }
}

}  // namespace umbrage
