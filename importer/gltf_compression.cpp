// Compressed data of glTF files: buffer views by meshoptimizer [EXT_meshopt_compression] and primitives by Draco
// [KHR_draco_mesh_compression], decoded by their libraries.
#include <draco/compression/decode.h>
#include <meshoptimizer.h>

#include "importer/gltf_file.h"
#include "importer/gltf_parts.h"

namespace umbrage {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Returns the max size that `compressed` bytes can stand for, so that a wrong count does not allocate memory. The
/// codec of vertices packs 16 bytes into 2 bits or more, those of indices use a byte or more per triangle or index.
std::size_t max_decoded(const std::string& mode, std::size_t stride, std::size_t compressed) {
  constexpr std::size_t kVertexRatio = 64, kBlock = 256;
  if (mode == "ATTRIBUTES") return kVertexRatio * compressed + kBlock * stride;
  return (mode == "TRIANGLES" ? 3 : 1) * stride * compressed;
}

}  // namespace

Result<Bytes> decode_meshopt(const Json& compression, ByteSpan bytes) {
  const std::string mode = text_of(member(compression, "mode")), filter = text_of(member(compression, "filter"));
  const std::int64_t count = integer_of(member(compression, "count")),
                     stride = integer_of(member(compression, "byteStride"));
  const bool of_vertices = mode == "ATTRIBUTES";
  if (!of_vertices && mode != "TRIANGLES" && mode != "INDICES")
    return file_error("EXT_meshopt_compression has the unknown mode '{}'", mode);
  constexpr std::int64_t kMaxStride = 256;
  const bool fits = of_vertices ? stride >= 4 && stride <= kMaxStride && stride % 4 == 0 : stride == 2 || stride == 4;
  if (count < 0 || !fits || (mode == "TRIANGLES" && count % 3 != 0))
    return file_error("EXT_meshopt_compression of mode {} cannot have the count {} and the stride {}", mode, count,
                      stride);
  if (std::uint64_t(count) > max_decoded(mode, std::size_t(stride), bytes.size()) / std::size_t(stride))
    return file_error("{} elements cannot be in {} bytes of EXT_meshopt_compression", count, bytes.size());
  const std::size_t elements = std::size_t(count), size = std::size_t(stride);
  Bytes decoded(elements * size);
  int failed = 0;
  if (of_vertices)
    failed = meshopt_decodeVertexBuffer(decoded.data(), elements, size, bytes.data(), bytes.size());
  else if (mode == "TRIANGLES")
    failed = meshopt_decodeIndexBuffer(decoded.data(), elements, size, bytes.data(), bytes.size());
  else
    failed = meshopt_decodeIndexSequence(decoded.data(), elements, size, bytes.data(), bytes.size());
  if (elements > 0 && failed != 0)
    return file_error("data of EXT_meshopt_compression is damaged, or of a newer version");
  if (filter.empty() || filter == "NONE" || elements == 0) return decoded;
  if (filter == "OCTAHEDRAL" && of_vertices && (size == 4 || size == 8))
    meshopt_decodeFilterOct(decoded.data(), elements, size);
  else if (filter == "QUATERNION" && of_vertices && size == 8)
    meshopt_decodeFilterQuat(decoded.data(), elements, size);
  else if (filter == "EXPONENTIAL" && of_vertices)
    meshopt_decodeFilterExp(decoded.data(), elements, size);
  else
    return file_error("EXT_meshopt_compression has the unknown filter '{}' of stride {}", filter, stride);
  return decoded;
}

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
