// Buffer views compressed with meshoptimizer [EXT_meshopt_compression], decoded by its library.
#include <meshoptimizer.h>

#include "importer/gltf_file.h"

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

}  // namespace umbrage
