// Request: what to draw, in fields of plain types. Every interface fills in a Request: the command line, the C API and
// the APIs built on it. renderer/options.h is the table of its fields.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gbuffers/settings.h"
#include "renderer/shared_image.h"

namespace umbrage {

/// How the values of a picture are written.
enum class PictureValues {
  kDisplay,
  kDisplay8,     ///< with 8 bits, for which output.dither is set
  kSceneLinear,  ///< as `beauty`, scene-linear light that is premultiplied by alpha, in place of `color`
};

/// The camera. Unset fields default to the model's own view; if it has none, to a view of the whole model from slightly
/// above and to the side. World space, scene units, degrees.
struct CameraSettings {
  std::optional<int> index{};  ///< a camera of the file, from 0; not with position, focal point or direction
  /// Camera position, and point at the centre of the picture, in the coordinates of the file: double, since they may
  /// exceed the precision of floats.
  std::optional<std::array<double, 3>> position{}, focal_point{};
  std::optional<std::array<float, 3>> view_up{};    ///< direction that points up in the picture; not 0
  std::optional<std::array<float, 3>> direction{};  ///< viewing direction; not 0
  std::optional<float> view_angle_deg{};            ///< vertical field of view, 0.1 to 179
  float azimuth_deg = 0.0f;                         ///< rotation around the model, applied after the fields above
  float elevation_deg = 0.0f;                       ///< rotation upwards around the model
  /// Azimuth and elevation move a fitted camera at one distance, as a turntable does; false: it is fitted after them.
  bool orbit = false;
  float zoom = 1.0f;  ///< > 1: closer; 0.001 to 1000
  bool orthographic = false;
};

/// The look of a request that names none, except for a file with a finished picture: see make_file_recipe.
inline constexpr std::string_view kDefaultLook = "studio";

/// What to draw or shade. Only the model, or the images of the G-buffer, must be set; all other defaults are usable.
struct Request {
  /// A file (OBJ, PLY, STL, glTF/GLB, 3DS, DAE, FBX, OFF, XYZ, PTS, PDB, 3MF; also .gz), or "scene:NAME?detail=N".
  std::string model{};
  std::vector<std::string> more_models{};  ///< additional models, placed as in their files
  std::string look{};                      ///< name of a look: see `umbrage list looks`; empty: kDefaultLook
  std::string occlusion{};                 ///< an occlusion technique, "reference" or "none"; empty: set by the look
  std::vector<std::string> settings{};     ///< "effect.parameter=value": see `umbrage list effects`
  int width = 1024, height = 1024;         ///< pixels, 1 to 16384 each; width * height at most 67 108 864
  int threads = 0;                         ///< 0: one per hardware thread; at most 1024
  std::string device = "auto";             ///< "cpu", "vulkan", "vulkan:N", or "auto": a GPU if there is one
  CameraSettings camera{};
  std::optional<std::array<float, 3>> up{};  ///< the model's up direction; default: set by its format
  std::optional<int> scene_index{};          ///< scene of a glTF file, from 0; default: its default scene
  std::optional<int> animation_index{};      ///< animation of a glTF file, from 0; default: none, the file's pose
  /// Seconds from the start of the animation, of the first one unless `animation_index` is set.
  std::optional<float> animation_time{};
  std::string lights = "studio";  ///< "file": the lights of a glTF file; "studio": the look's in their place
  /// 0 to 180: edges with a larger angle stay sharp where normals are generated; default: chosen per mesh.
  std::optional<float> crease_angle_deg{};
  std::string point_size{};  ///< size of a file's points: "0.01" scene units, or "0.5%"; empty: from their spacing
  std::string color_by{};    ///< name of the field of values whose colours the model gets; empty: its own colours
  /// Component of a field of vectors, from 0, or "x", "y", "z"; empty: the length of vectors.
  std::string color_component{};
  std::string color_map = "viridis";   ///< a colour map of scene/color_maps.h, or a file of colours
  std::vector<float> color_range{};    ///< values at the ends of the colour map; empty: those of the field
  std::string color_scale = "linear";  ///< "linear", "log", "symlog"
  std::optional<int> color_bands{};    ///< number of equal intervals of one colour each, 1 to 256; default: none
  std::optional<std::array<float, 3>> missing_color{};  ///< of what has no value, display values 0 to 1
  std::string point_sprites = "auto";                   ///< shape of a file's points: "auto", "disc", "sphere"
  /// Planes that cut the model, see parse_sections: "x=0.4", "y=50%", "z<0.4", "nx,ny,nz,d".
  std::vector<std::string> sections{};
  float explode = 0.0f;                ///< percent by which the parts of the model move away from its centre; 0 to 1000
  std::string quality{};               ///< "draft", "normal", "high", "ultra"; empty: set by the look
  std::optional<int> anti_aliasing{};  ///< averaged pictures, 1 to 256; default: set by the quality or look
  /// "0.3" scene units, or "5%" of the bounding-sphere radius; empty: set by the technique.
  std::string occlusion_radius{};
  std::string occlusion_scale{};                     ///< "full", "half", "quarter" resolution; empty: set by the look
  std::string ground = "auto";                       ///< a ground that only shows shadows: "auto", "on", "off"
  std::optional<std::array<float, 3>> background{};  ///< 0 to 1, display values; default: set by the look
  bool transparent = false;                          ///< alpha 0 where there is no surface
  /// Equirectangular environment image that lights the scene in place of its own lights: HDR, EXR, PFM (linear), PNG,
  /// JPEG, TGA, BMP (sRGB), or "sky:", which is built in; empty: none. It is twice as wide as it is high; its upper
  /// side is the model's up.
  std::string hdri_file{};
  bool hdri_ambient = true;               ///< the image lights the scene
  bool hdri_skybox = false;               ///< the image is the background; not with `transparent`
  float hdri_rotation_deg = 0.0f;         ///< rotation about the model's up, to the left as seen from inside
  float hdri_intensity = 1.0f;            ///< factor for the image's radiance, 0 to 1000000
  std::optional<float> light_size_deg{};  ///< angular diameter of the key light, 0 to 90; default: set by the light
  /// Azimuth and elevation of the key light, degrees, as seen from the camera: 0,0 is the camera, 90,0 the right, 0,90
  /// above. Empty: set by the look or the scene. Not for light from an image.
  std::vector<float> light_direction{};
  float key = 1.0f, fill = 1.0f, rim = 1.0f;    ///< factors for these lights, 0 to 100
  float shadow_strength = 1.0f;                 ///< factor for the strength of shadows, 0 to 1
  float occlusion_strength = 1.0f;              ///< factor for the occlusion of any technique, 0 to 10
  float contrast = 1.0f;                        ///< factor for the contrast about middle grey, 0 to 4
  float exposure = 0.0f;                        ///< added to the picture's exposure, stops, -20 to 20
  std::string material{};                       ///< "file": the model's own; "clay": white plaster; empty: by `style`
  std::optional<std::array<float, 3>> color{};  ///< of clay, display values 0 to 1; implies material "clay"
  std::string style{};                          ///< "white", "dark", "blueprint", "clay"; empty: none
  std::optional<int> layers{};                  ///< surfaces captured along each ray, 1 to 16; default: set by the look
  std::optional<int> extra_views{};             ///< additional cameras, 0 to 4; default: set by the look
  float guard_band = 0.0f;            ///< border drawn beyond each side, in percent of the longer side; 0 to 100
  std::vector<std::string> passes{};  ///< additional output planes: "depth", "normal", "ao", ...
  PictureValues values = PictureValues::kDisplay;  ///< no option sets it: it follows from the format of a file
  /// Whether to return the look's lines as curves; `cartoon`, `hatching` and `technical` draw such lines.
  bool strokes = false;
  // For shading the planes of another renderer:
  std::vector<std::string> effects{};  ///< effects run in this order, in place of the look
  GBufferSettings gbuffer{};
};

}  // namespace umbrage
