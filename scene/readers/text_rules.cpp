#include "scene/readers/text_rules.h"

#include <algorithm>

namespace umbrage {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank_or_tab(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

bool is_decimal_comma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < word.size() && is_digit(word[comma - 1]) &&
         is_digit(word[comma + 1]) && word.find_first_of(",.", comma + 1) == std::string_view::npos &&
         word.find('.') == std::string_view::npos;
}

}  // namespace

bool has_decimal_commas(std::string_view text) {
  constexpr std::string_view kBetween = " \t\v;\r\n";
  while (!text.empty()) {
    std::string_view word = text.substr(0, text.find_first_of(kBetween));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (word.ends_with(',')) word.remove_suffix(1);
    if (is_decimal_comma(word)) return true;
  }
  return false;
}

Error decimal_commas_error(const std::string& file, std::size_t line) {
  return file_error("'{}' has decimal commas, as in line {}; write decimal points", file, line);
}

std::size_t line_number_at(std::string_view text, const char* at) {
  const auto count = [&](char c) { return std::size_t(std::count(text.data(), at, c)); };
  const std::size_t lf = count('\n');
  return 1 + (lf > 0 ? lf : count('\r'));
}

std::string_view without_comment(std::string_view name) {
  for (std::size_t at = name.find('#', 1); at < name.size(); at = name.find('#', at + 1)) {
    if (!is_blank_or_tab(name[at - 1]) || (at + 1 < name.size() && is_digit(name[at + 1]))) continue;
    name = name.substr(0, at);
    while (!name.empty() && is_blank_or_tab(name.back())) name.remove_suffix(1);
  }
  return name;
}

}  // namespace umbrage
