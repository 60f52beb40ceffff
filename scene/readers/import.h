// Import: reads a model file into a Scene.
#pragma once
#include <filesystem>
#include <optional>

#include "core/progress.h"
#include "core/result.h"
#include "scene/points.h"
#include "scene/scene.h"

namespace umbrage {

struct ImportSettings {
  /// Faces that meet at a larger angle get a hard edge where normals are created. Degrees.
  /// Not set: chosen for each mesh.
  std::optional<float> crease_angle_deg;
  /// World up. Zero: as the format defines it (+z for STL, the file's own axis for FBX and DAE, otherwise +y).
  glm::vec3 up{0.0f};
  PointSettings points;
  /// Index of the scene in a file with several, from 0. Not set: the file's default scene, or else the first.
  std::optional<int> scene_index;
  /// Index of an animation in the file, from 0. Not set: the file's pose without animation.
  std::optional<int> animation_index;
  float animation_time = 0.0f;  ///< seconds from the start of the animation
  /// Name of the field of values to read; empty: all of them; not set: none.
  std::optional<std::string> field;
  /// The larger side of the picture or more, pixels: curved surfaces of CAD files become triangles that differ from
  /// them by at most a quarter of a pixel, if the whole model fills the picture.
  int picture_px = 1024;
  /// The larger side of the picture if it shows the whole model by the default camera, pixels: textures are then
  /// reduced to what its pixels average. 0: cameras may come close.
  int fitted_px = 0;
  bool file_lights = false;  ///< whether the lights of a glTF file are read; else looks have their own
};

/// Reads 3DS and DAE through Assimp, PDB through Gemmi, STEP and IGES through OpenCASCADE, OBJ with MTL, glTF/GLB, FBX,
/// PLY, STL, OFF, 3MF, VTK and points in text form (XYZ, PTS) with readers of our own, and textures through stb_image
/// and libwebp. Applies node transforms, triangulates faces, drops degenerate triangles and triangles with coordinates
/// that are not finite, and creates normals where the file has none. PLY, OFF, OBJ and XYZ files without faces, and
/// points of glTF files, become points. Missing textures cause a warning and a neutral colour. Errors: kFile with one
/// sentence that names the file and the cause; kUsage for a scene or animation index that the file does not have;
/// kInterrupted.
Result<Scene> import_scene(const std::filesystem::path& file, const ImportSettings& settings = {},
                           const ProgressMonitor& monitor = {});

/// Checks that the requested scene index exists in a file with `count` scenes. Errors: kUsage.
Result<void> check_scene_index(const ImportSettings& settings, const std::string& name, std::size_t count);

/// Returns the format of a model by its name: the extension in lower case without the dot, of "bunny.obj.gz" "obj".
std::string import_format(const std::filesystem::path& file);
/// Checks that the requested animation index exists in a file with `count` animations. Errors: kUsage.
Result<void> check_animation_index(const ImportSettings& settings, const std::string& name, std::size_t count);

/// Returns the file extensions that import_scene reads, lower case without the dot.
const std::vector<std::string>& import_formats();

}  // namespace umbrage
