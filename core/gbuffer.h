// GBuffer: the named inputs of shading, in one or more depth layers, and the camera that saw them.
//
// Planes of a layer, each optional but `depth`:
//   depth             positive distance along the view axis, scene units; +infinity where nothing was hit
//   normal.x .y .z    unit, view space, facing the camera; 0 where nothing was hit
//   albedo.r .g .b    diffuse reflectance, linear
//   specular          peak of the highlight, 0 to 1
//   shininess         Blinn-Phong exponent
//   shadow            share of the key light, the first one, that arrives, 0 to 1
//   shadow1 to shadow7   the same of the lights of these indices, where they cast shadows
//   emission.r .g .b  light that the surface sends out by itself, linear; where any material of the scene does
//   object_id, material_id   whole numbers; -1 where nothing was hit
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/light.h"

namespace umbrage {

/// What a depth layer beyond the first shows.
enum class LayerKind {
  kBehind,  ///< the surface behind that of layer `of`, along the same rays
  kBack,    ///< the other side of the surfaces of layer `of`: normals face away from the camera, light and shadow are
            ///< those of that side; without highlight, since no camera sees it
  kOther,   ///< what another camera sees
};

struct LayerInfo {
  LayerKind kind = LayerKind::kBehind;
  int of = 0;     ///< a layer
  Camera camera;  ///< kOther: its own, with the picture's size; otherwise unused
};

/// What an effect may know of a picture besides its planes.
struct PictureInfo {
  int width = 0, height = 0;  ///< with the guard band
  int guard = 0;  ///< pixels on each side that are drawn for the sake of those inside, and cut off at the end
  Camera camera;  ///< of the whole picture, guard band included
  std::vector<Light> lights;           ///< in view space
  glm::mat4 view_from_first{1.0f};     ///< from the view space of the first layer's camera; see layer_info
  std::vector<LayerInfo> more_layers;  ///< what the layers beyond the first are; empty for a bare first layer
  glm::vec3 ambient{0.3f};             ///< its mean over all normals
  AmbientShape ambient_shape;          ///< in view space
  float usual_light = 1.0f;            ///< luminance of what the lights make of white: see Scene
  float scene_radius = 1.0f;           ///< bounding sphere's radius; for a bare G-buffer half the robust depth extent
  float depth_min = 1.0f, depth_max = 2.0f;  ///< view depths between which the scene lies
  int ground_object = -1;         ///< object id of a ground that only shows the shade on it; below 0: there is none
  glm::vec3 ground_middle{0.0f};  ///< of that, in view space
  float ground_fades = 0.0f;      ///< distance from there at which the shade on it has faded; 0: it does not
  int reduced = 1;  ///< of a picture at reduced resolution: it holds every so manieth pixel, across and down
  int whole_width = 0, whole_height = 0;  ///< reduced > 1: inner size of the picture at full resolution

  /// How far apart the centres of neighbouring pixels are: at depth 1 in perspective, everywhere in an orthographic
  /// picture.
  float pixel_width() const { return (camera.right - camera.left) / float(width); }
  float pixel_height() const { return (camera.top - camera.bottom) / float(height); }

  /// The picture's size once the guard band is cut off.
  int inner_width() const { return width - 2 * guard; }
  int inner_height() const { return height - 2 * guard; }
  /// What shares of the picture's width and height are shares of, in pixels of this picture: at reduced resolution
  /// they mean the same distance.
  float share_width() const { return reduced > 1 ? float(whole_width) / float(reduced) : float(inner_width()); }
  float share_height() const { return reduced > 1 ? float(whole_height) / float(reduced) : float(inner_height()); }
};

/// A picture without a guard band, widened by `guard` pixels of the same size on each side.
PictureInfo with_guard(PictureInfo inner, int guard);

/// The camera of the picture once its guard band is cut off.
Camera inner_camera(const PictureInfo& info);

/// The picture once its guard band is cut off, as planes are that a device hands out.
PictureInfo inner_info(const PictureInfo& info);

/// How many pixels a row of a picture at reduced resolution has.
int reduced_side(int whole, int factor);

/// The picture that holds the pixels (factor i, factor j) of another one as its (i, j), its size rounded up. Its
/// cameras give each pixel the ray that it had. It has no guard band: what was one stays part of it.
PictureInfo reduced_info(const PictureInfo& whole, int factor);

/// The name of a plane at reduced resolution in a picture at full resolution, at whose upper left corner it lies:
/// `reduced_ao`.
std::string reduced_plane(std::string_view name);

/// The picture as layer `layer` shows it: of another camera, lights are in that one's view space.
PictureInfo layer_info(const PictureInfo& info, int layer);

/// The plane of the light of that index: `shadow`, `shadow1`.
std::string shadow_plane(int light);

/// The name of a plane of a depth layer in a picture that holds them all: `depth`, `layer1.depth`.
std::string layer_plane(int layer, std::string_view name);

/// The layer of a plane of that name.
int layer_of_plane(std::string_view name);

/// Its name on the first layer.
std::string_view of_first_layer(std::string_view plane);

/// A G-buffer on the host: its information and one image per depth layer, nearest first, of the information's size.
struct GBuffer {
  PictureInfo info;
  std::vector<Image> layers;
};

}  // namespace umbrage
