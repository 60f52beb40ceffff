#include "importer/gltf_skin.h"

#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "importer/gltf_accessor.h"

namespace umbrage {

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
