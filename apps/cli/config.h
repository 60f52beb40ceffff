// The configuration file: options that one would type each time.
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

/// The words of a command line (the command first) with those of the configuration file after the command, where the
/// user's own win. The file is that of --config, or else umbrage/config in XDG_CONFIG_HOME or ~/.config, if it is
/// there;
/// `--config none` is none. It has lines `option = value`, comments after #, and headings `[command]`; what stands
/// before the first heading is for every command that has the option. Options that the environment names are left to
/// it. Errors: kUsage, with file and line; kFile for a file of --config that cannot be read.
Result<std::vector<std::string>> with_config(CLI::App& app, std::vector<std::string> words);

}  // namespace umbrage::cli
