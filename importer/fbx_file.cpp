#include "importer/fbx_file.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>

#include "scene/readers/gzip.h"
#include "scene/readers/read_number.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

constexpr std::string_view kBinary = "Kaydara FBX Binary";
constexpr std::size_t kByteOrder = 22, kVersion = 23, kHeader = 27;  // offsets in a binary file
constexpr int kMaxDepth = 32;

/// The reading of a binary file. After an error everything is 0 or empty.
class BinaryParser {
 public:
  explicit BinaryParser(std::string_view bytes) : bytes_(bytes), is_big_endian_(bytes[kByteOrder] == 1) {}

  bool parse(FbxRecord& root) {
    wide_ = version() >= 7500;
    while (next(root, 0, bytes_.size())) {
    }
    return !failed_;
  }
  std::uint32_t version() {
    at_ = kVersion;
    return take<std::uint32_t>();
  }

 private:
  template <class T>
  T value_at(std::string_view bytes, std::size_t at) const {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes.data() + at, sizeof(T));
    if (is_big_endian_) std::reverse(raw, raw + sizeof(T));
    return std::bit_cast<T>(raw);
  }
  std::string_view take_bytes(std::size_t count) {
    failed_ = failed_ || count > bytes_.size() - at_;
    if (failed_) return {};
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  template <class T>
  T take() {
    const std::string_view raw = take_bytes(sizeof(T));
    return failed_ ? T{} : value_at<T>(raw, 0);
  }
  std::uint64_t take_size() { return wide_ ? take<std::uint64_t>() : take<std::uint32_t>(); }

  template <class T>
  void take_array(FbxRecord& to) {
    constexpr std::size_t kMaxRatio = 1100;  // of deflate
    const std::size_t size = sizeof(T) * take<std::uint32_t>();
    const bool is_packed = take<std::uint32_t>() == 1;
    const std::string_view stored = take_bytes(take<std::uint32_t>());
    std::string unpacked;
    if (is_packed && size / kMaxRatio <= stored.size()) unpacked = inflated_to(stored, size);
    const std::string_view raw = is_packed ? unpacked : stored;
    failed_ = failed_ || raw.size() < size;
    if (failed_) return;
    to.array.reserve(size / sizeof(T));
    for (std::size_t at = 0; at < size; at += sizeof(T)) to.array.push_back(double(value_at<T>(raw, at)));
  }
  void take_value(FbxRecord& to) {
    const auto add = [&](auto value) { to.values.push_back({double(value), std::int64_t(value), {}}); };
    const auto add_real = [&](double value) { to.values.push_back({value, 0, {}}); };
    switch (take<char>()) {
      case 'B':
      case 'C':
        return add(take<std::int8_t>());
      case 'Y':
        return add(take<std::int16_t>());
      case 'I':
        return add(take<std::int32_t>());
      case 'L':
        return add(take<std::int64_t>());
      case 'F':
        return add_real(double(take<float>()));
      case 'D':
        return add_real(take<double>());
      case 'S':
      case 'R':
        return to.values.push_back({0.0, 0, take_bytes(take<std::uint32_t>())}), void();
      case 'b':
      case 'c':
        return take_array<std::int8_t>(to);
      case 'i':
        return take_array<std::int32_t>(to);
      case 'l':
        return take_array<std::int64_t>(to);
      case 'f':
        return take_array<float>(to);
      case 'd':
        return take_array<double>(to);
      default:
        failed_ = true;
    }
  }
  /// Reads a record, which ends at `limit` at most, and adds it to its parent. Returns false at the end of a list.
  bool next(FbxRecord& parent, int depth, std::uint64_t limit) {
    if (at_ >= bytes_.size() && depth == 0) return false;  // cut before the last, empty record
    const std::uint64_t end = take_size(), count = take_size();
    take_size();  // of the values, bytes
    const std::string_view name = take_bytes(take<std::uint8_t>());
    if (failed_ || end == 0) return false;
    if (depth > kMaxDepth || end > limit) return !(failed_ = true);
    FbxRecord& record = parent.children.emplace_back();
    record.name = name;
    for (std::uint64_t k = 0; k < count && !failed_; ++k) take_value(record);
    while (!failed_ && at_ < end && next(record, depth + 1, end)) {
    }
    failed_ = failed_ || at_ > end;  // going back would read bytes again and again
    if (!failed_) at_ = end;
    return !failed_;
  }

  std::string_view bytes_;
  bool is_big_endian_, wide_ = false, failed_ = false;
  std::size_t at_ = kHeader;
};

/// The reading of a text file.
class TextParser {
 public:
  explicit TextParser(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  bool parse(FbxRecord& root) { return list(root, 0) && at_ == end_; }

 private:
  static bool is_of_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-+.|", c) ||
           static_cast<unsigned char>(c) > 127;
  }
  bool sees(char c) {
    while (at_ < end_ && (std::isspace(static_cast<unsigned char>(*at_)) || *at_ == ';')) {
      if (*at_ == ';') at_ = std::find(at_, end_, '\n');
      if (at_ < end_) ++at_;
    }
    return at_ < end_ && *at_ == c;
  }
  bool skip(char c) { return sees(c) && ++at_; }
  std::string_view word() {
    const char* const start = at_;
    while (at_ < end_ && *at_ && is_of_word(*at_)) ++at_;
    return {start, std::size_t(at_ - start)};
  }
  /// Reads a list of records up to '}' or the end.
  bool list(FbxRecord& parent, int depth) {
    while (true) {
      sees('}');
      if (at_ == end_ || *at_ == '}') return true;
      const std::string_view name = word();
      if (name.empty() || !skip(':') || depth > kMaxDepth) return false;
      if (name == "a") {
        numbers(parent.array);
        continue;
      }
      FbxRecord& record = parent.children.emplace_back();
      record.name = name;
      if (!values(record)) return false;
      if (skip('{') && (!list(record, depth + 1) || !skip('}'))) return false;
    }
  }
  void numbers(std::vector<double>& to) {
    double value = 0.0;
    do {
      sees(',');
      if (!read_number(at_, end_, value)) return;
      to.push_back(value);
    } while (skip(','));
  }
  bool values(FbxRecord& to) {
    do {
      if (skip('"')) {
        const char* const stop = std::find(at_, end_, '"');
        if (stop == end_) return false;
        to.values.push_back({0.0, 0, {at_, std::size_t(stop - at_)}});
        at_ = stop + 1;
        continue;
      }
      skip('*');  // the length of an array
      sees('{');
      const char* const start = at_;
      const std::string_view text = word();
      if (sees(':')) {  // the name of the next record
        at_ = start;
        return true;
      }
      if (text.empty()) continue;
      FbxValue value{0.0, 0, text};
      std::from_chars(text.data(), text.data() + text.size(), value.integer);
      const char* at = text.data();
      if (read_number(at, text.data() + text.size(), value.number) && at == text.data() + text.size()) value.text = {};
      to.values.push_back(value);
    } while (skip(','));
    return true;
  }

  const char *at_, *end_;
};

/// Sets the name of an object: "Model::name", in binary files name, 0, 1, "Model".
void set_name(std::string_view text, FbxObject& object) {
  constexpr std::string_view kMark("\0\1", 2);
  const std::size_t colons = text.find("::");
  object.name = text.substr(0, text.find(kMark));
  if (text.find(kMark) == std::string_view::npos && colons != std::string_view::npos)
    object.name = text.substr(colons + 2);
}

void connect(FbxFile& file) {
  for (const FbxRecord& record : file.root["Connections"].children) {
    if (record.name != "C" || record.values.size() < 3) continue;
    const auto child = file.objects.find(record.values[1].integer),
               parent = file.objects.find(record.values[2].integer);
    if (child == file.objects.end() || parent == file.objects.end()) continue;
    const std::string_view property = record.text(0) == "OP" ? record.text(3) : std::string_view();
    parent->second.children.push_back({&child->second, property});
    child->second.parents.push_back({&parent->second, property});
  }
}

const FbxRecord kNoRecord;

}  // namespace

const FbxRecord& FbxRecord::operator[](std::string_view child) const {
  for (const FbxRecord& each : children)
    if (each.name == child) return each;
  return kNoRecord;
}

constexpr std::size_t kFirstNumber = 4;  // of a property: name, type, label, flags, numbers

const FbxRecord& FbxObject::property(std::string_view key) const {
  if (!record) return kNoRecord;
  for (const FbxRecord& each : (*record)["Properties70"].children)
    if (each.text() == key) return each;
  if (!defaults) return kNoRecord;
  const auto found = defaults->find(key);
  return found == defaults->end() ? kNoRecord : *found->second;
}

double FbxObject::number(std::string_view key, double otherwise) const {
  return property(key).number(kFirstNumber, otherwise);
}

int FbxObject::choice(std::string_view key, int count, int otherwise) const {
  const double value = number(key, otherwise);
  return value >= 0.0 && value < count ? int(value) : otherwise;
}

glm::dvec3 FbxObject::vector(std::string_view key, const glm::dvec3& otherwise) const {
  const FbxRecord& found = property(key);
  if (found.values.size() < kFirstNumber + 3) return otherwise;
  return {found.values[kFirstNumber].number, found.values[kFirstNumber + 1].number,
          found.values[kFirstNumber + 2].number};
}

std::vector<FbxObject*> FbxObject::parts(std::string_view wanted) const {
  std::vector<FbxObject*> found;
  for (const Link& link : children)
    if (link.property.empty() && link.object->type == wanted) found.push_back(link.object);
  return found;
}

Result<void> read_fbx_file(const std::filesystem::path& path, FbxFile& file) {
  auto bytes = read_whole_file(path);
  if (!bytes) return bytes.error();
  file.bytes = std::move(*bytes);
  const auto unreadable = [&](const std::string& reason) {
    return file_error("'{}' cannot be read as FBX ({})", path.string(), reason);
  };
  constexpr std::uint32_t kOldest = 7000;
  std::uint32_t version = 0;
  bool is_sound = false;
  if (file.bytes.starts_with(kBinary) && file.bytes.size() > kHeader) {
    BinaryParser parser(file.bytes);
    version = parser.version();
    is_sound = version < kOldest || parser.parse(file.root);
  } else {
    is_sound = TextParser(without_mark(file.bytes)).parse(file.root);
    version = std::uint32_t(file.root["FBXHeaderExtension"]["FBXVersion"].number(0, 0.0));
  }
  if (!is_sound) return unreadable("its content is of another format, damaged, or cut short");
  if (version < kOldest)
    return unreadable(fmt::format("its version is {}; export it as FBX 2011 or later, version 7100", version));
  for (const FbxRecord& type : file.root["Definitions"].children)
    for (const FbxRecord& each : type["PropertyTemplate"]["Properties70"].children)
      file.defaults[type.text()].emplace(each.text(), &each);
  file.objects[0].type = "Model";
  for (const FbxRecord& record : file.root["Objects"].children) {
    if (record.values.size() < 3 || record.values[0].integer == 0) continue;
    FbxObject& object = file.objects[record.values[0].integer];
    object.record = &record;
    object.type = record.name;
    object.subtype = record.text(2);
    const auto known = file.defaults.find(record.name);
    object.defaults = known == file.defaults.end() ? nullptr : &known->second;
    set_name(record.text(1), object);
  }
  connect(file);
  return {};
}

}  // namespace umbrage
