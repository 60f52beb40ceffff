// Options that several commands share: the table of renderer/options.h as words of a command line.
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
  Request request;  ///< what the table's options say, once take_options has read them

  // As written, by the options' names.
  std::map<std::string_view, std::string> texts;
  std::map<std::string_view, std::vector<std::string>> lists;
  std::map<std::string_view, bool> flags;

  bool is_given(std::string_view option) const {
    const auto text = texts.find(option);
    return text != texts.end() && !text->second.empty();
  }
  /// What was written; nothing: "".
  std::string text_of(std::string_view option) const { return is_given(option) ? texts.find(option)->second : ""; }
};

/// Finds what is wrong with the text of an option, whatever the others say. Errors: kUsage.
using Check = std::function<Result<void>(const std::string&)>;

/// Has an option refuse what the check refuses, whether it stands on the command line, in a configuration file or in
/// the environment.
void add_check(CLI::Option& option, Check check);

/// Adds the options of a group that this command has.
void add_group(CLI::App& command, CommonOptions& options, OptionCommand which, std::string_view group);
/// The group Device, --verbose and --config.
void add_device_options(CLI::App& command, CommonOptions& options, OptionCommand which);
/// One option, in that group; its help and what holds where nobody says, where they differ from the table's.
void add_one(CLI::App& command, CommonOptions& options, std::string_view field, std::string_view group,
             std::string_view help = {}, std::string_view initial = {});

/// An option that is a number, and not of the table. It holds what `value` is now where nobody says, or what `initial`
/// says in words.
CLI::Option* add_number(CLI::App& command, const std::string& name, int& value, const Interval& takes,
                        std::string_view help, std::string_view initial = {});
CLI::Option* add_number(CLI::App& command, const std::string& name, double& value, const Interval& takes,
                        std::string_view help, std::string_view initial = {});
/// --resolution, any number of times.
CLI::Option* add_sizes(CLI::App& command, std::vector<std::string>& sizes, std::string_view initial);

/// Reads what was written into the request. Errors: kUsage, naming the field and what it takes.
Result<void> take_options(CommonOptions& options);

/// What runs a command once its options are read.
template <class Options>
std::function<Result<void>()> with_options(std::shared_ptr<Options> options, Result<void> (*command)(const Options&)) {
  return [options, command] {
    auto taken = take_options(*options);
    return taken ? command(*options) : taken;
  };
}

/// Adds a command that takes models, with the groups Scene and Camera; `named` is called if it is the one that was
/// named.
CLI::App* add_model_command(CLI::App& app, const std::string& name, const std::string& help, CommonOptions& options,
                            OptionCommand which, std::function<void()> named);

template <class Options>
struct ModelCommand {
  CLI::App* command;
  std::shared_ptr<Options> options;
};
/// Such a command, which sets `run` to `function` of its options.
template <class Options>
ModelCommand<Options> add_model_command(CLI::App& app, std::function<Result<void>()>& run, const std::string& name,
                                        const std::string& help, OptionCommand which,
                                        Result<void> (*function)(const Options&)) {
  const auto options = std::make_shared<Options>();
  return {add_model_command(app, name, help, *options, which,
                            [options, &run, function] { run = with_options(options, function); }),
          options};
}

/// A message of the library with the options' names in place of the fields'.
std::string in_options(std::string_view message);

Result<std::unique_ptr<Device>> device_of(const CommonOptions& options);

/// Whether a folder can be made, or these files written into the one that is there, before any work; makes nothing.
Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files);

}  // namespace umbrage::cli
