// Import: a file becomes a Scene.
#pragma once
#include <filesystem>
#include <optional>

#include "core/progress.h"
#include "core/result.h"
#include "scene/points.h"
#include "scene/scene.h"

namespace umbrage {

struct ImportSettings {
  /// Edges whose faces meet at a larger angle stay sharp where normals are made. Degrees.
  float crease_angle_deg = 80.0f;
  /// World up; the zero vector means: as the format says (+z for STL, what FBX and DAE name, otherwise +y).
  glm::vec3 up{0.0f};
  PointSettings points;
  /// Which of the scenes that a file holds, from 0; nothing: the one that the file names, or else the first.
  std::optional<int> scene_index;
};

/// Reads OBJ with MTL, STL, glTF/GLB, 3DS, DAE, FBX through Assimp, PLY, OFF and XYZ by readers of our own, and
/// textures through stb_image. Node transforms are applied; faces are triangulated; degenerate triangles and those with
/// coordinates that are not finite are dropped; normals are made where the file has none. PLY, OFF, OBJ and XYZ files
/// without faces, and points of glTF files without triangles, become points. Missing textures give a warning and a
/// neutral colour. Errors: kFile with one sentence that names the file and what is wrong with it;
/// kUsage for a scene that the file does not hold; kInterrupted.
Result<Scene> import_scene(const std::filesystem::path& file, const ImportSettings& settings = {},
                           const ProgressMonitor& monitor = {});

/// Of `count` scenes, whether the settings ask for one that there is. Errors: kUsage.
Result<void> check_scene_index(const ImportSettings& settings, const std::string& name, std::size_t count);

/// The endings that import_scene reads, lower case without the dot.
const std::vector<std::string>& import_formats();

}  // namespace umbrage
