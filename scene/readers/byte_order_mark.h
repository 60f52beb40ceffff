// The byte order mark that some programs write at the start of UTF-8 texts.
#pragma once
#include <string_view>

namespace umbrage {

/// Returns the text without its byte order mark, if it has one.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

}  // namespace umbrage
