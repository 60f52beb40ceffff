// Texts in lower case: letters of ASCII alone, whatever the locale of the process.
#pragma once
#include <string>
#include <string_view>

namespace umbrage {

inline char lowercase(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

inline std::string lowercase(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = lowercase(c);
  return result;
}

}  // namespace umbrage
