// The reference as an occlusion technique: what a person sets of `reference`, its table, and one call that traces it.
#pragma once
#include "core/effect.h"
#include "core/length.h"
#include "reference/trace.h"

namespace umbrage {

// Values of ReferenceParams::light, bounce_from and shadows.
inline constexpr int kReferenceOcclusion = 0, kReferenceDirect = 1, kReferenceBounce = 2;
inline constexpr int kReferenceFromAnywhere = 0, kReferenceFromRadius = 1;
inline constexpr int kReferenceSoftShadows = 0, kReferenceCapturedShadows = 1;

/// One row of the table in reference.cpp per field.
struct ReferenceParams {
  int samples;
  Length radius;        // scene units, or share of the scene's radius
  int falloff;          // a Falloff
  int normal;           // a HemisphereNormal
  int light;            // occlusion alone, direct light too, or its bounce too
  int bounce_from;      // surfaces at any distance, or within the radius
  int shadows;          // soft ones of every light, or what a capture holds
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
