#include "apps/cli/options.h"

#include <tbb/global_control.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <optional>

#include "io/image_file.h"
#include "renderer/accumulation.h"
#include "renderer/isa_setting.h"

namespace umbrage::cli {
namespace {

constexpr int kMostIndex = 1000000000;  // of cameras and scenes, which are counted once the file is read
constexpr float kFarthest = 1e15f;      // as for models: rays beyond leave what Embree takes

/// "x,y,z" or "x y z".
Result<glm::vec3> parse_vector(std::string_view option, std::string_view text) {
  glm::vec3 v(0.0f);
  std::size_t start = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t end = i == 2 ? text.size() : text.find(',', start);
    float value = 0.0f;
    const auto part = end == std::string_view::npos ? std::string_view() : text.substr(start, end - start);
    const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (part.empty() || error != std::errc() || stop != part.data() + part.size() || !(std::abs(value) <= kFarthest))
      return usage_error("{} cannot be '{}': it takes three numbers up to {:g}, such as 1,2.5,-3", option, text,
                         kFarthest);
    v[i] = value;
    start = end + 1;
  }
  return v;
}

template <class T>
Result<void> store(const Result<T>& parsed, auto& out) {
  if (!parsed) return parsed.error();
  out = *parsed;
  return {};
}

}  // namespace

Result<double> parse_number(std::string_view option, std::string_view text, double least, double most) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= least && value <= most))
    return usage_error("{} cannot be '{}': it takes a number from {:g} to {:g}", option, text, least, most);
  return value;
}

Result<int> parse_whole(std::string_view option, std::string_view text, int least, int most) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    return usage_error("{} cannot be '{}': it takes a whole number from {} to {}", option, text, least, most);
  return value;
}

void add_model_options(CLI::App& command, CommonOptions& o) {
  command.add_option("MODEL", o.models, "model files, - for standard input, or scene:NAME?detail=TRIANGLES")
      ->required();
  const auto scene = "Scene";
  command
      .add_option("--crease-angle", o.crease_angle,
                  "faces that meet at a larger angle keep their edge where a file has no normals, degrees [80]")
      ->group(scene);
  command
      .add_option("--point-size", o.point_size,
                  "size of a file's points: scene units (0.01) or a share of the scene's radius (0.5%) [their spacing]")
      ->group(scene);
  command
      .add_option("--point-sprites", o.point_shape,
                  "what a file's points are drawn as: disc, sphere or auto: discs where they lie on surfaces [auto]")
      ->group(scene);
  command.add_option("--up", o.up, "world up: +X -X +Y -Y +Z -Z or x,y,z [as the format says]")->group(scene);
  command
      .add_option("--scene-index", o.scene_index,
                  "one of the scenes that a glTF file holds, from 0: see umbrage info [the one that it names]")
      ->group(scene);
  command
      .add_option("--input-format", o.input_format,
                  "format of the model on standard input, such as obj [by its content]")
      ->group(scene);
}

void add_scene_options(CLI::App& command, CommonOptions& o) {
  add_model_options(command, o);
  const auto camera = "Camera";
  command.add_option("--camera-index", o.camera_index, "a camera of the file, from 0: see umbrage info [none of them]")
      ->group(camera);
  command.add_option("--camera-position", o.position, "x,y,z of the eye")->group(camera);
  command.add_option("--camera-focal-point", o.focal_point, "x,y,z that is looked at")->group(camera);
  command.add_option("--camera-view-up", o.view_up, "x,y,z that points up in the picture")->group(camera);
  command.add_option("--camera-direction", o.direction, "x,y,z in which the camera looks")->group(camera);
  command.add_option("--camera-view-angle", o.view_angle, "vertical field of view in degrees")->group(camera);
  command.add_option("--camera-azimuth-angle", o.azimuth, "turn around the model, degrees [0]")->group(camera);
  command.add_option("--camera-elevation-angle", o.elevation, "rise over the model, degrees [0]")->group(camera);
  command.add_option("--camera-zoom-factor", o.zoom, "above 1: nearer [1]")->group(camera);
  command.add_flag("--camera-orthographic", o.orthographic, "parallel projection")->group(camera);
}

void add_technique_options(CLI::App& command, CommonOptions& o) {
  const auto technique = "Technique";
  command
      .add_option("--ao-radius", o.radius,
                  "reach of occlusion: scene units (0.3) or a share of the scene's radius (5%)")
      ->group(technique);
  command.add_option("--set", o.settings, "effect.parameter=value, any number of times: see umbrage list effects")
      ->group(technique)
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  command
      .add_option("--quality", o.quality,
                  "how much time to take: draft, normal, high or ultra sets samples, resolution of occlusion, layers, "
                  "shadow rays and averaged pictures [the look's]")
      ->group(technique);
  command
      .add_option("--guard-band", o.guard_band,
                  "draw so much more on each side and cut it off, as a share of the longer side [0%]")
      ->group(technique);
  command
      .add_option(
          "--layers", o.layers,
          "surfaces captured along each ray: layer1.depth is the second one's depth [1, or what the look wants]")
      ->group(technique);
  command
      .add_option("--extra-views", o.extra_views,
                  "further cameras that see what the first cannot, 0 to 4 [0, or what the look wants]")
      ->group(technique);
}

void add_picture_options(CLI::App& command, CommonOptions& o) {
  const auto picture = "Picture";
  command.add_option("--resolution", o.resolution, "width,height in pixels [1024,1024]")->group(picture);
  command.add_option("--look", o.look, "recipe of the picture: see umbrage list looks [studio]")->group(picture);
  command.add_option("--ao", o.occlusion, "occlusion technique, or none [the look's]")->group(picture);
  command
      .add_option("--ao-scale", o.occlusion_scale,
                  "resolution at which occlusion is computed: full, half or quarter [the look's]")
      ->group(picture);
  command
      .add_option("--anti-aliasing", o.anti_aliasing,
                  "pictures that are averaged, each sampled elsewhere within its pixels: 1 to 256 [the look's]")
      ->group(picture);
  command
      .add_option("--ground", o.ground,
                  "a ground that shows the model's shadow: auto, on or off [auto: as the look says]")
      ->group(picture);
  command.add_option("--background-color", o.background, "red,green,blue from 0 to 1 [the look's]")->group(picture);
  command.add_flag("--no-background", o.no_background, "transparent where there is no surface")->group(picture);
}

void add_light_options(CLI::App& command, CommonOptions& o) {
  const auto light = "Light";
  command
      .add_option(
          "--hdri-file", o.hdri_file,
          "image of all directions, equirectangular, that lights the scene: .hdr, .exr, .png, .jpg, or sky: for "
          "a clear sky [none]")
      ->group(light);
  command
      .add_flag("--hdri-ambient", o.hdri_ambient,
                "light the scene by it, as it does unless --hdri-ambient=false is given [true]")
      ->group(light);
  command.add_flag("--hdri-skybox", o.hdri_skybox, "show it behind the scene")->group(light);
  command.add_option("--hdri-rotation", o.hdri_rotation, "turn it about the world's up, degrees [0]")->group(light);
  command.add_option("--hdri-intensity", o.hdri_intensity, "factor on its light [1]")->group(light);
  command
      .add_option("--light-size", o.light_size,
                  "what the key light spans as the scene sees it, degrees; more: softer shadows [the light's]")
      ->group(light);
}

void add_device_options(CLI::App& command, CommonOptions& o) {
  const auto device = "Device";
  command
      .add_option("--device", o.device,
                  "cpu, vulkan, vulkan:N (of umbrage list devices) or auto: a GPU if there is one [auto]")
      ->envname("UMBRAGE_DEVICE")
      ->group(device);
  command.add_option("--threads", o.threads, "number of threads; 0: all [0]")
      ->envname("UMBRAGE_NUM_THREADS")
      ->group(device);
  command
      .add_option("--isa", o.isa,
                  "widest instruction set of kernels and rays on the CPU: avx512, avx2, sse4, neon or scalar [the "
                  "machine's]")
      ->envname("UMBRAGE_ISA")
      ->group(device);
  command.add_flag("--verbose", o.verbose, "say what is done and how long each stage took")
      ->envname("UMBRAGE_VERBOSE")
      ->group("Output");
  add_config_option(command);
}

Result<std::pair<int, int>> parse_resolution(std::string_view text, long most) {
  int size[2] = {0, 0};
  const std::size_t comma = text.find_first_of(",x");
  const auto wrong = [&] {
    return usage_error("--resolution cannot be '{}': it takes width,height from 1 to {} pixels, together at most {}",
                       text, kLargestSide, std::min(most, long(kLargestSide) * kLargestSide));
  };
  if (comma == std::string_view::npos) return wrong();
  const std::string_view parts[2] = {text.substr(0, comma), text.substr(comma + 1)};
  for (int i = 0; i < 2; ++i) {
    const auto [end, error] = std::from_chars(parts[i].data(), parts[i].data() + parts[i].size(), size[i]);
    if (error != std::errc() || end != parts[i].data() + parts[i].size() || size[i] < 1 || size[i] > kLargestSide)
      return wrong();
  }
  if (long(size[0]) * size[1] > most) return wrong();
  return std::pair(size[0], size[1]);
}

Result<glm::vec3> parse_direction(std::string_view option, std::string_view text) {
  if (text.size() == 2 && (text[0] == '+' || text[0] == '-')) {
    const int axis = (text[1] | 0x20) - 'x';
    if (axis >= 0 && axis < 3) {
      glm::vec3 v(0.0f);
      v[axis] = text[0] == '+' ? 1.0f : -1.0f;
      return v;
    }
  }
  const auto v = parse_vector(option, text);
  if (!v || glm::length(*v) == 0.0f)
    return usage_error("{} cannot be '{}': it takes +X, -X, +Y, -Y, +Z, -Z or three numbers that are not all 0", option,
                       text);
  return glm::normalize(*v);
}

Result<DrawSettings> draw_settings(const CommonOptions& o, long most_pixels) {
  DrawSettings draw;
  const auto size = parse_resolution(o.resolution, most_pixels);
  if (!size) return size.error();
  std::tie(draw.width, draw.height) = *size;
  Framing& framing = draw.framing;
  const auto vector = [](std::string_view option, const std::string& text, std::optional<glm::vec3>& out,
                         bool direction) -> Result<void> {
    if (text.empty()) return {};
    return store(direction ? parse_direction(option, text) : parse_vector(option, text), out);
  };
  const auto number = [](std::string_view option, const std::string& text, double least, double most,
                         auto& out) -> Result<void> {
    if (text.empty()) return {};
    return store(parse_number(option, text, least, most), out);
  };
  constexpr double kAnyAngle = 36000.0;
  for (const auto& done :
       {vector("--camera-position", o.position, framing.position, false),
        vector("--camera-focal-point", o.focal_point, framing.focal_point, false),
        vector("--camera-view-up", o.view_up, framing.view_up, true),
        vector("--camera-direction", o.direction, framing.direction, true),
        number("--camera-view-angle", o.view_angle, 0.1, 179.0, framing.view_angle_deg),
        number("--camera-azimuth-angle", o.azimuth, -kAnyAngle, kAnyAngle, framing.azimuth_deg),
        number("--camera-elevation-angle", o.elevation, -kAnyAngle, kAnyAngle, framing.elevation_deg),
        number("--camera-zoom-factor", o.zoom, 1e-3, 1e3, framing.zoom),
        number("--hdri-rotation", o.hdri_rotation, -kAnyAngle, kAnyAngle, draw.hdri.rotation_deg),
        number("--hdri-intensity", o.hdri_intensity, 0.0, kMostIntensity, draw.hdri.intensity),
        number("--light-size", o.light_size, 0.0, kWidestLight, draw.light_size_deg)})
    if (!done) return done.error();
  if (framing.position && framing.focal_point && *framing.position == *framing.focal_point)
    return usage_error(
        "--camera-position and --camera-focal-point are both '{}': a camera cannot look at its own place", o.position);
  framing.orthographic = o.orthographic;
  if (!o.camera_index.empty()) {
    if (!o.position.empty() || !o.focal_point.empty() || !o.direction.empty())
      return usage_error("--camera-index and --camera-{} both say where the camera is: give one of them",
                         !o.position.empty()      ? "position"
                         : !o.focal_point.empty() ? "focal-point"
                                                  : "direction");
    const auto index = parse_whole("--camera-index", o.camera_index, 0, kMostIndex);
    if (!index) return index.error();
    draw.camera_index = *index;
  }
  const auto whole = [](std::string_view option, const std::string& text, int least, int most,
                        std::optional<int>& out) -> Result<void> {
    if (text.empty()) return {};
    const auto value = parse_number(option, text, least, most);
    if (!value) return value.error();
    if (*value != std::floor(*value))
      return usage_error("{} cannot be '{}': it takes a whole number from {} to {}", option, text, least, most);
    out = int(*value);
    return {};
  };
  if (auto done = whole("--layers", o.layers, 1, kMostLayers, draw.layers); !done) return done.error();
  if (auto done = whole("--extra-views", o.extra_views, 0, kMostExtraViews, draw.extra_views); !done)
    return done.error();
  if (auto done = whole("--anti-aliasing", o.anti_aliasing, 1, kMostFrames, draw.frames); !done) return done.error();
  constexpr double kWidestGuard = 100.0;
  const std::string_view share = std::string_view(o.guard_band).substr(0, o.guard_band.find('%'));
  const auto guard = parse_number("--guard-band", share, 0.0, kWidestGuard);
  if (!guard || share.size() + 1 != o.guard_band.size())
    return usage_error("--guard-band cannot be '{}': it takes 0% to {:g}% of the picture's longer side", o.guard_band,
                       kWidestGuard);
  draw.guard_percent = float(*guard);
  draw.hdri.file = o.hdri_file;
  draw.hdri.ambient = o.hdri_ambient;
  draw.hdri.skybox = o.hdri_skybox;
  if (auto fine = check_hdri(draw.hdri, o.no_background); !fine) return fine.error();
  draw.look = o.look;
  draw.quality = o.quality;
  constexpr std::string_view kGrounds[] = {"auto", "on", "off"};
  const auto ground = std::find(std::begin(kGrounds), std::end(kGrounds), o.ground);
  if (ground == std::end(kGrounds)) return usage_error("--ground cannot be '{}': it takes auto, on or off", o.ground);
  draw.ground = Ground(ground - std::begin(kGrounds));
  draw.occlusion = o.occlusion;
  draw.occlusion_scale = o.occlusion_scale;
  draw.radius = o.radius;
  if (!o.background.empty()) {
    const auto color = parse_vector("--background-color", o.background);
    for (int i = 0; i < 3; ++i) {
      if (!color || (*color)[i] < 0.0f || (*color)[i] > 1.0f)
        return usage_error("--background-color cannot be '{}': it takes three numbers from 0 to 1, such as 0.2,0.3,0.5",
                           o.background);
      draw.settings.push_back(fmt::format("output.background_{}={}", "rgb"[i], (*color)[i]));
    }
  }
  if (o.no_background) draw.settings.push_back("output.transparent=on");
  draw.settings.insert(draw.settings.end(), o.settings.begin(), o.settings.end());
  return draw;
}

Result<ImportSettings> import_settings(const CommonOptions& o) {
  ImportSettings settings;
  if (!o.scene_index.empty()) {
    const auto index = parse_whole("--scene-index", o.scene_index, 0, kMostIndex);
    if (!index) return index.error();
    settings.scene_index = *index;
  }
  if (!o.crease_angle.empty()) {
    const auto angle = parse_number("--crease-angle", o.crease_angle, 0.0, 180.0);
    if (!angle) return angle.error();
    settings.crease_angle_deg = float(*angle);
  }
  if (!o.point_size.empty()) {
    const auto size = parse_radius("--point-size", o.point_size);
    if (!size) return size.error();
    settings.points.size = *size;
  }
  constexpr std::string_view kShapes[] = {"auto", "disc", "sphere"};
  const auto shape = std::find(std::begin(kShapes), std::end(kShapes), o.point_shape);
  if (shape == std::end(kShapes))
    return usage_error("--point-sprites cannot be '{}': it takes auto, disc or sphere", o.point_shape);
  settings.points.shape = PointShape(shape - std::begin(kShapes));
  if (o.up.empty()) return settings;
  const auto up = parse_direction("--up", o.up);
  if (!up) return up.error();
  settings.up = *up;
  return settings;
}

Result<std::unique_ptr<Device>> device_of(const CommonOptions& o) {
  const auto threads = parse_number("--threads", o.threads, 0, kMaxThreads);
  if (!threads) return threads.error();
  if (*threads != std::floor(*threads))
    return usage_error("--threads cannot be '{}': it takes a whole number from 0 to {}", o.threads, kMaxThreads);
  if (!o.isa.empty())
    if (auto valid = use_isa(o.isa); !valid) return valid.error();
  // Also for work that no device does: hierarchies, metrics.
  static std::optional<tbb::global_control> limit;
  if (*threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(*threads));
  return make_device(o.device, int(*threads));
}

Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) {
    for (const char* file : files)
      if (auto writable = check_writable(folder / file); !writable) return writable;
    return {};
  }
  fs::path parent = fs::absolute(folder, ignored);
  while (!fs::exists(parent, ignored) && parent != parent.parent_path()) parent = parent.parent_path();
  if (folder.empty() || !fs::is_directory(parent, ignored) || ::access(parent.c_str(), W_OK | X_OK) != 0)
    return file_error("{}: the folder cannot be made", folder.string());
  return {};
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return words;
}

}  // namespace umbrage::cli
