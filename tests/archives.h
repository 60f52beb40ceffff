// Compressed files and 3MF models that tests write.
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

}  // namespace umbrage::test
