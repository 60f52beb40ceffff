// The commands of the programs umbrage and umbrage-lab. Each one registers itself with the command line and runs if the
// user names it.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// The command line as the user typed it, quoted for a shell.
extern std::string command_line;

/// The lists that umbrage list prints.
inline constexpr std::array<std::string_view, 7> kListKinds = {"looks",  "effects", "passes", "program",
                                                               "scenes", "devices", "formats"};

struct LabActions;

/// Parses the command line, runs a command and reports errors. Returns the exit code. `is_lab`: the program is
/// umbrage-lab, which runs and lists only its own commands.
int run_program(int argc, char** argv, const LabActions& actions, bool is_lab);

/// Returns the text of --version: the version, the commit that was built, and the instruction sets and devices that
/// this machine has, each in a line that ends with a line feed.
std::string version_text();

/// Adds a command to `app`. Parsing sets `run` to the action of the command that the user names.
using AddCommand = void (*)(CLI::App& app, std::function<Result<void>()>& run);

void add_render(CLI::App& app, std::function<Result<void>()>& run);
void add_shade(CLI::App& app, std::function<Result<void>()>& run);
void add_view(CLI::App& app, std::function<Result<void>()>& run);
void add_thumbnails(CLI::App& app, std::function<Result<void>()>& run);
void add_shaders(CLI::App& app, std::function<Result<void>()>& run);
void add_info(CLI::App& app, std::function<Result<void>()>& run);
void add_manual(CLI::App& app, std::function<Result<void>()>& run);
void add_list(CLI::App& app, std::function<Result<void>()>& run);

}  // namespace umbrage::cli
