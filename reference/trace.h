// Trace: the truth by rays, slow and literal. Occlusion, direct light with soft shadows, and one bounce of it, at the
// surface that each pixel's centre sees.
#pragma once
#include <functional>
#include <limits>

#include "core/gbuffer.h"
#include "core/image.h"
#include "core/result.h"
#include "rays/traced_scene.h"

namespace umbrage {

inline constexpr int kMaxSamples = 4096;

/// How much an occluder at distance t counts.
enum class Falloff {
  kNone,    ///< 1 within the radius
  kLinear,  ///< 1 - t / radius
  kSmooth,  ///< 1 - smoothstep(0, radius, t)
};

/// Around which normal the hemisphere lies.
enum class HemisphereNormal {
  kTriangle,  ///< the surface as it is, facets and all: the truth that techniques are measured against
  kShading,   ///< the interpolated normal; directions below the triangle are closed
};

struct OcclusionSettings {
  int samples = 64;                                       ///< rays per pixel, 1 to kMaxSamples
  float radius = std::numeric_limits<float>::infinity();  ///< scene units, above 0
  Falloff falloff = Falloff::kNone;
  HemisphereNormal normal = HemisphereNormal::kTriangle;
  std::uint32_t seed = 0;
};

struct LightSettings {
  int samples = 64;                                      ///< rays per pixel to each light, and for the bounce
  bool direct = true;                                    ///< trace `direct` and `shadow`
  bool bounce = true;                                    ///< trace `indirect`
  float reach = std::numeric_limits<float>::infinity();  ///< of the bounce: what lies farther away sends nothing
  /// Lights are points, and only those throw a shadow of which a capture holds one: what `shadow` planes say.
  bool captured_shadows = false;
  float sun_angle_deg = 0.0f;  ///< what directional lights span in the sky; 0: what each light says
  std::uint32_t seed = 0;
};

struct TraceControl {
  int threads = 0;  ///< 0: all that the process may use. The result does not depend on it
  /// Told the share that is done, now and then from any one thread at a time. It never falls and ends at 1; false ends
  /// the work, and nothing more is told.
  std::function<bool(double)> progress = [](double) { return true; };
};

/// Occlusion: the share of the hemisphere's directions, weighted with their cosine to the normal, in which nothing lies
/// within the radius; by falloff an occluder counts in part. Planes, of the picture's whole size:
///   ao                     1 open, 0 closed; 1 where there is no surface, and in the guard band
///   bent_normal.x .y .z    mean open direction, unit, view space; the normal where nothing is open, 0 without surface
/// Errors: kInterrupted.
Result<Image> trace_occlusion(const TracedScene& scene, const PictureInfo& info, const OcclusionSettings& settings,
                              const TraceControl& control = {});

/// Light: planes, of the picture's whole size, 0 without surface and in the guard band:
///   direct.r .g .b     (with direct) what the surface emits, and what the lights send to the eye by diffuse reflection
///   and
///                      highlight, as effects/lighting has it, with shadows as soft as the lights are large. A light's
///                      size does not change its brightness: a surface that sees all of it gets what a point of the
///                      same colour would give
///   shadow             (with direct) share of the key light that arrives; 1 without surface
///   indirect.r .g .b   (with bounce) mean radiance from the shading normal's hemisphere, cosine-weighted: what the
///                      surfaces in sight, within reach, reflect diffusely of the lights, and emit. Times the albedo it
///                      is light to the eye
/// Errors: kInterrupted.
Result<Image> trace_light(const TracedScene& scene, const PictureInfo& info, const LightSettings& settings,
                          const TraceControl& control = {});

}  // namespace umbrage
