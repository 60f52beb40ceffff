// The program umbrage-lab: the commands of umbrage that measure techniques and reproduce papers.
#include "apps/cli/commands.h"
#include "apps/lab/commands.h"

int main(int argc, char** argv) {
  using namespace umbrage::cli;
  return run_program(argc, argv, {run_compare, run_tune, run_figures, run_bench}, true);
}
