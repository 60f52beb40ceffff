// The material of the surface that a pixel shows, with its textures averaged over the pixel.
#pragma once
#include "rays/camera_rays.h"

namespace umbrage {

/// The properties of a material to compute.
struct MaterialParts {
  bool albedo = true, emission = true;
  bool surface = true;  ///< metallic, roughness and occlusion
  bool normal = true;
};

/// The material at a pixel; the properties are those of Material.
struct PixelMaterial {
  glm::vec3 albedo{0.0f};  ///< material, mesh colour and texture
  glm::vec3 emission{0.0f};
  float metallic = 0.0f, roughness = kNoRoughness;
  float occlusion = 1.0f;  ///< fraction of ambient light that arrives according to the material
  glm::vec3 normal{0.0f};  ///< normal of the surface with the normal map: unit, on the ray's side, world space
};

/// Returns the material of the surface that the pixel with the centre (px, py) shows.
///
/// The tangent frame of a normal map is that of the triangle's texture coordinates, perpendicular to the interpolated
/// normal. Differs from glTF 2.0: tangents in the file are not used.
PixelMaterial pixel_material(const TracedScene& traced, const CameraRays& rays, const Surface& surface, float px,
                             float py, const MaterialParts& parts = {});

}  // namespace umbrage
