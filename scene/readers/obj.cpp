#include "scene/readers/obj.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "scene/readers/find_file.h"
#include "scene/readers/obj_meshes.h"
#include "scene/readers/obj_text.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// The search for the libraries of a file. Bounds the time for lines with thousands of words.
struct LibrarySearch {
  FileFinder finder;
  Poll* poll;
  int look_ups_left = 1024;

  bool exists(std::string_view name) {
    if (look_ups_left == 0 || (poll && poll->passing(0.0))) return false;
    --look_ups_left;
    return finder.find(std::string(name)).has_value();
  }
};

/// Returns the names of the libraries in a line "mtllib a.mtl b.mtl"; names may contain blanks or be quoted.
void add_libraries(std::string_view line, LibrarySearch& search, std::vector<std::string>& names) {
  constexpr std::size_t kMaxNames = 256;  // bounds the time for long lines
  line = trimmed(line);
  while (!line.empty() && line[0] != '#' && names.size() < kMaxNames) {
    if (const std::size_t close = line.find('"', 1); line[0] == '"' && close != std::string_view::npos) {
      names.emplace_back(line.substr(1, close - 1));
      line = trimmed(line.substr(close + 1));
      continue;
    }
    // The longest name of a file that exists; else the text up to ".mtl" before a blank.
    constexpr int kMaxBlanks = 32;
    std::size_t end = line.size(), next_end = line.size();
    bool exists = false;
    for (int k = 0; k < kMaxBlanks && !exists; ++k) {
      exists = search.exists(trimmed(line.substr(0, end)));
      if (exists) break;
      const std::size_t blank = line.find_last_of(" \t", end - 1);
      if (blank == std::string_view::npos || blank == 0) break;
      end = line.find_last_not_of(" \t", blank) + 1;
    }
    if (!exists) {
      for (const std::string_view ending : {".mtl ", ".mtl\t", ".MTL ", ".MTL\t"})
        next_end =
            std::min(next_end, line.find(ending) == std::string_view::npos ? line.size() : line.find(ending) + 4);
      end = next_end;
    }
    names.emplace_back(trimmed(line.substr(0, end)));
    line = trimmed(line.substr(end));
  }
}

/// Renames the maps of a library that is not beside the model, where they are found beside the library.
void name_maps_from(const fs::path& library_file, const fs::path& folder, MtlLibrary& library) {
  FileFinder finder(library_file.parent_path());
  for (MtlMaterial& material : library.materials)
    for (MtlMap& map : material.maps)
      if (const auto found = finder.find(map.file)) map.file = found->lexically_proximate(folder).string();
}

std::vector<std::string> libraries_of(std::string_view text, LibrarySearch& search) {
  constexpr std::string_view kWord = "mtllib";
  std::vector<std::string> names;
  std::set<std::string_view> lines;
  for (std::size_t at = text.find(kWord); at != std::string_view::npos; at = text.find(kWord, at + 1)) {
    const std::size_t line_end = text.find('\n', at), after = at + kWord.size();
    const std::size_t before = text.find_last_not_of(" \t\v", at - 1);
    if (!is_blank(text[after]) || (at > 0 && before != std::string_view::npos && text[before] != '\n')) continue;
    // Some exporters repeat the line for each object.
    if (const std::string_view line = text.substr(after, line_end - after); lines.insert(line).second)
      add_libraries(line, search, names);
  }
  return names;
}

}  // namespace

bool ObjFile::has_maps() const {
  return std::any_of(materials.begin(), materials.end(), [](const MtlMaterial& each) { return each.has_maps(); });
}

Result<ObjFile> open_obj(const fs::path& path, Poll* poll) {
  auto text = read_whole_file(path, poll);
  if (!text) return text.error();
  const bool ends_in_line = !text->empty() && !text->ends_with('\n') && !text->ends_with('\r');
  ObjFile file{.path = path, .text = std::move(*text), .ends_in_line = ends_in_line};
  normalize_lines(file.text);
  LibrarySearch search{FileFinder(path.parent_path()), poll};
  std::set<std::string> known, read;
  for (const std::string& name : libraries_of(file.text, search)) {
    if (!read.insert(name).second) continue;
    if (poll && poll->passing(0.0)) return interrupted();
    const auto found = search.finder.find(name);
    auto content = found ? read_whole_file(*found, poll) : Result<std::string>(file_error("missing"));
    if (poll && poll->ended()) return interrupted();
    if (!content) {
      file.missing_libraries.push_back(name);
      continue;
    }
    normalize_lines(*content);
    MtlLibrary library = read_mtl(*content, found->filename().string());
    if (found->parent_path() != path.parent_path()) name_maps_from(*found, path.parent_path(), library);
    file.libraries.push_back(*found);
    file.warnings.insert(file.warnings.end(), library.warnings.begin(), library.warnings.end());
    for (MtlMaterial& material : library.materials)  // the first library that defines a name applies
      if (known.insert(material.name).second) file.materials.push_back(std::move(material));
  }
  return file;
}

Result<ObjScene> read_obj(const ObjFile& file, bool threads, Poll* poll) {
  constexpr std::size_t kMaxBytes = std::size_t(1) << 33;  // so that numbers of corners fit into 32 bits
  if (file.text.size() > kMaxBytes) return file_error("'{}' is larger than 8 GB", file.path.string());
  std::vector<ObjBlock> blocks = parse_obj(file.text, threads, poll);
  if (poll && poll->ended()) return interrupted();
  std::size_t positions = 0, uvs = 0, normals = 0;
  for (const ObjBlock& block : blocks) {
    positions += block.positions.size();
    uvs += block.uvs.size();
    normals += block.normals.size();
  }
  if (std::max({positions, uvs, normals}) > std::size_t(kMaxObjIndex))
    return file_error("'{}' has more than {} vertices", file.path.string(), kMaxObjIndex);
  return ObjMeshes(file, std::move(blocks), poll).scene();
}

}  // namespace umbrage
