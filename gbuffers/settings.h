// GBufferSettings: which files hold a G-buffer, and the meaning of their values where it is not to be recognised.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace umbrage {

/// The meaning of the values of a depth image, in the order of the choices of `depth_kind`. NaN and infinity always
/// mean that there is no surface.
enum class DepthMeaning {
  kPlanar,     ///< distance along the view axis, scene units; values <= 0, too, mean no surface
  kDistance,   ///< distance from the camera along the pixel's ray, scene units; values <= 0, too, mean no surface
  kWindow,     ///< depth buffer: 0 at the near plane, 1 at the far plane and where there is no surface
  kReversed,   ///< depth buffer: 1 at the near plane, 0 at the far plane and where there is no surface
  kDisparity,  ///< proportional to inverse planar depth, of unknown scale and offset unless these are given
  kHeight,     ///< elevation above a plane, seen from above by an orthographic camera
  kAuto,       ///< recognised in files; kPlanar for images in memory
};

/// The planes of another renderer: where they are, and what they mean.
struct GBufferSettings {
  // Files. Each may be "FILE" or "FILE:LAYER"; empty: none.
  std::string file{};  ///< file whose layers are recognised
  std::string depth_file{}, normal_file{}, albedo_file{}, beauty_file{}, position_file{}, id_file{}, motion_file{};
  std::string view{};  ///< view of a multi-view EXR, "left"; empty: the default view

  // Depth. A stored value v becomes depth_offset + depth_scale * v, after depth_range and depth_invert.
  std::string depth_kind = "auto";            ///< see DepthMeaning
  std::optional<float> depth_scale{};         ///< default: 1, or as the file says
  std::optional<float> depth_offset{};        ///< default: 0, or as the file says
  std::vector<float> depth_range{};           ///< two depths: those of the min and max stored value; empty: none
  bool depth_invert = false;                  ///< the max stored value is the nearest
  std::string depth_packing = "none";         ///< see packing.h
  std::optional<float> depth_background{};    ///< stored value that means no surface, besides those recognised
  bool flip = false;                          ///< the first row of the files is the lowest
  float near_plane = 0.1f, far_plane = 0.0f;  ///< for "window" and "reversed"; far_plane 0: at infinity
  std::optional<float> cell_size{};           ///< "height": width of a pixel, in units of the height

  // Normals and positions.
  std::string normal_space = "auto";     ///< "camera" (+x right, +y up, +z towards the camera) or "world"
  std::string normal_encoding = "auto";  ///< "signed": -1 to 1; "unsigned": 0 to 1 stands for -1 to 1
  std::string position_space = "auto";   ///< "camera" or "world"
  /// Of motion vectors: "px", "ndc" (-1 to 1 across the picture) or "uv" (0 to 1); to the "previous" or the "next"
  /// frame; y "up" or "down"; "to" that frame or "from" it. What is not said is recognised.
  std::vector<std::string> motion_kind{};
  /// Rows of a rotation from the space of the normals to view space: the upper left part of the view matrix if the
  /// normals are in world space. Normals need not have unit length or face the camera. Empty: recognised in files, no
  /// rotation for images in memory.
  std::vector<float> view_from_normal{};

  // Camera. Unset: as the file says, or fitted to position and depth, or 55 degrees high.
  bool orthographic = false;
  /// Left, right, bottom and top of the window that the picture fills: at distance 1, or in scene units for an
  /// orthographic camera. For a perspective camera top is tan(angle / 2), right is top * width / height. Empty: not
  /// set.
  std::vector<float> window{};
  std::optional<float> fov_deg{};          ///< vertical field of view
  std::vector<float> focal_length_px{};    ///< focal length in pixels: one number, or fx,fy,cx,cy
  std::optional<float> focal_length_mm{};  ///< with sensor_width_mm
  float sensor_width_mm = 36.0f;           ///< width of the sensor
  /// Bounding-sphere radius of the shaded scene, the base of relative lengths, scene units. 0: half the diagonal of the
  /// view-aligned box that contains nearly all visible points.
  float scene_radius = 0.0f;

  /// Pictures of one job are frames of a sequence: later ones take the meaning of depth, the scene radius, the range of
  /// depth and the exposure from the first.
  bool sequence = false;

  // Result.
  std::string repair = "auto";  ///< "on", "off", "auto": whether averaged depths and ids at edges are repaired
  int reduction = 1;            ///< the finished picture is reduced by this factor: 1 to 8

  /// Returns whether files hold the G-buffer.
  bool has_files() const {
    for (const std::string* each :
         {&file, &depth_file, &normal_file, &albedo_file, &beauty_file, &position_file, &id_file, &motion_file})
      if (!each->empty()) return true;
    return false;
  }
};

}  // namespace umbrage
