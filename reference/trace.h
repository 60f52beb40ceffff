// Trace: ground truth by brute-force ray tracing. Computes occlusion, direct light with soft shadows, and one bounce of
// light for the surface on the ray through each pixel's centre.
#pragma once
#include <functional>
#include <limits>
#include <vector>

#include "core/effect.h"
#include "core/gbuffer.h"
#include "core/image.h"
#include "core/result.h"
#include "rays/traced_scene.h"
#include "reference/held_occluders.h"

namespace umbrage {

inline constexpr int kMaxSamples = 4096;

/// The axis of the hemisphere.
enum class HemisphereNormal {
  kTriangle,  ///< normal of the triangle: the reference for techniques
  kShading,   ///< interpolated normal; directions below the triangle are blocked
};

/// Settings of trace_occlusion.
struct OcclusionSettings {
  int samples = 64;                                       ///< rays per pixel, 1 to kMaxSamples
  float radius = std::numeric_limits<float>::infinity();  ///< scene units, > 0
  Falloff falloff = Falloff::kNone;
  HemisphereNormal normal = HemisphereNormal::kTriangle;
  Occluders occluders = Occluders::kAll;
  std::uint32_t seed = 0;
  /// Radiance from a unit direction in world space, for each sky whose light is traced.
  std::vector<std::function<glm::vec3(glm::vec3)>> skies = {};
};

/// Settings of trace_light.
struct LightSettings {
  int samples = 64;    ///< rays per pixel to each light of nonzero size, and for the bounce
  bool direct = true;  ///< trace `direct` and `shadow`
  bool bounce = true;  ///< trace `indirect`
  float reach = std::numeric_limits<float>::infinity();  ///< max distance of bounced light, scene units
  /// Lights have no size, and a light casts a shadow only if a capture contains a `shadow` plane for it.
  bool captured_shadows = false;
  float sun_angle_deg = 0.0f;  ///< angular diameter of directional lights; 0: each light's own
  /// Radiance from a unit direction in world space; if set, trace `ambient`.
  std::function<glm::vec3(glm::vec3)> environment = {};
  std::uint32_t seed = 0;
};

/// Threads and progress of a trace.
struct TraceControl {
  int threads = 0;  ///< 0: all that the process may use; the result does not depend on the number
  /// Called with the finished fraction, by one thread at a time, not always the same. It never decreases and ends at 1.
  /// If it returns false, tracing stops and there are no more calls.
  std::function<bool(double)> progress = [](double) { return true; };
  float min_opacity = kOpaque;  ///< pixels show the first surface with at least this opacity
};

/// Calls take(x, y, surface) for the surface on the ray through the centre of each pixel inside the guard band that has
/// one, from several threads. Errors: kInterrupted.
Result<void> trace_surfaces(const TracedScene& scene, const PictureInfo& info, const TraceControl& control,
                            const std::function<void(int x, int y, const Surface& surface)>& take);

/// Traces visibility: the cosine-weighted fraction of the hemisphere without an occluder within the radius. With a
/// falloff, an occluder counts only partly: the nearest of each ray among those that count. Planes, of the picture's
/// whole size:
///   ao                     1 open, 0 blocked; 1 where there is no surface, and in the guard band
///   bent_normal.x .y .z    mean open direction, unit, view space; the normal where nothing is open; 0 without surface
///   sky0.r .g .b           (with skies; also sky1 and so on) mean radiance of the open part of a sky, cosine-weighted:
///                          the light of a white surface; 0 without surface
/// Errors: kInterrupted.
Result<Image> trace_occlusion(const TracedScene& scene, const PictureInfo& info, const OcclusionSettings& settings,
                              const TraceControl& control = {});

/// Traces light. Planes, of the picture's whole size, 0 where there is no surface and in the guard band:
///   direct.r .g .b     (with direct) emission, and diffuse reflection and highlight of the lights towards the camera,
///                      by metalness and roughness or as in effects/lighting, with shadows as soft as the lights are
///                      large. A light's size does not change its brightness: a surface that sees all of it receives as
///                      much as from a point light of the same colour
///   ambient.r .g .b    (with environment) light of the environment, reflected towards the camera; nothing occludes it
///   shadow             (with direct) visible fraction of the key light; 1 where there is no surface
///   indirect.r .g .b   (with bounce) mean radiance from the shading normal's hemisphere, cosine-weighted: emission and
///                      diffuse reflection of the lights by the surfaces within reach. Multiplied by the albedo, it
///                      is the indirect light towards the camera
/// Errors: kInterrupted.
Result<Image> trace_light(const TracedScene& scene, const PictureInfo& info, const LightSettings& settings,
                          const TraceControl& control = {});

}  // namespace umbrage
