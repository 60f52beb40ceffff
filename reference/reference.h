// The reference as an occlusion technique: its parameters, their table, and the function that traces it.
#pragma once
#include "core/effect.h"
#include "core/length.h"
#include "reference/trace.h"

namespace umbrage {

// Values of ReferenceParams::light, bounce_from and shadows.
inline constexpr int kReferenceOcclusion = 0, kReferenceDirect = 1, kReferenceBounce = 2;
inline constexpr int kReferenceFromAnywhere = 0, kReferenceFromRadius = 1;
inline constexpr int kReferenceSoftShadows = 0, kReferenceCapturedShadows = 1;

/// The parameters. The table in reference.cpp has one row per field.
struct ReferenceParams {
  int samples;
  Length radius;        // scene units, or relative to the bounding-sphere radius
  int falloff;          // a Falloff
  int normal;           // a HemisphereNormal
  int occluders;        // an Occluders
  int light;            // only occlusion; also direct light; or also one bounce
  int bounce_from;      // surfaces at any distance, or within the radius
  int shadows;          // soft shadows of all lights, or only the shadows that a capture contains
  float sun_angle_deg;  // 0: the angle of each light
  int seed;
};

/// Returns the reference as an effect: name, summary, parameter table and output planes. Its dispatch has no kernel,
/// because it needs the scene, which is not in a frame. Looks run it with LookRun::run_external_effect.
const Effect& reference_effect();

/// Traces the planes that the parameters select, of trace_occlusion and of trace_light. Errors: kUsage for a radius
/// larger than the scene; kInterrupted.
Result<Image> trace_reference(const TracedScene& scene, const PictureInfo& info, const ParameterBytes& params,
                              const TraceControl& control = {});

}  // namespace umbrage
