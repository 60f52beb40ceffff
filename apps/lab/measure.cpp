// What umbrage compare and umbrage tune share.
#include "apps/lab/commands.h"

#include "apps/cli/standard_input.h"

namespace umbrage::cli {

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
