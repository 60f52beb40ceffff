// Texts from files for messages: a control character in a name could change what a terminal shows.
#pragma once
#include <string>

namespace umbrage {

/// Replaces control characters of ASCII, and those of Latin-1 in UTF-8, by blanks. complete_import calls this for all
/// texts of a scene and for errors of readers, which need not.
inline std::string printable(std::string text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (byte(i) < ' ' || byte(i) == 127) text[i] = ' ';
    if (byte(i) == 0xc2 && i + 1 < text.size() && byte(i + 1) >= 0x80 && byte(i + 1) < 0xa0)
      text[i] = text[i + 1] = ' ';
  }
  return text;
}

}  // namespace umbrage
