#include "apps/cli/options.h"

#include <tbb/global_control.h>

#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "core/lowercase.h"
#include "io/image_file.h"
#include "renderer/devices.h"

namespace umbrage::cli {
namespace {

constexpr const char* kSizeName = "W,H";

/// Returns the help text with the range of an integer, if its upper end is below kMaxShownRange, and the default.
std::string help_with(std::string_view help, const Interval& interval, std::string_view initial) {
  constexpr double kMaxShownRange = 2000.0;
  std::string text(help);
  if (interval.kind != NumberKind::kReal && interval.max < kMaxShownRange)
    text += fmt::format(", {} to {}", long(interval.min), long(interval.max));
  return initial.empty() ? text : fmt::format("{} [{}]", text, initial);
}

/// Returns the name of a value that the help shows.
std::string type_of(const Interval& interval) { return interval.kind == NumberKind::kReal ? "FLOAT" : "INT"; }

std::string type_of(const Option& row) {
  switch (row.form) {
    case OptionForm::kSize:
      return kSizeName;
    case OptionForm::kPercent:
      return "PERCENT";
    case OptionForm::kLength:
      return "LENGTH";
    case OptionForm::kPosition:
    case OptionForm::kDirection:
      return "X,Y,Z";
    case OptionForm::kColor:
      return "COLOR";
    case OptionForm::kPair:
      return row.field == "color_range" ? "LOW,HIGH" : "NEAR,FAR";
    case OptionForm::kAngles:
      return "AZIMUTH,ELEVATION";
    case OptionForm::kRotation:
    case OptionForm::kWindow:
    case OptionForm::kIntrinsics:
      return "NUMBERS";
    case OptionForm::kWords:
      return "NAMES";
    case OptionForm::kPlain:
      break;
  }
  if (interval_of(row).max > 0.0) return type_of(interval_of(row));
  if (row.field == "bits") return "INT";
  if (row.field == "settings") return "EFFECT.PARAMETER=VALUE";
  if (row.field == "sections") return "PLANE";
  return row.field.ends_with("_file") ? "FILE" : "NAME";
}

template <class Number>
CLI::Option* add_any_number(CLI::App& command, const std::string& name, Number& value, const Interval& interval,
                            std::string_view help, std::string_view initial) {
  const std::string current = fmt::format("{}", value);
  CLI::Option* option = command.add_option_function<std::string>(
      name, [&value](const std::string& text) { value = Number(parse_number(text).value_or(double(value))); },
      help_with(help, interval, initial.empty() ? current : initial));
  option->type_name(type_of(interval));
  add_check(*option, [name, interval](const std::string& text) -> Result<void> {
    if (parse_number(text, interval)) return {};
    return field_error(name, text, "{} cannot be '{}': it takes {}", interval.words());
  });
  return option;
}

/// Checks the text of an option of the table, including that named looks, techniques and settings exist. Devices are
/// checked later.
Result<void> check_text(const Option& row, const std::string& text) {
  // CLI11 reads the environment for all commands, not only for the one that runs. Values from the environment are
  // therefore not checked here; parse_options checks those of the command that runs.
  const char* variable = row.environment.empty() ? nullptr : std::getenv(std::string(row.environment).c_str());
  if (variable && text == variable) return {};
  Request alone;
  if (auto set = set_option(row, text, alone); !set) return set;
  if (const auto settings = effect_settings(alone.settings); !settings) return settings.error();
  // Other options may depend on each other and cannot be checked alone.
  if (row.field != "look" && row.field != "occlusion" && row.field != "quality") return {};
  const auto recipe = make_recipe_of_look(alone);
  return recipe ? Result<void>() : recipe.error();
}

}  // namespace

void add_check(CLI::Option& option, Check check) {
  option.check([check = std::move(check)](const std::string& text) -> std::string {
    const auto status = text.empty() ? Result<void>() : check(text);  // main reports empty texts
    return status ? "" : status.error().message;
  });
}

CLI::Option* add_number(CLI::App& command, const std::string& name, int& value, const Interval& interval,
                        std::string_view help, std::string_view initial) {
  return add_any_number(command, name, value, interval, help, initial);
}

CLI::Option* add_number(CLI::App& command, const std::string& name, double& value, const Interval& interval,
                        std::string_view help, std::string_view initial) {
  return add_any_number(command, name, value, interval, help, initial);
}

CLI::Option* add_sizes(CLI::App& command, std::vector<std::string>& sizes, std::string_view initial) {
  CLI::Option* option =
      command
          .add_option("--resolution", sizes,
                      fmt::format("width,height, or one number for a square; may be given several times [{}]", initial))
          ->take_all()
          ->expected(1)
          ->allow_extra_args(false)
          ->type_name(kSizeName);
  add_check(*option, [](const std::string& text) -> Result<void> {
    const auto size = parse_size("width", text, kMaxPixels);
    return size ? Result<void>() : size.error();
  });
  return option;
}

void add_one(CLI::App& command, CommonOptions& o, std::string_view field, std::string_view group, std::string_view help,
             std::string_view initial) {
  const Option& row = option_of(field);
  const std::string name = "--" + std::string(row.option);
  const std::string text = with_option_names(
      help_with(help.empty() ? row.help : help, interval_of(row), initial.empty() ? row.initial : initial));
  CLI::Option* option = nullptr;
  if (const auto* of = std::get_if<FieldOf<bool>>(&row.where)) {
    bool& flag = o.flags[row.option];
    flag = (*of)(o.request);
    option = command.add_flag(name, flag, text);
  } else if (std::holds_alternative<FieldOf<std::vector<std::string>>>(row.where) && row.form != OptionForm::kWords) {
    option = command.add_option(name, o.lists[row.option], text)->take_all()->expected(1)->allow_extra_args(false);
  } else {
    option = command.add_option(name, o.texts[row.option], text);
  }
  if (!option->get_type_name().empty()) {  // not a flag
    option->type_name(type_of(row));
    add_check(*option, [&row](const std::string& word) { return check_text(row, word); });
  }
  if (!row.environment.empty()) option->envname(std::string(row.environment));
  if (!group.empty()) option->group(std::string(group));
}

void add_group(CLI::App& command, CommonOptions& o, OptionCommand which, std::string_view group) {
  for (const Option& row : options())
    if ((row.commands & which) && row.group == group && !row.option.empty()) add_one(command, o, row.field, group);
}

CLI::App* add_model_command(CLI::App& app, const std::string& name, const std::string& help, CommonOptions& o,
                            OptionCommand which, std::function<void()> selected) {
  CLI::App& command = *app.add_subcommand(name, help);
  command.callback(std::move(selected));
  command.add_option("MODEL", o.models, "model files, - for standard input, or scene:NAME?detail=TRIANGLES")
      ->required();
  add_group(command, o, which, "Scene");
  command
      .add_option("--input-format", o.input_format,
                  "format of the model on standard input, such as obj [detected from its content]")
      ->type_name("NAME")
      ->group("Scene");
  add_group(command, o, which, "Camera");
  return &command;
}

void add_device_options(CLI::App& command, CommonOptions& o, OptionCommand which) {
  add_group(command, o, which, "Device");
  command.add_flag("--verbose", o.verbose, "print each stage and its time")
      ->envname("UMBRAGE_VERBOSE")
      ->group("Output");
  add_config_option(command);
}

Result<void> parse_options(CommonOptions& o) {
  if (!o.models.empty()) {
    o.request.model = o.models[0];
    o.request.more_models.assign(o.models.begin() + 1, o.models.end());
  }
  for (const Option& row : options()) {
    if (row.commands == 0) continue;  // set by another row's option
    std::vector<std::string> words;
    if (o.is_given(row.option)) words.push_back(o.texts[row.option]);
    if (const auto list = o.lists.find(row.option); list != o.lists.end()) words = list->second;
    if (const auto flag = o.flags.find(row.option); flag != o.flags.end()) words = {flag->second ? "true" : "false"};
    for (const std::string& word : words)
      if (auto set = set_option(row, word, o.request); !set) return set;
  }
  return {};
}

void print_warning(std::string_view message) {
  fmt::print(stderr, "umbrage: warning: {}\n", with_option_names(message));
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(std::function<bool(const CLI::App*)>()))
    names.push_back(command->get_name());
  return names;
}

Result<std::unique_ptr<Device>> device_of(const CommonOptions& o) {
  if (o.is_given("isa"))
    if (auto valid = use_isa(o.text_of("isa")); !valid) return valid.error();
  // Limit the threads of work outside the device too, such as building hierarchies and computing metrics.
  static std::optional<tbb::global_control> limit;
  if (o.request.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(o.request.threads));
  return make_device(o.request.device, o.request.threads);
}

Result<std::vector<std::unique_ptr<Device>>> worker_devices(const CommonOptions& o, std::size_t count) {
  std::vector<std::unique_ptr<Device>> devices;
  auto first = device_of(o);
  if (!first) return first.error();
  const int threads = (*first)->threads();
  const bool is_cpu = (*first)->description().starts_with("cpu");
  count = std::clamp(count, std::size_t(1), std::size_t(threads));
  devices.push_back(std::move(*first));
  if (!is_cpu || count == 1) return devices;
  devices.clear();
  while (devices.size() < count) {
    auto next = make_device("cpu", std::max(1, threads / int(count)));
    if (!next) return next.error();
    devices.push_back(std::move(*next));
  }
  return devices;
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) return file_error("the folder '{}' cannot be created: {}", folder.string(), error.message());
  return {};
}

Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const std::string extension = lowercase(folder.extension().string());
  if (!fs::is_directory(folder, ignored) && (format_of(folder) || extension == ".html" || extension == ".json"))
    return field_error("--output", folder.string(), "{} cannot be '{}': it takes a folder, for {}",
                       files.size() > 0 ? fmt::format("{}", fmt::join(files, ", ")) : "the pictures");
  if (fs::is_directory(folder, ignored)) {
    for (const char* file : files)
      if (auto writable = check_writable(folder / file); !writable) return writable;
    return {};
  }
  fs::path parent = fs::absolute(folder, ignored);
  while (!fs::exists(parent, ignored) && parent != parent.parent_path()) parent = parent.parent_path();
  if (folder.empty() || !fs::is_directory(parent, ignored) || ::access(parent.c_str(), W_OK | X_OK) != 0)
    return file_error("the folder '{}' cannot be created", folder.string());
  return {};
}

}  // namespace umbrage::cli
