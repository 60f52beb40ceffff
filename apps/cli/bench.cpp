#include "apps/cli/commands.h"
namespace umbrage::cli {
void add_figures(CLI::App&, std::function<Result<void>()>&) {}
void add_bench(CLI::App&, std::function<Result<void>()>&) {}
}
