// Options shared by several commands: the option table of renderer/options.h as command-line options.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/config.h"
#include "core/device.h"
#include "renderer/options.h"
#include "renderer/recipe.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace umbrage::cli {

struct CommonOptions {
  std::vector<std::string> models;
  std::string input_format;
  bool verbose = false;
  Request request;  ///< values of the table's options; parse_options fills it in

  // Option values as the user wrote them, by option name.
  std::map<std::string_view, std::string> texts;
  std::map<std::string_view, std::vector<std::string>> lists;
  std::map<std::string_view, bool> flags;

  bool is_given(std::string_view option) const {
    const auto text = texts.find(option);
    return text != texts.end() && !text->second.empty();
  }
  /// Returns the text of the option; "" if it was not given.
  std::string text_of(std::string_view option) const { return is_given(option) ? texts.find(option)->second : ""; }
};

/// Checks the text of one option, independently of other options. Errors: kUsage.
using Check = std::function<Result<void>(const std::string&)>;

/// Applies `check` to the values of an option from the command line, a configuration file or the environment.
void add_check(CLI::Option& option, Check check);

/// Adds those options of a group that belong to the command `which`.
void add_group(CLI::App& command, CommonOptions& options, OptionCommand which, std::string_view group);
/// Adds the group Device, --verbose and --config.
void add_device_options(CLI::App& command, CommonOptions& options, OptionCommand which);
/// Adds one option of the table to a group. `help` and `initial` (the default as the help shows it), if not empty,
/// override those of the table.
void add_one(CLI::App& command, CommonOptions& options, std::string_view field, std::string_view group,
             std::string_view help = {}, std::string_view initial = {});

/// Adds a numeric option that is not in the table. Its default is the current `value`; the help shows `initial` instead
/// if that is not empty.
CLI::Option* add_number(CLI::App& command, const std::string& name, int& value, const Interval& interval,
                        std::string_view help, std::string_view initial = {});
CLI::Option* add_number(CLI::App& command, const std::string& name, double& value, const Interval& interval,
                        std::string_view help, std::string_view initial = {});
/// Adds --resolution, which may be given several times.
CLI::Option* add_sizes(CLI::App& command, std::vector<std::string>& sizes, std::string_view initial);

/// Parses the option texts into the request. Errors: kUsage, naming the field and its valid values.
Result<void> parse_options(CommonOptions& options);

/// Returns a function that parses the options and then runs the command.
template <class Options>
std::function<Result<void>()> with_options(std::shared_ptr<Options> options, Result<void> (*command)(const Options&)) {
  return [options, command] {
    auto taken = parse_options(*options);
    return taken ? command(*options) : taken;
  };
}

/// Adds a command that takes models, with the groups Scene and Camera. `selected` is called if the user names the
/// command.
CLI::App* add_model_command(CLI::App& app, const std::string& name, const std::string& help, CommonOptions& options,
                            OptionCommand which, std::function<void()> selected);

template <class Options>
struct ModelCommand {
  CLI::App* command;
  std::shared_ptr<Options> options;
};
/// Adds a command that takes models. If the user names it, `run` becomes a call of `function` with its options.
template <class Options>
ModelCommand<Options> add_model_command(CLI::App& app, std::function<Result<void>()>& run, const std::string& name,
                                        const std::string& help, OptionCommand which,
                                        Result<void> (*function)(const Options&)) {
  const auto options = std::make_shared<Options>();
  return {add_model_command(app, name, help, *options, which,
                            [options, &run, function] { run = with_options(options, function); }),
          options};
}

/// Prints a warning on standard error, with options in place of field names.
void print_warning(std::string_view message);

/// Returns the names of all commands, in the order of the help.
std::vector<std::string> command_names(const CLI::App& app);

/// Creates the requested device and applies --isa and --threads to the process.
Result<std::unique_ptr<Device>> device_of(const CommonOptions& options);

/// Returns the devices of `count` threads that draw at the same time: on the CPU one for each thread, at most one for
/// each core, among which the cores are divided; else one for all.
Result<std::vector<std::unique_ptr<Device>>> worker_devices(const CommonOptions& options, std::size_t count);

/// Checks that a folder can be created or, if it exists, that these files can be written into it. Creates nothing.
/// Errors: kFile.
Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files);

/// Makes a folder with its parents, unless it exists or `folder` is empty. Errors: kFile.
Result<void> make_folder(const std::filesystem::path& folder);

}  // namespace umbrage::cli
