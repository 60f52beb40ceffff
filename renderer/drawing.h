// Drawing: what all pictures of one drawing share: the device, the look, times, progress, and the exposure that is
// metered on a small picture before them. Internal to renderer/.
#pragma once
#include <optional>

#include "core/device.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// Converts the progress of single steps to the progress of a whole drawing. Reported progress never decreases.
class DrawProgress {
 public:
  /// `steps`: number of steps of each innermost part. Work between two steps counts as part of the second step.
  DrawProgress(const ProgressMonitor& monitor, std::size_t steps) : monitor_(monitor), steps_(double(steps)) {}

  /// A part of the part in which it begins, from one fraction of it to another: a sample, or a strip of it. It ends
  /// with this object.
  class Part {
   public:
    Part(DrawProgress& progress, double begin, double end);
    ~Part() { progress_.begin_ = begin_, progress_.size_ = size_, progress_.step_ = step_; }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    DrawProgress& progress_;
    const double begin_, size_;  // of the part around it
    const int step_;
  };

  /// Returns the monitor to pass to each step.
  ProgressMonitor step_monitor() {
    return [this](double fraction) { return report(fraction); };
  }
  void step_done() { ++step_; }
  /// Reports that all is drawn. Errors: kInterrupted.
  Result<void> end() const { return !monitor_ || monitor_(1.0) ? Result<void>() : interrupted(); }

 private:
  bool report(double fraction);

  const ProgressMonitor& monitor_;
  const double steps_;
  double begin_ = 0.0, size_ = 1.0;  // of the current part, fractions of the drawing
  int step_ = 0;
  double reported_ = 0.0;
};

/// Sets a run to report finished effects.
void report_to(DrawProgress& progress, StageTimes& times, LookRun& run);

/// Returns the number of steps of a picture: its capture and its effects.
std::size_t steps_of_picture(const Plan& plan);

/// Returns what traces the reference for the picture to which a plan is set. All its copies share a hierarchy of the
/// scene, which the first call builds.
RunExternalEffect reference_of(Device& device, const Scene& scene, const Plan& plan, const ProgressMonitor& monitor);

/// What all pictures of a plan share while they are drawn.
struct PictureDrawing {
  Device& device;
  StageTimes& times;
  DrawProgress& progress;
  LookRun run;  ///< of the plan, without lines
  /// An earlier capture of sample 0 without blended surfaces, in place of a new one. Null: none.
  const Frame* captured = nullptr;
  bool has_technique = false;  ///< `captured` has the planes of the technique and its filters, too

  /// Returns whether the picture to which a plan is set is `captured`.
  bool is_captured(const Plan& plan) const { return captured && plan.sample == 0 && !plan.capture.blended; }

  /// Captures the picture to which a plan is set, and adds the environment image if that is shown as background. Marks
  /// the pixels of the first sample if others are drawn at them only: see marked_samples.h.
  Result<Frame> capture(const Plan& plan, const Camera& camera) const;
};

inline constexpr int kMeteredSide = 192;  ///< max. side of the small picture, pixels

/// Returns whether the exposure of a plan's picture is metered on a picture.
bool meters_picture(const Plan& plan);

/// Returns the stops that metering adds to the exposure; those of drawing.run if it has any. They are metered on a
/// small picture of Plan::metered, or of the plan's own view, in which blended surfaces are opaque. Empty if nothing is
/// metered on a picture. Errors: kInterrupted; the errors of the device.
Result<std::optional<float>> metered_exposure(const PictureDrawing& drawing, const Plan& plan);

}  // namespace umbrage
