// The commands: each adds itself to the command line, and runs when it was named.
#pragma once
#include <functional>

#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// The command line as one would type it again, quoted for a shell.
extern std::string command_line;

/// Adds a command and sets `run` to what it does if it is the one that was named.
using AddCommand = void (*)(CLI::App& app, std::function<Result<void>()>& run);

void add_render(CLI::App& app, std::function<Result<void>()>& run);
void add_figures(CLI::App& app, std::function<Result<void>()>& run);
void add_bench(CLI::App& app, std::function<Result<void>()>& run);
void add_compare(CLI::App& app, std::function<Result<void>()>& run);
void add_tune(CLI::App& app, std::function<Result<void>()>& run);
void add_info(CLI::App& app, std::function<Result<void>()>& run);
void add_manual(CLI::App& app, std::function<Result<void>()>& run);
void add_list(CLI::App& app, std::function<Result<void>()>& run);

}  // namespace umbrage::cli
