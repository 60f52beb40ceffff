#include "renderer/options.h"

#include <algorithm>
#include <cctype>

#include "core/check.h"
#include "core/device.h"
#include "looks/looks.h"
#include "looks/quality.h"
#include "renderer/accumulation.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

constexpr double kAnyAngle = 36000.0;
constexpr double kMaxDistance = 1e15;  // scene units
constexpr double kMaxIndex = 1e9;      // of cameras and scenes; the true limit is known when the file has been read
constexpr unsigned kSceneCommands = kRender | kCompare | kTune, kDeviceCommands = kSceneCommands | kBench | kFigures;

template <auto member>
auto& in(Request& request) {
  return request.*member;
}
template <auto member>
auto& in_gbuffer(Request& request) {
  return request.gbuffer.*member;
}
template <auto member>
auto& in_camera(Request& request) {
  return request.camera.*member;
}

std::vector<std::string_view> look_names() {
  std::vector<std::string_view> names;
  for (const Look* look : looks()) names.push_back(look->name);
  return names;
}

std::vector<std::string_view> quality_names() {
  std::vector<std::string_view> names;
  for (const Quality& quality : qualities()) names.push_back(quality.name);
  return names;
}

std::vector<std::string_view> technique_names() { return occlusion_names(external_effects()); }

// The options in the order of the help.
const std::vector<Option> kOptions = {
    {.field = "crease_angle_deg",
     .option = "crease-angle",
     .group = "Scene",
     .help = "angle in degrees above which edges stay sharp where a file has no normals",
     .initial = "80",
     .where = in<&Request::crease_angle_deg>,
     .commands = kSceneCommands | kInfo,
     .max = 180.0,
     .unit = "deg"},
    {.field = "point_size",
     .option = "point-size",
     .group = "Scene",
     .help = "size of a file's points: scene units (0.01) or percent of the bounding-sphere radius (0.5%)",
     .initial = "from their spacing",
     .where = in<&Request::point_size>,
     .commands = kSceneCommands | kInfo,
     .form = OptionForm::kLength,
     .unit = "scene units"},
    {.field = "point_sprites",
     .option = "point-sprites",
     .group = "Scene",
     .help = "shape of a file's points: disc, sphere, or auto (discs if they lie on surfaces)",
     .initial = "auto",
     .where = in<&Request::point_sprites>,
     .commands = kSceneCommands | kInfo,
     .choices = {"auto", "disc", "sphere"}},
    {.field = "up",
     .option = "up",
     .group = "Scene",
     .help = "up direction of the model: +X -X +Y -Y +Z -Z or x,y,z",
     .initial = "set by the format",
     .where = in<&Request::up>,
     .commands = kSceneCommands | kInfo,
     .form = OptionForm::kDirection},
    {.field = "scene_index",
     .option = "scene-index",
     .group = "Scene",
     .help = "number of a scene in a glTF file, counted from 0: see umbrage info",
     .initial = "the file's default scene",
     .where = in<&Request::scene_index>,
     .commands = kSceneCommands | kInfo,
     .max = kMaxIndex},
    {.field = "camera.index",
     .option = "camera-index",
     .group = "Camera",
     .help = "number of a camera in the file, counted from 0: see umbrage info",
     .initial = "none",
     .where = in_camera<&CameraSettings::index>,
     .commands = kSceneCommands,
     .max = kMaxIndex},
    {.field = "camera.position",
     .option = "camera-position",
     .group = "Camera",
     .help = "camera position x,y,z",
     .where = in_camera<&CameraSettings::position>,
     .commands = kSceneCommands,
     .form = OptionForm::kPosition,
     .unit = "scene units"},
    {.field = "camera.focal_point",
     .option = "camera-focal-point",
     .group = "Camera",
     .help = "point x,y,z that the camera looks at",
     .where = in_camera<&CameraSettings::focal_point>,
     .commands = kSceneCommands,
     .form = OptionForm::kPosition,
     .unit = "scene units"},
    {.field = "camera.view_up",
     .option = "camera-view-up",
     .group = "Camera",
     .help = "direction x,y,z that points up in the picture",
     .where = in_camera<&CameraSettings::view_up>,
     .commands = kSceneCommands,
     .form = OptionForm::kDirection},
    {.field = "camera.direction",
     .option = "camera-direction",
     .group = "Camera",
     .help = "viewing direction x,y,z",
     .where = in_camera<&CameraSettings::direction>,
     .commands = kSceneCommands,
     .form = OptionForm::kDirection},
    {.field = "camera.view_angle_deg",
     .option = "camera-view-angle",
     .group = "Camera",
     .help = "vertical field of view in degrees",
     .where = in_camera<&CameraSettings::view_angle_deg>,
     .commands = kSceneCommands,
     .min = 0.1,
     .max = 179.0,
     .unit = "deg"},
    {.field = "camera.azimuth_deg",
     .option = "camera-azimuth-angle",
     .group = "Camera",
     .help = "rotation around the model, degrees",
     .initial = "0",
     .where = in_camera<&CameraSettings::azimuth_deg>,
     .commands = kSceneCommands,
     .min = -kAnyAngle,
     .max = kAnyAngle,
     .unit = "deg"},
    {.field = "camera.elevation_deg",
     .option = "camera-elevation-angle",
     .group = "Camera",
     .help = "elevation above the model, degrees",
     .initial = "0",
     .where = in_camera<&CameraSettings::elevation_deg>,
     .commands = kSceneCommands,
     .min = -kAnyAngle,
     .max = kAnyAngle,
     .unit = "deg"},
    {.field = "camera.zoom",
     .option = "camera-zoom-factor",
     .group = "Camera",
     .help = "zoom factor; above 1: closer",
     .initial = "1",
     .where = in_camera<&CameraSettings::zoom>,
     .commands = kSceneCommands,
     .min = 1e-3,
     .max = 1e3},
    {.field = "camera.orthographic",
     .option = "camera-orthographic",
     .group = "Camera",
     .help = "parallel projection",
     .where = in_camera<&CameraSettings::orthographic>,
     .commands = kSceneCommands},
    {.field = "occlusion_radius",
     .option = "ao-radius",
     .group = "Technique",
     .help = "radius of occlusion: scene units (0.3) or percent of the bounding-sphere radius (5%)",
     .initial = "set by the look",
     .where = in<&Request::occlusion_radius>,
     .commands = kSceneCommands | kShade,
     .form = OptionForm::kLength,
     .unit = "scene units"},
    {.field = "settings",
     .option = "set",
     .group = "Technique",
     .help = "sets a parameter of an effect: effect.parameter=value; may be repeated; see umbrage list effects",
     .where = in<&Request::settings>,
     .commands = kSceneCommands | kShade},
    {.field = "quality",
     .option = "quality",
     .group = "Technique",
     .help = "trade-off between time and quality: draft, normal, high or ultra; sets the numbers of samples, layers, "
             "shadow rays and averaged pictures, and the resolution of occlusion",
     .initial = "set by the look",
     .where = in<&Request::quality>,
     .commands = kSceneCommands | kShade,
     .names = quality_names},
    {.field = "guard_band",
     .option = "guard-band",
     .group = "Technique",
     .help = "extra width that is drawn beyond each side and cut off, in percent of the longer side",
     .initial = "0%",
     .where = in<&Request::guard_band>,
     .commands = kSceneCommands,
     .max = 100.0,
     .form = OptionForm::kPercent,
     .unit = "%"},
    {.field = "layers",
     .option = "layers",
     .group = "Technique",
     .help = "number of surfaces captured along each ray (layer1.depth is the depth of the second)",
     .initial = "1, or set by the look",
     .where = in<&Request::layers>,
     .commands = kSceneCommands,
     .min = 1,
     .max = kMaxLayers},
    {.field = "extra_views",
     .option = "extra-views",
     .group = "Technique",
     .help = "number of additional cameras, which see surfaces hidden from the first",
     .initial = "0, or set by the look",
     .where = in<&Request::extra_views>,
     .commands = kSceneCommands,
     .max = kMaxExtraViews},
    {.field = "width",
     .option = "resolution",
     .group = "Picture",
     .help = "width,height in pixels, or one number for a square",
     .initial = "1024,1024",
     .where = in<&Request::width>,
     .commands = kRender | kTune,
     .min = 1,
     .max = kMaxSide,
     .form = OptionForm::kSize,
     .unit = "px"},
    {.field = "height",
     .option = "resolution",
     .group = "",
     .help = "height of the picture, pixels",
     .where = in<&Request::height>,
     .commands = 0,
     .min = 1,
     .max = kMaxSide,
     .unit = "px"},
    {.field = "look",
     .option = "look",
     .group = "Picture",
     .help = "style of the picture: see umbrage list looks",
     .initial = "studio",
     .where = in<&Request::look>,
     .commands = kRender | kTune | kShade,
     .names = look_names},
    {.field = "occlusion",
     .option = "ao",
     .group = "Picture",
     .help = "occlusion technique, or none",
     .initial = "set by the look",
     .where = in<&Request::occlusion>,
     .commands = kRender | kTune | kShade,
     .names = technique_names},
    {.field = "occlusion_scale",
     .option = "ao-scale",
     .group = "Picture",
     .help = "resolution at which occlusion is computed: full, half or quarter",
     .initial = "set by the look",
     .where = in<&Request::occlusion_scale>,
     .commands = kSceneCommands | kBench | kShade,
     .choices = {"full", "half", "quarter"}},
    {.field = "anti_aliasing",
     .option = "anti-aliasing",
     .group = "Picture",
     .help = "number of pictures to average, each sampled at different positions within the pixels",
     .initial = "set by the look",
     .where = in<&Request::anti_aliasing>,
     .min = 1,
     .max = kMaxAveragedPictures},
    {.field = "ground",
     .option = "ground",
     .group = "Picture",
     .help = "a ground that shows the model's shadow: auto, on or off",
     .initial = "auto: set by the look",
     .where = in<&Request::ground>,
     .choices = {"auto", "on", "off"}},
    {.field = "background",
     .option = "background-color",
     .group = "Picture",
     .help = "colour of the background: red,green,blue from 0 to 1",
     .initial = "set by the look",
     .where = in<&Request::background>,
     .commands = kRender | kShade,
     .form = OptionForm::kColor},
    {.field = "transparent",
     .option = "no-background",
     .group = "Picture",
     .help = "transparent where there is no surface",
     .where = in<&Request::transparent>,
     .commands = kRender | kShade},
    {.field = "hdri_file",
     .option = "hdri-file",
     .group = "Light",
     .help = "equirectangular environment image that lights the scene: .hdr, .exr, .png, .jpg, or "
             "the built-in clear sky, sky:",
     .initial = "none",
     .where = in<&Request::hdri_file>},
    {.field = "hdri_ambient",
     .option = "hdri-ambient",
     .group = "Light",
     .help = "light the scene with the image; `hdri_ambient`=false: only show it",
     .initial = "true",
     .where = in<&Request::hdri_ambient>},
    {.field = "hdri_skybox",
     .option = "hdri-skybox",
     .group = "Light",
     .help = "show the image as the background",
     .where = in<&Request::hdri_skybox>},
    {.field = "hdri_rotation_deg",
     .option = "hdri-rotation",
     .group = "Light",
     .help = "rotation of the image about the up direction, degrees",
     .initial = "0",
     .where = in<&Request::hdri_rotation_deg>,
     .min = -kAnyAngle,
     .max = kAnyAngle,
     .unit = "deg"},
    {.field = "hdri_intensity",
     .option = "hdri-intensity",
     .group = "Light",
     .help = "factor for the brightness of the image",
     .initial = "1",
     .where = in<&Request::hdri_intensity>,
     .max = 1e6},
    {.field = "light_size_deg",
     .option = "light-size",
     .group = "Light",
     .help = "angular diameter of the key light, degrees; larger values give softer shadows",
     .initial = "set by the light",
     .where = in<&Request::light_size_deg>,
     .max = 90.0,
     .unit = "deg"},
    {.field = "device",
     .option = "device",
     .group = "Device",
     .help = "cpu, vulkan, vulkan:N (see umbrage list devices) or auto (a GPU if there is one)",
     .initial = "auto",
     .where = in<&Request::device>,
     .commands = kDeviceCommands,
     .environment = "UMBRAGE_DEVICE"},
    {.field = "threads",
     .option = "threads",
     .group = "Device",
     .help = "number of threads (0: all)",
     .initial = "0",
     .where = in<&Request::threads>,
     .commands = kDeviceCommands,
     .max = 1024,
     .environment = "UMBRAGE_NUM_THREADS"},
    {.field = "isa",
     .option = "isa",
     .group = "Device",
     .help = "widest instruction set for kernels and ray tracing on the CPU: avx512, avx2, sse4, neon or scalar",
     .initial = "the widest of the machine",
     .commands = kDeviceCommands,
     .environment = "UMBRAGE_ISA"},
    {.field = "passes",
     .option = "passes",
     .group = "Output",
     .help = "planes to write instead of the picture: all, or names such as depth,normal,ao",
     .where = in<&Request::passes>,
     .form = OptionForm::kWords},
    {.field = "bits",
     .option = "bits",
     .group = "Output",
     .help = "bits per channel of a PNG: 8 or 16",
     .initial = "8",
     .choices = {"8", "16"}},
    {.field = "strokes",
     .option = "svg",
     .group = "",
     .help = "return the look's lines as curves",
     .where = in<&Request::strokes>,
     .commands = 0},
    {.field = "effects",
     .option = "effects",
     .group = "G-buffer",
     .help = "effects to run in this order in place of the look: bitmask,denoise",
     .initial = "set by the look",
     .where = in<&Request::effects>,
     .commands = kShade,
     .form = OptionForm::kWords},
    {.field = "depth_kind",
     .option = "depth-kind",
     .group = "G-buffer",
     .help =
         "meaning of depth: distance along the view axis, or along the ray, or a depth buffer's value, which may be "
         "reversed",
     .initial = "view",
     .where = in_gbuffer<&GBufferSettings::depth_kind>,
     .commands = kShade,
     .choices = {"view", "ray", "window", "reversed"}},
    {.field = "near_plane",
     .option = "near-plane",
     .group = "G-buffer",
     .help = "near plane of a depth buffer, scene units",
     .initial = "0.1",
     .where = in_gbuffer<&GBufferSettings::near_plane>,
     .commands = kShade,
     .max = kMaxDistance,
     .unit = "scene units"},
    {.field = "far_plane",
     .option = "far-plane",
     .group = "G-buffer",
     .help = "far plane of a depth buffer, scene units; 0: at infinity",
     .initial = "0",
     .where = in_gbuffer<&GBufferSettings::far_plane>,
     .commands = kShade,
     .max = kMaxDistance,
     .unit = "scene units"},
    {.field = "view_from_normal",
     .option = "view-from-normal",
     .group = "G-buffer",
     .help = "rotation of normals to view space, three rows of three numbers",
     .initial = "none",
     .where = in_gbuffer<&GBufferSettings::view_from_normal>,
     .commands = kShade,
     .form = OptionForm::kRotation},
    {.field = "orthographic",
     .option = "orthographic",
     .group = "G-buffer",
     .help = "the G-buffer's camera is orthographic",
     .where = in_gbuffer<&GBufferSettings::orthographic>,
     .commands = kShade},
    {.field = "window",
     .option = "window",
     .group = "G-buffer",
     .help =
         "left, right, bottom and top of the window that the picture fills: at distance 1, or in scene units for an "
         "orthographic camera",
     .initial = "-1,1,-1,1",
     .where = in_gbuffer<&GBufferSettings::window>,
     .commands = kShade,
     .form = OptionForm::kWindow},
    {.field = "scene_radius",
     .option = "scene-radius",
     .group = "G-buffer",
     .help = "bounding-sphere radius, the base of relative lengths; 0: derived from the depth",
     .initial = "0",
     .where = in_gbuffer<&GBufferSettings::scene_radius>,
     .commands = kShade,
     .max = kMaxDistance,
     .unit = "scene units"},
    {.field = "model", .option = "MODEL", .group = "", .help = "", .where = in<&Request::model>, .commands = 0},
};

/// Returns the end of the quotation '...' that begins at `at`, after its closing mark; `at` if none begins there.
/// Apostrophes, as in "the picture's" or "the models' sizes", do not begin one.
std::size_t end_of_quotation(std::string_view message, std::size_t at) {
  const auto is_letter = [&](std::size_t k) { return k < message.size() && std::isalnum((unsigned char)message[k]); };
  if (message[at] != '\'' || (at > 0 && message[at - 1] != ' ' && message[at - 1] != '(')) return at;
  for (std::size_t k = at + 1; k < message.size(); ++k)
    if (message[k] == '\'' && !is_letter(k + 1)) return k + 1;
  return at;
}

}  // namespace

std::vector<std::string_view> words_of(const Option& option) { return option.names ? option.names() : option.choices; }

std::span<const Option> options() { return kOptions; }

const Option& option_of(std::string_view field) {
  for (const Option& option : kOptions)
    if (option.field == field) return option;
  fail_check(fmt::format("there is no option for the field '{}'", field));
}

std::string with_fields_renamed(std::string_view message, std::string (*rename)(const Option&)) {
  std::string text;
  for (std::size_t at = 0; at < message.size();) {
    if (message[at] == '`') {
      const std::size_t close = message.find('`', at + 1);
      const std::string_view field = message.substr(at + 1, close == message.npos ? close : close - at - 1);
      const auto row =
          std::find_if(kOptions.begin(), kOptions.end(), [&](const Option& o) { return o.field == field; });
      if (close != message.npos && row != kOptions.end()) {
        text += rename(*row);
        at = close + 1;
        continue;
      }
    }
    const std::size_t next = std::max(end_of_quotation(message, at), at + 1);
    text += message.substr(at, next - at);
    at = next;
  }
  return text;
}

}  // namespace umbrage
