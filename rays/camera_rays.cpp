#include "rays/camera_rays.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace umbrage {

CameraRays camera_rays(const TracedScene& traced, const PictureInfo& info) {
  const Camera& camera = info.camera;
  CameraRays rays;
  rays.world_from_view = glm::transpose(glm::mat3(camera.view_from_world));
  rays.eye = traced.unit_of(camera.eye());
  const glm::mat3 axes = rays.world_from_view * traced.scale;
  const glm::vec3 right = axes[0] * ((camera.right - camera.left) / float(info.width));
  const glm::vec3 down = axes[1] * (-(camera.top - camera.bottom) / float(info.height));
  const glm::vec3 corner = axes[0] * camera.left + axes[1] * camera.top;
  const glm::vec3 forward = -axes[2];
  rays.origin = rays.eye;
  rays.direction = forward;
  if (camera.projection == Projection::kOrthographic) {
    rays.origin += corner;
    rays.origin_x = right;
    rays.origin_y = down;
  } else {
    rays.direction += corner;
    rays.direction_x = right;
    rays.direction_y = down;
  }
  return rays;
}

bool rays_within_limit(const CameraRays& rays, const PictureInfo& info) {
  for (const float x : {0.0f, float(info.width)})
    for (const float y : {0.0f, float(info.height)}) {
      if (!within_ray_limit(rays.origin_at(x, y)) || !within_ray_limit(rays.direction_at(x, y))) return false;
    }
  return true;
}

namespace {

/// Returns the texture averaged over the pixel. The mesh must have texture coordinates.
glm::vec3 pixel_texel(const TracedScene& traced, const CameraRays& rays, const Surface& surface, int texture, float px,
                      float py) {
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
  return glm::vec3(sample_filtered(traced.textures[texture], t0 + t1 * surface.u + t2 * surface.v,
                                   change(px + 1.0f, py), change(px, py + 1.0f)));
}

}  // namespace

glm::vec3 pixel_albedo(const TracedScene& traced, const CameraRays& rays, const Surface& surface, float px, float py) {
  const Material& material = *surface.material;
  glm::vec3 albedo = material.albedo;
  if (!surface.mesh->colors.empty()) albedo *= mesh_color(surface);
  if (material.texture != kNoTexture && !surface.mesh->uvs.empty())
    albedo *= pixel_texel(traced, rays, surface, material.texture, px, py);
  return albedo;
}

glm::vec3 pixel_emission(const TracedScene& traced, const CameraRays& rays, const Surface& surface, float px,
                         float py) {
  const Material& material = *surface.material;
  if (material.emission_texture == kNoTexture || surface.mesh->uvs.empty()) return material.emission;
  return material.emission * pixel_texel(traced, rays, surface, material.emission_texture, px, py);
}

}  // namespace umbrage
