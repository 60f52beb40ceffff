#include "scene/readers/find_file.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "core/lowercase.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

}  // namespace

const FileFinder::Entries& FileFinder::entries_of(const fs::path& folder) {
  const auto [known, is_new] = entries_.try_emplace(folder.string());
  if (!is_new) return known->second;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    known->second.emplace(lowercase(name), name);
  }
  return known->second;
}

/// Returns the file at a path whose parts may differ from it in upper and lower case.
std::optional<fs::path> FileFinder::find_ignoring_case(const fs::path& folder, const fs::path& relative) {
  fs::path found = folder;
  for (const fs::path& part : relative) {
    fs::path exact = found / part;
    std::error_code ignored;
    if (fs::exists(exact, ignored)) {
      found = std::move(exact);
      continue;
    }
    const Entries& entries = entries_of(found);
    const auto other = entries.find(lowercase(part.string()));
    if (other == entries.end()) return std::nullopt;
    found /= other->second;
  }
  return is_file(found) ? std::optional(found) : std::nullopt;
}

std::optional<fs::path> FileFinder::find(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  name.erase(name.find_last_not_of(" \t\r") + 1);
  constexpr std::size_t kMaxLength = 4096;  // PATH_MAX of Linux
  if (name.empty() || name.size() > kMaxLength) return std::nullopt;
  const fs::path path(name), beside = folder_ / path;  // an absolute path replaces the folder
  if (is_file(beside)) return beside;
  if (path.is_absolute())
    if (auto found = find_ignoring_case({}, path)) return found;
  constexpr std::ptrdiff_t kMaxParts = 16;
  const std::ptrdiff_t count = std::distance(path.begin(), path.end());
  for (std::ptrdiff_t skipped = std::max<std::ptrdiff_t>(0, count - kMaxParts); skipped < count; ++skipped) {
    fs::path end;
    for (auto part = std::next(path.begin(), skipped); part != path.end(); ++part) end /= *part;
    if (end.is_absolute()) continue;
    if (auto found = find_ignoring_case(folder_, end)) return found;
  }
  return std::nullopt;
}

std::optional<fs::path> find_file(const fs::path& folder, std::string name) {
  return FileFinder(folder).find(std::move(name));
}

}  // namespace umbrage
