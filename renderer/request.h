// Request: what somebody asks for, in fields of plain types. Every interface fills one in: the command line, C and what
// stands on that. renderer/options.h is the table of its fields.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "renderer/shared_image.h"

namespace umbrage {

/// Where the camera stands. What is not said is chosen: the model's own view, or else the whole model from slightly
/// above and to the side. World space, scene units, degrees.
struct CameraSettings {
  std::optional<int> index{};  ///< a camera of the file, from 0; not with position, focal point or direction
  std::optional<std::array<float, 3>> position{};     ///< the eye
  std::optional<std::array<float, 3>> focal_point{};  ///< what is looked at
  std::optional<std::array<float, 3>> view_up{};      ///< what points up in the picture; not 0
  std::optional<std::array<float, 3>> direction{};    ///< in which the camera looks; not 0
  std::optional<float> view_angle_deg{};              ///< vertical field of view, 0.1 to 179
  float azimuth_deg = 0.0f;                           ///< then turned around the model,
  float elevation_deg = 0.0f;                         ///< and risen over it
  float zoom = 1.0f;                                  ///< above 1: nearer; 0.001 to 1000
  bool orthographic = false;
};

/// What the planes of another renderer mean.
struct GBufferSettings {
  std::string depth_kind = "view";            ///< "view", "ray", "window", "reversed": see DepthMeaning
  float near_plane = 0.1f, far_plane = 0.0f;  ///< of "window" and "reversed"; a far plane of 0 is at infinity
  /// Normals are turned by the rows of this rotation to view space: the upper left part of a view matrix where they are
  /// in world space. They need not be of length 1, nor face the camera.
  std::vector<float> view_from_normal = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool orthographic = false;
  /// Left, right, bottom and top of the window that the picture fills: at distance 1, or in scene units for an
  /// orthographic camera. Of a perspective camera top is tan(angle / 2), right is top * width / height.
  std::vector<float> window = {-1, 1, -1, 1};
  /// Bounding sphere's radius of what is shaded, which relative lengths are shares of. 0: half the diagonal of the box,
  /// along the camera's axes, that holds nearly all of what is seen.
  float scene_radius = 0.0f;
};

/// What to draw or shade. Everything but the model, or the G-buffer's images, has a value that serves.
struct Request {
  std::string model{};  ///< a file (OBJ, PLY, STL, glTF/GLB, 3DS, DAE, FBX, OFF) or "scene:NAME?detail=N"
  std::vector<std::string> more_models{};  ///< that stand beside it, as they are placed in their files
  std::string look = "studio";             ///< a recipe: see `umbrage list looks`
  std::string occlusion{};                 ///< an occlusion technique, "reference" or "none"; empty: the look's own
  std::vector<std::string> settings{};     ///< "effect.parameter=value": see `umbrage list effects`
  int width = 1024, height = 1024;         ///< pixels, 1 to 16384 each, together at most 67 108 864
  int threads = 0;                         ///< 0: as many as the machine has; at most 1024
  std::string device = "auto";             ///< "cpu", "vulkan", "vulkan:N", or "auto": a graphics card if there is one
  CameraSettings camera{};
  std::optional<std::array<float, 3>> up{};  ///< the model's up; as its format says
  std::optional<int> scene_index{};         ///< of a glTF file that holds several scenes, from 0; the one that it names
  std::optional<float> crease_angle_deg{};  ///< 0 to 180: edges of larger angles stay where normals are made; 80
  std::string
      point_size{};  ///< of a file's points: "0.01" scene units, or "0.5%" of the scene; empty: by their spacing
  std::string point_sprites = "auto";  ///< what they are drawn as: "auto", "disc", "sphere"
  std::string quality{};               ///< "draft", "normal", "high", "ultra"; empty: the look's own
  std::optional<int> anti_aliasing{};  ///< pictures that are averaged, 1 to 256; as quality or look say
  std::string occlusion_radius{};      ///< "0.3" scene units, or "5%" of the scene; empty: the technique's own
  std::string occlusion_scale{};       ///< "full", "half", "quarter" resolution; empty: the look's own
  std::string ground = "auto";         ///< a ground that shows the shade alone: "auto", "on", "off"
  std::optional<std::array<float, 3>> background{};  ///< 0 to 1, as in the file; the look's own
  bool transparent = false;                          ///< alpha 0 where there is no surface
  /// An equirectangular image of what is around the scene, which lights it in place of its own lights: HDR, EXR, PFM
  /// (as they are), PNG, JPEG, TGA, BMP (as sRGB), or "sky:", which is built in; empty: none. It is twice as wide as
  /// high, its upper side is the model's up.
  std::string hdri_file{};
  bool hdri_ambient = true;               ///< it lights the scene
  bool hdri_skybox = false;               ///< it is the background; not with `transparent`
  float hdri_rotation_deg = 0.0f;         ///< it is turned about the model's up, to the left as seen from inside
  float hdri_intensity = 1.0f;            ///< factor on its light, 0 to 1000000
  std::optional<float> light_size_deg{};  ///< what the key light spans, seen from the scene: 0 to 90; as the light says
  std::optional<int> layers{};            ///< surfaces captured along each ray, 1 to 16; as the look wants
  std::optional<int> extra_views{};       ///< further cameras, 0 to 4; as the look wants
  float guard_band = 0.0f;                ///< drawn beyond each side, in percent of the longer one; 0 to 100
  std::vector<std::string> passes{};      ///< that are wanted besides the picture: "depth", "normal", "ao", ...
  bool strokes = false;                   ///< the look's lines are wanted as curves: `cartoon` has some
  // Where another renderer's planes are shaded:
  std::vector<std::string> effects{};  ///< in place of the look: these alone, one after the other
  GBufferSettings gbuffer{};
};

/// The meaning of the numbers in an image of depth. In all of them NaN and infinity say that there is nothing.
enum class DepthMeaning {
  kView,      ///< distance along the view axis, scene units; 0 and below, too, where there is nothing
  kRay,       ///< distance from the eye along the pixel's ray, scene units; the same
  kWindow,    ///< 0 at the near plane, 1 at the far plane and where there is nothing, as depth buffers have it
  kReversed,  ///< 1 at the near plane, 0 at the far plane and where there is nothing
};

}  // namespace umbrage
