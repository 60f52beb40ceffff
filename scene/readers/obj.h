// Reader for OBJ [Wavefront 1995]. Our own, since tinyobjloader 2.0 takes 25 ms of processor time for the bunny (this
// reader 6) and knows no byte order mark, continued lines and several options of maps, and Assimp 5.2 reads floats, has
// no smoothing groups and refuses a file for one wrong index.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "scene/readers/mtl.h"
#include "scene/scene.h"

namespace umbrage {

/// The text of an OBJ file, and the materials of its libraries.
struct ObjFile {
  std::filesystem::path path;
  std::string text;                              ///< prepared by normalize_lines
  bool ends_in_line = false;                     ///< the text ended without a line end
  std::vector<std::filesystem::path> libraries;  ///< files that were read
  std::vector<std::string> missing_libraries;
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;

  bool has_maps() const;
};

/// Reads an OBJ file's text and its libraries. Errors: kFile if it cannot be read; kInterrupted.
Result<ObjFile> open_obj(const std::filesystem::path& path, Poll* poll = nullptr);

/// Scene and materials before finish_scene; textures are not read.
struct ObjScene {
  Scene scene;
  std::vector<const MtlMaterial*> sources;  ///< of each material of the scene; null: the file does not define it
};

/// Reads the geometry: one mesh for each pair of object or group and material. Coordinates are relative to
/// Scene::origin. Mesh::smoothing is set if the file has statements s. Faces with an index out of range or a coordinate
/// that is not finite are left out with a warning, as are lines and free-form curves. Without faces, the vertices are
/// points. The scene has the materials that faces use, without their maps. `threads`: uses several threads. Errors:
/// kFile if there is nothing to draw; kInterrupted.
Result<ObjScene> read_obj(const ObjFile& file, bool threads, Poll* poll = nullptr);

}  // namespace umbrage
