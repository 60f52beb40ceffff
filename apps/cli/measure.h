// Options and output shared by umbrage compare and umbrage tune.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "apps/cli/options.h"
#include "apps/cli/progress.h"
#include "apps/compare/measure_settings.h"

namespace umbrage::cli {

struct MeasureOptions : CommonOptions {
  int cameras = 2, samples = 256, runs = 3;
};

/// Adds --cameras, --samples and --runs to a group of the help.
void add_measure_options(CLI::App& command, MeasureOptions& o, const std::string& group);

/// Fills in the settings from the options. Errors: kUsage.
Result<void> apply_measure_options(const MeasureOptions& o, MeasureSettings& settings);

/// Returns a callback for MeasureSettings::progress that updates `line`. `line` must outlive it.
std::function<bool(const std::string&, double)> progress_on(ProgressLine& line);

/// Wipes the progress line, then prints warnings and, with --verbose, the device.
void print_measured(const MeasureOptions& o, const std::vector<std::string>& warnings, const Device& device,
                    ProgressLine& line);

}  // namespace umbrage::cli
