// A scene prepared for ray tracing: Embree's hierarchy, filtered textures, and the surface at a ray's hit. Used by
// captures on the CPU and by the ground-truth path tracer.
#pragma once
#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "rays/embree.h"
#include "rays/mip_texture.h"
#include "scene/scene.h"

namespace umbrage {

/// What alpha cuts out of a mesh, and how opaque the rest is.
struct CutOut {
  const MipTexture* texture = nullptr;        ///< with alpha ranges; null: alpha is 1
  std::vector<std::array<glm::vec2, 3>> uvs;  ///< of each triangle together, so that a test reads one cache line
  bool blended = false;
  float opacity = 1.0f, cutoff = 0.0f;  ///< (blended) opacity; (not blended) alpha below which texels are cut out
};

/// A scene in unit space: Embree gets the scene moved to the origin and scaled to about unit size, since products of
/// four edge lengths exceed the range of floats for a scene of micrometres or of light years. The scale is a power of
/// two, so scaling is exact.
struct TracedScene {
  const Scene* scene = nullptr;
  RTCDevice device = nullptr;
  RTCScene rtc = nullptr;
  int width = 8;                     ///< packet_width of the device
  std::vector<MipTexture> textures;  ///< those that rays cannot read are without levels
  std::vector<CutOut> cut_outs;      ///< one per mesh, empty for those without holes
  glm::vec3 center{0.0f};
  float scale = 1.0f;  ///< units of unit space per scene unit

  glm::vec3 unit_of(glm::vec3 world) const { return (world - center) * scale; }
};

struct FreeTracedScene {
  void operator()(TracedScene* traced) const;
};
using TracedScenePtr = std::unique_ptr<TracedScene, FreeTracedScene>;

/// Builds the hierarchy. The scene must outlive the result. Rays pass through texels that alpha cuts out. Errors:
/// kDevice if Embree cannot build the hierarchy (out of memory); kInterrupted.
Result<TracedScenePtr> build_traced_scene(const Scene& scene, const ProgressMonitor& monitor = {});
/// Does the same with at most `threads` threads.
Result<TracedScenePtr> build_traced_scene(const Scene& scene, int threads, const ProgressMonitor& monitor = {});

/// The surface that a ray hit, in unit space.
struct Surface {
  const Mesh* mesh = nullptr;
  const Material* material = nullptr;
  unsigned triangle = 0;     ///< index of the triangle or point
  float u = 0.0f, v = 0.0f;  ///< barycentric weights of the triangle's second and third vertex
  glm::vec3 position{0.0f};
  glm::vec3 geometric{0.0f};  ///< normal of the triangle or point, unit, on the ray's side
  glm::vec3 normal{0.0f};     ///< interpolated normal, unit, on the ray's side, not facing away from the ray
};

/// Returns the surface at the hit of a ray with this origin and direction at parameter `t`. `ng` is the normal of
/// the triangle as Embree returns it, of any length and sign. Normals of the result are on the side that the ray hit,
/// independent of the winding.
Surface surface_at(const TracedScene& traced, unsigned mesh, unsigned triangle, float u, float v, glm::vec3 origin,
                   glm::vec3 direction, glm::vec3 ng, float t);

/// Returns the origin for a ray that leaves the surface: offset along the geometric normal, so that rounding does not
/// make the ray hit the surface again. Above a disc the offset is larger, so that the surrounding discs, which deviate
/// slightly in height, do not block the ray. `seen_from` is the origin of the ray that hit the surface.
glm::vec3 ray_origin_above(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from);
/// Returns the length of that offset.
float ray_origin_height(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from);

/// Returns the origin for a ray to a light: on the smooth surface that the vertex normals of the triangle imply. The
/// triangle lies below that surface; at grazing light, rays from the triangle itself would be blocked by its neighbours
/// and give jagged shadows. [Hanika 2021]
glm::vec3 ray_origin_to_light(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from);

/// Offset of a ray's origin above a disc, as a fraction of the disc's radius.
inline constexpr float kDiscRayOffset = 0.3f;

/// Returns the mesh's colour at a hit; white if the mesh has none.
glm::vec3 mesh_color(const Surface& surface);

/// Returns the texture coordinates of a hit. The mesh must have texture coordinates.
glm::vec2 uv_at(const Mesh& mesh, unsigned triangle, float u, float v);

/// Returns the opacity of a surface: that of its material times the texture's alpha; 1 if it is not blended.
float opacity_at(const TracedScene& traced, const Mesh& mesh, unsigned triangle, float u, float v);

/// Returns whether a ray, in unit space, hits a surface with at least this opacity, and sets `hit`. A ray beyond
/// kRayLimit hits nothing.
bool first_hit(const TracedScene& traced, glm::vec3 origin, glm::vec3 direction, RTCRayHit& hit,
               float min_opacity = kOpaque);

/// Embree ends the program if a ray's origin or direction has a component beyond 1.844e18; rays stay below this.
inline constexpr float kRayLimit = 1e18f;

inline bool within_ray_limit(glm::vec3 v) {
  return std::abs(v.x) < kRayLimit && std::abs(v.y) < kRayLimit && std::abs(v.z) < kRayLimit;
}

/// Number of rays of a packet (rays/ray_packet.h).
inline constexpr int kPacket = 16;

}  // namespace umbrage
