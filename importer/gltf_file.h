// A glTF file: its JSON text, its buffers, and what was found wrong with it. Values of a wrong type or out of range
// never fail: they are counted, and a default is used.
//
// The JSON is read with nlohmann/json rather than tinygltf 2.7, which refuses whole files for one wrong property or for
// the buffers without data of EXT_meshopt_compression, and leaves sparse, quantized and compressed data to its caller.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace umbrage {

using Json = nlohmann::json;

/// Returns a member of an object, or null if it is missing or `object` is no object.
const Json& member(const Json& object, const char* name);
/// Returns an element of an array, or null.
const Json& element(const Json& list, std::size_t index);
/// Returns the number of elements of an array; 0 if it is none.
std::size_t count_of(const Json& list);
/// Returns a text, or an empty one if the value is none.
std::string text_of(const Json& value);
/// Returns a non-negative integer below 2^53, or -1.
std::int64_t integer_of(const Json& value);
/// Returns an index, or -1 if the value is none.
int index_of(const Json& value);
/// Returns the extension `name` of an object, or null.
const Json& extension_of(const Json& object, const char* name);

/// The place of an object in a file: "materials" and 3.
struct JsonPlace {
  const char* list = "";
  std::size_t index = 0;
};

/// The values of a file that are of a wrong type or out of range.
struct JsonFaults {
  std::size_t count = 0;
  std::string first;  ///< "materials[3].roughnessFactor"

  void add(const JsonPlace& place, const char* name);
};

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Returns the number `name` of an object, clamped to a range; `fallback` if it is missing.
double number_in(const Json& object, const char* name, double fallback, double low, double high, const JsonPlace& place,
                 JsonFaults& faults);

/// Returns an array of numbers, each clamped to a range; `fallback` if it is missing or has fewer numbers.
template <std::size_t N>
std::array<double, N> numbers_in(const Json& object, const char* name, const std::array<double, N>& fallback,
                                 double low, double high, const JsonPlace& place, JsonFaults& faults) {
  const Json& list = member(object, name);
  if (list.is_null()) return fallback;
  std::array<double, N> numbers = fallback;
  bool fits = count_of(list) >= N;
  for (std::size_t k = 0; fits && k < N; ++k) {
    fits = list[k].is_number();
    if (fits) numbers[k] = list[k].template get<double>();
  }
  if (!fits) numbers = fallback;
  bool in_range = true;
  for (double& v : numbers) {
    in_range = in_range && v >= low && v <= high;
    v = v < low ? low : v > high ? high : v;
  }
  if (!fits || !in_range) faults.add(place, name);
  return numbers;
}

/// Returns three numbers as a colour, 0 to `high`.
glm::vec3 color_in(const Json& object, const char* name, double fallback, double high, const JsonPlace& place,
                   JsonFaults& faults);

/// Returns a non-negative integer; `fallback` if it is missing or not one.
std::int64_t integer_in(const Json& object, const char* name, std::int64_t fallback, const JsonPlace& place,
                        JsonFaults& faults);

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
