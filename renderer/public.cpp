// The public interface: requests, recipes, plans and pictures in plain types.
#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "core/guarded.h"
#include "core/image.h"
#include "devices/vulkan/vulkan_device.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "io/svg.h"
#include "renderer/arrays.h"
#include "renderer/callers_progress.h"
#include "renderer/devices.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "renderer/passes.h"
#include "renderer/strokes.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

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
  Recipe recipe;
  ProgressMonitor monitor;
  ParameterBytes lines;  // where strokes are wanted
};

Result<Opened> open_model(const RenderRequest& request, std::vector<std::string>& warnings) {
  // All of it comes before the drawing, which is what shares are told of.
  ProgressMonitor before;
  if (request.progress) before = [&](double) { return request.progress(0.0); };
  const auto going_on = [&] { return !before || before(0.0); };
  auto recipe = make_recipe(request);
  if (!recipe) return recipe.error();
  const auto import_with = import_settings(request);
  if (!import_with) return import_with.error();
  auto lines = wanted_lines(request.strokes, *recipe);
  if (!lines) return lines.error();
  auto device = make_device(request.device, request.threads);
  if (!device) return device.error();
  if (!going_on()) return interrupted();
  const auto hdri_warnings = read_hdri(recipe->hdri, before);
  if (!hdri_warnings) return hdri_warnings.error();
  std::vector<std::string> models = {request.model};
  models.insert(models.end(), request.more_models.begin(), request.more_models.end());
  auto scene = load_scenes(models, *import_with, before);
  if (!scene) return scene.error();
  if (recipe->camera_index)
    if (auto used = use_camera(*recipe->camera_index, *scene); !used) return used.error();
  warnings = *hdri_warnings;
  warnings.insert(warnings.end(), scene->warnings.begin(), scene->warnings.end());
  if (!going_on()) return interrupted();
  furnish(*scene, *recipe);
  Opened opened{std::move(*device), std::make_unique<Scene>(std::move(*scene)), std::move(*recipe), request.progress,
                std::move(*lines)};
  if (const auto ready = opened.device->prepare(*opened.scene, before); !ready) return ready.error();
  return opened;
}

Result<Picture> draw_frame(Opened& opened) {
  StageTimes times;
  ProgressMonitor before;
  if (opened.monitor) before = [&](double) { return opened.monitor(0.0); };
  const auto plan = make_plan(opened.recipe, *opened.scene, opened.device->threads(), before);
  if (!plan) return plan.error();
  opened.recipe.capture.lighting = plan->lighting();  // of all frames
  const auto drawn = draw(*opened.device, *opened.scene, *plan, times, opened.monitor);
  if (!drawn) return drawn.error();
  return downloaded(*opened.device, drawn->frame, true, opened.recipe.passes, opened.lines);
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
  const auto recipe = make_recipe(request);
  if (!recipe) return recipe.error();
  auto shared = gbuffer_of(request);
  if (!shared) return shared.error();
  const auto lines = wanted_lines(request.strokes, *recipe);
  if (!lines) return lines.error();
  auto device = make_device(request.device, request.threads);
  if (!device) return device.error();
  StageTimes times;
  const auto frame = shade_planes(**device, std::move(shared->gbuffer), *recipe, times, request.progress);
  if (!frame) return frame.error();
  const auto& effects = request.effects;
  const bool color = effects.empty() || std::find(effects.begin(), effects.end(), "output") != effects.end();
  std::vector<std::string> passes = request.passes;
  if (passes.empty() && !effects.empty())
    passes = passes_made(effects.back(), params_of(recipe->settings, effects.back()));
  auto picture = downloaded(**device, *frame, color, passes, *lines);
  if (picture) give_back_ids(shared->ids, *picture);
  return picture;
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
  RenderRequest ignored;  // `bits` has no field in it
  if (auto fine = set_option(option_of("bits"), fmt::format("{}", request.bits), ignored); !fine) return fine;
  if (is_svg(file)) return write_strokes(picture, file);
  const auto format = format_of(file);
  if (!format) return Error{ErrorKind::kUsage, format.error().message};
  const bool holds_passes = (*format)->extension == "exr";
  if (picture.width < 1 || picture.height < 1) return usage_error("there is no picture to write to '{}'", file);
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
      return usage_error("'{}' holds one picture of colours or one pass of 1 or 3 channels; write to a .exr file",
                         file);
    const Pixels& pass = picture.passes[0];
    const std::vector<std::string> colors = {".r", ".g", ".b"};
    auto done = pass.channels == 1 ? add_planes(pass.name, {""}, pass.values, image)
                                   : add_planes("color", colors, pass.values, image);
    if (!done) return done;
  }
  WriteSettings settings{.bits = request.bits, .half = request.half};
  if (holds_passes)
    for (const Pixels& pass : picture.passes) {
      std::vector<float> bits;
      for (const std::uint32_t id : pass.ids) bits.push_back(std::bit_cast<float>(id));
      if (!bits.empty()) settings.whole_numbers.push_back(pass.name);
      const auto& values = bits.empty() ? pass.values : bits;
      if (auto done = add_planes(pass.name, channels_to_write(pass), values, image); !done) return done;
    }
  return write_image(file, image, settings);
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
  Framing framing;               ///< as the request has it
  std::optional<HeldPool> held;  ///< from frame to frame
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
                          state->held.emplace(state->opened.device->pool());
                          state->framing = state->opened.recipe.framing;
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
                         state_->opened.recipe.framing = std::move(*framing);
                         const KeptPlanes kept(state_->opened.device->pool());
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
