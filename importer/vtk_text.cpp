// VTK's text format, versions 1 to 5.1 [VTK, "VTK file formats"]; numbers of VTK files; and read_vtk.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/lowercase.h"
#include "core/printable.h"
#include "importer/readers.h"
#include "importer/vtk_parts.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace vtk {
namespace {

/// Returns the beginning of a word for a message.
std::string shown(std::string_view word) { return printable(word.substr(0, 24)); }

/// Returns a name of the file, in which %20 is a blank.
std::string decoded(std::string_view coded) {
  std::string name;
  for (; !coded.empty(); coded.remove_prefix(1)) {
    unsigned char byte = 0;
    const bool is_code = coded[0] == '%' && coded.size() > 2 &&
                         std::from_chars(coded.data() + 1, coded.data() + 3, byte, 16).ptr == coded.data() + 3;
    name += is_code ? char(byte) : coded[0];
    if (is_code) coded.remove_prefix(2);
  }
  return name;
}

class TextFile {
 public:
  TextFile(std::string_view bytes, Report& report) : rest_(bytes), report_(report) {}

  Grid read() {
    line();  // the version: the content tells it better
    line();  // the title
    const std::string_view form = word();
    is_binary_ = lowercase(form) == "binary";
    if (!is_binary_ && lowercase(form) != "ascii")
      report_.fail("its third line is '{}', not ASCII or BINARY", shown(form));
    while (!report_.failed()) {
      const std::string_view keyword = word();
      if (keyword.empty()) break;
      if (!read_part(lowercase(keyword))) report_.fail("it has '{}' in the place of a keyword", shown(keyword));
    }
    if (kind_.empty()) report_.fail("it has no DATASET");
    finish_cells();
    return std::move(grid_);
  }

 private:
  std::string_view line() {
    const std::string_view found = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(found.size() + 1, rest_.size()));
    return found;
  }
  std::string_view word() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    const std::string_view found = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(found.size());
    return found;
  }
  std::string next_word() const { return lowercase(TextFile(rest_, report_).word()); }

  /// Reads an integer, 0 to `max`. `what`: its name in errors.
  std::size_t count(std::string_view what, std::size_t max = kMaxCount) {
    const std::string_view found = word();
    const double value = number_of(found).value_or(-1.0);
    if (value >= 0.0 && value <= double(max) && value == std::floor(value)) return std::size_t(value);
    report_.fail("the number of its {} is '{}', not 0 to {}", what, shown(found), max);
    return 0;
  }

  /// Reads numbers, which begin after the end of the line if they are binary. `type`: not set: it comes first.
  Numbers numbers(std::size_t count, std::string_view what, std::optional<NumberType> type = {}) {
    const std::string_view name = type ? std::string_view() : word();
    if (!type) type = type_named(name);
    if (!type) report_.fail("the type of {} is '{}', which is not read", what, shown(name));
    Numbers out;
    if (is_binary_) line();
    if (report_.failed() || count == 0) return out;
    const std::size_t size = is_binary_ ? type->size(count) : 2 * count - 1;  // of text at least: digits and blanks
    if (is_binary_ && size <= rest_.size()) {
      append_numbers(rest_.substr(0, size), *type, true, out);
      rest_.remove_prefix(size);
      out.resize(count);  // of bits
    } else if (!is_binary_ && size <= rest_.size()) {
      append_text_numbers(rest_, count, out);
    }
    if (out.size() == count) return out;
    const std::string_view wrong = out.empty() && size > rest_.size() ? std::string_view() : word();
    if (wrong.empty()) report_.fail("{} has {} numbers, but the file ends before that", what, count);
    report_.fail("{} has '{}' in the place of number {} of {}{}", what, shown(wrong), out.size() + 1, count,
                 has_decimal_commas(wrong) ? "; decimal commas are not read" : "");
    return out;
  }

  /// Reads cells: each a count and its corners, or since version 5 the ends of all, which begin with 0, and all
  /// corners.
  void read_cells(Cells& cells) {
    const std::size_t count = this->count("cells"), size = this->count("corners of cells", std::size_t(1) << 40);
    cells.ends.clear();
    cells.corners.clear();
    if (next_word() == "offsets") {
      word();
      cells.ends = numbers(count, "OFFSETS");
      if (!cells.ends.empty()) cells.ends.erase(cells.ends.begin());
      skip_metadata();
      if (const std::string_view found = word(); lowercase(found) != "connectivity")
        report_.fail("it has '{}' in the place of CONNECTIVITY", shown(found));
      cells.corners = numbers(size, "CONNECTIVITY");
      return;
    }
    const Numbers list = numbers(size, "the array of its cells", kInteger);
    std::size_t at = 0;
    for (std::size_t i = 0; i < count && !report_.failed(); ++i) {
      const double corners = at < list.size() ? list[at++] : -1.0;
      if (!(corners >= 0.0 && corners <= double(list.size() - at)))
        return report_.fail("its cell {} of {} has {} corners, which its array does not hold", i + 1, count, corners);
      const auto first = list.begin() + std::ptrdiff_t(at);
      cells.corners.insert(cells.corners.end(), first, first + std::ptrdiff_t(corners));
      cells.ends.push_back(double(cells.corners.size()));
      at += std::size_t(corners);
    }
  }

  /// Reads what follows a keyword. Returns false if it is none at this place.
  bool read_part(const std::string& keyword) {
    if (keyword == "dataset") {
      kind_ = lowercase(word());
      if (kind_ != "polydata" && kind_ != "unstructured_grid")
        report_.fail(
            "its DATASET is '{}', not POLYDATA or UNSTRUCTURED_GRID; save its surface, for example with ParaView",
            shown(kind_));
    } else if (keyword == "metadata") {
      skip_lines();
    } else if (keyword == "field") {
      read_field();
    } else if (keyword == "point_data" || keyword == "cell_data") {
      finish_cells();
      const bool on_cells = keyword == "cell_data";
      const std::size_t all = on_cells ? grid_.cell_count : grid_.points.size();
      values_ = on_cells ? &grid_.cell_values : &grid_.point_values;
      value_count_ = count("values");
      if (value_count_ != all)
        report_.fail("it has {} {} and values for {}", all, on_cells ? "cells" : "points", value_count_);
    } else {
      return values_ ? read_values(keyword) : read_shape(keyword);
    }
    return true;
  }

  bool read_shape(const std::string& keyword) {
    for (std::size_t i = 0; i < std::size(kLists); ++i)
      if (keyword == kLists[i].first) return read_cells(lists_[i]), true;
    if (keyword == "points") {
      const Numbers values = numbers(3 * count("points"), "POINTS");
      for (std::size_t i = 0; i + 2 < values.size(); i += 3)
        grid_.points.emplace_back(values[i], values[i + 1], values[i + 2]);
      return true;
    }
    if (keyword == "cell_types") lists_.back().types = numbers(count("cell types"), "CELL_TYPES", kInteger);
    return keyword == "cell_types";
  }

  /// Adds the lists of cells, once all are read.
  void finish_cells() {
    for (std::size_t i = 0; i < std::size(kLists); ++i)
      grid_.add_cells(std::exchange(lists_[i], {}), 0, kLists[i].second);
  }

  /// Skips what versions since 4.1 add to arrays: lines until an empty one.
  void skip_metadata() {
    if (next_word() == "metadata") word(), skip_lines();
  }
  void skip_lines() {
    for (line(); !rest_.empty() && line().find_first_not_of(kBlanks) != std::string_view::npos;) {
    }
  }

  /// Reads the arrays of a FIELD.
  void read_field() {
    word();  // its name
    const std::size_t arrays = count("arrays");
    for (std::size_t i = 0; i < arrays && !report_.failed(); ++i) {
      skip_metadata();
      Values values{.name = decoded(word()), .components = count("components", kMaxComponents)};
      read_array(std::move(values), count("values"));
    }
  }

  void read_array(Values values, std::size_t tuples, std::optional<NumberType> type = {}) {
    const std::string name = fmt::format("its array '{}'", shown(values.name));
    if (!type && !is_binary_ && next_word() == "string") {
      report_.warnings.push_back(fmt::format("the array '{}' has no numbers and is not read", values.name));
      line();
      for (std::size_t i = 0; i < values.components * tuples && !rest_.empty(); ++i) line();
      return;
    }
    values.numbers = numbers(values.components * tuples, name, type);
    if (values_ && tuples != value_count_)
      report_.warnings.push_back(fmt::format("{} has {} values, not {}, and is not read", name, tuples, value_count_));
    else if (values_ && values.components > 0 && report_.needs(values))
      values_->push_back(std::move(values));
  }

  /// Reads values of points or cells. Returns whether the keyword begins some.
  bool read_values(const std::string& keyword) {
    constexpr std::pair<std::string_view, std::size_t> kComponents[] = {
        {"scalars", 1},    {"vectors", 3},      {"normals", 3},    {"tensors", 9},       {"tensors6", 6},
        {"global_ids", 1}, {"pedigree_ids", 1}, {"edge_flags", 1}, {"color_scalars", 0}, {"texture_coordinates", 0}};
    const auto found = std::find_if(std::begin(kComponents), std::end(kComponents),
                                    [&](const auto& known) { return known.first == keyword; });
    if (keyword == "lookup_table") return word(), numbers(4 * count("colours"), "a LOOKUP_TABLE", kByte), true;
    if (found == std::end(kComponents)) return false;
    Values values{.name = decoded(word()), .components = found->second};
    values.is_active = keyword == "scalars";
    values.is_normal = keyword == "normals";
    if (values.components == 0) values.components = count("components", 4);
    std::optional<NumberType> type;
    if (keyword == "color_scalars") {
      type = kByte;
      if (values.components >= 3) values.color_scale = is_binary_ ? 255.0 : 1.0;
    } else if (values.is_active && (type = type_named(next_word()))) {
      word();
      const std::string_view rest = rest_.substr(0, rest_.find('\n'));
      if (rest.find_first_not_of(kBlanks) != std::string_view::npos)
        values.components = count("components", kMaxComponents);
      if (next_word() == "lookup_table") word(), word();
      values.find_colors(type);
    }
    read_array(std::move(values), value_count_, type);
    return true;
  }

  static constexpr NumberType kInteger{4, 'i'}, kByte{1, 'u'};
  static constexpr std::pair<std::string_view, std::optional<CellType>> kLists[] = {{"vertices", kPolyVertex},
                                                                                    {"lines", kPolyLine},
                                                                                    {"polygons", kPolygon},
                                                                                    {"triangle_strips", kStrip},
                                                                                    {"cells", std::nullopt}};
  std::string_view rest_;
  Report& report_;
  bool is_binary_ = false;
  std::string kind_;  ///< of the dataset
  Grid grid_;
  std::array<Cells, std::size(kLists)> lists_;
  std::vector<Values>* values_ = nullptr;  ///< where the next values belong; null: nowhere
  std::size_t value_count_ = 0;
};

}  // namespace

Grid read_text_file(std::string_view bytes, Report& report) { return TextFile(bytes, report).read(); }

std::optional<NumberType> type_named(std::string_view name) {
  constexpr std::pair<std::string_view, NumberType> kNames[] = {
      {"bit", {0, 'u'}},   {"char", {1, 'i'}},   {"signed_char", {1, 'i'}}, {"short", {2, 'i'}},
      {"int", {4, 'i'}},   {"long", {8, 'i'}},   {"idtype", {4, 'i'}},      {"long_long", {8, 'i'}},
      {"float", {4, 'f'}}, {"double", {8, 'f'}}, {"int8", {1, 'i'}},        {"int16", {2, 'i'}},
      {"int32", {4, 'i'}}, {"int64", {8, 'i'}},  {"float32", {4, 'f'}},     {"float64", {8, 'f'}}};
  const std::string lower = lowercase(name);
  std::string_view plain = lower;
  bool has_sign = true;
  for (const std::string_view prefix : {"vtktype", "vtk", "unsigned_", "u"})
    if (plain.starts_with(prefix)) has_sign = has_sign && prefix[0] != 'u', plain.remove_prefix(prefix.size());
  for (const auto& [known, type] : kNames)
    if (known == plain) return NumberType{type.bytes, has_sign ? type.kind : 'u'};
  return std::nullopt;
}

void append_numbers(std::string_view bytes, NumberType type, bool big_endian, Numbers& out) {
  if (type.bytes == 0) {
    for (const char byte : bytes)
      for (int bit = 7; bit >= 0; --bit) out.push_back(byte >> bit & 1);
    return;
  }
  const int unused_bits = 64 - 8 * int(type.bytes);
  out.reserve(out.size() + bytes.size() / type.bytes);
  for (std::size_t at = 0; at + type.bytes <= bytes.size(); at += type.bytes) {
    std::uint64_t bits = 0;  // the number in its highest bytes
    std::memcpy(reinterpret_cast<char*>(&bits) + (big_endian ? 0 : unused_bits / 8), bytes.data() + at, type.bytes);
    if (big_endian) bits = __builtin_bswap64(bits);
    if (type.kind == 'i')
      out.push_back(double(std::int64_t(bits) >> unused_bits));
    else if (type.kind == 'u')
      out.push_back(double(bits >> unused_bits));
    else
      out.push_back(type.bytes == 4 ? double(std::bit_cast<float>(std::uint32_t(bits >> 32)))
                                    : std::bit_cast<double>(bits));
  }
}

void append_text_numbers(std::string_view& text, std::size_t count, Numbers& out) {
  const auto is_blank = [](char c) { return kBlanks.find(c) != std::string_view::npos; };
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t i = 0; i < count; ++i) {
    while (at < end && is_blank(*at)) ++at;
    const char* here = at;
    double value = 0.0;
    if (!read_number(here, end, value) || (here < end && !is_blank(*here))) break;
    out.push_back(value);
    at = here;
  }
  text.remove_prefix(std::size_t(at - text.data()));
}

}  // namespace vtk

Result<Scene> read_vtk(const std::filesystem::path& file, const std::optional<std::string>& field) {
  auto bytes = read_whole_file(file);
  if (!bytes) return bytes.error();
  vtk::Report report{.field = field};
  const bool is_text = without_mark(*bytes).starts_with("# vtk");
  vtk::Grid grid = is_text ? vtk::read_text_file(*bytes, report) : vtk::read_xml_file(std::move(*bytes), report);
  Scene scene;
  if (!report.failed()) scene = vtk::scene_of(std::move(grid), file.stem().string(), report);
  if (report.failed()) return file_error("'{}' cannot be read as VTK ({})", file.string(), report.problem);
  return scene;
}

}  // namespace umbrage
