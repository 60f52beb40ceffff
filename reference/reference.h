// The reference as an occlusion technique: what a person sets of `reference`, its table, and one call that traces it.
#pragma once
#include "core/effect.h"
#include "core/length.h"
#include "reference/trace.h"

namespace umbrage {

/// One row of the table in reference.cpp per field.
struct ReferenceParams {
  int samples;
  Length radius;        // scene units, or share of the scene's radius
  int falloff;          // a Falloff
  int normal;           // a HemisphereNormal
  int light;            // 0 occlusion alone, 1 direct light too, 2 its bounce too
  float sun_angle_deg;  // 0: what each light says
  int seed;
};

/// Name, summary, table, and the planes that it may write. Its pass has no kernel: it needs the scene, which no frame
/// holds, and is handed to looks.
const Effect& reference_effect();

/// Traces what the parameters ask for: the planes of trace_occlusion, and of trace_light.
/// Errors: kUsage for a radius larger than the scene, kInterrupted.
Result<Image> trace_reference(const TracedScene& scene, const PictureInfo& info, const ParameterBytes& params,
                              const TraceControl& control = {});

}  // namespace umbrage
