// Compressed files, 3MF and binary FBX models that tests write.
#pragma once
#include <zlib.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace umbrage::test {

/// Returns bytes that zlib has compressed.
inline std::string zlib_of(std::string_view content) {
  uLongf size = compressBound(uLong(content.size()));
  std::string bytes(size, '\0');
  compress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
           uLong(content.size()));
  bytes.resize(size);
  return bytes;
}

/// Returns a gzip file with one member.
inline std::string gzip_of(std::string_view content) {
  constexpr int kGzip = 16, kMemory = 8;
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, kMemory, Z_DEFAULT_STRATEGY);
  std::string bytes(deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = uInt(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = uInt(bytes.size());
  deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

/// Returns a zip archive whose entries are stored without compression.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string bytes, directory;
  const auto add = [](std::string& to, std::uint32_t value, int size) {
    for (int k = 0; k < size; ++k) to += char(value >> 8 * k);
  };
  constexpr std::uint32_t kVersion = 20;
  for (const auto& [name, content] : entries) {
    const std::uint32_t start = std::uint32_t(bytes.size()), size = std::uint32_t(content.size());
    const auto crc = std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(content.data()), size));
    const auto add_entry = [&](std::string& to) {
      for (const std::uint32_t field : {kVersion, 0u, 0u, 0u, 0u}) add(to, field, 2);  // flags, method, time, date
      for (const std::uint32_t field : {crc, size, size}) add(to, field, 4);
      add(to, std::uint32_t(name.size()), 2);
      add(to, 0, 2);
    };
    bytes += "PK\3\4";
    add_entry(bytes);
    bytes += name + content;
    directory += "PK\1\2";
    add(directory, kVersion, 2);
    add_entry(directory);
    for (const int size_of_field : {2, 2, 2, 4}) add(directory, 0, size_of_field);
    add(directory, start, 4);
    directory += name;
  }
  const std::uint32_t start = std::uint32_t(bytes.size()), count = std::uint32_t(entries.size());
  bytes += directory + "PK\5\6";
  for (const std::uint32_t field : {0u, 0u, count, count}) add(bytes, field, 2);
  add(bytes, std::uint32_t(directory.size()), 4);
  add(bytes, start, 4);
  add(bytes, 0, 2);
  return bytes;
}

/// Returns a 3MF file with this content of its root model's element `model`.
inline std::string three_mf_of(const std::string& model, const std::string& unit = "millimeter",
                               std::vector<std::pair<std::string, std::string>> more = {}) {
  more.insert(more.begin(),
              {{"_rels/.rels",
                "<Relationships><Relationship Target=\"/3D/3dmodel.model\" Id=\"r\" Type=\"http://"
                "schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
               {"3D/3dmodel.model", "<?xml version=\"1.0\"?><model unit=\"" + unit + "\">" + model + "</model>"}});
  return zip_of(more);
}

/// Returns the <mesh> of a cube from 0 to `size`, moved by `at`. `of_triangle`: attributes of triangle 0 to 11.
inline std::string cube_3mf(double size, const std::array<double, 3>& at = {},
                            std::string (*of_triangle)(int) = nullptr) {
  constexpr int kTriangles[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                     {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  std::string text = "<mesh><vertices>";
  for (int k = 0; k < 8; ++k) {
    const bool x = k % 4 == 1 || k % 4 == 2, y = k % 4 >= 2, z = k >= 4;
    text += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", at[0] + size * x, at[1] + size * y, at[2] + size * z);
  }
  text += "</vertices><triangles>";
  for (int k = 0; k < 12; ++k)
    text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\" {}/>", kTriangles[k][0], kTriangles[k][1],
                        kTriangles[k][2], of_triangle ? of_triangle(k) : "");
  return text + "</triangles></mesh>";
}

/// Returns the objects 1, a mesh, and a build of it.
inline std::string object_3mf(const std::string& mesh) {
  return "<resources><object id=\"1\">" + mesh + "</object></resources><build><item objectid=\"1\"/></build>";
}

// ---- binary FBX

template <class T>
void append_value(std::string& to, T value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// A record of a binary file of version 7400 at an offset.
inline std::string fbx_record(std::size_t offset, const std::string& name, const std::string& values,
                              std::uint32_t count, const std::vector<std::string (*)(std::size_t)>& children = {}) {
  std::string body = char(name.size()) + name + values;
  constexpr std::size_t kSizes = 12;
  for (const auto child : children) body += child(offset + kSizes + body.size());
  if (!children.empty()) body += std::string(kSizes + 1, '\0');
  std::string head;
  append_value(head, std::uint32_t(offset + kSizes + body.size()));
  append_value(head, count);
  append_value(head, std::uint32_t(values.size()));
  return head + body;
}

inline std::string fbx_text_value(const std::string& text) {
  std::string value = "S";
  append_value(value, std::uint32_t(text.size()));
  return value + text;
}
inline std::string fbx_id_value(std::int64_t id) {
  std::string value = "L";
  append_value(value, id);
  return value;
}

template <class T>
std::string fbx_array_value(char type, const std::vector<T>& numbers, bool is_packed) {
  const std::string raw(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
  std::string packed(compressBound(uLong(raw.size())), '\0');
  uLongf size = uLongf(packed.size());
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
           uLong(raw.size()));
  packed.resize(size);
  std::string value(1, type);
  append_value(value, std::uint32_t(numbers.size()));
  append_value(value, std::uint32_t(is_packed));
  append_value(value, std::uint32_t(is_packed ? packed.size() : raw.size()));
  return value + (is_packed ? packed : raw);
}

/// Returns a file of version 7400 with a triangle at 0, +x and +y, of length 1, in a node. `first`: makes a record
/// before the others.
inline std::string binary_fbx_triangle(std::string (*first)(std::size_t) = nullptr) {
  std::string bytes("Kaydara FBX Binary  \0\x1a\0", 23);
  append_value(bytes, std::uint32_t(7400));
  if (first) bytes += first(bytes.size());
  bytes += fbx_record(
      bytes.size(), "Objects", "", 0,
      {[](std::size_t at) {
         return fbx_record(at, "Geometry",
                           fbx_id_value(1) + fbx_text_value(std::string("g\0\1Geometry", 11)) + fbx_text_value("Mesh"),
                           3,
                           {[](std::size_t place) {
                              return fbx_record(place, "Vertices",
                                                fbx_array_value<double>('d', {0, 0, 0, 1, 0, 0, 0, 1, 0}, true), 1);
                            },
                            [](std::size_t place) {
                              return fbx_record(place, "PolygonVertexIndex",
                                                fbx_array_value<std::int32_t>('i', {0, 1, -3}, false), 1);
                            }});
       },
       [](std::size_t at) {
         return fbx_record(at, "Model",
                           fbx_id_value(10) + fbx_text_value(std::string("node\0\1Model", 11)) + fbx_text_value("Mesh"),
                           3);
       }});
  bytes += fbx_record(
      bytes.size(), "Connections", "", 0,
      {[](std::size_t at) { return fbx_record(at, "C", fbx_text_value("OO") + fbx_id_value(1) + fbx_id_value(10), 3); },
       [](std::size_t at) {
         return fbx_record(at, "C", fbx_text_value("OO") + fbx_id_value(10) + fbx_id_value(0), 3);
       }});
  return bytes + std::string(13, '\0');
}

}  // namespace umbrage::test
