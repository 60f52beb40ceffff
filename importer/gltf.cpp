// Reads glTF 2.0 [glTF 2.0]: nodes, meshes, materials and cameras become a Scene.
#include "importer/readers.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <set>

#include "importer/gltf_nodes.h"
#include "importer/gltf_parts.h"
#include "scene/framing.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/positions.h"

namespace umbrage {
namespace {

/// What read_gltf has read so far.
struct Build {
  GltfFile& file;
  const ImportSettings& settings;
  Scene scene = {};
  std::vector<GltfNode> nodes = {};
  std::vector<glm::dmat4> world = {};
  PoseNodes pose = {};  ///< of the chosen animation; empty: none is chosen
  std::vector<int> drawn_nodes = {};
  GltfMaterials materials = {};
  GltfMeshRules rules = {};
  GltfCounts counts = {};
  std::vector<PlacedMesh> meshes = {};
  std::map<int, std::vector<Result<GltfPrimitive>>> known = {};  ///< meshes with their default weights
  std::string first_problem = {};
  std::set<std::string> names_not_drawn = {};
  bool skips_not_drawn = true;
};

std::vector<float> default_weights(const Json& mesh) {
  std::vector<float> weights;
  const Json& list = member(mesh, "weights");
  for (std::size_t k = 0; k < count_of(list); ++k) weights.push_back(list[k].is_number() ? list[k].get<float>() : 0.0f);
  return weights;
}

std::vector<Result<GltfPrimitive>> read_mesh(Build& build, int index, const std::vector<float>& node_weights) {
  const Json& mesh = build.file.list("meshes", std::size_t(index));
  const auto weights = node_weights.empty() ? default_weights(mesh) : node_weights;
  std::vector<Result<GltfPrimitive>> primitives;
  for (std::size_t p = 0; p < count_of(member(mesh, "primitives")); ++p)
    primitives.push_back(read_primitive(build.file, mesh, p, weights, build.rules, build.counts));
  for (const auto& primitive : primitives) {
    if (primitive || primitive.error().message.empty()) continue;
    const std::string& reason = primitive.error().message;
    if (build.first_problem.empty()) build.first_problem = reason;
    build.file.warn_once("primitive", fmt::format("a part of the mesh '{}' cannot be read and is left out: {}",
                                                  text_of(member(mesh, "name")), reason));
  }
  return primitives;
}

/// Adds the primitives of a node's mesh, each at all of its instances.
void add_mesh(Build& build, int node_index, int mesh_index, int& object) {
  GltfFile& file = build.file;
  const auto node = std::size_t(node_index);
  const Json& json = file.list("nodes", node);
  std::vector<Result<GltfPrimitive>> own;
  const std::vector<Result<GltfPrimitive>>* primitives = &own;
  if (build.nodes[node].weights.empty()) {
    auto found = build.known.find(mesh_index);
    if (found == build.known.end()) found = build.known.emplace(mesh_index, read_mesh(build, mesh_index, {})).first;
    primitives = &found->second;
  } else {
    own = read_mesh(build, mesh_index, build.nodes[node].weights);
  }
  std::vector<glm::dmat4> joints;
  if (const Json& skin = member(json, "skin"); !skin.is_null()) {
    auto read = transforms_of_skin(file, index_of(skin), build.world);
    if (read)
      joints = std::move(*read);
    else
      file.warn_once("skin",
                     fmt::format("a skin cannot be used, its mesh is shown without it: {}", read.error().message));
  }
  for (const glm::dmat4& instance : instances_of(file, json)) {
    bool has_mesh = false;
    for (const auto& primitive : *primitives) {
      if (!primitive) continue;
      const auto material = std::size_t(primitive->mesh.material);
      if (build.skips_not_drawn && build.materials.not_drawn[material]) {
        build.names_not_drawn.insert(text_of(member(file.list("materials", material), "name")));
        continue;
      }
      if (primitive->has_alpha && build.materials.uses_alpha[material])
        file.warn_once("COLOR_0 alpha", "transparency in the colours of vertices is not drawn");
      const bool is_skinned = !joints.empty() && !primitive->joints.empty();
      PlacedMesh mesh =
          is_skinned ? skinned(*primitive, joints) : placed(primitive->mesh, build.world[node] * instance);
      if (mesh.mesh.name.empty()) mesh.mesh.name = text_of(member(json, "name"));
      mesh.mesh.object = object;
      has_mesh = true;
      build.meshes.push_back(std::move(mesh));
    }
    if (has_mesh) ++object;
  }
}

/// Adds all meshes of the scene. A file without nodes shows its meshes.
void add_meshes(Build& build) {
  GltfFile& file = build.file;
  int object = 0;
  if (build.nodes.empty()) {
    build.nodes.emplace_back();
    build.world.emplace_back(1.0);
    for (std::size_t m = 0; m < count_of(member(file.json, "meshes")); ++m) add_mesh(build, 0, int(m), object);
    return;
  }
  for (const int node : build.drawn_nodes) {
    const Json& mesh = member(file.list("nodes", std::size_t(node)), "mesh");
    if (mesh.is_null()) continue;
    const int index = index_of(mesh);
    if (index < 0 || !file.list("meshes", std::size_t(index)).is_object())
      file.faults.add({"nodes", std::size_t(node)}, "mesh");
    else
      add_mesh(build, node, index, object);
  }
}

/// Adds the cameras of the scene, in the order of its nodes.
void add_cameras(Build& build) {
  GltfFile& file = build.file;
  constexpr double kMaxAngle = 3.1415;
  for (const int node : build.drawn_nodes) {
    const Json& json = file.list("nodes", std::size_t(node));
    const int index = index_of(member(json, "camera"));
    const Json& camera = file.list("cameras", std::size_t(index));
    const glm::dmat4& world = build.world[std::size_t(node)];
    const glm::dvec3 along = -glm::dvec3(world[2]), up(world[1]), eye = glm::dvec3(world[3]) - build.scene.origin;
    if (index < 0 || !camera.is_object() || !(glm::length(along) > 0.0) || !(glm::length(up) > 0.0)) continue;
    const JsonPlace place{"cameras", std::size_t(index)};
    View view;
    view.name = text_of(member(camera, "name"));
    if (view.name.empty()) view.name = text_of(member(json, "name"));
    view.eye = glm::vec3(eye);
    view.target = glm::vec3(eye + glm::normalize(along));
    view.up = glm::vec3(glm::normalize(up));
    if (const Json& parallel = member(camera, "orthographic"); parallel.is_object())
      view.height = 2.0f * float(number_in(parallel, "ymag", 1.0, 1e-30, 1e30, place, file.faults));
    else
      view.angle_deg =
          float(glm::degrees(number_in(member(camera, "perspective"), "yfov", glm::radians(double(view.angle_deg)),
                                       1e-4, kMaxAngle, place, file.faults)));
    build.scene.cameras.push_back(std::move(view));
  }
}

void add_lights(Build& build) {
  GltfFile& file = build.file;
  const std::size_t count = count_of(member(extension_of(file.json, "KHR_lights_punctual"), "lights"));
  if (count == 0) return;
  if (build.settings.file_lights) return add_gltf_lights(file, build.drawn_nodes, build.world, build.scene);
  file.warnings.push_back(
      fmt::format("the file's {} not used (KHR_lights_punctual): looks have their own; `lights` "
                  "'file' uses {}",
                  count == 1 ? "light is" : "lights are", count == 1 ? "it" : "them"));
}

/// Moves the nodes to a time of the chosen animation.
void set_pose(Build& build, double time_s) {
  if (build.pose) build.pose(time_s, build.nodes);
  build.world = world_matrices(build.nodes);
}

/// Chooses the scene and the pose. Errors: kUsage.
Result<void> choose_scene(Build& build) {
  GltfFile& file = build.file;
  Scene& scene = build.scene;
  const std::string name = file.path.filename().string();
  const Json& scenes = member(file.json, "scenes");
  const std::size_t count = count_of(scenes);
  if (auto status = check_scene_index(build.settings, name, std::max<std::size_t>(count, 1)); !status) return status;
  std::int64_t index = integer_in(file.json, "scene", 0, {"scene", 0}, file.faults);
  if (count > 0 && std::size_t(index) >= count) {
    file.faults.add({"scene", 0}, "index");
    index = 0;
  }
  scene.scene_index = build.settings.scene_index.value_or(int(index));
  if (count > 1) {
    for (const Json& each : scenes) scene.scene_names.push_back(text_of(member(each, "name")));
    if (!build.settings.scene_index)
      file.warn_once("scenes", fmt::format("the file has {} scenes; its default scene, or else the first, is drawn; "
                                           "`scene_index` selects another",
                                           count));
  }
  const auto animations = list_animations(file);
  for (const GltfAnimation& each : animations) {
    scene.animation_names.push_back(each.name);
    scene.animation_durations_s.push_back(each.duration_s);
  }
  if (auto status = check_animation_index(build.settings, name, animations.size()); !status) return status;
  build.nodes = read_nodes(file);
  build.drawn_nodes = nodes_of_scene(file, scene.scene_index, build.nodes);
  if (build.settings.animation_index)
    build.pose = read_animation(file, *build.settings.animation_index, build.nodes.size());
  set_pose(build, double(build.settings.animation_time));
  if (build.settings.animation_index) {
    const double end_s = scene.animation_durations_s[std::size_t(*build.settings.animation_index)];
    if (double(build.settings.animation_time) > end_s)
      file.warnings.push_back(fmt::format("the animation ends after {:.4g} s; its last pose is drawn", end_s));
  }
  return {};
}

/// Adds the vertices of a mesh's triangles, or its points.
void add_vertices(const PlacedMesh& placed, FarthestPoints& farthest) {
  const Mesh& mesh = placed.mesh;
  std::vector<std::uint8_t> used(mesh.positions.size(), mesh.points);
  for (const std::uint32_t index : mesh.indices) used[index] = 1;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) farthest.add(placed.positions.empty() ? glm::dvec3(mesh.positions[i]) : placed.positions[i]);
}

/// Returns points around the meshes in poses of the whole animation. The poses do not depend on the time that is drawn.
std::vector<glm::dvec3> motion_of(Build& build) {
  // Placing this number of vertices takes a fraction of a second; larger models are placed kMinPoses times.
  constexpr std::size_t kMaxVertices = 2'000'000, kMinPoses = 4, kMaxPoses = 256;
  if (!build.pose) return {};
  std::vector<PlacedMesh> meshes = std::move(build.meshes);
  const GltfCounts counts = build.counts;
  std::size_t vertices = 1;
  for (const PlacedMesh& each : meshes) vertices += each.mesh.positions.size();
  for (auto& [index, primitives] : build.known)
    for (Result<GltfPrimitive>& each : primitives)
      if (each)
        each->mesh.normals = {}, each->mesh.uvs = {}, each->mesh.colors = {}, each->mesh.smoothing = {},
        each->mesh.fields = {};
  const std::size_t poses = std::clamp(kMaxVertices / vertices, kMinPoses, kMaxPoses);
  const double duration_s = build.scene.animation_durations_s[std::size_t(*build.settings.animation_index)];
  FarthestPoints farthest;
  for (std::size_t k = 0; k < poses; ++k) {
    set_pose(build, duration_s * double(k) / double(poses - 1));
    build.meshes.clear();
    add_meshes(build);
    for (const PlacedMesh& each : build.meshes) add_vertices(each, farthest);
  }
  set_pose(build, double(build.settings.animation_time));
  build.meshes = std::move(meshes);
  build.counts = counts;
  return farthest.points();
}

void list_materials(Build& build) {
  build.materials = list_gltf_materials(build.file);
  build.rules.placements = build.materials.placements;
  build.rules.has_borders = build.materials.has_borders;
  build.rules.default_material = int(build.materials.placements.size()) - 1;
  build.rules.flat = !build.settings.crease_angle_deg;
  build.rules.field = build.settings.field;
}

void add_warnings(Build& build) {
  GltfFile& file = build.file;
  Scene& scene = build.scene;
  for (const std::string& name : build.names_not_drawn)
    file.warnings.push_back(fmt::format("surfaces of the material '{}' are transparent and are not drawn", name));
  if (build.counts.out_of_range > 0)
    file.warnings.push_back(fmt::format("{} of {} triangles have vertex indices out of range and are left out",
                                        build.counts.out_of_range, build.counts.triangles));
  if (file.faults.count > 0)
    file.warnings.push_back(
        fmt::format("{} of the file {} of a wrong type or out of range, and a valid one is used: {}",
                    file.faults.count == 1 ? "one value" : fmt::format("{} values", file.faults.count),
                    file.faults.count == 1 ? "is" : "are", file.faults.first));
  warn_of_ignored(scene);
  scene.warnings.insert(scene.warnings.end(), file.warnings.begin(), file.warnings.end());
}

Result<Scene> build_scene(GltfFile& file, const ImportSettings& settings) {
  Build build{file, settings};
  build.scene.has_front = true;
  const std::string name = file.path.string();
  if (auto status = choose_scene(build); !status) return status.error();
  warn_of_extensions(file);
  list_materials(build);
  add_meshes(build);
  if (build.meshes.empty() && !build.names_not_drawn.empty()) {
    // If nothing has a material that is drawn, everything is.
    build.skips_not_drawn = false;
    build.names_not_drawn.clear();
    add_meshes(build);
  }
  if (build.meshes.empty() && !build.first_problem.empty())
    return file_error("'{}' cannot be read as glTF ({})", name, build.first_problem);
  if (build.meshes.empty() && build.counts.out_of_range > 0)
    return file_error("'{}' has no triangles that can be drawn; all {} have vertex indices out of range", name,
                      build.counts.out_of_range);
  const std::vector<glm::dvec3> motion = motion_of(build);
  move_to_scene(std::move(build.meshes), build.scene, motion);
  read_gltf_materials(file, build.materials, smallest_footprints(build.scene, build.materials.images, settings),
                      build.scene);
  add_cameras(build);
  add_lights(build);
  const bool uses_default = std::any_of(build.scene.meshes.begin(), build.scene.meshes.end(), [&](const Mesh& mesh) {
    return mesh.material == build.rules.default_material;
  });
  if (!uses_default) build.scene.materials.pop_back();
  drop_unused_textures(build.scene);
  add_warnings(build);
  return std::move(build.scene);
}

}  // namespace

std::optional<Result<Scene>> read_gltf(const std::filesystem::path& path, const ImportSettings& settings) {
  auto file = open_gltf(path);
  if (!file) return file.error();
  if (is_first_version(*file)) return std::nullopt;
  return build_scene(*file, settings);
}

}  // namespace umbrage
