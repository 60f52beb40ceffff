#include "apps/cli/frame_names.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <optional>

namespace umbrage::cli {
namespace {

constexpr int kMaxDigits = 9;

/// A frame number in a name: its place, and its digits.
struct NumberPlace {
  std::size_t begin = 0, end = 0;
  int digits = 1;
};

/// Returns a name with $F4, as Houdini writes a frame number, as %04d, and $F as %d.
std::string with_percent(std::string name) {
  for (std::size_t at = name.find("$F"); at != std::string::npos; at = name.find("$F", at + 1)) {
    const std::size_t end = std::min(name.find_first_not_of("0123456789", at + 2), name.size());
    if (end > at + 3 || (end < name.size() && std::isalpha(static_cast<unsigned char>(name[end])))) continue;
    name.replace(at, end - at, end == at + 2 ? "%d" : fmt::format("%0{}d", name[at + 2]));
  }
  return name;
}

/// Returns the number that begins at `at`, with # or %; nullopt if these characters are none.
std::optional<NumberPlace> number_at(const std::string& name, std::size_t at) {
  NumberPlace place{at, at + 1, 1};
  if (name[at] == '#') {
    place.end = std::min(name.find_first_not_of('#', at), name.size());
    place.digits = int(place.end - at);
  } else {
    place.end = std::min(name.find_first_not_of("0123456789", at + 1), name.size());
    const std::string_view width = std::string_view(name).substr(at + 1, place.end - at - 1);
    if (place.end == name.size() || name[place.end] != 'd') return std::nullopt;
    ++place.end;
    if (!width.empty() &&
        (width[0] != '0' || std::from_chars(width.begin(), width.end(), place.digits).ec != std::errc()))
      return std::nullopt;
    place.digits = std::max(place.digits, 1);
  }
  return place.digits <= kMaxDigits ? std::optional(place) : std::nullopt;
}

}  // namespace

std::string FrameNames::of(int frame) const { return fmt::format("{}{:0{}}{}", before, frame, digits, after); }

std::string FrameNames::pattern() const { return before + std::string(std::size_t(digits), '#') + after; }

std::vector<int> FrameNames::existing(FrameNames* others) const {
  namespace fs = std::filesystem;
  std::vector<int> frames;
  if (others) *others = {before, after, 0};
  if (after.find('/') != std::string::npos) return frames;
  const fs::path start(before);
  const std::string stem = start.filename().string();
  std::error_code error;
  fs::directory_iterator entry(start.has_parent_path() ? start.parent_path() : fs::path("."), error), end;
  for (; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() <= stem.size() + after.size() || !name.starts_with(stem) || !name.ends_with(after)) continue;
    const std::string_view number(name.data() + stem.size(), name.size() - stem.size() - after.size());
    int frame = 0;
    const auto [stop, failed] = std::from_chars(number.begin(), number.end(), frame);
    if (failed != std::errc() || stop != number.end()) continue;
    // The same number may be written with other digits, which is another name.
    if (fs::path(of(frame)).filename().string() == name)
      frames.push_back(frame);
    else if (const int count = int(number.size()); others && frame >= 0)
      others->digits = others->digits == 0 ? count : std::min(others->digits, count);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

bool has_frame_number(const std::string& given) {
  const std::string name = with_percent(given);
  for (std::size_t at = 0; at < name.size(); ++at) {
    if (name[at] != '%' && name[at] != '#') continue;
    const bool begins = at == 0 || name[at - 1] != '#';  // further # belong to the same number
    if (begins && number_at(name, at)) return true;
    if (name.compare(at, 2, "%%") == 0) ++at;
  }
  return false;
}

Result<FrameNames> frame_names(const std::string& given, std::string_view option) {
  const std::string name = with_percent(given);
  FrameNames names;
  bool numbered = false;
  for (std::size_t at = 0; at < name.size(); ++at) {
    std::string& part = numbered ? names.after : names.before;
    const bool is_escaped = name.compare(at, 2, "%%") == 0;
    if ((name[at] != '%' && name[at] != '#') || is_escaped) {
      part += name[at];
      if (is_escaped) ++at;
      continue;
    }
    const auto place = number_at(name, at);
    if (!place || numbered)
      return usage_error(
          "{} cannot be '{}': it takes one frame number, such as #### or %04d; write %% for a percent sign", option,
          given);
    names.digits = place->digits;
    numbered = true;
    at = place->end - 1;
  }
  if (numbered) return names;
  constexpr int kDefaultDigits = 4;
  const std::filesystem::path plain(names.before);
  names.after = plain.extension().string();
  names.before = names.before.substr(0, names.before.size() - names.after.size()) + "_";
  names.digits = kDefaultDigits;
  return names;
}

}  // namespace umbrage::cli
