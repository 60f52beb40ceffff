// ErrorMap: the error of an occlusion technique against the ray-traced reference, as a picture.
#pragma once
#include <list>
#include <string>

#include "apps/view/draw_messages.h"
#include "apps/view/view_model.h"

namespace umbrage::view {

/// Difference of the occlusion that the map shows in full colour.
inline constexpr float kErrorRange = 0.1f;
/// Number of runs of the reference, each with other noise, whose mean is the ground truth in the end.
inline constexpr int kMaxReferenceRuns = 16;

/// Returns the map of the difference of `ao` to the ground truth: red where the technique is too bright, blue where it
/// is too dark, white where it is right, grey where there is no surface, which is where depth is infinite. `numbers`
/// become the error over all pixels with a surface.
Image error_picture(const Plane& ao, const Plane& truth, const Plane& depth, ErrorNumbers& numbers);

class ErrorMap {
 public:
  struct Drawn {
    Image picture;
    ErrorNumbers error;
    int runs = 0;  ///< of the reference
  };
  /// Draws the map of the technique of a request, at the pixel centres. The ground truth is kept while neither the
  /// camera nor the size nor the radius change; `runs`: number of runs that it must have. `key` names the model and
  /// its version. Errors: those of ViewModel::planes.
  Result<Drawn> draw(ViewModel& model, DrawingDevice& device, const Request& request, const std::string& key, int runs,
                     const DrawControl& control, StageTimes& times);

 private:
  struct Truth {
    std::string key;
    Plane sum;  // of the runs
    int runs = 0;
  };
  std::list<Truth> truths_;  // the last used first
};

}  // namespace umbrage::view
