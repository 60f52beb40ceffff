// The public interface on top of a job.
#include "apps/job/job.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

Result<Picture> draw_picture(const RenderRequest& request, std::vector<std::string>& warnings) {
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
  auto device = make_device("cpu", request.threads);
  if (!device) return device.error();
  auto scene = load_scene(request.model);
  if (!scene) return scene.error();
  warnings = scene->warnings;
  furnish(*scene, settings);
  if (const auto ready = (*device)->prepare(*scene); !ready) return ready.error();
  StageTimes times;
  const auto frame = draw(**device, *scene, settings, times);
  if (!frame) return frame.error();
  const auto image = (*device)->download(*frame, {"color.r", "color.g", "color.b", "color.a"});
  if (!image) return image.error();
  Picture picture{image->width, image->height, {}};
  picture.rgba.reserve(std::size_t(image->width) * image->height * 4);
  for (int y = 0; y < image->height; ++y)
    for (int x = 0; x < image->width; ++x)
      for (const Plane& plane : image->planes) picture.rgba.push_back(plane.at(x, y));
  return picture;
}

}  // namespace

Outcome render(const RenderRequest& request, Picture& picture) {
  Outcome outcome;
  auto drawn = draw_picture(request, outcome.warnings);
  if (!drawn) {
    outcome.code = int(drawn.error().kind);
    outcome.message = drawn.error().message;
  } else {
    picture = std::move(*drawn);
  }
  return outcome;
}

const char* version() { return UMBRAGE_VERSION; }

}  // namespace umbrage
