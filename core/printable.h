// Text from files and file names, made fit for a message: valid UTF-8 without control characters.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace umbrage {

/// Returns the number of bytes of the UTF-8 character at `at`; 0: there is none. Overlong forms, surrogates and code
/// points above U+10FFFF are none (RFC 3629).
inline std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < text.size() ? (unsigned char)(text[at + k]) : 0u; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xc2 || first > 0xf4 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  const unsigned min = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
  const unsigned max = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
  return length > 0 && second >= min && second <= max ? length : 0;
}

/// Returns the text with blanks in place of the bytes of control characters (C0, DEL and C1), and U+FFFD in place of
/// each byte that is not UTF-8.
inline std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string_view character = text.substr(at, length);
    const bool is_c1 = length == 2 && character < "\xc2\xa0";
    const bool is_control = is_c1 || character == "\x7f" || (length == 1 && (unsigned char)(character[0]) < ' ');
    if (is_control)
      out.append(length, ' ');
    else
      out += length == 0 ? "\xef\xbf\xbd" : character;
    at += length == 0 ? 1 : length;
  }
  return out;
}

}  // namespace umbrage
