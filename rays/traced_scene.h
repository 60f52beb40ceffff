// A scene made ready for rays: Embree's hierarchy, filtered textures, and what a ray's hit is. What captures on the CPU
// and what traces the truth both stand on it.
#pragma once
#include <embree3/rtcore.h>

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "rays/mip_texture.h"
#include "scene/scene.h"

namespace umbrage {

/// Embree sees the scene moved to the origin and scaled to about unit size, since single floats serve neither a
/// micrometre nor a light year: products of four edges would leave their range. A power of two keeps every bit.
struct TracedScene {
  const Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene rtc = nullptr;
  std::vector<MipTexture> textures;
  glm::vec3 center{0.0f};
  float scale = 1.0f;  ///< units per scene unit

  glm::vec3 unit_of(glm::vec3 world) const { return (world - center) * scale; }
};

struct FreeTracedScene {
  void operator()(TracedScene* traced) const;
};
using TracedScenePtr = std::unique_ptr<TracedScene, FreeTracedScene>;

/// Builds the hierarchy. The scene must outlive the result. Rays pass where a texture's alpha is cut away.
/// Errors: kDevice where Embree cannot (out of memory); kInterrupted.
Result<TracedScenePtr> trace_ready(const Scene& scene, const ProgressMonitor& monitor = {});
/// The same by so many threads.
Result<TracedScenePtr> trace_ready(const Scene& scene, int threads, const ProgressMonitor& monitor = {});

/// What a ray met, in unit space.
struct Surface {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  unsigned triangle = 0;     ///< or point
  float u = 0.0f, v = 0.0f;  ///< barycentric weights of the triangle's second and third vertex
  glm::vec3 position{0.0f};
  glm::vec3 geometric{0.0f};  ///< the triangle's normal, or the point's, unit, on the side that the ray came from
  glm::vec3 normal{0.0f};     ///< the interpolated one, unit, on that side of both the triangle and the ray
};

/// The hit of a ray with this origin and direction at parameter `t`; `across` is a normal of the triangle, of any
/// length and either side, as Embree gives it. The side that was met counts, whatever the winding says.
Surface surface_at(const TracedScene& traced, unsigned mesh, unsigned triangle, float u, float v, glm::vec3 origin,
                   glm::vec3 direction, glm::vec3 across, float t);

/// Where a ray that leaves the surface starts: far enough along the geometric normal that rounding does not let it meet
/// the surface again; above a disc so far that those around it, which rise and dip a little, do not stop it.
/// `seen_from` is the origin of the ray that found the surface.
glm::vec3 start_above(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from);

/// The same for a ray to a light: from where the smooth surface lies that the normals at the triangle's vertices
/// suggest. The triangle itself cuts below it, and where light grazes it, neighbours would throw a jagged shadow on it.
/// [Hanika 2021]
glm::vec3 start_to_light(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from);

/// The share of its radius by which a ray starts above a disc.
inline constexpr float kAboveDisc = 0.3f;

/// The colour that a mesh has at a hit by itself: white where it has none.
glm::vec3 mesh_color(const Surface& surface);

/// Texture coordinates of a hit. The mesh must have some.
glm::vec2 uv_at(const Mesh& mesh, unsigned triangle, float u, float v);

/// Whether a single ray, in unit space, meets a surface, and which one. It meets none where it would leave the range of
/// floats.
bool first_hit(const TracedScene& traced, glm::vec3 origin, glm::vec3 direction, RTCRayHit& hit);

/// Embree ends the program where a ray's origin or direction has a component beyond 1.844e18: rays stay below this.
inline constexpr float kRayLimit = 1e18f;

inline bool within_ray_limit(glm::vec3 v) {
  return std::abs(v.x) < kRayLimit && std::abs(v.y) < kRayLimit && std::abs(v.z) < kRayLimit;
}

/// How many rays a packet has (rays/ray_packet.h).
inline constexpr int kPacket = 16;

}  // namespace umbrage
