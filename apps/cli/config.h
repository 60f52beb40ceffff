// The configuration file: options that apply to every run.
#pragma once
#include <string>
#include <vector>

#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// A value that a configuration file sets.
struct ConfigValue {
  std::string option, value;  ///< option: its long name, without dashes
  std::string place;          ///< file and line, as messages name them
};

/// A command line with the values of the configuration file.
struct Configured {
  std::vector<std::string> words;
  std::vector<ConfigValue> values;  ///< those of the file among them
};

/// Adds --config to a command.
void add_config_option(CLI::App& command);

/// Inserts the options of the configuration file after the command, which is the first word of `words`. Options on the
/// command line and in the environment take precedence. The file is that of --config or else umbrage/config in
/// XDG_CONFIG_HOME or ~/.config, if it exists; `--config none` reads no file. It has lines `option = value`, comments
/// after # and headings `[command]`; options before the first heading apply to every command that has them.
/// Errors: kUsage, with file and line; kFile for a file of --config that cannot be read.
Result<Configured> with_config(CLI::App& app, std::vector<std::string> words);

/// Returns an error that was found after the values had been read, with file and line in front if one of them is to
/// blame.
Error with_place(Error error, const std::vector<ConfigValue>& values);

}  // namespace umbrage::cli
