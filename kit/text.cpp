#include "kit/text.h"

#include <algorithm>

namespace umbrage {

std::string stripped(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \n"), end = text.find_last_not_of(" \n");
  return begin == std::string_view::npos ? std::string() : std::string(text.substr(begin, end - begin + 1));
}

std::string blanked(std::string text) {
  for (std::size_t at = 0; (at = text.find("//", at)) != std::string::npos;)
    for (; at < text.size() && text[at] != '\n'; ++at) text[at] = ' ';
  return text;
}

std::vector<std::string> words_of(const std::string& text) {
  const std::string code = blanked(text);
  std::vector<std::string> words;
  for (std::size_t begin = 0, end = 0; begin < code.size(); begin = std::max(end, begin + 1)) {
    for (end = begin; end < code.size() && is_word(code[end]);) ++end;
    if (end > begin) words.push_back(code.substr(begin, end - begin));
  }
  return words;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string with_word(std::string_view text, std::string_view word, std::string_view by) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const bool matches = text.substr(k).starts_with(word) && (k == 0 || !is_word(text[k - 1])) &&
                         (k + word.size() == text.size() || !is_word(text[k + word.size()]));
    out += matches ? by : text.substr(k, 1);
    k += matches ? word.size() : 1;
  }
  return out;
}

std::size_t closing(std::string_view code, std::size_t open) {
  int depth = 0;
  for (std::size_t k = open; k < code.size(); ++k) {
    depth += code[k] == '(' || code[k] == '{' || code[k] == '[';
    depth -= code[k] == ')' || code[k] == '}' || code[k] == ']';
    if (depth == 0) return k;
  }
  return code.size() - 1;
}

std::vector<std::string> split_outside(std::string_view code, std::string_view separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < code.size(); ++k) {
    if (code[k] == '(' || code[k] == '[') k = closing(code, k);
    if (!code.substr(k).starts_with(separator)) continue;
    parts.push_back(stripped(code.substr(begin, k - begin)));
    begin = k + separator.size();
  }
  parts.push_back(stripped(code.substr(begin)));
  return parts;
}

}  // namespace umbrage
