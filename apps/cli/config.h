// The configuration file: options that apply to every run.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// Adds --config to a command.
void add_config_option(CLI::App& command);

/// Inserts the options of the configuration file after the command, which is the first word of `words`. Options on the
/// command line and in the environment take precedence. The file is that of --config or else umbrage/config in
/// XDG_CONFIG_HOME or ~/.config, if it exists; `--config none` reads no file. It has lines `option = value`, comments
/// after # and headings `[command]`; options before the first heading apply to every command that has them.
/// Errors: kUsage, with file and line; kFile for a file of --config that cannot be read.
Result<std::vector<std::string>> with_config(CLI::App& app, std::vector<std::string> words);

}  // namespace umbrage::cli
