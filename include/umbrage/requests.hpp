// What a program asks Umbrage for, and gets, as plain structs of C++. umbrage/umbrage.hpp includes this header.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace umb {

/// How it went. `code` is 0, or the exit code that the command line would give: 1 internal, 2 a wrong request, 3 a file
/// that cannot be used, 4 a device that cannot do it or too little memory, 130 ended by a Progress; `message` is
/// then one sentence for people.
struct Outcome {
  int code = 0;
  std::string message{};
  std::vector<std::string> warnings{};  ///< such as missing textures
};

/// Called now and then during long work, by the thread that called Umbrage and by no other, with about the share that
/// is done: from 0 to 1, never falling. Returns whether to go on: after false it is not called again, the work ends
/// soon, and its outcome has code 130. Reading a model and making it ready, which come first, ask as often, with 0.
using Progress = std::function<bool(double done)>;

/// What one pass holds: `channels` floats of each pixel, one after the other.
struct Pixels {
  std::string name{};           ///< "depth", "normal", "layer1.depth"
  int channels = 1;             ///< 3 for normals (x, y, z) and colours (red, green, blue)
  std::vector<float> values{};  ///< width * height * channels
  /// Of object_id and material_id that were handed in as PixelArray::ids: the same; 0 where there is no surface. Then
  /// `values` are their places, from 0, in the rising list of the numbers that are in `ids`, since floats do not tell
  /// all ids apart.
  std::vector<std::uint32_t> ids{};
};

/// A point of a stroke. Pixels from the picture's upper left corner, where the first pixel's centre is at (0.5, 0.5).
struct StrokePoint {
  float x = 0.0f, y = 0.0f, width = 0.0f;
};

enum class StrokeKind {
  kOutline,  ///< an object ends: before another one, another material or the background
  kFold,     ///< an object hides a part of itself
  kCrease,   ///< two faces meet
};

/// A line of the picture: a polyline with round ends and joins, whose width changes linearly from point to point.
struct Stroke {
  StrokeKind kind = StrokeKind::kOutline;
  int object = 0;       ///< object_id of the nearer surface; the bits of PixelArray::ids
  bool closed = false;  ///< the last point is the first one again
  std::vector<StrokePoint> points{};
};

/// A picture as it would be written to an 8-bit file: red, green, blue, alpha from 0 to 1, alpha not multiplied in.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgba{};            ///< width * height * 4; empty where no colour was asked for
  std::vector<Pixels> passes{};         ///< those asked for, in that order
  std::vector<Stroke> strokes{};        ///< where they were asked for
  std::array<float, 3> stroke_color{};  ///< red, green, blue, as in `rgba`
  float stroke_opacity = 0.0f;          ///< of all strokes together; 0: none were asked for
};

/// Where the camera stands. What is not said is chosen: the model's own view, or else the whole model from slightly
/// above and to the side. World space, scene units, degrees.
struct CameraRequest {
  std::optional<int> index{};  ///< a camera of the file, from 0; not with position, focal point or direction
  std::optional<std::array<float, 3>> position{};     ///< the eye
  std::optional<std::array<float, 3>> focal_point{};  ///< what is looked at
  std::optional<std::array<float, 3>> view_up{};      ///< what points up in the picture; not 0
  std::optional<std::array<float, 3>> direction{};    ///< in which it looks; not 0; not beside position and focal_point
  std::optional<float> view_angle_deg{};              ///< vertical field of view, 0.1 to 179
  float azimuth_deg = 0.0f;                           ///< then turned around the model,
  float elevation_deg = 0.0f;                         ///< and risen over it
  float zoom = 1.0f;                                  ///< above 1: nearer; 0.001 to 1000
  bool orthographic = false;
};

/// What to draw. Everything but the model has a value that serves.
struct RenderRequest {
  std::string model{};  ///< a file (OBJ, PLY, STL, glTF/GLB, 3DS, DAE, FBX, OFF) or "scene:NAME?detail=N"
  std::vector<std::string> more_models{};  ///< that stand beside it, as they are placed in their files
  std::string look = "studio";             ///< a recipe: see `umbrage list looks`
  std::string occlusion{};                 ///< an occlusion technique, "reference" or "none"; empty: the look's own
  std::vector<std::string> settings{};     ///< "effect.parameter=value": see `umbrage list effects`
  int width = 1024, height = 1024;         ///< pixels, 1 to 16384 each, together at most 67 108 864
  int threads = 0;                         ///< 0: as many as the machine has; at most 1024
  std::string device = "auto";             ///< "cpu", "vulkan", "vulkan:N", or "auto": a graphics card if there is one
  CameraRequest camera{};
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
  std::vector<std::string> passes{};      ///< to hand out besides the picture: "depth", "normal", "ao", ...
  bool strokes = false;                   ///< hand out the look's lines as curves: `cartoon` has some
  Progress progress{};
};

/// A camera of one frame. Where `placed` is false it stands as the request says.
struct FrameCamera {
  bool placed = false;
  float eye[3] = {0, 0, 1}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
  float angle_deg = 30.0f;  ///< vertical field of view
};

/// What the floats of an array of depth are. In all of them NaN and infinity say that there is nothing.
enum class DepthKind {
  kView,      ///< distance along the view axis, scene units; 0 and below, too, where there is nothing
  kRay,       ///< distance from the eye along the pixel's ray, scene units; the same
  kWindow,    ///< 0 at the near plane, 1 at the far plane and where there is nothing, as depth buffers have it
  kReversed,  ///< 1 at the near plane, 0 at the far plane and where there is nothing
};

/// A caller's floats, of the picture's size. They are read during the call and not kept.
struct PixelArray {
  /// What they are. One channel: depth, specular (peak of the highlight, 0 to 1), shininess (Blinn-Phong exponent),
  /// shadow (share of the key light that arrives), shadow1 to shadow7 (of the lights after it), object_id, material_id,
  /// ao. Three: normal, albedo (diffuse reflectance), emission, direct and ambient (light that surfaces send to the
  /// eye, by where it comes from), indirect, lit (all of it). A name such as layer1.depth is that of the surface
  /// behind; every other plane that an effect reads has its own name too.
  std::string name{};
  const float* values = nullptr;  ///< of the upper left pixel, first channel
  /// Floats from a pixel to the next one; 0: as many as there are channels, or 1 where channel_stride is given.
  std::ptrdiff_t pixel_stride = 0;
  std::ptrdiff_t row_stride = 0;      ///< floats from a row to the next; 0: width times pixel_stride. May be negative
  std::ptrdiff_t channel_stride = 1;  ///< floats from a channel to the next; width * height for plane after plane
  /// In place of `values`, of object_id and material_id: whole numbers, all 32 bits of which count. Strides are in
  /// them.
  const std::uint32_t* ids = nullptr;
};

/// What to shade, and how.
struct ShadeRequest {
  int width = 0, height = 0;         ///< as of RenderRequest
  std::vector<PixelArray> arrays{};  ///< depth always; without normals they are made of the depth
  DepthKind depth_kind = DepthKind::kView;
  float near_plane = 0.1f, far_plane = std::numeric_limits<float>::infinity();  ///< of kWindow and kReversed
  /// Normals are turned by the rows of this rotation to view space: the upper left part of a view matrix where they are
  /// in world space. They need not be of length 1, nor face the camera.
  std::array<float, 9> view_from_normal = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool orthographic = false;
  /// The window that the picture fills: at distance 1, or in scene units for an orthographic camera. Of a perspective
  /// camera top is tan(angle / 2), right is top * width / height.
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
  /// Of a ball around what is shaded: lengths given as shares are shares of it. 0: half the diagonal of the box, along
  /// the camera's axes, that holds nearly all of what is seen.
  float scene_radius = 0.0f;

  /// The look that makes the picture, on lights of its own: behind the camera, above it and to the left.
  std::string look = "studio";
  /// In place of the look: these effects alone, one after the other, such as "bitmask", "denoise".
  std::vector<std::string> effects{};
  std::string occlusion{}, occlusion_radius{}, occlusion_scale{},
      quality{};  ///< as of RenderRequest, where there is a look
  std::vector<std::string> settings{};
  std::optional<std::array<float, 3>> background{};
  bool transparent = false;
  /// To hand out: names as of RenderRequest. With `effects` and no name at all: what the last one of them makes.
  std::vector<std::string> passes{};
  bool strokes = false;  ///< hand out the lines of the look, or of the effect `outline`, as curves
  std::string device = "auto";
  int threads = 0;
  Progress progress{};
};

/// How a file is written.
struct SaveRequest {
  int bits = 8;       ///< per channel, of .png: 8 or 16
  bool half = false;  ///< .exr: half instead of float where that suffices
};

}  // namespace umb
