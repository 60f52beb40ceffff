// The public interface on top of a job.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "core/guarded.h"
#include "core/image.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "io/svg.h"
#include "renderer/accumulation.h"
#include "renderer/arrays.h"
#include "renderer/callers_progress.h"
#include "renderer/job.h"
#include "renderer/lines.h"
#include "renderer/passes.h"
#include "renderer/strokes.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

constexpr float kFarthest = 1e15f;  // as for models: rays beyond leave what Embree takes

Result<void> within(const char* option, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return usage_error("{} cannot be {}: it takes a number from {:g} to {:g}", option, value, least, most);
}

Result<void> store_vector(const char* option, const std::optional<std::array<float, 3>>& from, bool direction,
                          std::optional<glm::vec3>& to) {
  if (!from) return {};
  const glm::vec3 v((*from)[0], (*from)[1], (*from)[2]);
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(v[i]) <= kFarthest))
      return usage_error("{} cannot be {},{},{}: it takes three numbers up to {:g}", option, v.x, v.y, v.z, kFarthest);
  if (direction && !(glm::length(v) > 0.0f))
    return usage_error("{} cannot be 0,0,0: it takes three numbers that are not all 0", option);
  to = direction ? glm::normalize(v) : v;
  return {};
}

/// What looks are asked for in the same words, of models and of arrays.
template <class Request>
Result<void> store_picture(const Request& request, DrawSettings& settings) {
  if (auto valid = within("--threads", request.threads, 0, kMaxThreads); !valid) return valid;
  settings.look = request.look;
  settings.occlusion = request.occlusion;
  settings.occlusion_scale = request.occlusion_scale;
  settings.radius = request.occlusion_radius;
  settings.quality = request.quality;
  if (request.background)
    for (int i = 0; i < 3; ++i) {
      const float value = (*request.background)[std::size_t(i)];
      if (auto fine = within("--background-color", value, 0.0, 1.0); !fine) return fine;
      settings.settings.push_back(fmt::format("output.background_{}={}", "rgb"[i], value));
    }
  if (request.transparent) settings.settings.push_back("output.transparent=on");
  settings.settings.insert(settings.settings.end(), request.settings.begin(), request.settings.end());
  if (request.progress) settings.progress = request.progress;
  return {};
}

/// Everything of a request that can be wrong without its model.
Result<DrawSettings> draw_settings(const RenderRequest& request) {
  for (const int side : {request.width, request.height})
    if (side < 1 || side > kLargestSide)
      return usage_error("a picture cannot be {} pixels wide or high: 1 to {} can", side, kLargestSide);
  if (long(request.width) * request.height > kMostPixels)
    return usage_error("a picture cannot have {} x {} pixels: {} together are the most", request.width, request.height,
                       kMostPixels);
  DrawSettings settings;
  settings.width = request.width;
  settings.height = request.height;
  settings.layers = request.layers;
  settings.extra_views = request.extra_views;
  settings.frames = request.anti_aliasing;
  settings.guard_percent = request.guard_band;
  settings.hdri = {.file = request.hdri_file,
                   .ambient = request.hdri_ambient,
                   .skybox = request.hdri_skybox,
                   .rotation_deg = request.hdri_rotation_deg,
                   .intensity = request.hdri_intensity,
                   .panorama = nullptr};
  settings.light_size_deg = request.light_size_deg;
  const CameraRequest& camera = request.camera;
  Framing& framing = settings.framing;
  framing.view_angle_deg = camera.view_angle_deg;
  framing.azimuth_deg = camera.azimuth_deg;
  framing.elevation_deg = camera.elevation_deg;
  framing.zoom = camera.zoom;
  framing.orthographic = camera.orthographic;
  if (camera.index && (camera.position || camera.focal_point || camera.direction))
    return usage_error("--camera-index and --camera-{} both say where the camera is: give one of them",
                       camera.position      ? "position"
                       : camera.focal_point ? "focal-point"
                                            : "direction");
  settings.camera_index = camera.index;
  constexpr double kAnyAngle = 36000.0;
  for (const auto& done :
       {store_picture(request, settings), store_vector("--camera-position", camera.position, false, framing.position),
        store_vector("--camera-focal-point", camera.focal_point, false, framing.focal_point),
        store_vector("--camera-view-up", camera.view_up, true, framing.view_up),
        store_vector("--camera-direction", camera.direction, true, framing.direction),
        within("--camera-view-angle", camera.view_angle_deg.value_or(30.0f), 0.1, 179.0),
        within("--camera-azimuth-angle", camera.azimuth_deg, -kAnyAngle, kAnyAngle),
        within("--camera-elevation-angle", camera.elevation_deg, -kAnyAngle, kAnyAngle),
        within("--camera-zoom-factor", camera.zoom, 1e-3, 1e3),
        within("--layers", request.layers.value_or(1), 1, kMostLayers),
        within("--extra-views", request.extra_views.value_or(0), 0, kMostExtraViews),
        within("--anti-aliasing", request.anti_aliasing.value_or(1), 1, kMostFrames),
        within("--guard-band", request.guard_band, 0.0, 100.0),
        within("--hdri-rotation", request.hdri_rotation_deg, -kAnyAngle, kAnyAngle),
        within("--hdri-intensity", request.hdri_intensity, 0.0, kMostIntensity),
        within("--light-size", request.light_size_deg.value_or(0.0f), 0.0, kWidestLight),
        check_hdri(settings.hdri, request.transparent)})
    if (!done) return done.error();
  constexpr std::string_view kGrounds[] = {"auto", "on", "off"};
  const auto ground = std::find(std::begin(kGrounds), std::end(kGrounds), request.ground);
  if (ground == std::end(kGrounds))
    return usage_error("--ground cannot be '{}': it takes auto, on or off", request.ground);
  settings.ground = Ground(ground - std::begin(kGrounds));
  want_passes(request.passes, settings);
  const auto recipe = make_recipe(settings);
  if (!recipe) return recipe.error();
  if (const auto capture = capture_settings(settings, *recipe->look, kMostShadows); !capture) return capture.error();
  if (auto fine = check_passes(request.passes, settings); !fine) return fine.error();
  return settings;
}

Result<ImportSettings> import_settings(const RenderRequest& request) {
  ImportSettings settings;
  std::optional<glm::vec3> up;
  if (auto done = store_vector("--up", request.up, true, up); !done) return done.error();
  if (up) settings.up = *up;
  settings.scene_index = request.scene_index;
  if (!request.point_size.empty()) {
    const auto size = parse_radius("--point-size", request.point_size);
    if (!size) return size.error();
    settings.points.size = *size;
  }
  constexpr std::string_view kShapes[] = {"auto", "disc", "sphere"};
  const auto shape = std::find(std::begin(kShapes), std::end(kShapes), request.point_sprites);
  if (shape == std::end(kShapes))
    return usage_error("--point-sprites cannot be '{}': it takes auto, disc or sphere", request.point_sprites);
  settings.points.shape = PointShape(shape - std::begin(kShapes));
  if (!request.crease_angle_deg) return settings;
  if (auto fine = within("--crease-angle", *request.crease_angle_deg, 0.0, 180.0); !fine) return fine.error();
  settings.crease_angle_deg = *request.crease_angle_deg;
  return settings;
}

/// Channels one after the other, pixel by pixel.
std::vector<float> interleaved(const Image& image) {
  std::vector<float> values(std::size_t(image.width) * std::size_t(image.height) * image.planes.size());
  const std::size_t channels = image.planes.size();
  for (std::size_t c = 0; c < channels; ++c)
    for (int y = 0; y < image.height; ++y) {
      const float* row = image.planes[c].row(y);
      float* to = values.data() + std::size_t(y) * std::size_t(image.width) * channels + c;
      for (int x = 0; x < image.width; ++x) to[std::size_t(x) * channels] = row[x];
    }
  return values;
}

const std::vector<std::string> kColor = {"color.r", "color.g", "color.b", "color.a"};

/// What a frame holds of what was asked for; strokes where there are parameters of lines.
Result<Picture> downloaded(Device& device, const Frame& frame, bool color, const std::vector<std::string>& passes,
                           const ParameterBytes& lines) {
  Picture picture;
  picture.width = frame.info.inner_width();
  picture.height = frame.info.inner_height();
  if (color) {
    const auto image = device.download(frame, kColor);
    if (!image) return image.error();
    picture.rgba = interleaved(*image);
  }
  if (!lines.empty())
    if (auto done = add_strokes(device, frame, lines, picture); !done) return done.error();
  if (passes.empty()) return picture;
  const auto chosen = chosen_planes(passes, device.plane_names(frame), frame.info);
  if (!chosen) return chosen.error();
  for (const PassPlanes& pass : *chosen) {
    const auto image = device.download(frame, pass.planes);
    if (!image) return image.error();
    picture.passes.push_back({pass.name, int(pass.planes.size()), interleaved(*image)});
  }
  return picture;
}

/// A model on a device, ready to be drawn.
struct Opened {
  std::unique_ptr<Device> device;
  std::unique_ptr<Scene> scene;  // devices point to it
  DrawSettings settings;
  std::vector<std::string> passes;
  ParameterBytes lines;  // where strokes are wanted
};

Error interrupted() { return {ErrorKind::kInterrupted, "interrupted"}; }

Result<Opened> open_model(const RenderRequest& request, std::vector<std::string>& warnings) {
  auto settings = draw_settings(request);
  if (!settings) return settings.error();
  const auto import_with = import_settings(request);
  if (!import_with) return import_with.error();
  auto lines = wanted_lines(request.strokes, *settings, {});
  if (!lines) return lines.error();
  auto device = make_device(request.device, request.threads);
  if (!device) return device.error();
  if (!settings->progress(0.0)) return interrupted();
  const auto hdri_warnings = read_hdri(settings->hdri);
  if (!hdri_warnings) return hdri_warnings.error();
  auto scene = load_scene(request.model, *import_with);
  if (!scene) return scene.error();
  if (settings->camera_index)
    if (auto used = use_camera(*settings->camera_index, *scene); !used) return used.error();
  warnings = *hdri_warnings;
  warnings.insert(warnings.end(), scene->warnings.begin(), scene->warnings.end());
  if (!settings->progress(0.0)) return interrupted();
  furnish(*scene, *settings);
  Opened opened{std::move(*device), std::make_unique<Scene>(std::move(*scene)), std::move(*settings), request.passes,
                std::move(*lines)};
  if (const auto ready = opened.device->prepare(*opened.scene); !ready) return ready.error();
  return opened;
}

Result<Picture> draw_frame(Opened& opened) {
  StageTimes times;
  const auto frame = draw(*opened.device, *opened.scene, opened.settings, times);
  if (!frame) return frame.error();
  return downloaded(*opened.device, *frame, true, opened.passes, opened.lines);
}

Result<Picture> draw_picture(const RenderRequest& request, std::vector<std::string>& warnings) {
  auto opened = open_model(request, warnings);
  if (!opened) return opened.error();
  return draw_frame(*opened);
}

/// What an effect makes, without the planes by which its own passes hand on to each other.
std::vector<std::string> passes_made(const std::string& effect, const ParameterBytes& params) {
  std::vector<std::string> planes;
  for (const Pass& pass : find_effect(effect)->passes) {
    if (pass.needed && !pass.needed(params)) continue;
    for (const std::string_view input : pass.inputs) std::erase(planes, input);
    for (const std::string_view plane : pass.outputs)
      if (layer_of_plane(plane) == 0 && pass_of(plane) != "color") planes.emplace_back(plane);
  }
  std::vector<std::string> names;
  for (const PassPlanes& group : grouped_planes(planes)) names.push_back(group.name);
  return names;
}

Result<Picture> shade_picture(const ShadeRequest& request) {
  DrawSettings settings;
  if (auto done = store_picture(request, settings); !done) return done.error();
  auto gbuffer = gbuffer_of(request);
  if (!gbuffer) return gbuffer.error();
  const auto lines = wanted_lines(request.strokes, settings, request.effects);
  if (!lines) return lines.error();
  auto device = make_device(request.device, request.threads);
  if (!device) return device.error();
  StageTimes times;
  const auto frame = shade_planes(**device, std::move(*gbuffer), settings, request.effects, times);
  if (!frame) return frame.error();
  const auto& effects = request.effects;
  const bool color = effects.empty() || std::find(effects.begin(), effects.end(), "output") != effects.end();
  std::vector<std::string> passes = request.passes;
  if (passes.empty() && !effects.empty()) {
    const auto all = effect_settings(settings.settings);
    if (!all) return all.error();
    passes = passes_made(effects.back(), all->find(effects.back())->second);
  }
  return downloaded(**device, *frame, color, passes, *lines);
}

/// One pass or the colour as planes of a file. Errors: kUsage where it is not of the picture's size.
Result<void> add_planes(const std::string& name, const std::vector<std::string>& channels,
                        const std::vector<float>& values, Image& image) {
  const std::size_t pixels = std::size_t(image.width) * std::size_t(image.height);
  if (channels.empty() || values.size() != pixels * channels.size())
    return usage_error("{} of a picture of {} x {} pixels cannot have {} values", name, image.width, image.height,
                       values.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (image.find(name + channels[c])) return usage_error("the picture has the pass '{}' twice", name);
    Plane& plane = image.add(name + channels[c]) = Plane(image.width, image.height);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        plane.at(x, y) = values[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * channels.size() + c];
  }
  return {};
}

/// A pass's channels by name, or by number where nobody knows the name.
std::vector<std::string> channels_to_write(const Pixels& pass) {
  auto channels = channels_of(pass.name);
  if (int(channels.size()) == pass.channels) return channels;
  channels = {".r", ".g", ".b", ".a"};
  if (pass.channels == 1) return {""};
  if (pass.channels < 1 || pass.channels > int(channels.size())) return {};
  channels.resize(std::size_t(pass.channels));
  return channels;
}

Result<void> write_picture(const Picture& picture, const std::string& file, const SaveRequest& request) {
  if (request.bits != 8 && request.bits != 16)
    return usage_error("--bits cannot be {}: it takes 8 or 16", request.bits);
  if (is_svg(file)) return write_strokes(picture, file);
  const auto format = format_of(file);
  if (!format) return Error{ErrorKind::kUsage, format.error().message};
  const bool holds_passes = (*format)->extension == "exr";
  if (picture.width < 1 || picture.height < 1) return usage_error("there is no picture to write to {}", file);
  if (auto writable = check_writable(file); !writable) return writable;
  Image image(picture.width, picture.height);
  if (!picture.rgba.empty()) {
    if (auto done = add_planes("color", {".r", ".g", ".b", ".a"}, picture.rgba, image); !done) return done;
    bool opaque = true;
    for (std::size_t k = 3; k < picture.rgba.size(); k += 4) opaque = opaque && picture.rgba[k] >= 1.0f;
    if (opaque) {
      image.names.pop_back();
      image.planes.pop_back();
    }
  } else if (!holds_passes) {
    if (picture.passes.size() != 1 || (picture.passes[0].channels != 1 && picture.passes[0].channels != 3))
      return usage_error("{} holds one picture of colours or one pass of 1 or 3 channels; write to a .exr file", file);
    const Pixels& pass = picture.passes[0];
    const std::vector<std::string> colors = {".r", ".g", ".b"};
    auto done = pass.channels == 1 ? add_planes(pass.name, {""}, pass.values, image)
                                   : add_planes("color", colors, pass.values, image);
    if (!done) return done;
  }
  if (holds_passes)
    for (const Pixels& pass : picture.passes)
      if (auto done = add_planes(pass.name, channels_to_write(pass), pass.values, image); !done) return done;
  return write_image(file, image, {.bits = request.bits, .half = request.half});
}

template <class Request>
std::string asked_for(const Request& request) {
  return fmt::format("a picture of {} x {} pixels", request.width, request.height);
}

std::string asked_for(const RenderRequest& request) {
  return fmt::format("a picture of {}, {} x {} pixels", request.model, request.width, request.height);
}

/// Says how it went. Nothing here can throw.
template <class T>
void conclude(Result<T>& done, Outcome& outcome) {
  if (done) return;
  outcome.code = int(done.error().kind);
  outcome.message = std::move(done.error().message);
}

/// The same, and takes over the picture if there is one.
void conclude(Result<Picture>& drawn, Picture& picture, Outcome& outcome) {
  conclude(drawn, outcome);
  if (drawn) picture = std::move(*drawn);
}

/// The picture that draw(request, warnings) makes, with the caller's Progress watched.
template <class Request, class Draw>
Outcome make_picture(const Request& request, Picture& picture, const Draw& draw) {
  Outcome outcome;
  CallersProgress progress;
  auto drawn = guarded([&] { return asked_for(request); },
                       [&] {
                         Request watched = request;
                         watched.progress = progress.watched(request.progress);
                         return draw(watched, outcome.warnings);
                       });
  progress.rethrow();
  conclude(drawn, picture, outcome);
  return outcome;
}

}  // namespace

inline namespace v0 {

Outcome render(const RenderRequest& request, Picture& picture) { return make_picture(request, picture, draw_picture); }

Outcome shade(const ShadeRequest& request, Picture& picture) {
  return make_picture(request, picture,
                      [](const ShadeRequest& watched, std::vector<std::string>&) { return shade_picture(watched); });
}

Outcome save(const Picture& picture, const std::string& file, const SaveRequest& request) {
  Outcome outcome;
  auto written = guarded([&] { return asked_for(picture); }, [&] { return write_picture(picture, file, request); });
  conclude(written, outcome);
  return outcome;
}

struct FrameRenderer::State {
  CallersProgress progress;
  std::string asked;  ///< for sentences
  Opened opened;
  Framing framing;  ///< as the request has it
  KeptPlanes kept;
};

FrameRenderer::FrameRenderer() = default;
FrameRenderer::~FrameRenderer() = default;
FrameRenderer::FrameRenderer(FrameRenderer&&) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&&) noexcept = default;

Outcome FrameRenderer::open(const RenderRequest& request) {
  Outcome outcome;
  std::unique_ptr<State> state;
  auto opened = guarded([&] { return asked_for(request); },
                        [&]() -> Result<void> {
                          state = std::make_unique<State>();
                          state->asked = asked_for(request);
                          RenderRequest watched = request;
                          watched.progress = state->progress.watched(request.progress);
                          auto model = open_model(watched, outcome.warnings);
                          if (!model) return model.error();
                          state->opened = std::move(*model);
                          state->framing = state->opened.settings.framing;
                          return {};
                        });
  if (state) state->progress.rethrow();
  conclude(opened, outcome);
  if (opened) state_ = std::move(state);
  return outcome;
}

namespace {

/// Where the next frame's camera stands. Errors: kUsage for one that cannot be.
Result<Framing> framing_of(const FrameCamera& camera, const Framing& requested) {
  if (!camera.placed) return requested;
  const auto vector = [](const float v[3]) { return glm::vec3(v[0], v[1], v[2]); };
  Framing framing;
  framing.position = vector(camera.eye);
  framing.focal_point = vector(camera.target);
  framing.view_up = vector(camera.up);
  framing.view_angle_deg = camera.angle_deg;
  const bool sound = glm::length(*framing.position - *framing.focal_point) > 0.0f &&
                     glm::length(*framing.view_up) > 0.0f && camera.angle_deg > 0.0f && camera.angle_deg < 180.0f;
  if (sound) return framing;
  return usage_error(
      "a camera needs an eye that is not its target, an upward direction, and an angle between 0 and 180 degrees, not "
      "{}",
      camera.angle_deg);
}

}  // namespace

Outcome FrameRenderer::draw(const FrameCamera& camera, Picture& picture) {
  Outcome outcome;
  auto drawn = guarded([&] { return state_ ? state_->asked : std::string("a picture"); },
                       [&]() -> Result<Picture> {
                         if (!state_) return usage_error("FrameRenderer::open comes before draw");
                         auto framing = framing_of(camera, state_->framing);
                         if (!framing) return framing.error();
                         state_->opened.settings.framing = std::move(*framing);
                         return draw_frame(state_->opened);
                       });
  if (state_) state_->progress.rethrow();
  conclude(drawn, picture, outcome);
  return outcome;
}

std::string FrameRenderer::device() const {
  if (!state_) return {};
  auto name = guarded([] { return std::string("a name"); },
                      [&] { return Result<std::string>(state_->opened.device->description()); });
  return name ? std::move(*name) : std::string();
}

unsigned long long FrameRenderer::device_bytes() const {
  return state_ ? vulkan_memory(*state_->opened.device).device_bytes : 0;
}

const char* version() { return UMBRAGE_VERSION; }

}  // namespace v0
}  // namespace umbrage
