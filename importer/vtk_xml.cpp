// VTK's XML formats [VTK, "VTK file formats"]: arrays as text, in base64, or appended to the XML, where raw bytes are
// no valid XML; compressed by zlib.
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <pugixml.hpp>
#include <utility>

#include "core/printable.h"
#include "importer/importer.h"
#include "importer/vtk_parts.h"
#include "scene/readers/gzip.h"

namespace umbrage::vtk {
namespace {

using pugi::xml_node;

/// Returns the first `count` bytes that a text in base64 encodes, or fewer if there are no more. Parts that are encoded
/// one by one, each with its padding, follow each other.
std::string from_base64(std::string_view text, std::size_t count) {
  static const auto values = [] {
    std::array<std::int8_t, 256> table;
    table.fill(-1);
    std::int8_t value = 0;
    for (const char c : std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"))
      table[std::uint8_t(c)] = value++;
    return table;
  }();
  std::string bytes;
  bytes.reserve(std::min(count, text.size()));
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    if (bytes.size() >= count) break;
    const int value = values[std::uint8_t(c)];
    if (value < 0) {
      if (c == '=') bit_count = 0;  // the end of a part
      if (c != '=' && kBlanks.find(c) == std::string_view::npos) break;
      continue;
    }
    bits = bits << 6 | std::uint32_t(value);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += char(bits >> bit_count);
  }
  return bytes;
}

class XmlFile {
 public:
  XmlFile(std::string bytes, Report& report) : bytes_(std::move(bytes)), report_(report) {}

  Grid read() {
    const xml_node root = parse();
    const std::string kind = root.attribute("type").value();
    if (kind != "PolyData" && kind != "UnstructuredGrid")
      report_.fail("its type is '{}', not PolyData or UnstructuredGrid; save its surface, for example with ParaView",
                   printable(kind));
    for (const xml_node& piece : root.child(kind.c_str()).children("Piece"))
      if (!report_.failed()) read_piece(piece);
    return std::move(grid_);
  }

 private:
  /// Parses the XML without the appended data. Returns the root.
  xml_node parse() {
    const std::size_t at = bytes_.find("<AppendedData");
    if (at == std::string::npos) {
      head_ = std::move(bytes_);
    } else {
      const std::size_t start = std::min(bytes_.find('_', bytes_.find('>', at)), bytes_.size() - 1) + 1;
      appended_ = std::string_view(bytes_).substr(start);
      is_appended_base64_ = std::string_view(bytes_).substr(at, start - at).find("base64") != std::string_view::npos;
      head_ = bytes_.substr(0, at) + "</VTKFile>";
    }
    constexpr double kMemoryPerByte = 2.0;
    raise_limits_by(kMemoryPerByte * double(head_.size()));
    const pugi::xml_parse_result parsed = document_.load_buffer_inplace(head_.data(), head_.size());
    if (!document_.child("VTKFile")) report_.fail("it begins neither with # vtk DataFile nor with <VTKFile>");
    if (!parsed) report_.fail("it is cut short, or invalid XML at byte {}", std::size_t(parsed.offset));
    const xml_node root = document_.child("VTKFile");
    const std::string compressor = root.attribute("compressor").value(), header = root.attribute("header_type").value();
    is_compressed_ = !compressor.empty();
    is_big_endian_ = std::string_view(root.attribute("byte_order").value()) == "BigEndian";
    if (is_compressed_ && compressor != "vtkZLibDataCompressor")
      report_.fail("it is compressed by '{}'; save it with zlib or without compression, for example with ParaView",
                   printable(compressor));
    if (header == "UInt64")
      word_.bytes = 8;
    else if (!header.empty() && header != "UInt32")
      report_.fail("its header_type is '{}', not UInt32 or UInt64", printable(header));
    return root;
  }

  std::size_t count(const xml_node& node, const char* name, std::size_t fallback = 0) {
    const std::string_view text = node.attribute(name).value();
    if (text.empty()) return fallback;
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value <= kMaxCount) return value;
    report_.fail("its {} is '{}', not 0 to {}", name, printable(text), kMaxCount);
    return 0;
  }

  /// Returns the bytes of an array without their header, inflated if they are compressed. `max_size`: what they may
  /// take.
  std::string content(std::string_view text, bool is_base64, const std::string& name, double max_size) {
    const auto failed = [&](const char* how) {
      report_.fail("its array '{}' is {}", name, how);
      return std::string();
    };
    const auto start = [&](std::size_t size) {
      return is_base64 ? from_base64(text, size) : std::string(text.substr(0, size));
    };
    const auto words = [&](std::size_t count) {
      Numbers out;
      append_numbers(start(word_.size(count)), word_, is_big_endian_, out);
      return out;
    };
    const auto room = double(text.size());
    Numbers header = words(1);
    if (header.empty() || header[0] > room) return failed("cut short");
    if (!is_compressed_) {
      const std::size_t size = word_.bytes + std::size_t(header[0]);
      std::string all = start(size);
      return all.size() < size ? failed("cut short") : all.erase(0, word_.bytes);
    }
    // The number of blocks, the size of each, and of the last one if that is not full; then the size that each takes.
    const auto blocks = std::size_t(header[0]);
    if (blocks == 0) return {};
    header = words(3 + blocks);
    if (header.size() < 3 + blocks) return failed("cut short");
    double taken = double(header.size() * word_.bytes);
    for (std::size_t i = 3; i < header.size(); ++i) taken += header[i];
    const std::string all = taken > room ? std::string() : start(std::size_t(taken));
    if (double(all.size()) < taken) return failed("cut short");
    constexpr double kMaxRatio = 1100.0;  // zlib's is 1032
    const double size = double(blocks - 1) * header[1] + (header[2] > 0.0 ? header[2] : header[1]);
    if (size > max_size) return failed("larger than its number of values");
    if (size > kMaxRatio * taken) return failed("damaged: its blocks are too large for their compressed size");
    raise_limits_by(size);
    std::string out;
    std::size_t at = header.size() * word_.bytes;
    for (std::size_t i = 0; i < blocks; ++i) {
      const auto block = std::size_t(i + 1 == blocks && header[2] > 0.0 ? header[2] : header[1]);
      const auto compressed = std::size_t(header[3 + i]);
      const std::string inflated = inflated_to(std::string_view(all).substr(at, compressed), block);
      if (inflated.size() < block) return failed("damaged: a block cannot be inflated");
      out += inflated;
      at += compressed;
    }
    return out;
  }

  /// Returns the numbers of an array; empty without one. `count`: how many there must be.
  Numbers numbers(const xml_node& array, std::optional<std::size_t> count = {}) {
    Numbers out;
    if (!array || report_.failed()) return out;
    const std::string name = printable(array.attribute("Name").value()), format = array.attribute("format").value();
    const auto type = type_named(array.attribute("type").value());
    if (!type) report_.fail("its array '{}' is of type '{}'", name, printable(array.attribute("type").value()));
    constexpr double kMaxBytes = 8.0;  // of a number
    const double max_size = count ? kMaxBytes * double(*count) : std::numeric_limits<double>::infinity();
    if (format == "ascii") {
      std::string_view text = array.child_value();
      append_text_numbers(text, std::numeric_limits<std::size_t>::max(), out);
      text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
      if (!text.empty())
        report_.fail("its array '{}' has '{}' in the place of a number", name, printable(text.substr(0, 24)));
    } else if (format == "binary") {
      if (type) append_numbers(content(array.child_value(), true, name, max_size), *type, is_big_endian_, out);
    } else if (format == "appended") {
      const unsigned long long offset = array.attribute("offset").as_ullong(appended_.size());
      if (offset > appended_.size()) report_.fail("its array '{}' begins beyond the end of the file", name);
      if (report_.failed()) return out;
      append_numbers(content(appended_.substr(offset), is_appended_base64_, name, max_size), *type, is_big_endian_,
                     out);
    } else {
      report_.fail("its array '{}' has the format '{}', not ascii, binary or appended", name, printable(format));
    }
    if (type && type->bytes == 0 && count && format != "ascii") out.resize(std::min(out.size(), *count));  // of bits
    if (count && out.size() != *count) report_.fail("its array '{}' has {} numbers, not {}", name, out.size(), *count);
    return out;
  }

  /// Appends the values of a piece with `tuples` points or cells to those of the pieces before it, with `before`. Those
  /// that a piece lacks are missing.
  void read_values(const xml_node& section, std::size_t before, std::size_t tuples, std::vector<Values>& all) {
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    for (const xml_node& array : section.children("DataArray")) {
      Values values{.name = array.attribute("Name").value(), .components = count(array, "NumberOfComponents", 1)};
      const auto type = type_named(array.attribute("type").value());
      if (!type || values.components == 0 || values.components > kMaxComponents) {
        report_.warnings.push_back(fmt::format("the array '{}' has no numbers and is not read", values.name));
        continue;
      }
      values.is_active = section.attribute("Scalars").value() == values.name;
      values.is_normal = section.attribute("Normals").value() == values.name;
      values.find_colors(type);
      if (!report_.needs(values)) continue;
      const Numbers more = numbers(array, values.components * tuples);
      auto found = std::find_if(all.begin(), all.end(), [&](const Values& each) {
        return each.name == values.name && each.components == values.components;
      });
      if (found == all.end()) found = all.insert(all.end(), std::move(values));
      found->numbers.resize(before * found->components, kMissing);  // of several time steps the last one remains
      found->numbers.insert(found->numbers.end(), more.begin(), more.end());
    }
    for (Values& each : all) each.numbers.resize((before + tuples) * each.components, kMissing);
  }

  void read_piece(const xml_node& piece) {
    const std::size_t first_point = grid_.points.size(), first_cell = grid_.cell_count;
    const Numbers values = numbers(piece.child("Points").child("DataArray"), 3 * count(piece, "NumberOfPoints"));
    for (std::size_t i = 0; i + 2 < values.size(); i += 3)
      grid_.points.emplace_back(values[i], values[i + 1], values[i + 2]);
    // Values of cells have this order.
    constexpr std::pair<const char*, std::optional<CellType>> kSections[] = {
        {"Verts", kPolyVertex}, {"Lines", kPolyLine}, {"Polys", kPolygon}, {"Strips", kStrip}, {"Cells", std::nullopt}};
    for (const auto& [name, type] : kSections) {
      const auto array = [this, section = piece.child(name)](const char* of) {
        return numbers(section.find_child_by_attribute("DataArray", "Name", of));
      };
      const Cells cells{.types = array("types"), .ends = array("offsets"), .corners = array("connectivity")};
      if (const auto all = count(piece, fmt::format("NumberOf{}", name).c_str()); cells.ends.size() != all)
        report_.fail("it has {} {}, not {}", cells.ends.size(), name, all);
      grid_.add_cells(cells, first_point, type);
    }
    read_values(piece.child("PointData"), first_point, grid_.points.size() - first_point, grid_.point_values);
    read_values(piece.child("CellData"), first_cell, grid_.cell_count - first_cell, grid_.cell_values);
  }

  std::string bytes_, head_;
  std::string_view appended_;
  bool is_appended_base64_ = false, is_big_endian_ = false, is_compressed_ = false;
  NumberType word_{4, 'u'};  ///< of the headers of arrays
  Report& report_;
  pugi::xml_document document_;
  Grid grid_;
};

}  // namespace

Grid read_xml_file(std::string bytes, Report& report) { return XmlFile(std::move(bytes), report).read(); }

}  // namespace umbrage::vtk
