#include "importer/gltf_draco.h"

#include <draco/compression/decode.h>

namespace umbrage {
namespace {

/// Returns an attribute as numbers. The accessor says whether its integers are normalised.
GltfNumbers numbers_of(draco::Mesh& mesh, int attribute_id, const Json& accessor) {
  draco::PointAttribute& attribute = *mesh.attribute(attribute_id);
  attribute.set_normalized(false);
  const Json& flag = member(accessor, "normalized");
  const bool is_normalized = flag.is_boolean() && flag.get<bool>();
  const int component = index_of(member(accessor, "componentType"));
  GltfNumbers numbers{.count = mesh.num_points(), .width = attribute.num_components()};
  numbers.values.resize(numbers.count * std::size_t(numbers.width));
  float* to = numbers.values.data();
  for (std::uint32_t point = 0; point < mesh.num_points(); ++point, to += numbers.width) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(point));
    if (value.value() >= attribute.size()) continue;
    attribute.ConvertValue<float>(value, std::int8_t(numbers.width), to);
    for (int k = 0; is_normalized && k < numbers.width; ++k) to[k] = normalized(double(to[k]), component);
  }
  return numbers;
}

}  // namespace

Result<DracoPrimitive> decode_draco(GltfFile& file, const Json& primitive) {
  const Json& extension = extension_of(primitive, "KHR_draco_mesh_compression");
  const auto bytes = file.buffer_view(index_of(member(extension, "bufferView")));
  if (!bytes) return bytes.error();
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    return file_error("data of KHR_draco_mesh_compression is damaged ({})", decoded.status().error_msg_string());
  draco::Mesh& mesh = *decoded.value();
  DracoPrimitive result;
  result.indices.reserve(std::size_t(mesh.num_faces()) * 3);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) result.indices.push_back(point.value());
  const Json& attributes = member(extension, "attributes");
  if (!attributes.is_object()) return file_error("KHR_draco_mesh_compression lists no attributes");
  for (const auto& [name, id] : attributes.items()) {
    const int index = mesh.GetAttributeIdByUniqueId(std::uint32_t(std::max(index_of(id), 0)));
    if (index < 0) return file_error("data of KHR_draco_mesh_compression lacks the attribute {}", name);
    const int accessor = index_of(member(member(primitive, "attributes"), name.c_str()));
    result.attributes[name] = numbers_of(mesh, index, file.list("accessors", std::size_t(accessor)));
  }
  return result;
}

}  // namespace umbrage
