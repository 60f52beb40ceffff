// The public interface on top of a job.
#include <glm/geometric.hpp>

#include "apps/job/job.h"
#include "core/image.h"
#include "devices/vulkan/vulkan_device.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

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
  settings.look = request.look;
  settings.occlusion = request.occlusion;
  settings.settings = request.settings;
  if (const auto recipe = make_recipe(settings); !recipe) return recipe.error();
  return settings;
}

Result<Picture> downloaded(Device& device, const Frame& frame) {
  const auto image = device.download(frame, {"color.r", "color.g", "color.b", "color.a"});
  if (!image) return image.error();
  Picture picture{image->width, image->height, {}};
  picture.rgba.reserve(std::size_t(image->width) * image->height * 4);
  for (int y = 0; y < image->height; ++y)
    for (int x = 0; x < image->width; ++x)
      for (const Plane& plane : image->planes) picture.rgba.push_back(plane.at(x, y));
  return picture;
}

/// A model on a device, ready to be drawn.
struct Opened {
  std::unique_ptr<Device> device;
  std::unique_ptr<Scene> scene;  // devices point to it
  DrawSettings settings;
};

Result<Opened> open_model(const RenderRequest& request, const std::string& device_name,
                          std::vector<std::string>& warnings) {
  auto settings = draw_settings(request);
  if (!settings) return settings.error();
  auto device = make_device(device_name, request.threads);
  if (!device) return device.error();
  auto scene = load_scene(request.model);
  if (!scene) return scene.error();
  warnings = scene->warnings;
  furnish(*scene, *settings);
  Opened opened{std::move(*device), std::make_unique<Scene>(std::move(*scene)), std::move(*settings)};
  if (const auto ready = opened.device->prepare(*opened.scene); !ready) return ready.error();
  return opened;
}

Result<Picture> draw_frame(Opened& opened) {
  StageTimes times;
  const auto frame = draw(*opened.device, *opened.scene, opened.settings, times);
  if (!frame) return frame.error();
  return downloaded(*opened.device, *frame);
}

Result<Picture> draw_picture(const RenderRequest& request, std::vector<std::string>& warnings) {
  auto opened = open_model(request, "cpu", warnings);
  if (!opened) return opened.error();
  return draw_frame(*opened);
}

/// Says how it went; takes over the picture if there is one.
void conclude(Result<Picture> drawn, Picture& picture, Outcome& outcome) {
  if (drawn) {
    picture = std::move(*drawn);
    return;
  }
  outcome.code = int(drawn.error().kind);
  outcome.message = drawn.error().message;
}

}  // namespace

Outcome render(const RenderRequest& request, Picture& picture) {
  Outcome outcome;
  conclude(draw_picture(request, outcome.warnings), picture, outcome);
  return outcome;
}

struct FrameRenderer::State {
  Opened opened;
  KeptPlanes kept;
};

FrameRenderer::FrameRenderer() = default;
FrameRenderer::~FrameRenderer() = default;
FrameRenderer::FrameRenderer(FrameRenderer&&) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&&) noexcept = default;

Outcome FrameRenderer::open(const RenderRequest& request, const std::string& device) {
  Outcome outcome;
  auto opened = open_model(request, device, outcome.warnings);
  if (!opened) {
    outcome.code = int(opened.error().kind);
    outcome.message = opened.error().message;
    return outcome;
  }
  state_ = std::make_unique<State>();
  state_->opened = std::move(*opened);
  return outcome;
}

Outcome FrameRenderer::draw(const FrameCamera& camera, Picture& picture) {
  Outcome outcome;
  if (!state_) {
    conclude(usage_error("FrameRenderer::open comes before draw"), picture, outcome);
    return outcome;
  }
  Framing& framing = state_->opened.settings.framing = {};
  const auto vector = [](const float v[3]) { return glm::vec3(v[0], v[1], v[2]); };
  if (camera.placed) {
    framing.position = vector(camera.eye);
    framing.focal_point = vector(camera.target);
    framing.view_up = vector(camera.up);
    framing.view_angle_deg = camera.angle_deg;
    const bool sound = glm::length(*framing.position - *framing.focal_point) > 0.0f &&
                       glm::length(*framing.view_up) > 0.0f && camera.angle_deg > 0.0f && camera.angle_deg < 180.0f;
    if (!sound) {
      conclude(usage_error("a camera needs an eye that is not its target, an upward direction, and an angle between 0 "
                           "and 180 degrees, not {}",
                           camera.angle_deg),
               picture, outcome);
      return outcome;
    }
  }
  conclude(draw_frame(state_->opened), picture, outcome);
  return outcome;
}

std::string FrameRenderer::device() const { return state_ ? state_->opened.device->description() : std::string(); }

unsigned long long FrameRenderer::device_bytes() const {
  return state_ ? vulkan_memory(*state_->opened.device).device_bytes : 0;
}

const char* version() { return UMBRAGE_VERSION; }

}  // namespace umbrage
