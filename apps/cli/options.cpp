#include "apps/cli/options.h"

#include <tbb/global_control.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>

#include "io/image_file.h"
#include "renderer/devices.h"
#include "renderer/isa_setting.h"

namespace umbrage::cli {

void add_one(CLI::App& command, CommonOptions& o, std::string_view field, std::string_view group, std::string_view help,
             std::string_view initial) {
  const Option& row = option_of(field);
  const std::string name = "--" + std::string(row.option);
  std::string text(help.empty() ? row.help : help);
  constexpr double kTold = 2000.0;  // up to which people want to know how far a number goes
  if (is_whole(row) && row.max < kTold) text += fmt::format(", {} to {}", long(row.min), long(row.max));
  if (initial.empty()) initial = row.initial;
  if (!initial.empty()) text += fmt::format(" [{}]", initial);
  CLI::Option* option = nullptr;
  if (const auto* of = std::get_if<FieldOf<bool>>(&row.where)) {
    bool& flag = o.flags[row.option];
    flag = (*of)(o.request);
    option = command.add_flag(name, flag, text);
  } else if (std::holds_alternative<FieldOf<std::vector<std::string>>>(row.where)) {
    option = command.add_option(name, o.lists[row.option], text)->take_all()->expected(1)->allow_extra_args(false);
  } else {
    option = command.add_option(name, o.texts[row.option], text);
  }
  if (!row.environment.empty()) option->envname(std::string(row.environment));
  if (!group.empty()) option->group(std::string(group));
}

void add_group(CLI::App& command, CommonOptions& o, OptionCommand which, std::string_view group) {
  for (const Option& row : options())
    if ((row.commands & which) && row.group == group) add_one(command, o, row.field, group);
}

void add_model_options(CLI::App& command, CommonOptions& o, OptionCommand which) {
  command.add_option("MODEL", o.models, "model files, - for standard input, or scene:NAME?detail=TRIANGLES")
      ->required();
  add_group(command, o, which, "Scene");
  command
      .add_option("--input-format", o.input_format,
                  "format of the model on standard input, such as obj [by its content]")
      ->group("Scene");
  add_group(command, o, which, "Camera");
}

void add_device_options(CLI::App& command, CommonOptions& o, OptionCommand which) {
  add_group(command, o, which, "Device");
  command.add_flag("--verbose", o.verbose, "say what is done and how long each stage took")
      ->envname("UMBRAGE_VERBOSE")
      ->group("Output");
  add_config_option(command);
}

Result<void> take_options(CommonOptions& o) {
  if (!o.models.empty()) {
    o.request.model = o.models[0];
    o.request.more_models.assign(o.models.begin() + 1, o.models.end());
  }
  for (const Option& row : options()) {
    if (row.commands == 0) continue;  // another row's option
    std::vector<std::string> words;
    if (o.is_given(row.option)) words.push_back(o.texts[row.option]);
    if (const auto list = o.lists.find(row.option); list != o.lists.end()) words = list->second;
    if (const auto flag = o.flags.find(row.option); flag != o.flags.end()) words = {flag->second ? "true" : "false"};
    for (const std::string& word : words)
      if (auto set = set_option(row, word, o.request); !set) return set;
  }
  return {};
}

std::string in_options(std::string_view message) {
  return with_fields_renamed(message, [](const Option& row) { return "--" + std::string(row.option); });
}

Result<std::unique_ptr<Device>> device_of(const CommonOptions& o) {
  if (o.is_given("isa"))
    if (auto valid = use_isa(o.texts.find("isa")->second); !valid) return valid.error();
  // Also for work that no device does: hierarchies, metrics.
  static std::optional<tbb::global_control> limit;
  if (o.request.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(o.request.threads));
  return make_device(o.request.device, o.request.threads);
}

Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) {
    for (const char* file : files)
      if (auto writable = check_writable(folder / file); !writable) return writable;
    return {};
  }
  fs::path parent = fs::absolute(folder, ignored);
  while (!fs::exists(parent, ignored) && parent != parent.parent_path()) parent = parent.parent_path();
  if (folder.empty() || !fs::is_directory(parent, ignored) || ::access(parent.c_str(), W_OK | X_OK) != 0)
    return file_error("'{}': the folder cannot be made", folder.string());
  return {};
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return words;
}

}  // namespace umbrage::cli
