// A glTF file: its JSON text, its buffers, and what was found wrong with it.
//
// The JSON is read with nlohmann/json rather than tinygltf 2.7, which refuses whole files for one wrong property or for
// the buffers without data of EXT_meshopt_compression, and leaves sparse, quantized and compressed data to its caller.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "importer/gltf_json.h"

namespace umbrage {

using ByteSpan = std::span<const std::uint8_t>;

struct GltfFile {
  std::filesystem::path path;
  Json json;
  std::string bytes;              ///< of the whole file
  std::optional<ByteSpan> chunk;  ///< the binary chunk of a GLB file
  JsonFaults faults;
  std::vector<std::string> warnings;

  /// The number of bytes that have been read from files and data URIs.
  std::size_t byte_count() const;
  /// Adds a sentence to `warnings` unless there is one with this key.
  void warn_once(const std::string& key, const std::string& sentence);
  /// Returns an element of one of the file's lists: list("meshes", 3).
  const Json& list(const char* name, std::size_t index) const { return element(member(json, name), index); }

  /// Returns the bytes of a buffer. Errors: kFile if they do not exist or are too few.
  Result<ByteSpan> buffer(int index);
  /// Returns the bytes of a buffer view, decompressed. Errors: kFile.
  Result<ByteSpan> buffer_view(int index);
  /// Returns the distance of elements in a buffer view, bytes; 0 if the file gives none.
  std::size_t stride_of_view(int index) const;

  std::map<int, Result<std::vector<std::uint8_t>>> buffers;  ///< those that have been read
  std::map<int, Result<std::vector<std::uint8_t>>> views;    ///< compressed ones that have been decoded
  std::set<std::string> warned;
};

/// Reads the JSON text of a .gltf or .glb file. Errors: kFile with one sentence.
Result<GltfFile> open_gltf(const std::filesystem::path& path);

/// Returns whether the file is glTF 1.0, whose JSON is another one.
bool is_first_version(const GltfFile& file);

/// Returns the bytes that a text in base64 stands for; nothing if it has other letters.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);

/// Returns the bytes of a data URI; nothing if the URI is none. Errors: kFile if its text is not base64.
std::optional<Result<std::vector<std::uint8_t>>> data_of_uri(const std::string& uri);

/// Decodes a buffer view of EXT_meshopt_compression or KHR_meshopt_compression. Errors: kFile.
Result<std::vector<std::uint8_t>> decode_meshopt(const Json& compression, ByteSpan bytes);

}  // namespace umbrage
