// GBuffer: the named input planes of shading, in one or more depth layers, and the camera that captured them.
//
// Planes of a layer, each optional but `depth`:
//   depth             view depth, scene units; +infinity where nothing was hit
//   normal.x .y .z    unit, view space, facing the camera; 0 where nothing was hit
//   albedo.r .g .b    diffuse reflectance, of metals the reflectance, linear
//   specular          peak of the highlight, 0 to 1
//   shininess         Blinn-Phong exponent
//   shadow            fraction of the key light (light 0) that arrives, 0 to 1
//   shadow1 to shadow7   the same for the lights 1 to 7, if they cast shadows
//   emission.r .g .b  emitted light, linear; only if a material of the scene emits
//   metallic          0 dielectric, 1 metal; this and roughness only if a material of the scene has a roughness
//   roughness         0 to 1, as in glTF 2.0; below 0: none, and `specular` and `shininess` hold for the pixel
//   material_ao       fraction of ambient light that arrives by the material's occlusion map; only if one has a map
//   opacity           of all blended surfaces along the ray together: the fraction of the pixel that they cover
//   transmittance.r .g .b   fraction of the light from behind them that arrives; these four only if they are captured
//   object_id, material_id   integers; -1 where nothing was hit
//   ray_offset.x .y .z   from the surface to the point where rays leave it, view space, scene units: along the
//                     triangle's normal, on the visible side; 0 where nothing was hit; only on request
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/light.h"

namespace umbrage {

struct LinesBetween;  // core/strokes.h

/// A patch of surface, one of a few coarse occluders that stand for the surfaces of a scene.
struct Occluder {
  glm::vec3 center{0.0f};  ///< centroid of the patch, world space, scene units
  /// Radius of a sphere with the area of the patch, scene units. The cross-section of the sphere is a quarter of the
  /// patch, which is the mean shadow of a convex body with that surface.
  float radius = 0.0f;
  glm::vec3 mean_normal{0.0f};  ///< over the patch, world space: of length 1 where it is flat, 0 where it is closed
  int object = 0;               ///< index of the object among those of the set, from 0
};

/// Sorted by object.
struct OccluderSet {
  std::vector<Occluder> occluders;
  int objects = 0;  ///< number of objects
};

inline constexpr int kMaxOccluders = 256;  ///< of a set

/// The content of a depth layer beyond the first.
enum class LayerKind {
  kBehind,  ///< the next surface behind that of layer `of`, along the same rays
  /// The back side of the surfaces of layer `of`: normals face away from the camera, and light and shadow are those of
  /// that side. No highlight, since no camera sees that side.
  kBack,
  kOther,  ///< the surfaces that another camera sees
};

struct LayerInfo {
  LayerKind kind = LayerKind::kBehind;
  int of = 0;     ///< index of the layer to which `kind` refers
  Camera camera;  ///< kOther: camera of the layer, with the picture's size; otherwise unused
};

/// Properties of a picture that effects may use besides its planes.
struct PictureInfo {
  int width = 0, height = 0;  ///< pixels, guard band included
  int guard = 0;              ///< guard band: pixels on each side that effects can read, cropped from the result
  Camera camera;              ///< of the whole picture, guard band included
  std::vector<Light> lights;  ///< in view space
  /// Transform from the view space of the first layer's camera to that of this picture; see layer_info.
  glm::mat4 view_from_first{1.0f};
  std::vector<LayerInfo> more_layers;                          ///< the layers beyond the first
  glm::vec3 ambient{0.3f};                                     ///< ambient light, mean over all normals
  AmbientShape ambient_shape;                                  ///< in view space
  std::shared_ptr<const ReflectionMap> reflections = nullptr;  ///< as in Lighting
  bool has_roughness = false, has_material_ao = false;         ///< the planes `roughness`, `material_ao` exist
  float lit_white_luminance = 1.0f;  ///< luminance of a white surface that faces the light: see Scene
  /// Radius of the bounding sphere, scene units; for a G-buffer without a scene half the robust depth extent.
  float scene_radius = 1.0f;
  float depth_min = 1.0f, depth_max = 2.0f;  ///< range of view depths that contains the scene
  int ground_object = -1;                    ///< object id of a ground that shows only shadow and occlusion; < 0: none
  glm::vec3 ground_center{0.0f};             ///< centre of that ground, view space
  float ground_fade_distance = 0.0f;  ///< distance from ground_center at which its shadow has faded out; 0: no fading
  /// Coarse occluders of the scene, world space; null if they are not requested or there is no scene.
  std::shared_ptr<const OccluderSet> occluders = nullptr;
  /// Lines of key frames, which an effect with KeySteps draws in place of new ones; null: there are none.
  std::shared_ptr<const LinesBetween> lines_between = nullptr;
  std::optional<Camera> other_camera;  ///< camera of the other frame whose planes this one reads, guard band included
  int reduced = 1;                     ///< downsampling factor of a picture at reduced resolution; 1: full resolution
  int whole_width = 0, whole_height = 0;  ///< reduced > 1: inner size of the picture at full resolution
  /// Of rows that were cut out of a finished picture: their first row there, and the rows of that picture; 0: whole.
  int first_row = 0, whole_rows = 0;

  /// Return the distance between the centres of neighbouring pixels: at depth 1 in a perspective picture, at any depth
  /// in an orthographic one.
  float pixel_width() const { return (camera.right - camera.left) / float(width); }
  float pixel_height() const { return (camera.top - camera.bottom) / float(height); }

  /// Return the size of the picture without its guard band.
  int inner_width() const { return width - 2 * guard; }
  int inner_height() const { return height - 2 * guard; }
  /// Return the size to which relative lengths refer, in pixels of this picture: a percentage is the same distance at
  /// full and at reduced resolution.
  float reference_width() const { return reduced > 1 ? float(whole_width) / float(reduced) : float(inner_width()); }
  float reference_height() const { return reduced > 1 ? float(whole_height) / float(reduced) : float(inner_height()); }
};

/// Returns the information of `inner`, a picture without a guard band, extended by `guard` pixels of the same size on
/// each side.
PictureInfo with_guard(PictureInfo inner, int guard);

/// Returns the camera of the picture without its guard band.
Camera inner_camera(const PictureInfo& info);

/// Returns the information of the picture without its guard band: that of the planes that Device::download returns.
PictureInfo inner_info(const PictureInfo& info);

/// Returns the number of pixels in a row or column of a picture at reduced resolution.
int reduced_side(int whole, int factor);

/// Returns the information of the picture whose pixel (i, j) is pixel (factor i, factor j) of `whole`, on the same ray.
/// Its size is rounded up. It has no guard band: that of `whole` becomes part of the picture.
PictureInfo reduced_info(const PictureInfo& whole, int factor);

/// Returns the pass of a plane: `normal` for normal.x, `layer1.depth` for itself.
std::string pass_of(std::string_view plane);

/// Returns the name of a reduced-resolution plane that lies in the upper left corner of a picture at full resolution:
/// `reduced_ao`.
std::string reduced_plane(std::string_view name);

/// Returns the name that a plane of another frame has in a frame that reads it: `other_ao`. The other frame is the
/// first sample of the same picture, or a neighbour in a sequence.
std::string other_plane(std::string_view name);

/// Returns the information of layer `layer`. If another camera captured it, camera, lights and ground are those of the
/// view space of that camera.
PictureInfo layer_info(const PictureInfo& info, int layer);

/// Returns the name of the shadow plane of a light: `shadow`, `shadow1`.
std::string shadow_plane(int light);
/// Returns whether this is the name of the shadow plane of a light, on the first layer.
bool is_shadow_plane(std::string_view plane);

/// Returns the name of a plane of a depth layer in a picture with all layers: `depth`, `layer1.depth`.
std::string layer_plane(int layer, std::string_view name);

/// Returns the layer to which a plane name belongs.
int layer_of_plane(std::string_view name);

/// Returns the name of the same plane on the first layer.
std::string_view name_on_first_layer(std::string_view plane);

/// A G-buffer on the host: its information and one image per depth layer, nearest first, with the size in `info`.
struct GBuffer {
  PictureInfo info;
  std::vector<Image> layers;
};

/// Returns the information of a G-buffer, with has_roughness and has_material_ao as its planes are.
PictureInfo info_of(const GBuffer& gbuffer);

}  // namespace umbrage
