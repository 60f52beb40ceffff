#include "apps/cli/measure.h"

#include "apps/cli/standard_input.h"

namespace umbrage::cli {

void add_measure_options(CLI::App& command, MeasureOptions& o, const std::string& group) {
  add_number(command, "--cameras", o.cameras, kCameras, "max number of views of each scene")->group(group);
  add_number(command, "--samples", o.samples, kSamples, "rays per pixel of the ground truth, an even number")
      ->group(group);
  add_number(command, "--runs", o.runs, kRuns, "runs per measured time")->group(group);
}

Result<void> apply_measure_options(const MeasureOptions& o, MeasureSettings& settings) {
  settings.models = o.models;
  settings.cameras = o.cameras;
  settings.samples = o.samples;
  settings.runs = o.runs;
  const auto import_with = import_settings(o.request);
  if (!import_with) return import_with.error();
  settings.import = *import_with;
  settings.draw = o.request;
  settings.load = loader_of(o);
  return check_standard_input(o.models, o.input_format);
}

std::function<bool(const std::string&, double)> progress_on(ProgressLine& line) {
  return [&line](const std::string& what, double done) {
    line.show(what, done);
    return true;
  };
}

void print_measured(const MeasureOptions& o, const std::vector<std::string>& warnings, const Device& device,
                    ProgressLine& line) {
  line.wipe();
  for (const std::string& warning : warnings) print_warning(warning);
  if (o.verbose) fmt::print(stderr, "{}\n", device.description());
}

}  // namespace umbrage::cli
