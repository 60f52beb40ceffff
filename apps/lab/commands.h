// The commands of umbrage-lab.
#pragma once
#include "apps/cli/lab_options.h"

namespace umbrage::cli {

Result<void> run_compare(const CompareOptions& options);
Result<void> run_tune(const TuneOptions& options);
Result<void> run_figures(const FiguresOptions& options);
Result<void> run_bench(const BenchOptions& options);

}  // namespace umbrage::cli
