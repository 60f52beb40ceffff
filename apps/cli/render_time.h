// `--time` of `umbrage render`: samples are added to a picture while they fit into the time.
#pragma once
#include <optional>
#include <string>

#include "apps/cli/render_options.h"
#include "renderer/draw.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage::cli {

/// Sets the number of samples for --time: that of the request or the quality, at least 4 if neither names one, so that
/// edges are smooth even if no others fit. Errors: kUsage.
Result<void> choose_samples(RenderOptions& o);

/// The samples that are added to one picture. Its time begins with the constructor.
class TimedSamples {
 public:
  /// `time_s`: 0 adds no samples. `monitor` must outlive the object.
  TimedSamples(double time_s, const ProgressMonitor& monitor);
  TimedSamples(const TimedSamples&) = delete;  // the functions that it returns refer to it

  Continuation continuation();
  /// Returns a monitor that reports the part of the time that has passed, but no more than is drawn.
  ProgressMonitor monitor();
  /// Returns a sentence about the samples and the time that they took.
  std::string summary(const Plan& plan) const;

 private:
  std::optional<TimeLimit> limit_;
  const ProgressMonitor& monitor_;
  bool is_last_ = false;  // no further sample fits
};

}  // namespace umbrage::cli
