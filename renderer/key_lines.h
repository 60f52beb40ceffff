// Lines that stay on surfaces in a sequence. Lines that each frame draws anew, as hatching does, flicker. So only key
// frames have new ones, and the frames between them get those of the key frames before and after, by KeySteps of the
// effect. A frame depends on these two alone: it has the same bytes by itself, in a run and in a shard.
#pragma once
#include <functional>
#include <map>

#include "renderer/draw.h"

namespace umbrage {

class KeyLines {
 public:
  /// `plan`: returns the plan of a frame; `count`, `is_closed`: as in SteadyFrames. The device must outlive this
  /// object.
  KeyLines(Device& device, std::function<Plan(int frame)> plan, int count, bool is_closed);

  /// Sets Plan::lines_between of the plan of a frame, unless the picture has no lines with KeySteps.
  /// Draws the lines of key frames that are not there. Errors: kInterrupted; the errors of the device.
  Result<void> complete(int frame, Plan& plan, StageTimes& times, const ProgressMonitor& monitor);

 private:
  Result<SurfaceLines> lines_of_key(int frame, StageTimes& times, const ProgressMonitor& monitor);

  Device& device_;
  const std::function<Plan(int)> plan_;
  const int count_;
  StrokeParameters lines_;                      // with KeySteps, one or none
  Effect field_;                                // the effect without the step that traces
  std::vector<int> keys_;                       // the key frames; in a closed sequence also `count`, which is frame 0
  std::map<int, SurfaceLines> drawn_, joined_;  // of key frames; of the frames that follow one
};

}  // namespace umbrage
