#include "scene/readers/obj_text.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/lists.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"

namespace umbrage {
namespace {

constexpr double kNotFinite = std::numeric_limits<double>::quiet_NaN();

/// Replaces carriage returns: by line ends, or before a line end by a blank.
void replace_returns(std::string& text) {
  char* const end = text.data() + text.size();
  for (char* at = text.data(); (at = static_cast<char*>(std::memchr(at, '\r', std::size_t(end - at)))); ++at)
    *at = at + 1 < end && at[1] == '\n' ? ' ' : '\n';
}

/// Joins a line that ends in a backslash with the next one, unless the backslash is in a comment, which starts with a
/// '#' after a blank. The line end between them becomes a vertical tab, which line_number counts.
void join_lines(std::string& text) {
  std::size_t seen = 0;
  bool is_comment = false;
  for (std::size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    const std::string_view unseen = std::string_view(text).substr(seen, at - seen);
    if (const std::size_t line_end = unseen.rfind('\n'); line_end != std::string_view::npos) {
      seen += line_end + 1;
      is_comment = false;
    }
    for (; seen < at; ++seen)
      is_comment =
          is_comment || (text[seen] == '#' && (seen == 0 || text[seen - 1] == '\n' || is_blank(text[seen - 1])));
    const std::size_t line_end = at + 1 < text.size() && text[at + 1] == ' ' ? at + 2 : at + 1;
    if (is_comment || line_end >= text.size() || text[line_end] != '\n') continue;
    text[at] = ' ';
    text[line_end] = '\v';
  }
}

/// A parser of one block.
class BlockParser {
 public:
  BlockParser(ObjBlock& block, std::size_t start)
      : block_(block), at_(block.text.data()), end_(at_ + block.text.size()), start_(start) {}

  void parse() {
    while (at_ < end_) {
      skip_blanks();
      line_ = at_;
      if (at_[0] == 'v' && is_blank(at_[1])) {
        at_ += 1;
        position();
      } else if (at_[0] == 'f' && is_blank(at_[1])) {
        at_ += 1;
        face();
      } else if (at_[0] == 'v' && at_[1] == 'n' && is_blank(at_[2])) {
        at_ += 2;
        normal();
      } else if (at_[0] == 'v' && at_[1] == 't' && is_blank(at_[2])) {
        at_ += 2;
        uv();
      } else if (at_[0] != '\n' && at_[0] != '#') {
        statement();
      }
      at_ = static_cast<const char*>(std::memchr(at_, '\n', std::size_t(end_ - at_))) + 1;
    }
  }

  /// For each index relative to the vertices before it: 3 times the corner plus its component.
  std::vector<std::size_t> relative;

 private:
  static constexpr int kMaxNumbers = 6;

  /// Returns the position of the line in the file's text.
  std::size_t place() const { return start_ + std::size_t(line_ - block_.text.data()); }

  static bool ends_word(char c) { return is_blank(c) || c == '\n' || c == '#'; }

  void skip_blanks() {
    while (is_blank(*at_)) ++at_;
  }

  /// Reads up to `max` numbers; returns how many there are before the end of the line or something else.
  int numbers(double* values, int max) {
    int count = 0;
    for (; count < max; ++count) {
      skip_blanks();
      const char* const word = at_;
      if (*at_ == '\n' || !read_number(at_, end_, values[count])) break;
      if (*at_ == ',' && has_decimal_commas({word, std::size_t(std::find_if(at_, end_, ends_word) - word)}))
        block_.commas.add(place());
      if (!ends_word(*at_)) break;  // a number that goes on is none
    }
    return count;
  }

  /// Reserves space for the remainder of the block, whose elements take at least this many bytes of text. Space that is
  /// not used costs nothing, but growing would copy.
  template <class T>
  void reserve(std::vector<T>& list, std::size_t min_bytes) {
    if (list.empty()) list.reserve(std::size_t(end_ - line_) / min_bytes + 1);
  }

  void position() {
    double values[kMaxNumbers];
    reserve(block_.positions, 16);
    const int count = numbers(values, kMaxNumbers);
    ++block_.vertex_lines;
    const bool is_sound = count >= 3 && std::isfinite(values[0] + values[1] + values[2]);
    block_.positions.push_back(is_sound ? glm::dvec3(values[0], values[1], values[2]) : glm::dvec3(kNotFinite));
    if (!is_sound) block_.bad_positions.add(place());
    const bool colored = count >= 6;  // a fourth number alone is a weight, which applies to free-form curves
    if (!colored && block_.colors.empty()) return;
    block_.colors.resize(block_.positions.size() - 1, glm::vec3(1.0f));
    block_.colors.push_back(colored ? glm::vec3(values[3], values[4], values[5]) : glm::vec3(1.0f));
  }

  void normal() {
    double values[3];
    const int count = numbers(values, 3);
    ++block_.vertex_lines;
    // Normals of length zero are replaced by those of the faces.
    block_.normals.push_back(count == 3 ? glm::vec3(values[0], values[1], values[2]) : glm::vec3(0.0f));
  }

  void uv() {
    double values[3] = {0.0, 0.0, 0.0};
    const int count = numbers(values, 3);
    ++block_.vertex_lines;
    block_.uvs.push_back(count >= 1 ? glm::dvec2(values[0], values[1]) : glm::dvec2(0.0));
  }

  void face() {
    bool is_bad = false;
    reserve(block_.corners, 6);
    reserve(block_.faces, 18);
    while (true) {
      skip_blanks();
      if (*at_ == '\n' || *at_ == '#') break;
      is_bad = !corner() || is_bad;
    }
    block_.positions_of_faces = block_.positions.size();
    block_.faces.push_back({std::uint32_t(block_.corners.size()), std::uint32_t(line_ - block_.text.data()), is_bad});
  }

  /// Reads "1", "1/2", "1//3" or "1/2/3".
  bool corner() {
    ObjCorner corner(kNoObjIndex);
    bool is_sound = index(0, block_.positions.size(), corner) && corner[0] != kNoObjIndex;
    if (is_sound && *at_ == '/') {
      ++at_;
      if (*at_ != '/' && !ends_word(*at_)) is_sound = index(1, block_.uvs.size(), corner);
      if (is_sound && *at_ == '/') {
        ++at_;
        if (!ends_word(*at_)) is_sound = index(2, block_.normals.size(), corner);
      }
    }
    is_sound = is_sound && ends_word(*at_);
    while (!ends_word(*at_)) ++at_;
    block_.corners.push_back(corner);
    return is_sound;
  }

  /// Reads an index. 0 counts as none. `count`: the number of vertices before it in the block.
  bool index(int component, std::size_t count, ObjCorner& corner) {
    const bool is_negative = *at_ == '-';
    if (is_negative || *at_ == '+') ++at_;
    std::int64_t value = 0;
    const char* const first = at_;
    for (; *at_ >= '0' && *at_ <= '9'; ++at_) value = std::min<std::int64_t>(10 * value + (*at_ - '0'), kMaxObjIndex);
    if (at_ == first) return false;
    if (value == 0) return true;
    if (is_negative) relative.push_back(3 * block_.corners.size() + std::size_t(component));
    corner[component] = std::int32_t(is_negative ? std::int64_t(count) - value : value - 1);
    return true;
  }

  void statement() {
    const char* word_end = at_;
    while (!is_blank(*word_end) && *word_end != '\n') ++word_end;
    const std::string_view word(at_, std::size_t(word_end - at_));
    const char* line_end = static_cast<const char*>(std::memchr(word_end, '\n', std::size_t(end_ - word_end)));
    const std::string_view rest = without_comment(trimmed({word_end, std::size_t(line_end - word_end)}));
    const auto add = [&](ObjStatement::Kind kind) { block_.statements.push_back({kind, block_.faces.size(), rest}); };
    const auto is_one_of = [&](std::initializer_list<std::string_view> words) { return contains(words, word); };
    if (word == "usemtl") {
      add(ObjStatement::kMaterial);
    } else if (word == "o") {
      add(ObjStatement::kObject);
    } else if (word == "g") {
      add(ObjStatement::kGroup);
    } else if (word == "s") {
      add(ObjStatement::kSmoothing);
    } else if (word == "fo") {  // a face in files of before 1990
      at_ += 2;
      face();
    } else if (is_one_of({"v", "vt", "vn", "f"})) {  // without anything after it
      at_ = word_end;
      word == "v" ? position() : word == "vt" ? uv() : word == "vn" ? normal() : face();
    } else if (word == "l") {
      block_.lines.add(place());
    } else if (word == "p") {
      block_.points.add(place());
    } else if (is_one_of({"curv", "curv2", "surf"})) {
      block_.curves.add(place());
    } else if (!is_one_of({"mtllib",   "vp",   "cstype",     "deg",       "bmat",  "step",  "parm",  "trim",
                           "hole",     "scrv", "sp",         "end",       "con",   "mg",    "bevel", "c_interp",
                           "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech", "stech", "maplib"})) {
      constexpr std::size_t kMaxWords = 16;  // of a file that is something else
      if (block_.other.size() < kMaxWords && !contains(block_.other, word)) block_.other.push_back(word);
    }
    at_ = std::min(at_, line_end);
  }

  ObjBlock& block_;
  const char *at_, *end_, *line_ = nullptr;
  std::size_t start_;
};

/// Returns blocks of about `size` bytes that end with a line.
std::vector<ObjBlock> blocks_of(std::string_view text, std::size_t size) {
  std::vector<ObjBlock> blocks;
  while (!text.empty()) {
    const std::size_t end = text.size() <= size ? text.size() : text.find('\n', size) + 1;
    blocks.emplace_back().text = text.substr(0, end);
    text.remove_prefix(end);
  }
  return blocks;
}

}  // namespace

void normalize_lines(std::string& text) {
  if (text.starts_with("\xef\xbb\xbf")) text.replace(0, 3, "   ");
  replace_returns(text);
  if (text.empty() || text.back() != '\n') text.push_back('\n');
  join_lines(text);
  if (text.back() != '\n') text.push_back('\n');
}

std::size_t line_number(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  return 1 +
         std::size_t(std::count(before.begin(), before.end(), '\n') + std::count(before.begin(), before.end(), '\v'));
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<ObjBlock> parse_obj(std::string_view text, bool threads, Poll* poll) {
  constexpr std::size_t kBlockBytes = std::size_t(1) << 18, kBlocksPerPoll = 64;
  std::vector<ObjBlock> blocks = blocks_of(text, kBlockBytes);
  std::vector<std::vector<std::size_t>> relative(blocks.size());
  const auto parse = [&](std::size_t i) {
    BlockParser parser(blocks[i], std::size_t(blocks[i].text.data() - text.data()));
    parser.parse();
    relative[i] = std::move(parser.relative);
  };
  for (std::size_t first = 0; first < blocks.size(); first += kBlocksPerPoll) {
    if (poll && poll->passing(double(first) / double(blocks.size()))) return blocks;
    const std::size_t last = std::min(first + kBlocksPerPoll, blocks.size());
    if (threads && last - first > 1)
      tbb::parallel_for(first, last, parse);
    else
      for (std::size_t i = first; i < last; ++i) parse(i);
  }
  ObjCorner before(0);
  const auto add = [](std::int32_t& sum, std::size_t count) {  // without overflow, for files that read_obj refuses
    sum = std::int32_t(std::min(std::size_t(sum) + count, std::size_t(kMaxObjIndex)));
  };
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (const std::size_t place : relative[i]) blocks[i].corners[place / 3][int(place % 3)] += before[int(place % 3)];
    add(before.x, blocks[i].positions.size());
    add(before.y, blocks[i].uvs.size());
    add(before.z, blocks[i].normals.size());
  }
  return blocks;
}

}  // namespace umbrage
