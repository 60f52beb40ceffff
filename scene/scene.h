// Scene: meshes, materials, textures, lights, views and bounds. World space, right-handed; lengths in the file's units.
#pragma once
#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/light.h"

namespace umbrage {

/// An image that a material refers to. 8-bit RGBA, sRGB or linear colour with linear alpha. Row 0 is at the top;
/// texture coordinate (0, 0) is the lower left corner, so v = 1 at the top, as in OBJ.
struct Texture {
  std::string name;  ///< file or description, for messages
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< width * height * 4
  bool linear = false;             ///< the colour channels hold linear values
  bool nearest = false;            ///< texels have sharp edges where they are larger than a pixel
  bool clamped = false;            ///< beyond its borders the texture has their colours; else it repeats
};

inline constexpr int kNoTexture = -1;

// The range of Material::specular_exponent.
inline constexpr float kMinExponent = 1.0f;     ///< with less, a highlight is as wide as the diffuse lobe
inline constexpr float kMaxExponent = 2048.0f;  ///< with more, a highlight is smaller than a pixel

/// Reflection of a surface, linear Rec.709: with a roughness that of glTF 2.0, appendix B, else Lambert and
/// Blinn-Phong.
struct Material {
  std::string name;
  glm::vec3 albedo{0.8f};    ///< diffuse reflectance, of metals the reflectance; multiplies the texture
  int texture = kNoTexture;  ///< index into Scene::textures
  bool alpha_mask = false;   ///< cut out where the texture's alpha is below alpha_cutoff
  float alpha_cutoff = 0.5f;
  float specular_strength = 0.0f;   ///< peak of the Blinn-Phong highlight, 0 to 1
  float specular_exponent = 32.0f;  ///< Blinn-Phong exponent
  glm::vec3 emission{0.0f};
  int emission_texture = kNoTexture;  ///< multiplies `emission`
  float metallic = 0.0f;              ///< 0 dielectric, 1 metal
  float roughness = kNoRoughness;     ///< 0 to 1: perceptual, the square root of the GGX width; kNoRoughness: see above
  /// A linear texture: red is the fraction of ambient light that arrives, green multiplies `roughness`, blue
  /// `metallic`.
  int surface_texture = kNoTexture;
  float occlusion_strength = 0.0f;  ///< how far the red channel of `surface_texture` applies, 0 to 1
  /// A linear texture with the normal in the triangle's tangent space: x towards u, y towards v, as 2 t - 1 of a texel
  /// t.
  int normal_texture = kNoTexture;
  float normal_scale = 1.0f;  ///< multiplies x and y of the normal
  /// Blended: the surface covers a pixel by its opacity, and what is behind it is seen, multiplied by `tint`, through
  /// the remainder. Multiplied by the alpha of `texture`.
  bool blended = false;
  float opacity = 1.0f;
  bool glass = false;                ///< blended only: reflects by Fresnel's law where it is clear, too
  glm::vec3 tint{1.0f};              ///< blended only: transmittance of the material, linear
  std::vector<std::string> ignored;  ///< properties in the file that are not drawn: "clearcoat"
};

/// Returns the members of a material that are indices of textures.
inline std::array<int*, 4> textures_of(Material& material) {
  return {&material.texture, &material.emission_texture, &material.surface_texture, &material.normal_texture};
}

/// Values of a file on the vertices or triangles of a mesh, such as a pressure. `--color-by` shows them.
struct Field {
  std::string name;           ///< as in the file
  int components = 1;         ///< of each value; at least 1
  bool on_triangles = false;  ///< a value per triangle, else one per position; only before finish_scene
  bool is_spread = false;     ///< by finish_scene: each triangle has three positions of its own, with one value
  std::vector<float> values;  ///< `components` per value; NaN: missing
};

struct ValueColors;

/// An indexed triangle mesh with one material, or a set of points.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;      ///< one per position, unit; empty for spheres, else only before finish_scene
  std::vector<glm::vec2> uvs;          ///< one per position, or empty; points have none
  std::vector<glm::vec3> colors;       ///< one per position, linear, or empty; they multiply the material's albedo
  std::vector<std::uint32_t> indices;  ///< three per triangle; points have none
  /// Smoothing group of each triangle, or empty; only before finish_scene. Normals are created within a group; 0: flat.
  std::vector<std::uint32_t> smoothing;
  bool points = false;       ///< each position is drawn as a disc perpendicular to its normal, or as a sphere
  bool spheres = false;      ///< points only: drawn as spheres
  std::vector<float> radii;  ///< points only: one per position, scene units; empty only before finish_scene
  /// Discs only: change of the normal across each disc, see bent_normal; 1 / scene units; empty: discs are flat.
  std::vector<glm::vec3> bends;
  std::vector<Field> fields;  ///< those that ImportSettings::field asks for
  int material = 0;           ///< index into Scene::materials
  int object = 0;             ///< object id; parts of one object have the same id
};

/// A camera of a scene: where it is, where it looks, and its projection.
struct View {
  glm::vec3 eye{0.0f}, target{0.0f};
  float angle_deg = 30.0f;  ///< vertical field of view
  glm::vec3 up{0.0f};       ///< up direction; zero: Scene::up
  float height = 0.0f;      ///< height of the window of a parallel projection, scene units; 0: perspective
  std::string name;
};

/// A fact that depends on an up direction. Keeps that of the last one.
template <class Fact>
class KeptFact {
 public:
  /// Returns the fact for `up`, from find() if it is not known. Several threads may call this: one of them finds it.
  template <class Find>
  Fact of(const glm::vec3& up, const Find& find) {
    const std::lock_guard lock(mutex_);
    if (!fact_ || up_ != up) fact_ = find(), up_ = up, ++found_;
    return *fact_;
  }
  /// Returns how often the fact was found.
  int found() const { return found_; }

 private:
  std::mutex mutex_;
  std::optional<Fact> fact_;
  glm::vec3 up_{0.0f};
  int found_ = 0;
};

/// Facts of a scene's shape that take a pass over all its triangles: each is found once, not once per picture.
struct ShapeFacts {
  KeptFact<glm::vec3> front;            ///< of scene/front.h
  KeptFact<std::vector<float>> relief;  ///< of scene/ground.h
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;  ///< world space; the first one is the key light; empty: default lights are used
  std::vector<View> views;    ///< suggested by the scene; the first is the default camera; empty: automatic framing
  std::vector<View> cameras;  ///< cameras of the file, used on request
  std::vector<std::string> scene_names;      ///< names of all scenes in the file, if it has several; else empty
  int scene_index = 0;                       ///< index of this scene in scene_names
  std::vector<std::string> animation_names;  ///< names of all animations in the file
  std::vector<float> animation_durations_s;  ///< one per name, seconds
  /// Position of the scene's origin in the coordinates of the file, which exceed the precision of floats if the model
  /// is far from the file's origin.
  glm::dvec3 origin{0.0};
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  bool has_front = false;      ///< the format of the file defines that models face +z where y is up
  glm::vec3 ambient{0.3f};     ///< radiance of ambient light, averaged over all normals
  AmbientShape ambient_shape;  ///< change of ambient light with the normal, world space
  /// Luminance of a white surface that faces the light; pictures are exposed for it. With the built-in lights about 1.
  float lit_white_luminance = 1.0f;
  std::shared_ptr<const ReflectionMap> reflections;  ///< see Lighting
  /// Filled by finish_scene; of a model in a pose of an animation, those of `motion`.
  glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};
  /// Points around the model in all poses of its animation, so that the camera and the ground are the same for all
  /// times; empty: it has the file's pose.
  std::vector<glm::vec3> motion;
  /// The model at the start of its animation, which decides what must not change with the time but depends on more than
  /// bounds: front, own ground, exposure. Null: this scene.
  std::shared_ptr<const Scene> start;
  int ground_object = -1;         ///< object id of the disc from add_ground; below 0: there is none
  glm::vec3 ground_center{0.0f};  ///< centre of the disc
  /// Distance from the centre of the disc at which shadows on the disc have faded out; 0: they do not fade.
  float ground_fade_distance = 0.0f;
  std::shared_ptr<const ValueColors> value_colors;  ///< null: no values are shown
  std::vector<std::string> warnings;                ///< one sentence each, shown to the user
  /// Found on demand and shared by copies of the scene, which differ in materials, lights and the
  /// ground. New after finish_scene and whatever else changes the model's shape.
  std::shared_ptr<ShapeFacts> shape_facts = std::make_shared<ShapeFacts>();

  glm::vec3 center() const { return 0.5f * (bounds_min + bounds_max); }
  /// Returns half the diagonal of the bounding box, scene units.
  float radius() const;
  std::size_t triangle_count() const;
  std::size_t point_count() const;
};

/// Returns whether a material has a roughness, and so reflects its surroundings.
bool has_roughness(const Scene& scene);

/// A blended surface with at least this opacity is drawn as an opaque one; with less than kMinOpacity it is not drawn;
/// with less than kMinShadowOpacity it casts no shadow.
inline constexpr float kOpaque = 0.998f, kMinOpacity = 0.002f, kMinShadowOpacity = 0.5f;

/// Reflectance of glass seen from in front, and the min opacity that readers give it, so that a pane remains visible.
inline constexpr float kGlassReflectance = 0.04f, kGlassOpacity = 0.1f;

/// Returns whether a mesh has a surface that is seen through.
bool has_blended(const Scene& scene);

/// Returns a copy of the scene's lighting.
Lighting lighting_of(const Scene& scene);
/// Replaces the scene's lighting.
void set_lighting(Lighting lighting, Scene& scene);

/// Returns the scene's size as text: "12 triangles", "5 points", "12 triangles and 5 points".
std::string size_text(const Scene& scene);

/// Returns the position that a reader subtracts, in double precision, from the coordinates of a file with this bounding
/// box, before it converts them to floats, and that it stores in Scene::origin. Zero if the box is near the origin for
/// its size: then floats are precise enough and coordinates stay as they are. Otherwise near the box's centre, a
/// multiple of a power of two, so that the subtraction is exact.
glm::dvec3 scene_origin(const glm::dvec3& low, const glm::dvec3& high);

/// Moves the scene's origin to this position in the coordinates of the file: all positions change, what is drawn does
/// not. Rounds to floats.
void set_origin(const glm::dvec3& origin, Scene& scene);

/// Moves each object away from the scene's centre by a fraction of the distance of their centres, and sets the bounds.
/// Adds a warning if there is only one object.
void explode(float fraction, Scene& scene);

/// Sets Scene::motion, and the bounds to those of the points. Without points, nothing changes.
void set_motion(std::vector<glm::vec3> points, Scene& scene);

/// Returns a view matrix for the coordinates of the file from one for those of the scene.
glm::dmat4 view_from_file(const glm::mat4& view_from_scene, const glm::dvec3& origin);

}  // namespace umbrage
