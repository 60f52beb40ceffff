#include "importer/gltf_nodes.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "importer/gltf_accessor.h"

namespace umbrage {
namespace {

constexpr double kMaxNumber = 1e30;

GltfNode node_of(GltfFile& file, const Json& json, std::size_t index) {
  const JsonPlace place{"nodes", index};
  GltfNode node;
  if (!member(json, "matrix").is_null()) {
    std::array<double, 16> identity{};
    for (std::size_t k = 0; k < 16; k += 5) identity[k] = 1.0;
    const auto m = numbers_in<16>(json, "matrix", identity, -kMaxNumber, kMaxNumber, place, file.faults);
    glm::dmat4 matrix;
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) matrix[column][row] = m[std::size_t(4 * column + row)];
    node.matrix = matrix;
  }
  const auto t = numbers_in<3>(json, "translation", {}, -kMaxNumber, kMaxNumber, place, file.faults);
  const auto s = numbers_in<3>(json, "scale", {1.0, 1.0, 1.0}, -kMaxNumber, kMaxNumber, place, file.faults);
  const auto r = numbers_in<4>(json, "rotation", {0.0, 0.0, 0.0, 1.0}, -kMaxNumber, kMaxNumber, place, file.faults);
  node.translation = {t[0], t[1], t[2]};
  node.scale = {s[0], s[1], s[2]};
  node.rotation = glm::dquat(r[3], r[0], r[1], r[2]);
  const double length = glm::length(node.rotation);
  node.rotation = length > 0.0 ? node.rotation / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
  const Json& weights = member(json, "weights");
  for (std::size_t k = 0; k < count_of(weights); ++k)
    node.weights.push_back(weights[k].is_number() ? weights[k].get<float>() : 0.0f);
  return node;
}

glm::dmat4 matrix_of(const GltfNode& node) {
  if (node.matrix) return *node.matrix;
  glm::dmat4 m = glm::mat4_cast(node.rotation);
  for (int axis = 0; axis < 3; ++axis) m[axis] *= node.scale[axis];
  m[3] = glm::dvec4(node.translation, 1.0);
  return m;
}

bool is_visible(const Json& node) {
  const Json& visible = member(extension_of(node, "KHR_node_visibility"), "visible");
  return !visible.is_boolean() || visible.get<bool>();
}

}  // namespace

void split_matrix(GltfNode& node) {
  if (!node.matrix) return;
  glm::dmat3 turn(*node.matrix);
  node.translation = glm::dvec3((*node.matrix)[3]);
  for (int axis = 0; axis < 3; ++axis) {
    node.scale[axis] = glm::length(turn[axis]);
    if (node.scale[axis] > 0.0) turn[axis] /= node.scale[axis];
  }
  if (glm::determinant(turn) < 0.0) {
    node.scale.x = -node.scale.x;
    turn[0] = -turn[0];
  }
  node.rotation = glm::quat_cast(turn);
  node.matrix.reset();
}

std::vector<GltfNode> read_nodes(GltfFile& file) {
  const Json& list = member(file.json, "nodes");
  std::vector<GltfNode> nodes;
  for (std::size_t k = 0; k < count_of(list); ++k) nodes.push_back(node_of(file, list[k], k));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Json& children = member(list[k], "children");
    for (std::size_t c = 0; c < count_of(children); ++c) {
      const int child = index_of(children[c]);
      if (child < 0 || std::size_t(child) >= nodes.size() || nodes[std::size_t(child)].parent >= 0)
        file.faults.add({"nodes", k}, "children");
      else
        nodes[std::size_t(child)].parent = int(k);
    }
  }
  // In an invalid file a node may be its own ancestor: more steps than there are nodes show it.
  std::vector<bool> has_root(nodes.size(), false);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    std::vector<std::size_t> way;
    std::size_t at = k;
    while (!has_root[at] && way.size() <= nodes.size()) {
      way.push_back(at);
      if (nodes[at].parent < 0) break;
      at = std::size_t(nodes[at].parent);
    }
    if (way.size() > nodes.size()) {
      nodes[k].parent = -1;
      file.faults.add({"nodes", k}, "children");
    }
    for (const std::size_t each : way) has_root[each] = true;
  }
  return nodes;
}

std::vector<glm::dmat4> world_matrices(const std::vector<GltfNode>& nodes) {
  std::vector<glm::dmat4> world(nodes.size(), glm::dmat4(1.0));
  std::vector<bool> known(nodes.size(), false);
  std::vector<int> way;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    for (int at = int(k); at >= 0 && !known[std::size_t(at)]; at = nodes[std::size_t(at)].parent) way.push_back(at);
    for (; !way.empty(); way.pop_back()) {
      const GltfNode& node = nodes[std::size_t(way.back())];
      const glm::dmat4 parent = node.parent < 0 ? glm::dmat4(1.0) : world[std::size_t(node.parent)];
      world[std::size_t(way.back())] = parent * matrix_of(node);
      known[std::size_t(way.back())] = true;
    }
  }
  return world;
}

std::vector<int> nodes_of_scene(GltfFile& file, int scene, const std::vector<GltfNode>& nodes) {
  std::vector<int> stack, order;
  const Json& list = member(file.json, "nodes");
  const auto push_all = [&](const Json& children) {
    for (std::size_t k = count_of(children); k-- > 0;)
      if (const int node = index_of(children[k]); node >= 0 && std::size_t(node) < nodes.size()) stack.push_back(node);
  };
  if (count_of(member(file.json, "scenes")) > 0) {
    push_all(member(file.list("scenes", std::size_t(scene)), "nodes"));
  } else {
    for (std::size_t k = nodes.size(); k-- > 0;)
      if (nodes[k].parent < 0) stack.push_back(int(k));
  }
  std::vector<bool> visited(nodes.size(), false);
  while (!stack.empty()) {
    const auto node = std::size_t(stack.back());
    stack.pop_back();
    if (visited[node] || !is_visible(list[node])) continue;
    visited[node] = true;
    order.push_back(int(node));
    push_all(member(list[node], "children"));
  }
  return order;
}

// ---- skins and instances: the transforms that nodes give to their meshes

Result<std::vector<glm::dmat4>> transforms_of_skin(GltfFile& file, int index, const std::vector<glm::dmat4>& world) {
  const Json& skin = file.list("skins", std::size_t(index));
  const Json& joints = member(skin, "joints");
  if (index < 0 || count_of(joints) == 0) return file_error("it has no skin {} with joints", index);
  std::optional<GltfNumbers> inverse_bind;
  if (const Json& accessor = member(skin, "inverseBindMatrices"); !accessor.is_null()) {
    auto read = read_numbers(file, index_of(accessor), 16, 16);
    if (!read) return read.error();
    if (read->count < count_of(joints))
      return file_error("the skin {} has {} joints and {} matrices", index, count_of(joints), read->count);
    inverse_bind = std::move(*read);
  }
  std::vector<glm::dmat4> transforms;
  for (std::size_t k = 0; k < count_of(joints); ++k) {
    const int node = index_of(joints[k]);
    if (node < 0 || std::size_t(node) >= world.size())
      return file_error("the skin {} has a joint that is no node", index);
    glm::dmat4 bind(1.0);
    for (int column = 0; inverse_bind && column < 4; ++column)
      for (int row = 0; row < 4; ++row) bind[column][row] = double(inverse_bind->at(k)[4 * column + row]);
    transforms.push_back(world[std::size_t(node)] * bind);
  }
  return transforms;
}

std::vector<glm::dmat4> instances_of(GltfFile& file, const Json& node) {
  const Json& extension = extension_of(node, "EXT_mesh_gpu_instancing");
  if (!extension.is_object()) return {glm::dmat4(1.0)};
  std::optional<GltfNumbers> parts[3];
  constexpr const char* kNames[] = {"TRANSLATION", "ROTATION", "SCALE"};
  std::size_t count = 0;
  bool is_first = true;
  for (int p = 0; p < 3; ++p) {
    const Json& accessor = member(member(extension, "attributes"), kNames[p]);
    if (accessor.is_null()) continue;
    const int width = p == 1 ? 4 : 3;
    auto read = read_numbers(file, index_of(accessor), width, width);
    if (!read) {
      file.warn_once("instances",
                     fmt::format("{} of EXT_mesh_gpu_instancing cannot be used: {}", kNames[p], read.error().message));
      continue;
    }
    count = is_first ? read->count : std::min(count, read->count);
    is_first = false;
    parts[p] = std::move(*read);
  }
  if (is_first) return {glm::dmat4(1.0)};
  std::vector<glm::dmat4> instances(count, glm::dmat4(1.0));
  for (std::size_t i = 0; i < count; ++i) {
    if (parts[1]) {
      const float* r = parts[1]->at(i);
      const glm::dquat rotation(r[3], r[0], r[1], r[2]);
      if (const double length = glm::length(rotation); length > 0.0) instances[i] = glm::mat4_cast(rotation / length);
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (parts[2]) instances[i][axis] *= double(parts[2]->at(i)[axis]);
      if (parts[0]) instances[i][3][axis] = double(parts[0]->at(i)[axis]);
    }
  }
  return instances;
}

}  // namespace umbrage
