// Checks of a model file before and after reading, and the choice of the process: built-in readers run in this process,
// third-party readers in a separate one.
#include "scene/readers/import.h"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <new>
#include <set>
#include <string>
#include <system_error>

#include "core/lists.h"
#include "core/lowercase.h"
#include "core/printable.h"
#include "scene/finish.h"
#include "scene/readers/content.h"
#include "scene/readers/import_in_child_process.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/model_readers.h"
#include "scene/readers/obj.h"
#include "scene/readers/positions.h"
#include "scene/readers/whole_file.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

std::string list_of_formats() {
  std::string list;
  for (const std::string& format : import_formats()) list += (list.empty() ? "." : ", .") + format;
  return list;
}

/// Reads an OBJ file whose materials have no textures.
std::optional<Result<Scene>> import_own_obj(const fs::path& path, Poll* poll) {
  const Result<ObjFile> file = open_obj(path, poll);
  if (!file) return file.error();
  if (file->has_maps()) return std::nullopt;
  constexpr bool kThreads = true;
  Result<ObjScene> obj = read_obj(*file, kThreads, poll);
  if (!obj) return obj.error();
  warn_of_ignored(obj->scene);
  return std::move(obj->scene);
}

/// Reads OBJ, PLY, OFF, STL, or points in text form. Returns nothing for other formats, and for files with a texture,
/// which a third-party decoder reads.
std::optional<Result<Scene>> import_own(const fs::path& file, const std::string& format,
                                        const std::optional<std::string>& field, Poll* poll) {
  if (format == "obj") return import_own_obj(file, poll);
  if (format == "off") return read_off(file, poll);
  if (format == "stl") return read_stl(file, poll);
  if (format == "xyz" || format == "pts") return read_xyz(file, field, poll);
  if (format != "ply") return std::nullopt;
  if (ply_has_texture(file)) return std::nullopt;
  std::vector<std::string> textures;
  return read_ply(file, field, textures, poll);
}

/// Makes points at 0 0 0 of the file invalid, as depth cameras write pixels without a depth, if they are many and
/// outside of the box of all others. Returns their number.
std::size_t mark_zero_points(Scene& scene) {
  constexpr std::size_t kMany = 10;
  const glm::vec3 zero(-scene.origin);
  std::size_t count = 0;
  SceneBox others;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.points)
      for (const glm::vec3& p : mesh.positions) {
        if (p == zero)
          ++count;
        else if (is_finite(p))
          extend(others, p);
      }
  const bool is_inside = glm::clamp(zero, others.low, others.high) == zero;
  if (count < kMany || others.is_empty() || is_inside) return 0;
  for (Mesh& mesh : scene.meshes)
    if (mesh.points)
      std::replace(mesh.positions.begin(), mesh.positions.end(), zero,
                   glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  return count;
}

/// Makes all texts of a scene printable.
void make_printable(Scene& scene) {
  const auto clean = [](std::string& text) { text = printable(text); };
  clean(scene.name);
  for (std::vector<std::string>* texts : {&scene.scene_names, &scene.animation_names, &scene.warnings})
    std::for_each(texts->begin(), texts->end(), clean);
  for (Mesh& mesh : scene.meshes) {
    clean(mesh.name);
    for (Field& field : mesh.fields) clean(field.name);
  }
  for (Texture& texture : scene.textures) clean(texture.name);
  for (View& camera : scene.cameras) clean(camera.name);
  for (Material& material : scene.materials) {
    clean(material.name);
    std::for_each(material.ignored.begin(), material.ignored.end(), clean);
  }
}

}  // namespace

const std::vector<std::string>& import_formats() {
  static const std::vector<std::string> formats{"obj", "ply", "stl", "gltf", "glb", "3ds",  "dae",
                                                "fbx", "off", "xyz", "pts",  "pdb", "ent",  "3mf",
                                                "vtk", "vtp", "vtu", "step", "stp", "iges", "igs"};
  return formats;
}

std::string import_format(const fs::path& file) {
  const std::string ending = lowercase(without_gz(file).extension().string());
  return ending.empty() ? ending : ending.substr(1);
}

std::optional<Error> check_model_file(const fs::path& file, const std::string& format) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) return file_error("'{}' does not exist", file.string());
  if (error) return file_error("'{}' cannot be read: {}", file.string(), error.message());
  if (status.type() == fs::file_type::directory) {
    return file_error("'{}' is a folder, not a model file", file.string());
  }
  if (const std::string advice = conversion_advice(format); !advice.empty())
    return file_error("'{}' is {}", file.string(), advice);
  if (!contains(import_formats(), format)) {
    return file_error("'{}' is not a supported model file; it must end in one of {}, or one of these and .gz",
                      file.string(), list_of_formats());
  }
  if (status.type() != fs::file_type::regular) return file_error("'{}' is not a regular file", file.string());
  if (fs::file_size(file, error) == 0 && !error) return file_error("'{}' is empty", file.string());
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return file_error("'{}' cannot be opened: {}", file.string(), std::strerror(errno));
  ::close(descriptor);
  return std::nullopt;
}

Error too_large_to_read(const fs::path& file) {
  return file_error("'{}' needs more memory than is available, or is damaged", file.string());
}

void warn_of_ignored(Scene& scene) {
  std::set<std::string> ignored;
  for (const Material& material : scene.materials) ignored.insert(material.ignored.begin(), material.ignored.end());
  if (ignored.empty()) return;
  constexpr std::size_t kMaxShown = 32;  // more than readers know, apart from unknown words of the file
  const std::size_t shown = std::min(ignored.size(), kMaxShown);
  const auto end = std::next(ignored.begin(), std::ptrdiff_t(shown));
  scene.warnings.push_back(fmt::format(
      "the file's materials have properties that are not drawn: {}{}", fmt::join(ignored.begin(), end, ", "),
      shown < ignored.size() ? fmt::format(" and {} more", ignored.size() - shown) : ""));
}

Result<Scene> complete_import(Result<Scene> imported, const fs::path& file, const ImportSettings& settings,
                              Poll* poll) {
  if (!imported) return imported;
  Scene& scene = *imported;
  scene.name = file.filename().string();
  if (const std::string read_as = format_of_file(file), named = import_format(file); read_as != named)
    scene.warnings.insert(scene.warnings.begin(),
                          fmt::format("the file {}, but its content is .{}, which is read",
                                      named.empty() ? "has no ending" : "ends in ." + named, read_as));
  make_printable(scene);
  if (const float length = glm::length(settings.up); length > 0.0f && std::isfinite(length)) {
    scene.up = settings.up / length;
  }
  if (scene.meshes.empty()) return file_error("'{}' has no triangles and no points", file.string());
  for (Mesh& mesh : scene.meshes)
    if (mesh.points) mesh.indices.clear();
  const std::size_t triangles = scene.triangle_count(), points = scene.point_count();
  const DamagedTriangles damaged = count_damaged(scene);
  const auto warn = [&](std::size_t count, std::size_t of, const char* what) {
    if (count > 0) scene.warnings.push_back(fmt::format("{} of {} {} and are left out", count, of, what));
  };
  warn(damaged.out_of_range, triangles, "triangles have vertex indices out of range");
  if (std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) {
        const auto [low, high] = std::minmax_element(mesh.indices.begin(), mesh.indices.end());
        return low != mesh.indices.end() && *low == 1 && *high == mesh.positions.size();
      }))
    scene.warnings.push_back("vertex indices seem to count from 1; the format counts from 0");
  warn(damaged.not_finite, triangles, "triangles have coordinates that are not finite or above 1e15");
  if (settings.points.size.value > 0.0f)  // the user's size replaces that of the file
    for (Mesh& mesh : scene.meshes) mesh.radii.clear();
  const std::size_t zeros = mark_zero_points(scene);
  warn(zeros, points, "points are at exactly 0 0 0, outside of all others,");
  const std::size_t dropped =
      finish_scene(scene, settings.crease_angle_deg, settings.points, poll, BoundsOf::kAllButStrays);
  if (poll && poll->ended()) return interrupted();
  const std::size_t dropped_triangles = triangles - scene.triangle_count();
  separate_coplanar_faces(scene, poll);
  set_motion(std::move(scene.motion), scene);
  if (poll && poll->ended()) return interrupted();
  if (scene.meshes.empty() && points > 0) {
    return file_error("'{}' has no points that can be drawn; all {} are not finite", file.string(), points);
  }
  if (scene.meshes.empty()) {
    return file_error("'{}' has no triangles that can be drawn; all {} are degenerate or not finite", file.string(),
                      triangles);
  }
  if (show_if_invisible(scene))
    scene.warnings.push_back("all surfaces of the model are transparent in the file; they are drawn opaque");
  if (points > 0) warn(dropped - dropped_triangles - zeros, points, "points are not finite");
  constexpr std::size_t kWarnOneIn = 4;  // one in four; fewer are common in CAD and not visible
  const std::size_t degenerate = dropped_triangles - damaged.out_of_range - damaged.not_finite;
  if (degenerate * kWarnOneIn > triangles) warn(degenerate, triangles, "triangles are degenerate");
  return imported;
}

Result<void> check_scene_index(const ImportSettings& settings, const std::string& name, std::size_t count) {
  if (!settings.scene_index) return {};
  if (*settings.scene_index >= 0 && std::size_t(*settings.scene_index) < count) return {};
  return field_error("scene_index", *settings.scene_index, "`{}` cannot be '{}': '{}' has {}", name,
                     count == 1   ? "one scene, 0"
                     : count == 2 ? "two scenes, 0 and 1"
                                  : fmt::format("{} scenes, 0 to {}", count, count - 1));
}

Result<void> check_animation_index(const ImportSettings& settings, const std::string& name, std::size_t count) {
  if (!settings.animation_index) return {};
  if (*settings.animation_index >= 0 && std::size_t(*settings.animation_index) < count) return {};
  if (count == 0)
    return with_field(field_error("animation_index", *settings.animation_index,
                                  "'{2}' has no animation that is read; omit `{0}` and `animation_time`", name),
                      "animation_time");
  return field_error("animation_index", *settings.animation_index, "`{}` cannot be '{}': '{}' has {}", name,
                     count == 1   ? "one animation, 0"
                     : count == 2 ? "two animations, 0 and 1"
                                  : fmt::format("{} animations, 0 to {}", count, count - 1));
}

Result<Scene> import_scene(const fs::path& file, const ImportSettings& settings, const ProgressMonitor& monitor) {
  const std::string format = format_of_file(file);
  if (auto error = check_model_file(file, format)) return std::move(*error);
  if (format != "gltf" && format != "glb") {  // a file of another format is one scene
    const std::string name = file.filename().string();
    if (auto status = check_scene_index(settings, name, 1); !status) return status.error();
    if (auto status = check_animation_index(settings, name, 0); !status) return status.error();
  }
  try {
    constexpr double kRead = 0.5;  // approximate fraction of the work after reading the file
    Poll poll(monitor);
    poll.part(0.0, kRead);
    if (poll.ended()) return interrupted();
    auto own = import_own(file, format, settings.field, &poll);
    auto scene = own ? std::move(*own) : import_in_child_process(file, settings, &poll);
    poll.part(kRead, 1.0);
    scene = complete_import(std::move(scene), file, settings, &poll);
    if (scene && poll.ask(1.0)) return interrupted();
    if (!scene || scene->motion.empty() || !(settings.animation_time > 0.0f)) return scene;
    ImportSettings at_start = settings;
    at_start.animation_time = 0.0f;
    auto start = import_scene(file, at_start, [&](double) { return !monitor || monitor(1.0); });
    if (!start) return start;
    scene->start = std::make_shared<const Scene>(std::move(*start));
    return scene;
  } catch (const std::bad_alloc&) {
    return too_large_to_read(file);
  }
}

}  // namespace umbrage
