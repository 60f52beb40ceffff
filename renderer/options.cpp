#include "renderer/options.h"

#include <algorithm>
#include <cctype>

#include "core/check.h"
#include "core/printable.h"
#include "renderer/option_rows.h"

namespace umbrage {
namespace {

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

std::span<const Option> options() {
  static const std::vector<Option> all = [] {
    std::vector<Option> rows = scene_options();
    for (const auto& more : {picture_options(), gbuffer_options()}) rows.insert(rows.end(), more.begin(), more.end());
    return rows;
  }();
  return all;
}

const Option* find_field(std::string_view field) {
  const auto row = std::find_if(options().begin(), options().end(), [&](const Option& o) { return o.field == field; });
  return row == options().end() ? nullptr : &*row;
}

const Option& option_of(std::string_view field) {
  if (const Option* option = find_field(field)) return *option;
  fail_check(fmt::format("there is no option for the field '{}'", field));
}

const Option* find_option(std::string_view name, unsigned commands) {
  for (const Option& option : options())
    if (option.option == name && (option.commands & commands)) return &option;
  return nullptr;
}

std::string with_option_names(std::string_view sentence) {
  const std::string message = printable(sentence);
  std::string text;
  for (std::size_t at = 0, next = 0; at < message.size(); at = next) {
    const std::size_t close = message[at] == '`' ? message.find('`', at + 1) : std::string_view::npos;
    const Option* row = close == std::string_view::npos
                            ? nullptr
                            : find_field(std::string_view(message).substr(at + 1, close - at - 1));
    next = row ? close + 1 : std::max(end_of_quotation(message, at), at + 1);
    text += row ? fmt::format("--{}", row->option) : message.substr(at, next - at);
  }
  return text;
}

}  // namespace umbrage
