// The state of one comparison.
#pragma once
#include <algorithm>
#include <glm/mat3x3.hpp>
#include <string>
#include <vector>

#include "apps/compare/pictures.h"
#include "reference/trace.h"
#include "renderer/recipe.h"

namespace umbrage {

/// The state of one comparison.
struct Run {
  Device& device;
  const CompareSettings& settings;
  std::vector<const Effect*> techniques;
  const Effect* filter;
  Recipe recipe;
  Comparison& result;
  double error_sum = 0.0, light_error_sum = 0.0, truth_sum = 0.0;
  long pictures = 0, light_pictures = 0, pixels = 0;

  // Progress. start, span: beginning and length of the present picture, as fractions of the whole work. units, done:
  // all work units of the picture and those that are done. A unit is about the time of one ray per pixel.
  double start = 0.0, span = 1.0, units = 1.0, done = 0.0;

  bool report_progress(const std::string& what, double more = 0.0) const {
    return settings.progress(what, start + span * std::min((done + more) / units, 1.0));
  }
  TraceControl control(const std::string& what, double work_units) const {
    return {device.threads(),
            [this, what, work_units](double fraction) { return report_progress(what, work_units * fraction); }};
  }
};

/// Traces the ground truths of a picture. Quantities other than occlusion are missing if they are not requested, and
/// Quantity::kLight if no surface receives any. `axes`: those of the environments, in world space.
Result<std::vector<Truth>> trace_truths(Run& run, const TracedScene& traced, const PictureInfo& info, float radius,
                                        const ClassMap& classes, const glm::mat3& axes, const std::string& what);

}  // namespace umbrage
