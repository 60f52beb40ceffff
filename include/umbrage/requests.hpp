// Requests and results of the C++ interface as plain structs. umbrage/umbrage.hpp includes this header.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace umb {

/// Result of a call. `code` is 0 or the exit code that the command line would return: 1 internal error, 2 invalid
/// request, 3 a file that cannot be used, 4 a missing or insufficient device or too little memory, 130 cancelled by a
/// Progress. `message` is one sentence for display if `code` is not 0.
struct Outcome {
  int code = 0;
  std::string message{};
  std::vector<std::string> warnings{};  ///< such as missing textures
};

/// Called repeatedly during long work, always by the thread that called Umbrage, with the approximate fraction of the
/// work that is done: 0 to 1, never decreasing. Returns whether to continue: after false it is not called again, the
/// work ends soon, and its outcome has code 130. The fraction is 0 while a model is read and prepared.
using Progress = std::function<bool(double done)>;

/// The pixels of one pass: `channels` floats for each pixel, interleaved.
struct Pixels {
  std::string name{};           ///< "depth", "normal", "layer1.depth"
  int channels = 1;             ///< 3 for normals (x, y, z) and colours (red, green, blue)
  std::vector<float> values{};  ///< width * height * channels
  /// The ids of object_id and material_id if these were passed as PixelArray::ids; 0 where there is no surface. In that
  /// case `values` are indices, from 0, into the ascending list of the distinct numbers in `ids`, since floats cannot
  /// represent all ids.
  std::vector<std::uint32_t> ids{};
};

/// A point of a stroke, in pixels from the picture's upper left corner. The first pixel's centre is at (0.5, 0.5).
struct StrokePoint {
  float x = 0.0f, y = 0.0f, width = 0.0f;
};

enum class StrokeKind {
  kOutline,     ///< border of an object against another object, another material or the background
  kFold,        ///< an object occludes a part of itself
  kCrease,      ///< two faces meet
  kHatch,       ///< hatching along a surface
  kCrossHatch,  ///< hatching that crosses other hatching
  kHidden,      ///< a dash of an edge behind the visible surface
};

/// A line of the picture: a polyline with round caps and joins, whose width changes linearly from point to point.
struct Stroke {
  StrokeKind kind = StrokeKind::kOutline;
  int object = 0;       ///< object_id of the nearer surface; if ids were passed as PixelArray::ids, the id's 32 bits
  bool closed = false;  ///< the last point coincides with the first
  std::vector<StrokePoint> points{};
};

/// A camera: see UmbView.
struct PictureView {
  std::array<double, 12> view_from_world{};
  float left = 0.0f, right = 0.0f, bottom = 0.0f, top = 0.0f;
  bool orthographic = false;
};

/// A picture as it would be written to an 8-bit file: red, green, blue, alpha, 0 to 1; alpha is not premultiplied.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgba{};            ///< width * height * 4; empty if no colour was requested
  std::vector<Pixels> passes{};         ///< the requested passes, in the order of the request
  std::vector<Stroke> strokes{};        ///< empty if not requested
  std::array<float, 3> stroke_color{};  ///< red, green, blue, as in `rgba`
  float stroke_opacity = 0.0f;          ///< of all strokes together; 0: strokes were not requested
  std::optional<PictureView> view{};    ///< camera of a rendered picture or of files; .exr files store it
  std::vector<std::string> facts{};     ///< what was found about the files of a G-buffer, one line each
};

/// A camera. Members that are not set are chosen automatically: the model's own view, or else a view of the whole model
/// from slightly above and to the side. Values are in world space, in scene units and degrees.
struct CameraRequest {
  std::optional<int> index{};  ///< a camera of the file, from 0; not with position, focal_point or direction
  std::optional<std::array<double, 3>> position{};     ///< camera position, in the coordinates of the file
  std::optional<std::array<double, 3>> focal_point{};  ///< point that the camera looks at, in the same
  std::optional<std::array<float, 3>> view_up{};       ///< direction that points up in the picture; not 0
  std::optional<std::array<float, 3>> direction{};  ///< view direction; not 0; not with both position and focal_point
  std::optional<float> view_angle_deg{};            ///< vertical field of view, 0.1 to 179
  float azimuth_deg = 0.0f;                         ///< rotation around the model, applied last
  float elevation_deg = 0.0f;                       ///< elevation above the model, applied last
  /// Azimuth and elevation move a fitted camera at one distance, as a turntable does; false: it is fitted after them.
  bool orbit = false;
  float zoom = 1.0f;  ///< > 1: closer; 0.001 to 1000
  bool orthographic = false;
};

/// A picture to render. All members except `model` have usable defaults.
struct RenderRequest {
  /// A file (OBJ, PLY, STL, glTF/GLB, 3DS, DAE, FBX, OFF, XYZ, PTS, PDB, 3MF; also .gz), or "scene:NAME?detail=N".
  std::string model{};
  std::vector<std::string> more_models{};  ///< further models, placed as in their files
  std::string look = "studio";             ///< name of a look: see `umbrage list looks`
  std::string occlusion{};                 ///< an occlusion technique, "reference" or "none"; empty: chosen by the look
  std::vector<std::string> settings{};     ///< "effect.parameter=value": see `umbrage list effects`
  int width = 1024, height = 1024;         ///< pixels, 1 to 16384 each, at most 67 108 864 in total
  int threads = 0;                         ///< 0 to 1024; 0: as many as the machine has
  std::string device = "auto";             ///< "cpu", "vulkan", "vulkan:N", or "auto": a GPU if there is one
  CameraRequest camera{};
  std::optional<std::array<float, 3>> up{};  ///< up direction of the model; default: given by its format
  std::optional<int> scene_index{};          ///< scene of a glTF file, from 0; default: the file's default scene
  std::optional<int> animation_index{};      ///< animation of a glTF file, from 0; default: the file's pose
  std::optional<float> animation_time{};     ///< seconds from the start of the animation
  std::string lights = "studio";             ///< "file": the lights of a glTF file
  /// 0 to 180: computed normals keep larger angles sharp; default: chosen for each mesh.
  std::optional<float> crease_angle_deg{};
  /// Size of the points of a file: "0.01" scene units, or "0.5%" of the bounding-sphere radius; empty: derived
  /// from their spacing.
  std::string point_size{};
  std::string point_sprites = "auto";  ///< shape of points: "auto", "disc", "sphere"
  std::string color_by{};         ///< field of the file's values to show as colours; empty: the model's own colours
  std::string color_component{};  ///< of vectors: from 0, or "x", "y", "z"; empty: their length
  std::string color_map{};        ///< "viridis", "magma_r", or a file of colours; empty: "viridis"
  std::optional<std::array<float, 2>> color_range{};    ///< values at the ends of the map; default: those of the field
  std::string color_scale{};                            ///< "linear", "log", "symlog"; empty: "linear"
  std::optional<int> color_bands{};                     ///< equal intervals of one colour, 1 to 256; default: none
  std::optional<std::array<float, 3>> missing_color{};  ///< sRGB, 0 to 1: of what has no value
  /// Planes that cut the model, separated by spaces: "x=0.4", "y=50%", "z<0.4" (what stays), "nx,ny,nz,d"; empty: none.
  std::string sections{};
  float explode = 0.0f;                ///< percent by which the parts of the model move away from its centre; 0 to 1000
  std::string quality{};               ///< "draft", "normal", "high", "ultra"; empty: chosen by the look
  std::optional<int> anti_aliasing{};  ///< number of averaged pictures, 1 to 256; default: chosen by quality or look
  /// "0.3" scene units, or "5%" of the bounding-sphere radius; empty: chosen by the technique.
  std::string occlusion_radius{};
  std::string occlusion_scale{};  ///< "full", "half", "quarter" resolution; empty: chosen by the look
  std::string ground = "auto";    ///< invisible ground that shows shadow and occlusion: "auto", "on", "off"
  std::optional<std::array<float, 3>> background{};  ///< sRGB, 0 to 1; default: chosen by the look
  bool transparent = false;                          ///< alpha 0 where there is no surface
  /// An equirectangular environment image, which replaces the scene's own lights: HDR, EXR, PFM (linear), PNG, JPEG,
  /// TGA, BMP (sRGB), or "sky:", which is built in; empty: none. It is twice as wide as high, and its top is the
  /// model's up direction.
  std::string hdri_file{};
  bool hdri_ambient = true;               ///< whether the image lights the scene
  bool hdri_skybox = false;               ///< whether the image is the background; not with `transparent`
  float hdri_rotation_deg = 0.0f;         ///< rotation about the model's up direction, to the left as seen from inside
  float hdri_intensity = 1.0f;            ///< factor for the brightness of the image, 0 to 1000000
  std::optional<float> light_size_deg{};  ///< angular size of the key light, 0 to 90; default: given by the light
  /// Azimuth and elevation of the key light, degrees, as seen from the camera; default: set by the look or the scene.
  std::optional<std::array<float, 2>> light_direction{};
  float key = 1.0f, fill = 1.0f, rim = 1.0f;    ///< factors for these lights, 0 to 100
  float shadow_strength = 1.0f;                 ///< factor for the strength of shadows, 0 to 1
  float occlusion_strength = 1.0f;              ///< factor for the occlusion of any technique, 0 to 10
  float exposure = 0.0f;                        ///< stops, -20 to 20
  float contrast = 1.0f;                        ///< about middle grey, 0 to 4
  std::string material{};                       ///< "file": the model's own; "clay": white plaster; empty: by `style`
  std::optional<std::array<float, 3>> color{};  ///< of the whole model, as clay; sRGB, 0 to 1
  std::string style{};                          ///< "white", "dark", "blueprint", "clay"; empty: none
  std::optional<int> layers{};       ///< surfaces captured along each ray, 1 to 16; default: chosen by the look
  std::optional<int> extra_views{};  ///< additional cameras, 0 to 4; default: chosen by the look
  float guard_band = 0.0f;  ///< width drawn beyond each side and cut off, in percent of the longer side; 0 to 100
  /// Passes to return besides the picture: "depth", "normal", "ao", ... "beauty" is the picture as .exr files hold it:
  /// scene-linear light, before the tone curve, premultiplied.
  std::vector<std::string> passes{};
  bool strokes =
      false;  ///< return the look's lines as curves; of the looks, `cartoon`, `hatching` and `technical` draw lines
  Progress progress{};
};

/// The camera of one frame. If `placed` is false, the camera of the request is used.
struct FrameCamera {
  bool placed = false;
  /// Position, point that the camera looks at, and up direction. World space: the coordinates of the file.
  double eye[3] = {0, 0, 1}, target[3] = {0, 0, 0};
  float up[3] = {0, 1, 0};
  float angle_deg = 30.0f;  ///< vertical field of view
};

/// The meaning of depth values. For all kinds, NaN and infinity mean that there is no surface.
enum class DepthKind {
  kPlanar,     ///< distance along the view axis, scene units; no surface if <= 0
  kDistance,   ///< distance from the camera along the pixel's ray, scene units; no surface if <= 0
  kWindow,     ///< 0 at the near plane, 1 at the far plane and where there is no surface, as in a depth buffer
  kReversed,   ///< 1 at the near plane, 0 at the far plane and where there is no surface
  kDisparity,  ///< files: proportional to inverse planar depth
  kHeight,     ///< files: elevation, seen from above by an orthographic camera
  kAuto,       ///< recognised in files; kPlanar for arrays
};

/// An array of the caller with the picture's size. It is read during the call and not kept.
struct PixelArray {
  /// Name of the plane or pass. One channel: depth, specular (peak of the highlight, 0 to 1), shininess (Blinn-Phong
  /// exponent), shadow (fraction of the key light that arrives), shadow1 to shadow7 (of the other lights), object_id,
  /// material_id, ao. Three channels: normal, albedo (diffuse reflectance), emission, direct and ambient (radiance
  /// towards the camera, by its source), indirect, lit (total radiance). layer1.depth is the depth of the second
  /// surface along the ray. Every other plane that an effect reads can be passed by its name, too.
  std::string name{};
  const float* values = nullptr;  ///< first channel of the upper left pixel
  /// Floats from one pixel to the next; 0: the number of channels, or 1 if channel_stride is set.
  std::ptrdiff_t pixel_stride = 0;
  std::ptrdiff_t row_stride = 0;      ///< floats from one row to the next, may be negative; 0: width times pixel_stride
  std::ptrdiff_t channel_stride = 1;  ///< floats from one channel to the next; width * height for planar data
  /// Used instead of `values` for object_id and material_id: 32-bit integers. Strides then count integers.
  const std::uint32_t* ids = nullptr;
};

/// Files that hold a G-buffer, as an alternative to arrays. Each is "FILE" or "FILE:LAYER"; empty: none.
struct FilesRequest {
  std::string file{};  ///< file whose layers are recognised
  std::string depth_file{}, normal_file{}, albedo_file{}, beauty_file{}, position_file{}, id_file{};
  /// Other parameters of files, such as {"depth_scale", "0.001"}: see umbGetParameter for "shade". Values are written
  /// as on the command line.
  std::vector<std::pair<std::string, std::string>> parameters{};
  std::optional<float> fov_deg{};  ///< vertical field of view; default: as the files say, else fitted, else 55

  bool empty() const {
    return file.empty() && depth_file.empty() && normal_file.empty() && albedo_file.empty() && beauty_file.empty() &&
           position_file.empty() && id_file.empty();
  }
};

/// A G-buffer (depth, normals and other values of each pixel) to shade, and how to shade it.
struct ShadeRequest {
  FilesRequest files{};              ///< in place of width, height, arrays, the window and view_from_normal
  int width = 0, height = 0;         ///< pixels; limits as in RenderRequest
  std::vector<PixelArray> arrays{};  ///< depth is required; missing normals are computed from depth
  DepthKind depth_kind = DepthKind::kAuto;
  float near_plane = 0.1f, far_plane = std::numeric_limits<float>::infinity();  ///< for kWindow and kReversed
  /// Rotation from the space of the normals to view space, row by row: the upper left part of the view matrix for
  /// normals in world space. Normals need neither have length 1 nor face the camera.
  std::array<float, 9> view_from_normal = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool orthographic = false;
  /// View window of the picture: at distance 1, or in scene units for an orthographic camera. For a perspective camera
  /// top is tan(angle / 2) and right is top * width / height. All 0: 55 degrees high, or 2 scene units.
  float left = 0.0f, right = 0.0f, bottom = 0.0f, top = 0.0f;
  /// Bounding-sphere radius of the shaded surfaces, scene units; relative lengths refer to it. 0: half the diagonal of
  /// the view-aligned box that contains nearly all visible surfaces.
  float scene_radius = 0.0f;

  /// Name of the look. It uses its own lights: behind the camera, above and to the left. Empty: "studio", or "comp" for
  /// files that hold a beauty.
  std::string look{};
  /// Effects that run, in this order, instead of the look, such as "bitmask", "denoise".
  std::vector<std::string> effects{};
  /// As in RenderRequest; only with a look.
  std::string occlusion{}, occlusion_radius{}, occlusion_scale{}, quality{};
  std::vector<std::string> settings{};
  std::optional<std::array<float, 3>> background{};
  bool transparent = false;
  float shadow_strength = 1.0f, occlusion_strength = 1.0f, exposure = 0.0f, contrast = 1.0f;
  std::string style{};
  /// Passes to return, named as in RenderRequest. If empty while `effects` is set: the passes that the last effect
  /// makes.
  std::vector<std::string> passes{};
  bool strokes = false;  ///< return the lines of the look, or of the effect `outline`, as curves
  std::string device = "auto";
  int threads = 0;
  Progress progress{};
};

/// Options for writing a file.
struct SaveRequest {
  int bits = 8;       ///< bits per channel of .png: 8 or 16
  bool half = false;  ///< .exr: 16-bit instead of 32-bit floats where their precision suffices
};

}  // namespace umb
