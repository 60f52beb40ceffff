#include "rays/traced_scene.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <set>

#include "scene/points.h"

namespace umbrage {

void FreeTracedScene::operator()(TracedScene* traced) const {
  if (traced->rtc) rtcReleaseScene(traced->rtc);
  if (traced->device) rtcReleaseDevice(traced->device);
  delete traced;
}

namespace {

// Offset of a ray that leaves a surface, as a fraction of the hit's distance from the scene's origin and from the
// camera; float positions are accurate to 6e-8 of their size.
constexpr float kStartOffset = 4e-6f;

glm::vec2 interpolated(const std::array<glm::vec2, 3>& uvs, float u, float v) {
  return uvs[0] * (1.0f - u - v) + uvs[1] * u + uvs[2] * v;
}

/// Returns the alpha of the mesh's texture; 1 if it has none.
float alpha_at(const TracedScene& traced, const Mesh& mesh, unsigned triangle, float u, float v) {
  const int texture = traced.scene->materials[mesh.material].texture;
  if (texture == kNoTexture || mesh.uvs.empty()) return 1.0f;
  return sample_alpha(traced.textures[texture], uv_at(mesh, triangle, u, v));
}

/// Filter function of Embree: rejects hits where the texture's alpha is below the cutoff, or the opacity of a blended
/// surface below that of the context.
void cut_away(const RTCFilterFunctionNArguments* args) {
  const auto& cut_out = *static_cast<const CutOut*>(args->geometryUserPtr);
  const float bound =
      cut_out.blended ? reinterpret_cast<const RayContext*>(args->context)->min_opacity : cut_out.cutoff;
  for (unsigned k = 0; k < args->N; ++k) {
    if (args->valid[k] == 0) continue;
    bool reaches = cut_out.opacity >= bound;
    if (cut_out.texture) {
      const auto& uvs = cut_out.uvs[RTCHitN_primID(args->hit, args->N, k)];
      const float u = RTCHitN_u(args->hit, args->N, k), v = RTCHitN_v(args->hit, args->N, k);
      reaches = alpha_reaches(*cut_out.texture, interpolated(uvs, u, v), cut_out.opacity, bound);
    }
    if (!reaches) args->valid[k] = 0;
  }
}

/// Normalizes v even if its square is outside the range of floats, as for the normal of a tiny triangle.
glm::vec3 unit(glm::vec3 v) {
  const glm::vec3 size = glm::abs(v);
  const float largest = std::max({size.x, size.y, size.z});
  return largest > 0.0f ? glm::normalize(v / largest) : glm::vec3(0.0f, 0.0f, 1.0f);
}

}  // namespace

glm::vec2 uv_at(const Mesh& mesh, unsigned triangle, float u, float v) {
  const std::uint32_t* i = mesh.indices.data() + std::size_t(triangle) * 3;
  return interpolated({mesh.uvs[i[0]], mesh.uvs[i[1]], mesh.uvs[i[2]]}, u, v);
}

float opacity_at(const TracedScene& traced, const Mesh& mesh, unsigned triangle, float u, float v) {
  const Material& material = traced.scene->materials[mesh.material];
  return material.blended ? material.opacity * alpha_at(traced, mesh, triangle, u, v) : 1.0f;
}

Surface surface_at(const TracedScene& traced, unsigned mesh_index, unsigned triangle, float u, float v,
                   glm::vec3 origin, glm::vec3 direction, glm::vec3 ng, float t) {
  const Mesh& mesh = traced.scene->meshes[mesh_index];
  Surface surface{
      .mesh = &mesh, .material = &traced.scene->materials[mesh.material], .triangle = triangle, .u = u, .v = v};
  surface.position = origin + direction * t;
  glm::vec3 geometric = ng, normal = ng;
  if (mesh.points) {
    // Embree's normal of a sphere has arbitrary length.
    normal = geometric = mesh.spheres ? unit(ng) : mesh.normals[triangle];
    if (!mesh.bends.empty())
      normal = bent_normal(normal, mesh.bends[triangle] / traced.scale,
                           surface.position - traced.unit_of(mesh.positions[triangle]));
  } else {
    const std::uint32_t* i = mesh.indices.data() + std::size_t(triangle) * 3;
    normal = mesh.normals[i[0]] * (1.0f - u - v) + mesh.normals[i[1]] * u + mesh.normals[i[2]] * v;
  }
  if (glm::dot(geometric, direction) > 0.0f) geometric = -geometric;
  if (glm::dot(normal, geometric) < 0.0f) normal = -normal;
  surface.geometric = unit(geometric);
  const float length = glm::length(normal);
  normal = length > 1e-12f ? normal / length : surface.geometric;
  // Interpolation must not tilt a normal past the horizon.
  if (const float away = glm::dot(normal, direction); away > 0.0f) {
    constexpr float kPastHorizon = 1.001f;
    normal = glm::normalize(normal - direction * (away / glm::dot(direction, direction) * kPastHorizon));
  }
  surface.normal = normal;
  return surface;
}

float ray_origin_height(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from) {
  const glm::vec3 extent = glm::abs(surface.position) + glm::abs(surface.position - seen_from);
  float height = kStartOffset * std::max({extent.x, extent.y, extent.z});
  const Mesh& mesh = *surface.mesh;
  if (mesh.points && !mesh.spheres) height += kDiscRayOffset * traced.scale * mesh.radii[surface.triangle];
  return height;
}

glm::vec3 ray_origin_above(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from) {
  return surface.position + surface.geometric * ray_origin_height(traced, surface, seen_from);
}

glm::vec3 mesh_color(const Surface& surface) {
  const Mesh& mesh = *surface.mesh;
  if (mesh.colors.empty()) return glm::vec3(1.0f);
  if (mesh.points) return mesh.colors[surface.triangle];
  const std::uint32_t* i = mesh.indices.data() + std::size_t(surface.triangle) * 3;
  return mesh.colors[i[0]] * (1.0f - surface.u - surface.v) + mesh.colors[i[1]] * surface.u +
         mesh.colors[i[2]] * surface.v;
}

glm::vec3 ray_origin_to_light(const TracedScene& traced, const Surface& surface, glm::vec3 seen_from) {
  const Mesh& mesh = *surface.mesh;
  if (mesh.points) return ray_origin_above(traced, surface, seen_from);
  const std::uint32_t* i = mesh.indices.data() + std::size_t(surface.triangle) * 3;
  const float weights[3] = {1.0f - surface.u - surface.v, surface.u, surface.v};
  const glm::vec3 start = ray_origin_above(traced, surface, seen_from);
  constexpr float kFlat = 1.0f - 1e-6f;  // cosine: ignores a lift of at most 0.1 % of a triangle's size
  const auto is_flat = [&](int k) { return std::abs(glm::dot(mesh.normals[i[k]], surface.geometric)) > kFlat; };
  if (is_flat(0) && is_flat(1) && is_flat(2)) return start;
  glm::vec3 lift(0.0f);
  for (int k = 0; k < 3; ++k) {
    glm::vec3 normal = mesh.normals[i[k]];
    if (glm::dot(normal, surface.geometric) < 0.0f) normal = -normal;
    // Distance of the point below the tangent plane of the vertex.
    const float below = -glm::dot(surface.position - traced.unit_of(mesh.positions[i[k]]), normal);
    lift += normal * (weights[k] * std::max(below, 0.0f));
  }
  return start + lift;
}

namespace {

/// Returns the indices of the textures that rays can read: those of materials of meshes with texture coordinates.
std::vector<int> textures_of_rays(const Scene& scene) {
  std::set<int> used;
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.uvs.empty()) {
      Material material = scene.materials[std::size_t(mesh.material)];
      for (const int* texture : textures_of(material)) used.insert(*texture);
    }
  used.erase(kNoTexture);
  return {used.begin(), used.end()};
}

/// Passes a mesh to Embree, moved to unit space. Returns false if memory is exhausted.
bool set_triangles(const TracedScene& traced, const Mesh& mesh, RTCGeometry geometry) {
  // Use buffers that Embree allocates: it reads 16 bytes per vertex, beyond the end of a shared array of 12 bytes each.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                           mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh.indices.size() / 3);
  if (!vertices || !indices) return false;
  std::transform(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(vertices),
                 [&](glm::vec3 p) { return traced.unit_of(p); });
  std::memcpy(indices, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
  return true;
}

/// Stores what alpha cuts out of a mesh. Returns false if that is nothing.
bool set_cut_out(const Mesh& mesh, const Material& material, std::vector<MipTexture>& textures, CutOut& out) {
  const bool textured = material.texture != kNoTexture && !mesh.uvs.empty();
  if (!material.blended && !(material.alpha_mask && textured)) return false;
  if (material.blended) out = {.blended = true, .opacity = material.opacity};
  if (!textured) return true;
  MipTexture& texture = textures[std::size_t(material.texture)];
  if (texture.alpha_ranges.empty()) add_alpha_ranges(texture);
  if (!material.blended) {
    out.cutoff = material.alpha_cutoff;
    if (float(whole_range(texture).min) / 255.0f >= out.cutoff) return false;
  }
  out.texture = &texture;
  out.uvs.resize(mesh.indices.size() / 3);
  for (std::size_t k = 0; k < mesh.indices.size(); ++k) out.uvs[k / 3][k % 3] = mesh.uvs[mesh.indices[k]];
  return true;
}

bool set_points(const TracedScene& traced, const Mesh& mesh, RTCGeometry geometry) {
  const std::size_t count = mesh.positions.size();
  auto* points = static_cast<glm::vec4*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), count));
  if (!points) return false;
  for (std::size_t i = 0; i < count; ++i)
    points[i] = glm::vec4(traced.unit_of(mesh.positions[i]), mesh.radii[i] * traced.scale);
  if (mesh.spheres) return true;
  void* normals =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), count);
  if (!normals) return false;
  std::memcpy(normals, mesh.normals.data(), count * sizeof(glm::vec3));
  return true;
}

}  // namespace

Result<TracedScenePtr> build_traced_scene(const Scene& scene, int threads, const ProgressMonitor& monitor) {
  tbb::task_arena arena(threads);
  return arena.execute([&] { return build_traced_scene(scene, monitor); });
}

Result<TracedScenePtr> build_traced_scene(const Scene& scene, const ProgressMonitor& monitor) {
  Watch watch(monitor, 1);
  TracedScenePtr traced(new TracedScene);
  traced->scene = &scene;
  const auto device = new_embree_device();
  if (!device) return device.error();
  traced->device = *device;
  traced->width = packet_width(traced->device);
  traced->rtc = rtcNewScene(traced->device);
  rtcSetSceneFlags(traced->rtc, RTC_SCENE_FLAG_ROBUST);
  traced->center = scene.center();
  if (const float radius = scene.radius(); radius > 0.0f) traced->scale = std::exp2(-std::round(std::log2(radius)));
  const std::vector<int> used = textures_of_rays(scene);
  traced->textures.resize(scene.textures.size());
  tbb::parallel_for(std::size_t(0), used.size(), [&](std::size_t k) {
    watch.reached(0.0);
    if (!watch.ended()) traced->textures[std::size_t(used[k])] = make_mips(scene.textures[std::size_t(used[k])]);
  });
  if (watch.ended()) return interrupted();
  traced->cut_outs.resize(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    watch.reached(0.0);
    if (watch.ended()) return interrupted();
    const Mesh& mesh = scene.meshes[m];
    const RTCGeometryType type = !mesh.points   ? RTC_GEOMETRY_TYPE_TRIANGLE
                                 : mesh.spheres ? RTC_GEOMETRY_TYPE_SPHERE_POINT
                                                : RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT;
    const RTCGeometry geometry = rtcNewGeometry(traced->device, type);
    if (!(mesh.points ? set_points(*traced, mesh, geometry) : set_triangles(*traced, mesh, geometry))) {
      rtcReleaseGeometry(geometry);
      return build_error(scene, RTC_ERROR_OUT_OF_MEMORY);
    }
    const Material& material = scene.materials[std::size_t(mesh.material)];
    if (CutOut& cut_out = traced->cut_outs[m]; set_cut_out(mesh, material, traced->textures, cut_out)) {
      rtcSetGeometryUserData(geometry, &cut_out);
      rtcSetGeometryIntersectFilterFunction(geometry, cut_away);
      rtcSetGeometryOccludedFilterFunction(geometry, cut_away);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(traced->rtc, geometry, unsigned(m));
    rtcReleaseGeometry(geometry);
  }
  // Embree calls this from all threads that build, including the calling thread.
  if (monitor)
    rtcSetSceneProgressMonitorFunction(
        traced->rtc,
        [](void* pointer, double fraction) {
          auto& watched = *static_cast<Watch*>(pointer);
          watched.reached(fraction);
          return !watched.ended();
        },
        &watch);
  rtcCommitScene(traced->rtc);
  if (watch.ended()) return interrupted();
  rtcSetSceneProgressMonitorFunction(traced->rtc, nullptr, nullptr);
  if (const RTCError error = rtcGetDeviceError(traced->device); error != RTC_ERROR_NONE)
    return build_error(scene, error);
  return traced;
}

bool first_hit(const TracedScene& traced, glm::vec3 origin, glm::vec3 direction, RTCRayHit& hit, float min_opacity) {
  if (!within_ray_limit(origin) || !within_ray_limit(direction)) return false;
  RayContext context(Coherence::kIncoherent, min_opacity);
  hit = {};
  hit.ray.org_x = origin.x;
  hit.ray.org_y = origin.y;
  hit.ray.org_z = origin.z;
  hit.ray.dir_x = direction.x;
  hit.ray.dir_y = direction.y;
  hit.ray.dir_z = direction.z;
  hit.ray.tfar = std::numeric_limits<float>::infinity();
  hit.ray.mask = ~0u;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  trace(traced.rtc, hit, context);
  return hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace umbrage
