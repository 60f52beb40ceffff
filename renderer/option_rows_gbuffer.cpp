// The options of a G-buffer: its files, and the meaning of their values, in the order of the help.
#include "renderer/option_rows.h"

namespace umbrage {
namespace {

constexpr double kMaxDistance = 1e15;  // scene units

/// Returns an option that names a file, or a layer of one.
Option file_option(std::string_view field, std::string_view option, std::string_view help, FieldOf<std::string> where) {
  return row("Files", kShade | kInfo, field, option, help, "none", where);
}

Option row(std::string_view field, std::string_view option, std::string_view help, std::string_view initial,
           OptionField where) {
  return row("G-buffer", kShade | kInfo, field, option, help, initial, where);
}

std::vector<Option> file_options() {
  return {
      file_option("file", "", "file whose layers are recognised", in_gbuffer<&GBufferSettings::file>),
      file_option("depth_file", "depth", "depth: FILE, or FILE:LAYER", in_gbuffer<&GBufferSettings::depth_file>),
      file_option("normal_file", "normal", "normals: FILE, or FILE:LAYER", in_gbuffer<&GBufferSettings::normal_file>),
      file_option("albedo_file", "albedo", "reflectance: FILE, or FILE:LAYER",
                  in_gbuffer<&GBufferSettings::albedo_file>),
      file_option("beauty_file", "beauty", "the renderer's own picture: FILE, or FILE:LAYER",
                  in_gbuffer<&GBufferSettings::beauty_file>),
      file_option("position_file", "position", "positions: FILE, or FILE:LAYER",
                  in_gbuffer<&GBufferSettings::position_file>),
      file_option("id_file", "id", "ids of objects: FILE, or FILE:LAYER", in_gbuffer<&GBufferSettings::id_file>),
      file_option("motion_file", "motion", "motion vectors, for --steady: FILE, or FILE:LAYER",
                  in_gbuffer<&GBufferSettings::motion_file>),
      file_option("view", "view", "view of a stereo file, such as left", in_gbuffer<&GBufferSettings::view>),
  };
}

std::vector<Option> depth_options() {
  return {
      with_choices(row("depth_kind", "depth-kind",
                       "meaning of depth: planar (along the view axis), distance (along the ray), window (0 near to 1 "
                       "far, as in a depth buffer), reversed (1 near), disparity, height (elevation)",
                       "auto: recognised; planar for images in memory", in_gbuffer<&GBufferSettings::depth_kind>),
                   {"planar", "distance", "window", "reversed", "disparity", "height", "auto"}),
      with_range(row("depth_scale", "depth-scale", "factor for stored depths: 0.001 for millimetres", "1",
                     in_gbuffer<&GBufferSettings::depth_scale>),
                 -kMaxDistance, kMaxDistance),
      with_range(row("depth_offset", "depth-offset", "added to depths after the factor", "0",
                     in_gbuffer<&GBufferSettings::depth_offset>),
                 -kMaxDistance, kMaxDistance),
      with_form(row("depth_range", "depth-range", "near,far: depths of the min and max stored value", "none",
                    in_gbuffer<&GBufferSettings::depth_range>),
                OptionForm::kPair, "scene units"),
      row("depth_invert", "depth-invert", "the max stored value is the nearest", "",
          in_gbuffer<&GBufferSettings::depth_invert>),
      with_choices(
          row("depth_packing", "depth-packing",
              "how a depth is stored in several channels: none, rgb24 (24 bits, R the highest), bgr24, float32 "
              "(the bits of a float, R the lowest), float32-bgra, terrain-rgb and terrarium (elevation)",
              "none", in_gbuffer<&GBufferSettings::depth_packing>),
          {"none", "rgb24", "bgr24", "float32", "float32-bgra", "terrain-rgb", "terrarium"}),
      with_range(row("depth_background", "background", "stored depth that means no surface", "recognised",
                     in_gbuffer<&GBufferSettings::depth_background>),
                 -1e38, 1e38),
      row("flip", "flip", "the first row of the files is the lowest", "", in_gbuffer<&GBufferSettings::flip>),
      with_range(row("near_plane", "near-plane", "near plane of a depth buffer, scene units", "0.1",
                     in_gbuffer<&GBufferSettings::near_plane>),
                 0.0, kMaxDistance, "scene units"),
      with_range(row("far_plane", "far-plane", "far plane of a depth buffer, scene units; 0: at infinity", "0",
                     in_gbuffer<&GBufferSettings::far_plane>),
                 0.0, kMaxDistance, "scene units"),
      with_range(row("cell_size", "cell-size", "width of a pixel of an elevation model, in units of the height",
                     "as the file says", in_gbuffer<&GBufferSettings::cell_size>),
                 1e-10, kMaxDistance),
      with_choices(row("repair", "repair",
                       "mend depths that are stored in steps, and depths and ids averaged at edges: auto, on or off",
                       "auto", in_gbuffer<&GBufferSettings::repair>),
                   {"auto", "on", "off"}),
  };
}

std::vector<Option> space_options() {
  return {
      with_choices(row("normal_space", "normal-space", "space of normals: camera, world or auto", "auto: recognised",
                       in_gbuffer<&GBufferSettings::normal_space>),
                   {"auto", "camera", "world"}),
      with_choices(
          row("normal_encoding", "normal-encoding", "signed: components from -1 to 1; unsigned: from 0 to 1; or auto",
              "auto: recognised", in_gbuffer<&GBufferSettings::normal_encoding>),
          {"auto", "signed", "unsigned"}),
      with_choices(row("position_space", "position-space", "space of positions: camera, world or auto",
                       "auto: recognised", in_gbuffer<&GBufferSettings::position_space>),
                   {"auto", "camera", "world"}),
      with_form(with_choices(row("motion_kind", "motion-kind",
                                 "meaning of motion vectors, such as px,previous,up: px, ndc (-1 to 1) or uv (0 to 1); "
                                 "previous or next frame; y up or down; to that frame or from it",
                                 "recognised", in_gbuffer<&GBufferSettings::motion_kind>),
                             {"px", "ndc", "uv", "previous", "next", "up", "down", "to", "from"}),
                OptionForm::kWords),
      with_form(
          row("view_from_normal", "view-from-normal", "rotation of normals to view space, three rows of three numbers",
              "none", in_gbuffer<&GBufferSettings::view_from_normal>),
          OptionForm::kRotation),
      row("orthographic", "orthographic", "the G-buffer's camera is orthographic", "",
          in_gbuffer<&GBufferSettings::orthographic>),
      with_form(row("window", "window",
                    "left, right, bottom and top of the window that the picture fills: at distance 1, or in scene "
                    "units for an orthographic camera",
                    "as the file says, else fitted to normals, else 55 degrees or 2 scene units high",
                    in_gbuffer<&GBufferSettings::window>),
                OptionForm::kWindow),
      with_range(row("fov_deg", "fov", "vertical field of view in degrees",
                     "as the file says, else fitted to normals, else 55", in_gbuffer<&GBufferSettings::fov_deg>),
                 0.1, 179.0, "deg"),
      with_form(row("focal_length_px", "focal-length-px", "focal length in pixels: one number, or fx,fy,cx,cy", "none",
                    in_gbuffer<&GBufferSettings::focal_length_px>),
                OptionForm::kIntrinsics, "px"),
      with_range(row("focal_length_mm", "focal-length-mm", "focal length in mm", "none",
                     in_gbuffer<&GBufferSettings::focal_length_mm>),
                 1e-3, 1e6, "mm"),
      with_range(row("sensor_width_mm", "sensor-width", "width of the sensor in mm, for a focal length in mm", "36",
                     in_gbuffer<&GBufferSettings::sensor_width_mm>),
                 1e-3, 1e6, "mm"),
      with_range(row("scene_radius", "scene-radius",
                     "bounding-sphere radius, the base of relative lengths; 0: derived from the depth", "0",
                     in_gbuffer<&GBufferSettings::scene_radius>),
                 0.0, kMaxDistance, "scene units"),
      row("sequence", "",
          "pictures are frames of a sequence: later ones take the meaning of depth, the radius and the exposure from "
          "the "
          "first",
          "", in_gbuffer<&GBufferSettings::sequence>),
      with_range(row("reduction", "reduction", "factor by which the finished picture is reduced", "1",
                     in_gbuffer<&GBufferSettings::reduction>),
                 1, 8),
  };
}

}  // namespace

std::vector<Option> gbuffer_options() {
  std::vector<Option> all = file_options();
  for (const auto& more : {depth_options(), space_options()}) all.insert(all.end(), more.begin(), more.end());
  all.push_back({.field = "effects",
                 .option = "effects",
                 .group = "G-buffer",
                 .help = "effects to run in this order in place of the look: bitmask,denoise",
                 .initial = "set by the look",
                 .where = in<&Request::effects>,
                 .commands = kShade,
                 .form = OptionForm::kWords});
  return all;
}

}  // namespace umbrage
