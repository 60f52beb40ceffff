// The commands of umbrage-lab, and what compare and tune share.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "apps/cli/lab_options.h"
#include "apps/cli/progress.h"
#include "apps/compare/measure_settings.h"

namespace umbrage::cli {

Result<void> run_compare(const CompareOptions& options);
Result<void> run_tune(const TuneOptions& options);
Result<void> run_figures(const FiguresOptions& options);
Result<void> run_bench(const BenchOptions& options);

/// Fills in the settings from the options. Errors: kUsage.
Result<void> apply_measure_options(const MeasureOptions& o, MeasureSettings& settings);

/// Returns a callback for MeasureSettings::progress that updates `line`. `line` must outlive it.
std::function<bool(const std::string&, double)> progress_on(ProgressLine& line);

/// Wipes the progress line, then prints warnings and, with --verbose, the device.
void print_measured(const MeasureOptions& o, const std::vector<std::string>& warnings, const Device& device,
                    ProgressLine& line);

}  // namespace umbrage::cli
