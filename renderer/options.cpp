#include "renderer/options.h"

#include <algorithm>
#include <cctype>

#include "core/check.h"
#include "renderer/option_rows.h"

namespace umbrage {
namespace {

/// Returns all options in the order of the help.
const std::vector<Option>& all_options() {
  static const std::vector<Option> all = [] {
    std::vector<Option> rows = scene_options();
    for (const auto& more : {picture_options(), gbuffer_options()}) rows.insert(rows.end(), more.begin(), more.end());
    return rows;
  }();
  return all;
}

/// Returns the end of the quotation '...' that begins at `at`, after its closing mark; `at` if none begins there.
/// Apostrophes, as in "the picture's" or "the models' sizes", do not begin one.
std::size_t end_of_quotation(std::string_view message, std::size_t at) {
  const auto is_letter = [&](std::size_t k) { return k < message.size() && std::isalnum((unsigned char)message[k]); };
  if (message[at] != '\'' || (at > 0 && message[at - 1] != ' ' && message[at - 1] != '(')) return at;
  for (std::size_t k = at + 1; k < message.size(); ++k)
    if (message[k] == '\'' && !is_letter(k + 1)) return k + 1;
  return at;
}

}  // namespace

std::vector<std::string_view> words_of(const Option& option) { return option.names ? option.names() : option.choices; }

std::span<const Option> options() { return all_options(); }

const Option& option_of(std::string_view field) {
  for (const Option& option : all_options())
    if (option.field == field) return option;
  fail_check(fmt::format("there is no option for the field '{}'", field));
}

const Option* find_option(std::string_view name, unsigned commands) {
  for (const Option& option : all_options())
    if (option.option == name && (option.commands & commands)) return &option;
  return nullptr;
}

std::string with_fields_renamed(std::string_view message, std::string (*rename)(const Option&)) {
  std::string text;
  for (std::size_t at = 0; at < message.size();) {
    if (message[at] == '`') {
      const std::size_t close = message.find('`', at + 1);
      const std::string_view field = message.substr(at + 1, close == std::string_view::npos ? close : close - at - 1);
      const auto row =
          std::find_if(all_options().begin(), all_options().end(), [&](const Option& o) { return o.field == field; });
      if (close != std::string_view::npos && row != all_options().end()) {
        text += rename(*row);
        at = close + 1;
        continue;
      }
    }
    const std::size_t next = std::max(end_of_quotation(message, at), at + 1);
    text += message.substr(at, next - at);
    at = next;
  }
  return text;
}

std::string with_option_names(std::string_view message) {
  return with_fields_renamed(message, [](const Option& row) { return "--" + std::string(row.option); });
}

}  // namespace umbrage
