// Functions on texts in GLSL and in the kernel dialect.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace umbrage {

/// Returns whether a name can contain a character.
inline bool is_word(char c) {
  return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Returns the text without spaces and line feeds at its ends.
std::string stripped(std::string_view text);

/// Returns the text with comments replaced by spaces.
std::string blanked(std::string text);

/// Returns the words of a text that could be names, without comments.
std::vector<std::string> words_of(const std::string& text);

/// Return the text with all occurrences of a text, or of a whole word, replaced.
std::string replaced(std::string text, std::string_view what, std::string_view by);
std::string with_word(std::string_view text, std::string_view word, std::string_view by);

/// Returns the index of the bracket that closes the one at `open`.
std::size_t closing(std::string_view code, std::size_t open);

/// Splits at a separator outside of brackets, and strips the parts.
std::vector<std::string> split_outside(std::string_view code, std::string_view separator);

}  // namespace umbrage
