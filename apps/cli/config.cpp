#include "apps/cli/config.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/cli/options.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "renderer/options.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOption = "--config";
constexpr std::string_view kNone = "none";

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

/// Returns whether trimmed text is empty or a comment.
bool is_comment(std::string_view rest) { return rest.empty() || rest[0] == '#'; }

/// Returns the value after `=`, without a comment and enclosing quotation marks. Errors: kUsage; the caller adds the
/// line number.
Result<std::string> value_of(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && (text[0] == '"' || text[0] == '\''))
    if (const auto end = text.find(text[0], 1); end != std::string_view::npos) {
      const std::string_view rest = trimmed(text.substr(end + 1));
      if (is_comment(rest)) return std::string(text.substr(1, end - 1));
      return usage_error("'{}' follows {}; only a comment may follow", rest, text.substr(0, end + 1));
    }
  const std::size_t comment = std::min(text.find(" #"), text.find("\t#"));
  return std::string(trimmed(text.substr(0, comment)));
}

/// Returns the last value of --config on a command line.
std::optional<std::string> named_file(const std::vector<std::string>& words) {
  std::optional<std::string> named;
  const std::string start = std::string(kOption) + "=";
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i].starts_with(start)) named = words[i].substr(start.size());
    if (words[i] == kOption && i + 1 < words.size()) named = words[i + 1];
  }
  return named;
}

fs::path default_file() {
  if (const char* folder = std::getenv("XDG_CONFIG_HOME"); folder && *folder)
    return fs::path(folder) / "umbrage/config";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".config/umbrage/config";
  return {};
}

/// Returns whether the command line has the option in one of its spellings.
bool is_given(const CLI::Option& option, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    for (const std::string& name : option.get_lnames())
      if (word == "--" + name || word.starts_with("--" + name + "=")) return true;
    for (const std::string& name : option.get_snames())
      if (word.starts_with("-" + name) && !word.starts_with("--")) return true;
    return false;
  });
}

/// Checks the value of one option, independently of other options. Errors: kUsage.
Result<void> check_value(CLI::Option& option, std::string value) {
  if (option.get_type_name().empty()) {  // a flag
    try {
      CLI::detail::to_flag_value(value);
      return {};
    } catch (const std::invalid_argument&) {
      return field_error(option.get_name(), value, "{} cannot be '{}': it takes true or false");
    }
  }
  try {
    const std::string wrong = (*option.get_validator())(value);
    return wrong.empty() ? Result<void>() : Error{ErrorKind::kUsage, wrong};
  } catch (const CLI::OptionNotFound&) {  // no validator: any text is valid
    return {};
  }
}

/// An option that a file sets, as written there.
struct Setting {
  std::string section;        ///< command, or empty for all commands
  std::string option, value;  ///< option: without dashes
  std::string place;          ///< file and line or, of JSON, name, as messages name them
};

Error error_at(const std::string& place, const std::string& what) { return usage_error("{}: {}", place, what); }

/// Reads lines `option = value` under headings. Errors: kUsage.
Result<std::vector<Setting>> settings_of_lines(std::istream& stream, const fs::path& file) {
  std::vector<Setting> settings;
  std::string section, line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text[0] == '#' || text[0] == ';') continue;
    const std::string place = fmt::format("'{}', line {}", file.string(), number);
    if (text[0] == '[') {
      const std::size_t end = text.find(']');
      if (end == text.npos) return error_at(place, "a heading must have the form [command]");
      section = std::string(trimmed(text.substr(1, end - 1)));
      const std::string_view rest = trimmed(text.substr(end + 1));
      if (!is_comment(rest))
        return error_at(place, fmt::format("'{}' follows [{}]; only a comment may follow", rest, section));
      settings.push_back({section, "", "", place});
      continue;
    }
    const std::size_t equals = text.find('=');
    std::string name(trimmed(text.substr(0, equals)));
    if (equals == text.npos || name.empty()) return error_at(place, "a line must have the form option = value");
    if (name.starts_with("--")) name.erase(0, 2);
    const auto value = value_of(text.substr(equals + 1));
    if (!value) return error_at(place, value.error().message);
    settings.push_back({section, name, *value, place});
  }
  return settings;
}

/// Adds the options of a JSON object: texts, numbers, true or false, or lists of them. Errors: kUsage.
Result<void> add_json(const nlohmann::json& object, const std::string& section, const fs::path& file,
                      std::vector<Setting>& settings) {
  for (const auto& [name, value] : object.items()) {
    const std::string place = fmt::format("'{}', {}", file.string(), name);
    if (value.is_object()) {
      if (!section.empty()) return error_at(place, "an option takes no object");
      settings.push_back({name, "", "", place});
      if (auto added = add_json(value, name, file, settings); !added) return added;
      continue;
    }
    for (const nlohmann::json& each : value.is_array() ? value : nlohmann::json::array({value})) {
      if (!each.is_primitive() || each.is_null())
        return error_at(place, "an option takes a text, a number, true or false, or a list of these");
      settings.push_back({section, name, each.is_string() ? each.get<std::string>() : each.dump(), place});
    }
  }
  return {};
}

/// Reads a JSON object: options, and objects of options by command, which override them. Errors: kUsage.
Result<std::vector<Setting>> settings_of_json(const std::string& text, const fs::path& file) {
  std::vector<Setting> settings;
  try {
    const nlohmann::json object = nlohmann::json::parse(text);
    if (auto added = add_json(object, "", file, settings); !added) return added.error();
  } catch (const nlohmann::json::exception& error) {
    return usage_error("'{}' is not valid JSON: {}", file.string(), error.what());
  }
  std::stable_partition(settings.begin(), settings.end(), [](const Setting& each) { return each.section.empty(); });
  return settings;
}

/// Adds the value of a setting for `command`, unless it is given elsewhere. `heading_of`: section of each option that
/// has been added. Errors: kUsage.
Result<void> add_setting(const Setting& setting, const CLI::App& app, CLI::App& command,
                         const std::vector<std::string>& words, std::map<std::string, std::string>& heading_of,
                         std::vector<ConfigValue>& added) {
  const auto& [section, name, value, place] = setting;
  if (name.empty()) {  // a heading
    const std::vector<std::string> names = command_names(app);
    if (contains(names, section)) return {};
    return error_at(place, unknown_name("command", section, names).message);
  }
  if (value.empty()) return error_at(place, fmt::format("{} needs a value", name));
  // The name must be an option of the section's command or, before the first heading, of any command.
  bool known = false;
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands({})) {
    if (!section.empty() && each->get_name() != section) continue;
    for (const CLI::Option* option : each->get_options())
      for (const std::string& spelling : option->get_lnames())
        if (spelling != "help" && spelling != "config") {
          names.push_back(spelling);
          known = known || spelling == name;
        }
  }
  if (!known) return error_at(place, unknown_name("option", name, names).message);
  if (!section.empty() && section != command.get_name()) return {};
  CLI::Option* option = command.get_option_no_throw("--" + name);
  if (!option) return {};
  const bool several = option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  // Values of --set add up across headings and the command line, since each sets another parameter.
  const bool adds_up = name == option_of("settings").option;
  const char* variable = option->get_envname().empty() ? nullptr : std::getenv(option->get_envname().c_str());
  if ((is_given(*option, words) && !adds_up) || (variable && *variable)) return {};
  if (const auto status = check_value(*option, value); !status) return error_at(place, status.error().message);
  // A later line overrides an earlier one, unless both are values of a repeatable option under the same heading.
  const auto [earlier, first] = heading_of.emplace(name, section);
  if (!first && !adds_up && !(several && earlier->second == section))
    std::erase_if(added, [&name = setting.option](const ConfigValue& other) { return other.option == name; });
  earlier->second = section;
  added.push_back({name, value, place});
  return {};
}

}  // namespace

void add_config_option(CLI::App& command) {
  // Read by with_config, before the command line is parsed.
  static std::string ignored;
  command
      .add_option(kOption, ignored,
                  "configuration file, or none [umbrage/config in XDG_CONFIG_HOME or ~/.config, if it exists]")
      ->type_name("FILE")
      ->group("Configuration");
}

Result<Configured> with_config(CLI::App& app, std::vector<std::string> words) {
  if (words.empty()) return Configured();
  CLI::App* command = nullptr;
  for (CLI::App* each : app.get_subcommands({}))
    if (each->get_name() == words[0]) command = each;
  if (!command || !command->get_option_no_throw(kOption)) return Configured{std::move(words), {}};
  const auto named = named_file(words);
  if (named && *named == kNone) return Configured{std::move(words), {}};
  const fs::path file = named ? fs::path(*named) : default_file();
  std::error_code ignored;
  if (!named && (file.empty() || !fs::is_regular_file(file, ignored))) return Configured{std::move(words), {}};
  std::ifstream stream(file);
  if (!stream || fs::is_directory(file, ignored))
    return file_error("'{}' cannot be read as a configuration", file.string());

  std::stringstream content;
  content << stream.rdbuf();
  const auto settings = trimmed(content.str()).starts_with('{') ? settings_of_json(content.str(), file)
                                                                : settings_of_lines(content, file);
  if (!settings) return settings.error();
  std::vector<ConfigValue> added;
  std::map<std::string, std::string> heading_of;  // heading of each added option, by option name
  for (const Setting& setting : *settings)
    if (auto status = add_setting(setting, app, *command, words, heading_of, added); !status) return status.error();
  std::vector<std::string> texts;
  for (const ConfigValue& each : added) texts.push_back("--" + each.option + "=" + each.value);
  words.insert(words.begin() + 1, texts.begin(), texts.end());
  return Configured{std::move(words), std::move(added)};
}

Error with_place(Error error, const std::vector<ConfigValue>& values) {
  for (const bool any_value : {false, true})
    for (const auto& [field, value] : error.fields) {
      const Option* row = find_field(field);
      // Values of --set add up, so that the wrong one may be on the command line.
      const bool adds_up = field == "settings" && !value.empty();
      for (const ConfigValue& each : values)
        if ((row ? each.option == row->option : "--" + each.option == field) &&
            (each.value == value || (any_value && !adds_up))) {
          error.message = each.place + ": " + error.message;
          return error;
        }
    }
  return error;
}

}  // namespace umbrage::cli
