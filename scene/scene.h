// Scene: meshes, materials, textures, lights, bounds. World space, right-handed; lengths in the file's units.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/light.h"

namespace umbrage {

/// An image that a material refers to. 8-bit RGBA, sRGB colour with linear alpha, row 0 at the top (v = 1 in the
/// convention of OBJ and of this struct's users: texture coordinate (0, 0) is the lower left corner).
struct Texture {
  std::string name;  ///< file or description, for messages
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< width * height * 4
};

inline constexpr int kNoTexture = -1;

/// Reflection of a surface, linear Rec.709.
struct Material {
  std::string name;
  glm::vec3 albedo{0.8f};    ///< diffuse reflectance; multiplies the texture
  int texture = kNoTexture;  ///< index into Scene::textures
  bool alpha_mask = false;   ///< cut away where the texture's alpha is below alpha_cutoff
  float alpha_cutoff = 0.5f;
  float specular_strength = 0.0f;   ///< peak of the Blinn-Phong highlight, 0 to 1
  float specular_exponent = 32.0f;  ///< Blinn-Phong exponent
  glm::vec3 emission{0.0f};
  int emission_texture = kNoTexture;  ///< multiplies `emission`
};

/// An indexed triangle mesh with one material, or points. Its index in Scene::meshes is its object id, unless `object`
/// says otherwise.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;      ///< one per position, unit; empty for spheres, else only before finish_scene
  std::vector<glm::vec2> uvs;          ///< one per position, or empty; points have none
  std::vector<glm::vec3> colors;       ///< one per position, linear, or empty; they multiply the material's albedo
  std::vector<std::uint32_t> indices;  ///< three per triangle; points have none
  bool points = false;                 ///< each position is a disc across its normal, or a sphere
  bool spheres = false;                ///< of points
  std::vector<float> radii;            ///< of points, one per position; empty only before finish_scene
  int material = 0;                    ///< index into Scene::materials
  int object = 0;                      ///< object id: parts of one object share it
};

/// A place to look from, and at.
struct View {
  glm::vec3 eye{0.0f}, target{0.0f};
  float angle_deg = 30.0f;  ///< vertical field of view
  glm::vec3 up{0.0f};       ///< zero: Scene::up
  float height = 0.0f;      ///< of the window of a parallel projection; 0: the projection is perspective
  std::string name;
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;  ///< in world space; the first one is the key light. Empty: a default rig is made
  std::vector<View> views;    ///< suggested, the first is used where nobody names a camera; empty: automatic framing
  std::vector<View> cameras;  ///< those that the file holds, used where asked for
  std::vector<std::string> scene_names;  ///< of a file that holds several scenes, of which this is one; else empty
  int scene_index = 0;                   ///< which one
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  glm::vec3 ambient{0.3f};     ///< radiance from everywhere, the mean over all normals
  AmbientShape ambient_shape;  ///< in world space
  /// Luminance of white that is turned to the light: pictures are exposed for it. Lights of our own make about 1.
  float usual_light = 1.0f;
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  ///< filled by finish_scene
  int ground_object = -1;                        ///< object id of what add_ground added; below 0: nothing
  glm::vec3 ground_middle{0.0f};                 ///< of that
  float ground_fades = 0.0f;                     ///< distance from there at which its shade has faded; 0: it does not
  std::vector<std::string> warnings;             ///< one sentence each, for the user

  glm::vec3 center() const { return 0.5f * (bounds_min + bounds_max); }
  /// Radius of the bounding box's sphere.
  float radius() const;
  std::size_t triangle_count() const;
  std::size_t point_count() const;
};

Lighting lighting_of(const Scene& scene);
void set_lighting(Lighting lighting, Scene& scene);

/// "12 triangles", "5 points", "12 triangles and 5 points".
std::string size_text(const Scene& scene);

}  // namespace umbrage
