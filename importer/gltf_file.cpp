// The container of glTF 2.0 files: GLB, buffers, data URIs, buffer views.
#include "importer/gltf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "importer/importer.h"
#include "importer/texture_cache.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Finds the chunks of a GLB file. Returns the JSON text.
Result<std::string_view> chunks_of_glb(GltfFile& file) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  const std::string name = file.path.string();
  const std::string& bytes = file.bytes;
  if (bytes.size() < kHeader + kChunkHeader)
    return file_error("'{}' cannot be read as glTF (it is cut short within its header)", name);
  const std::uint32_t version = word_at(bytes, 4), length = word_at(bytes, 8);
  if (version == 1) return std::string_view();  // glTF 1.0
  if (version != 2) return file_error("'{}' cannot be read as glTF (version {} is unknown; 2 is read)", name, version);
  if (length > bytes.size())
    return file_error("'{}' cannot be read as glTF (it is cut short: {} of {} bytes are there)", name, bytes.size(),
                      length);
  std::optional<std::string_view> text;
  for (std::size_t at = kHeader; at + kChunkHeader <= bytes.size();) {
    const std::size_t size = word_at(bytes, at), start = at + kChunkHeader;
    const std::uint32_t type = word_at(bytes, at + 4);
    if (size > bytes.size() - start)
      return file_error("'{}' cannot be read as glTF (it is cut short: a chunk of {} bytes has only {})", name, size,
                        bytes.size() - start);
    if (type == kJsonChunk && !text) text = std::string_view(bytes).substr(start, size);
    if (type == kBinaryChunk && !file.chunk)
      file.chunk = ByteSpan(reinterpret_cast<const std::uint8_t*>(bytes.data()) + start, size);
    if (at == kHeader && !text) break;
    at = start + size;
    if (at >= length) break;
  }
  if (!text) return file_error("'{}' cannot be read as glTF (its first chunk is not JSON)", name);
  return *text;
}

/// Returns the value of a base64 letter, or -1.
int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // '-' and '_': the alphabet for URLs
  return c == '/' || c == '_' ? 63 : -1;
}

/// Reads the bytes of a buffer that is not the binary chunk.
Result<Bytes> bytes_of_uri(const GltfFile& file, const std::string& uri) {
  if (auto data = data_of_uri(uri)) return std::move(*data);
  const auto path = find_referenced_file(file.path.parent_path(), uri);
  if (!path) return file_error("its buffer '{}' does not exist", uri);
  raise_limits_for(*path);
  const auto read = read_whole_file(*path);
  if (!read) return file_error("its buffer '{}' cannot be read", uri);
  return Bytes(read->begin(), read->end());
}

/// Returns `whole`, cut to a part. Errors: kFile if it is not inside.
Result<ByteSpan> part_of(ByteSpan whole, const Json& view, int index) {
  const std::int64_t offset = std::max(integer_of(member(view, "byteOffset")), std::int64_t(0)),
                     length = integer_of(member(view, "byteLength"));
  if (length < 0) return file_error("its buffer view {} has no byteLength", index);
  if (std::size_t(offset) > whole.size() || std::size_t(length) > whole.size() - std::size_t(offset))
    return file_error("its buffer view {} ends {} bytes past the end of its buffer", index,
                      offset + length - std::int64_t(whole.size()));
  return whole.subspan(std::size_t(offset), std::size_t(length));
}

const Json& meshopt_of(const Json& view) {
  const Json& compression = extension_of(view, "EXT_meshopt_compression");
  return compression.is_object() ? compression : extension_of(view, "KHR_meshopt_compression");
}

}  // namespace

std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text) {
  std::array<std::int8_t, 256> values;
  for (int c = 0; c < 256; ++c) values[std::size_t(c)] = std::int8_t(base64_value(char(c)));
  while (!text.empty() && (text.back() == '=' || text.back() == '\n')) text.remove_suffix(1);
  Bytes bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) {
      if (c == '\n' || c == '\r' || c == ' ') continue;
      return std::nullopt;
    }
    bits = bits << 6 | std::uint32_t(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(std::uint8_t(bits >> count));
  }
  return bytes;
}

std::size_t GltfFile::byte_count() const {
  std::size_t count = bytes.size();
  for (const auto& [index, buffer] : buffers)
    if (buffer) count += buffer->size();
  return count;
}

void GltfFile::warn_once(const std::string& key, const std::string& sentence) {
  if (warned.insert(key).second) warnings.push_back(sentence);
}

std::optional<Result<Bytes>> data_of_uri(const std::string& uri) {
  if (!uri.starts_with("data:")) return std::nullopt;
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) return file_error("a data URI has no data");
  const std::string_view kind = std::string_view(uri).substr(0, comma), text = std::string_view(uri).substr(comma + 1);
  if (!kind.ends_with(";base64")) {
    const std::string plain = without_escapes(std::string(text));
    return Bytes(plain.begin(), plain.end());
  }
  auto bytes = from_base64(text.find('%') == std::string_view::npos ? text : without_escapes(std::string(text)));
  if (!bytes) return file_error("a data URI is not base64");
  return std::move(*bytes);
}

Result<ByteSpan> GltfFile::buffer(int index) {
  const Json& buffer = list("buffers", std::size_t(index));
  if (index < 0 || !buffer.is_object()) return file_error("it has no buffer {}", index);
  const std::string uri = text_of(member(buffer, "uri"));
  ByteSpan bytes;
  if (uri.empty()) {
    if (!chunk || index != 0) return file_error("its buffer {} has no data", index);
    bytes = *chunk;
  } else {
    auto known = buffers.find(index);
    if (known == buffers.end()) known = buffers.emplace(index, bytes_of_uri(*this, uri)).first;
    if (!known->second) return known->second.error();
    bytes = *known->second;
  }
  // A buffer that is shorter than it says may still hold all that is used.
  if (const std::int64_t length = integer_of(member(buffer, "byteLength"));
      length >= 0 && std::size_t(length) < bytes.size())
    bytes = bytes.first(std::size_t(length));
  return bytes;
}

Result<ByteSpan> GltfFile::buffer_view(int index) {
  const Json& view = list("bufferViews", std::size_t(index));
  if (index < 0 || !view.is_object()) return file_error("it has no buffer view {}", index);
  const Json& compression = meshopt_of(view);
  if (!compression.is_object()) {
    const auto whole = buffer(index_of(member(view, "buffer")));
    return whole ? part_of(*whole, view, index) : whole.error();
  }
  auto known = views.find(index);
  if (known == views.end()) {
    const auto whole = buffer(index_of(member(compression, "buffer")));
    const auto part = whole ? part_of(*whole, compression, index) : whole.error();
    known = views.emplace(index, part ? decode_meshopt(compression, *part) : part.error()).first;
  }
  if (!known->second) return known->second.error();
  return ByteSpan(*known->second);
}

std::size_t GltfFile::stride_of_view(int index) const {
  const Json& view = list("bufferViews", std::size_t(index));
  std::int64_t stride = integer_of(member(view, "byteStride"));
  if (stride <= 0 && text_of(member(meshopt_of(view), "mode")) == "ATTRIBUTES")
    stride = integer_of(member(meshopt_of(view), "byteStride"));
  return stride > 0 ? std::size_t(stride) : 0;
}

Result<GltfFile> open_gltf(const fs::path& path) {
  GltfFile file{.path = path};
  auto bytes = read_whole_file(path);
  if (!bytes) return bytes.error();
  file.bytes = std::move(*bytes);
  std::string_view text = file.bytes;
  if (text.starts_with("glTF")) {
    auto found = chunks_of_glb(file);
    if (!found) return found.error();
    if (found->empty()) return file;
    text = *found;
  }
  try {
    file.json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    return file_error("'{}' cannot be read as glTF (its JSON text has an error at byte {})", path.string(), error.byte);
  } catch (const Json::exception&) {
    return file_error("'{}' cannot be read as glTF (its JSON text has a number out of range)", path.string());
  }
  if (!file.json.is_object()) return file_error("'{}' cannot be read as glTF (its JSON is no object)", path.string());
  return file;
}

bool is_first_version(const GltfFile& file) {
  return file.json.is_null() || text_of(member(member(file.json, "asset"), "version")).starts_with("1");
}

const Json& member(const Json& object, const char* name) {
  static const Json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(name);
  return found == object.end() ? nothing : *found;
}

const Json& element(const Json& list, std::size_t index) {
  static const Json nothing;
  return list.is_array() && index < list.size() ? list[index] : nothing;
}

std::size_t count_of(const Json& list) { return list.is_array() ? list.size() : 0; }

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

std::int64_t integer_of(const Json& value) {
  constexpr double kMax = 9007199254740992.0;  // 2^53
  // Some exporters write integers as "3.0".
  const double number = value.is_number() ? value.get<double>() : -1.0;
  const bool fits = number >= 0.0 && number < kMax && number == double(std::int64_t(number));
  return fits ? std::int64_t(number) : -1;
}

int index_of(const Json& value) {
  constexpr std::int64_t kMax = 1 << 30;
  const std::int64_t index = integer_of(value);
  return index < kMax ? int(index) : -1;
}

const Json& extension_of(const Json& object, const char* name) { return member(member(object, "extensions"), name); }

void JsonFaults::add(const JsonPlace& place, const char* name) {
  if (count++ == 0) first = fmt::format("{}[{}].{}", place.list, place.index, name);
}

double number_in(const Json& object, const char* name, double fallback, double low, double high, const JsonPlace& place,
                 JsonFaults& faults) {
  const Json& value = member(object, name);
  if (value.is_null()) return fallback;
  const double number = value.is_number() ? value.get<double>() : fallback;
  const bool in_range = number >= low && number <= high;
  if (!value.is_number() || !in_range) faults.add(place, name);
  return number >= low ? std::min(number, high) : low;
}

glm::vec3 color_in(const Json& object, const char* name, double fallback, double high, const JsonPlace& place,
                   JsonFaults& faults) {
  const auto c = numbers_in<3>(object, name, {fallback, fallback, fallback}, 0.0, high, place, faults);
  return {float(c[0]), float(c[1]), float(c[2])};
}

std::int64_t integer_in(const Json& object, const char* name, std::int64_t fallback, const JsonPlace& place,
                        JsonFaults& faults) {
  const Json& value = member(object, name);
  if (value.is_null()) return fallback;
  const std::int64_t number = integer_of(value);
  if (number < 0) faults.add(place, name);
  return number < 0 ? fallback : number;
}

}  // namespace umbrage
