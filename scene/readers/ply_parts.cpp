#include "scene/readers/ply_parts.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>

#include "core/lists.h"
#include "core/lowercase.h"
#include "scene/readers/read_number.h"
#include "scene/readers/whole_file.h"

namespace umbrage::ply {
namespace {

std::optional<Number> number_named(std::string_view name) {
  struct Named {
    std::string_view name;
    Number number;
  };
  static constexpr Named kNames[] = {
      {"char", Number::kInt8},      {"int8", Number::kInt8},       {"uchar", Number::kUint8},
      {"uint8", Number::kUint8},    {"short", Number::kInt16},     {"int16", Number::kInt16},
      {"ushort", Number::kUint16},  {"uint16", Number::kUint16},   {"int", Number::kInt32},
      {"int32", Number::kInt32},    {"uint", Number::kUint32},     {"uint32", Number::kUint32},
      {"float", Number::kFloat32},  {"float32", Number::kFloat32}, {"double", Number::kFloat64},
      {"float64", Number::kFloat64}};
  for (const Named& named : kNames) {
    if (named.name == name) return named.number;
  }
  return std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlank = " \t\r";
  for (std::size_t i = line.find_first_not_of(kBlank); i < line.size(); i = line.find_first_not_of(kBlank, i)) {
    const std::size_t end = std::min(line.find_first_of(kBlank, i), line.size());
    words.push_back(line.substr(i, end - i));
    i = end;
  }
  return words;
}

bool read_format(const std::vector<std::string_view>& words, Header& header) {
  if (words.size() < 2) return false;
  if (words[1] == "ascii") {
    header.storage = Storage::kText;
  } else if (words[1] == "binary_little_endian") {
    header.storage = Storage::kLittle;
  } else if (words[1] == "binary_big_endian") {
    header.storage = Storage::kBig;
  } else {
    return false;
  }
  return true;
}

bool read_element(const std::vector<std::string_view>& words, Header& header) {
  if (words.size() != 3) return false;
  Element element{std::string(words[1]), 0, {}};
  const char* const end = words[2].data() + words[2].size();
  const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
  header.elements.push_back(std::move(element));
  return error == std::errc() && stop == end;
}

bool read_property(const std::vector<std::string_view>& words, Header& header) {
  if (header.elements.empty() || words.size() < 3) return false;
  Property property;
  const bool is_list = words[1] == "list";
  if (words.size() != (is_list ? 5u : 3u)) return false;
  const std::optional<Number> number = number_named(words[is_list ? 3 : 1]);
  if (is_list) property.list_size = number_named(words[2]);
  if (!number || (is_list && !property.list_size)) return false;
  property.number = *number;
  property.name = words.back();
  constexpr std::string_view kAnyCase[] = {"x", "y", "z", "nx", "ny", "nz", "r", "g", "b"};
  if (const std::string lower = lowercase(property.name);
      contains(kAnyCase, lower) && header.elements.back().find(lower) < 0)
    property.name = lower;
  // As a float, a packed colour may be no number, whose bits conversions do not keep.
  if (header.storage != Storage::kText && (property.name == "rgb" || property.name == "rgba") &&
      property.number == Number::kFloat32)
    property.number = Number::kUint32;
  header.elements.back().properties.push_back(std::move(property));
  return true;
}

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

bool is_comment(const char* at, const char* end) {
  if (*at != 'c' && *at != 'o' && *at != '#') return false;
  const std::string_view rest(at, std::size_t(end - at));
  return *at == '#' || rest.starts_with("comment") || rest.starts_with("obj_info");
}

/// Counts the lines of a text that are neither empty nor comments, and end in LF, CR LF or CR.
std::size_t lines_of(const char* at, const char* end) {
  std::size_t count = 0;
  for (bool inside = false; at < end; ++at) {
    const bool breaks = is_line_end(*at), begins = !breaks && !inside && *at != ' ' && *at != '\t';
    count += begins && !is_comment(at, end);
    inside = !breaks && (inside || begins);
  }
  return count;
}

}  // namespace

int Element::find(std::string_view property, bool list) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property && properties[i].list_size.has_value() == list) return int(i);
  return -1;
}

Result<Header> read_header(std::string_view& text, const std::string& file) {
  Header header;
  constexpr std::size_t kMaxShown = 60;  // characters of a line in a message
  text = without_mark(text);
  const std::size_t first_end = text.find_first_of("\r\n");
  // Some programs end lines in CR alone.
  const bool ends_in_cr = first_end != std::string_view::npos && text[first_end] == '\r' &&
                          (first_end + 1 == text.size() || text[first_end + 1] != '\n');
  bool first = true, has_format = false;
  while (true) {
    const std::size_t end = text.find(ends_in_cr ? '\r' : '\n');
    if (end == std::string_view::npos) return file_error("'{}' has a PLY header without end_header", file);
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::vector<std::string_view> words = words_of(line);
    if (first && (words.size() != 1 || words[0] != "ply")) {
      return file_error("'{}' cannot be read as PLY (its first line is not 'ply')", file);
    }
    first = false;
    if (words.empty() || words[0] == "ply" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    bool valid = true;
    if (words[0] == "comment") {
      if (words.size() > 2 && words[1] == "TextureFile") {
        std::string_view name = line.substr(std::size_t(words[2].data() - line.data()));
        while (is_blank(name.back())) name.remove_suffix(1);
        header.textures.emplace_back(name);
      }
    } else if (words[0] == "format") {
      valid = has_format = read_format(words, header);
    } else if (words[0] == "element") {
      valid = read_element(words, header);
    } else {
      valid = words[0] == "property" && read_property(words, header);
    }
    if (valid) continue;
    std::string shown(line.substr(0, kMaxShown));
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return file_error("'{}' has the PLY header line '{}', which is not valid", file, shown);
  }
  if (!has_format) return file_error("'{}' has a PLY header without a format", file);
  return header;
}

Body::Body(std::string_view whole, std::string_view body, const Header& header)
    : whole_(whole),
      at_(body.data()),
      end_(body.data() + body.size()),
      row_end_(end_),
      row_begin_(at_),
      storage_(header.storage) {
  if (storage_ != Storage::kText) return;
  std::size_t rows = 0;
  for (const Element& element : header.elements) rows += element.properties.empty() ? 0 : element.count;
  row_per_line_ = lines_of(at_, end_) == rows;
}

void Body::begin_row() {
  row_is_bad_ = false;
  if (storage_ != Storage::kText) return;
  skip_blanks_and_comments();
  row_begin_ = at_;
  row_end_ = row_per_line_ ? std::find_if(at_, end_, is_line_end) : end_;
}

void Body::skip_blanks_and_comments() {
  while (true) {
    while (at_ < end_ && is_blank(*at_)) ++at_;
    if (at_ == end_ || !is_comment(at_, end_)) return;
    at_ = std::find_if(at_, end_, is_line_end);
  }
}

bool Body::end_row() {
  if (storage_ == Storage::kText && row_per_line_) at_ = row_end_;
  if (!row_is_bad_) return false;
  if (bad_rows_++ == 0) first_bad_ = row_begin_;
  return true;
}

double Body::text() {
  if (ended_) return 0.0;
  while (at_ < row_end_ && is_blank(*at_)) ++at_;
  if (at_ == row_end_) {
    row_is_bad_ = true;
    ended_ = row_end_ == end_;
    return std::numeric_limits<double>::quiet_NaN();
  }
  double value = 0.0;
  const char* stop = at_;
  const bool found = read_number(stop, row_end_, value);
  if (!found || (stop < row_end_ && !is_blank(*stop) && *stop != '#')) {
    row_is_bad_ = true;
    if (!comma_ && has_decimal_commas({at_, std::size_t(std::find_if(at_, row_end_, is_blank) - at_)})) comma_ = at_;
    if (!row_per_line_) ended_ = !found;
    if (row_per_line_) value = std::numeric_limits<double>::quiet_NaN();
    if (row_per_line_) stop = std::find_if(stop, row_end_, is_blank);
  }
  at_ = stop;
  return value;
}

template <class T>
double Body::binary_as() {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at_, sizeof(T));
  const bool swap = (storage_ == Storage::kBig) == (std::endian::native == std::endian::little);
  if (swap) std::reverse(bytes.begin(), bytes.end());
  at_ += sizeof(T);
  return double(std::bit_cast<T>(bytes));
}

double Body::binary(Number number) {
  if (end_ - at_ < kBytes[std::size_t(number)]) {
    ended_ = true;
    return 0.0;
  }
  switch (number) {
    case Number::kInt8:
      return binary_as<std::int8_t>();
    case Number::kUint8:
      return binary_as<std::uint8_t>();
    case Number::kInt16:
      return binary_as<std::int16_t>();
    case Number::kUint16:
      return binary_as<std::uint16_t>();
    case Number::kInt32:
      return binary_as<std::int32_t>();
    case Number::kUint32:
      return binary_as<std::uint32_t>();
    case Number::kFloat32:
      return binary_as<float>();
    case Number::kFloat64:
      return binary_as<double>();
  }
  return 0.0;
}

}  // namespace umbrage::ply
