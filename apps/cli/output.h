// What all commands that write pictures share: their options, the checks of the output, and the printed times.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/render_options.h"
#include "core/device.h"
#include "renderer/times.h"

namespace umbrage::cli {

/// Adds --passes, --bits, --picture-quality, --half, --memory and --json to the group Output.
void add_output_options(CLI::App& command, RenderOptions& options, std::string_view help_of_memory);

/// Adds --frame-rate to the group Output.
void add_frame_rate(CLI::App& command, double& frame_rate);

/// Parses a number of bytes, such as "6G", "512M" or "100000". Errors: kUsage.
Result<double> parse_memory(std::string_view text);

/// Checks that standard output can receive a PNG. Errors: kUsage.
Result<void> check_piped(const RenderOptions& o);

/// Checks that a file with this extension supports the requested passes, bits, quality and half floats. Errors: kUsage.
Result<void> check_output(const RenderOptions& o, const std::string& extension);

/// Returns the total time of each dispatch, sorted by the first run of each.
std::vector<DispatchTime> times_by_dispatch(const std::vector<DispatchTime>& dispatches);

/// Prints times on standard error, or as JSON on standard output.
void print_times(const StageTimes& times, const std::vector<DispatchTime>& dispatches, bool json);

/// Adds the times of other work.
void add_times(StageTimes& sum, const StageTimes& more);

}  // namespace umbrage::cli
