// Reading a file into memory, inflated if it is compressed by gzip. All readers of models read through these functions.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/progress.h"
#include "core/result.h"

namespace umbrage {

/// Returns all bytes of a file; of one compressed by gzip its content. Errors: kFile if it cannot be read or inflated,
/// and if its name ends in .gz but it is not compressed; kInterrupted.
Result<std::string> read_whole_file(const std::filesystem::path& file, Poll* poll = nullptr);

/// Returns the number of those bytes. Errors: kFile if the file cannot be read or inflated.
Result<std::size_t> inflated_size_of(const std::filesystem::path& file);

/// Returns the first `count` bytes of that, or fewer if there are no more; empty if the file cannot be read.
std::string read_file_start(const std::filesystem::path& file, std::size_t count);

/// Returns whether a file is compressed by gzip.
bool is_gzip_file(const std::filesystem::path& file);

/// Returns the path without the extension .gz.
std::filesystem::path without_gz(const std::filesystem::path& file);

/// Returns the text without its byte order mark, if it has one.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

}  // namespace umbrage
