#include "rays/pixel_material.h"

#include <glm/geometric.hpp>

namespace umbrage {
namespace {

/// The texture coordinates of a pixel, and their change on the triangle's plane.
struct PixelUv {
  glm::vec2 uv{0.0f}, right{0.0f}, down{0.0f};  ///< at the surface, and the change to the next pixel
  glm::vec3 across{0.0f};                       ///< normal of the triangle by its winding, of any length
  glm::vec3 tangent{0.0f};                      ///< change of the position with u, times the determinant below
  float determinant = 0.0f;                     ///< signed area of the triangle in texture space, times 2
};

/// The mesh must have texture coordinates.
PixelUv pixel_uv(const TracedScene& traced, const CameraRays& rays, const Surface& surface, float px, float py) {
  const Mesh& mesh = *surface.mesh;
  const std::uint32_t* i = mesh.indices.data() + std::size_t(surface.triangle) * 3;
  const glm::vec3 p0 = mesh.positions[i[0]];
  const glm::vec3 e1 = (mesh.positions[i[1]] - p0) * traced.scale, e2 = (mesh.positions[i[2]] - p0) * traced.scale;
  const glm::vec3 ng = glm::cross(e1, e2);
  const glm::vec2 t0 = mesh.uvs[i[0]], t1 = mesh.uvs[i[1]] - t0, t2 = mesh.uvs[i[2]] - t0;
  // Gradients of the texture coordinates on the triangle: gradients of the barycentric weights times the differences
  // along the edges.
  const float inverse = 1.0f / glm::dot(ng, ng);
  const glm::vec3 gradient1 = glm::cross(e2, ng) * inverse, gradient2 = glm::cross(ng, e1) * inverse;
  const glm::vec3 gradient_u = gradient1 * t1.x + gradient2 * t2.x, gradient_v = gradient1 * t1.y + gradient2 * t2.y;
  // Returns the change of the texture coordinates from the surface point to where the ray through (x, y) meets the
  // triangle's plane.
  const auto change = [&](float x, float y) {
    const glm::vec3 origin = rays.origin_at(x, y), direction = rays.direction_at(x, y);
    const float t = glm::dot(ng, surface.position - origin) / glm::dot(ng, direction);
    const glm::vec3 offset = origin + direction * t - surface.position;
    return glm::vec2(glm::dot(offset, gradient_u), glm::dot(offset, gradient_v));
  };
  return {.uv = t0 + t1 * surface.u + t2 * surface.v,
          .right = change(px + 1.0f, py),
          .down = change(px, py + 1.0f),
          .across = ng,
          .tangent = e1 * t2.y - e2 * t1.y,
          .determinant = t1.x * t2.y - t1.y * t2.x};
}

/// Returns the interpolated normal as the mesh stores it, of any length.
glm::vec3 stored_normal(const Surface& surface) {
  const Mesh& mesh = *surface.mesh;
  const std::uint32_t* i = mesh.indices.data() + std::size_t(surface.triangle) * 3;
  return mesh.normals[i[0]] * (1.0f - surface.u - surface.v) + mesh.normals[i[1]] * surface.u +
         mesh.normals[i[2]] * surface.v;
}

/// Returns the surface's normal, turned by `texel` of its normal map. On the back of the surface, bumps are dents.
glm::vec3 mapped_normal(const Surface& surface, const PixelUv& at, glm::vec3 texel, glm::vec3 ray) {
  const glm::vec3 normal = surface.normal, stored = stored_normal(surface);
  const float side = glm::dot(stored, normal) < 0.0f ? -1.0f : 1.0f;
  glm::vec3 tangent = at.tangent * (at.determinant < 0.0f ? -1.0f : 1.0f);
  tangent -= normal * glm::dot(normal, tangent);
  const float length = glm::length(tangent);
  if (!(length > 0.0f) || at.determinant == 0.0f) return normal;
  tangent *= 1.0f / length;
  const float handed = (glm::dot(at.across, stored) < 0.0f) != (at.determinant < 0.0f) ? -1.0f : 1.0f;
  const glm::vec3 bitangent = glm::cross(normal, tangent) * (side * handed);
  const glm::vec2 slope = (glm::vec2(texel) * 2.0f - 1.0f) * (surface.material->normal_scale * side);
  glm::vec3 mapped = tangent * slope.x + bitangent * slope.y + normal * (texel.z * 2.0f - 1.0f);
  const float size = glm::length(mapped);
  if (!(size > 1e-6f)) return normal;
  mapped *= 1.0f / size;
  // As in surface_at: a normal that faces away from the camera is turned until it does not.
  const float away = glm::dot(mapped, ray);
  return away > 0.0f ? glm::normalize(mapped - ray * (away / glm::dot(ray, ray) * 1.001f)) : mapped;
}

}  // namespace

PixelMaterial pixel_material(const TracedScene& traced, const CameraRays& rays, const Surface& surface, float px,
                             float py, const MaterialParts& parts) {
  const Material& material = *surface.material;
  const bool has_uvs = !surface.mesh->uvs.empty();
  const auto used = [&](bool part, int texture) { return part && has_uvs && texture != kNoTexture; };
  const bool albedo = used(parts.albedo, material.texture), emission = used(parts.emission, material.emission_texture),
             maps = used(parts.surface, material.surface_texture), normal = used(parts.normal, material.normal_texture);
  PixelMaterial out{.albedo = material.albedo,
                    .emission = material.emission,
                    .metallic = material.metallic,
                    .roughness = material.roughness,
                    .normal = surface.normal};
  if (parts.albedo && !surface.mesh->colors.empty()) out.albedo *= mesh_color(surface);
  if (!albedo && !emission && !maps && !normal) return out;
  const PixelUv at = pixel_uv(traced, rays, surface, px, py);
  MipFootprint footprint;  // the maps of a material usually have one size
  const auto texel = [&](int index) {
    const MipTexture& texture = traced.textures[std::size_t(index)];
    if (texture.levels[0].width != footprint.width || texture.levels[0].height != footprint.height)
      footprint = footprint_of(texture, at.uv, at.right, at.down);
    return glm::vec3(sample_filtered(texture, footprint));
  };
  if (albedo) out.albedo *= texel(material.texture);
  if (emission) out.emission *= texel(material.emission_texture);
  if (maps) {
    const glm::vec3 factors = texel(material.surface_texture);
    out.occlusion = 1.0f + material.occlusion_strength * (factors.r - 1.0f);
    if (material.roughness >= 0.0f) out.roughness *= factors.g;
    out.metallic *= factors.b;
  }
  if (normal) out.normal = mapped_normal(surface, at, texel(material.normal_texture), rays.direction_at(px, py));
  return out;
}

}  // namespace umbrage
