// The commands of the program. Each one registers itself with the command line and runs if the user names it.
#pragma once
#include <array>
#include <functional>
#include <string_view>

#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// The command line as the user typed it, quoted for a shell.
extern std::string command_line;

/// The lists that umbrage list prints.
inline constexpr std::array<std::string_view, 6> kListKinds = {"looks",  "effects", "passes",
                                                               "scenes", "devices", "formats"};

/// Adds a command to `app`. Parsing sets `run` to the action of the command that the user names.
using AddCommand = void (*)(CLI::App& app, std::function<Result<void>()>& run);

void add_render(CLI::App& app, std::function<Result<void>()>& run);
void add_shade(CLI::App& app, std::function<Result<void>()>& run);
void add_view(CLI::App& app, std::function<Result<void>()>& run);
void add_thumbnails(CLI::App& app, std::function<Result<void>()>& run);
void add_figures(CLI::App& app, std::function<Result<void>()>& run);
void add_bench(CLI::App& app, std::function<Result<void>()>& run);
void add_compare(CLI::App& app, std::function<Result<void>()>& run);
void add_tune(CLI::App& app, std::function<Result<void>()>& run);
void add_info(CLI::App& app, std::function<Result<void>()>& run);
void add_manual(CLI::App& app, std::function<Result<void>()>& run);
void add_list(CLI::App& app, std::function<Result<void>()>& run);

}  // namespace umbrage::cli
