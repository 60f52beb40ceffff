#include "apps/figures/studio.h"

#include <array>
#include <cmath>

namespace umbrage {
namespace {

constexpr std::array kChannels = {"color.r", "color.g", "color.b"};

std::string vector_text(glm::vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

}  // namespace

bool Shot::surface(int x, int y) const { return std::isfinite(value("depth", x, y)); }

glm::vec3 Shot::world(int x, int y) const {
  const Camera& c = info.camera;
  const float d = value("depth", x, y);
  const glm::vec4 view((c.left + (float(x) + 0.5f) / float(info.width) * (c.right - c.left)) * d,
                       (c.top - (float(y) + 0.5f) / float(info.height) * (c.top - c.bottom)) * d, -d, 1.0f);
  return glm::vec3(glm::inverse(c.view_from_world) * view);
}

FigurePicture Shot::picture(std::string file, std::string caption) const {
  Image color(image.width, image.height);
  for (const char* name : kChannels) color.add(name) = image.plane(name);
  return {std::move(file), std::move(caption), command, std::move(color)};
}

FigurePicture Shot::pass(const std::string& name, std::string file, std::string caption) const {
  constexpr std::array kAxes = {".x", ".y", ".z"};
  Image color(image.width, image.height);
  const bool vector = image.find(name) == nullptr;
  for (std::size_t k = 0; k < kChannels.size(); ++k) {
    Plane& plane = color.add(kChannels[k]);
    plane = image.plane(vector ? name + kAxes[k] : name);
    for (int y = 0; vector && y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = 0.5f * plane.at(x, y) + 0.5f;
  }
  return {std::move(file), std::move(caption), command + " --passes " + name, std::move(color)};
}

Result<Shot> Studio::shoot(const std::vector<std::string>& settings, const std::string& occlusion,
                           const std::vector<std::string>& planes) {
  Request request = draw;
  request.settings.insert(request.settings.end(), settings.begin(), settings.end());
  request.occlusion = occlusion;
  StageTimes times;
  auto recipe = make_recipe(request);
  if (!recipe) return recipe.error();
  recipe->framing = framing;
  auto frame = umbrage::draw(device, *scene, *recipe, times);
  if (!frame) return frame.error();
  std::vector<std::string> names = {kChannels.begin(), kChannels.end()};
  names.push_back("depth");
  names.insert(names.end(), planes.begin(), planes.end());
  auto image = device.download(*frame, names);
  if (!image) return image.error();
  std::string command = fmt::format("umbrage {} -o out.png --look {} --resolution {},{}", model, recipe->look->name,
                                    request.width, request.height);
  if (request.anti_aliasing) command += fmt::format(" --anti-aliasing {}", *request.anti_aliasing);
  if (!occlusion.empty()) command += " --ao " + occlusion;
  if (framing.position) command += " --camera-position=" + vector_text(*framing.position);
  if (framing.focal_point) command += " --camera-focal-point=" + vector_text(*framing.focal_point);
  if (framing.view_angle_deg) command += fmt::format(" --camera-view-angle={}", *framing.view_angle_deg);
  if (framing.azimuth_deg != 0.0f) command += fmt::format(" --camera-azimuth-angle={}", framing.azimuth_deg);
  if (framing.elevation_deg != 0.0f) command += fmt::format(" --camera-elevation-angle={}", framing.elevation_deg);
  if (framing.zoom != 1.0f) command += fmt::format(" --camera-zoom-factor={}", framing.zoom);
  if (framing.light_deg) command += fmt::format(" --light-direction={},{}", framing.light_deg->x, framing.light_deg->y);
  if (request.key != 1.0f) command += fmt::format(" --key {}", request.key);
  if (request.layers) command += fmt::format(" --layers {}", *request.layers);
  if (request.extra_views) command += fmt::format(" --extra-views {}", *request.extra_views);
  for (const std::string& setting : request.settings) command += " --set " + setting;
  return Shot{std::move(*image), frame->info, std::move(command)};
}

Result<void> Studio::show(Scene other) {
  scene = std::make_shared<const Scene>(std::move(other));
  return device.prepare(*scene);
}

Result<std::vector<Figure>> figures_of(const std::vector<FigurePart>& parts, const FigureSettings& settings) {
  std::vector<Figure> figures;
  for (const auto& [name, make] : parts) {
    settings.progress(name);
    auto figure = make();
    if (!figure) return figure.error();
    figures.push_back(std::move(*figure));
  }
  return figures;
}

Result<Studio> open_studio(Device& device, const std::string& model, const std::string& look, int size) {
  auto scene = load_scene(model);
  if (!scene) return scene.error();
  Studio studio{device, model, nullptr, {}};
  studio.draw.width = studio.draw.height = size;
  studio.draw.look = look;
  if (auto status = studio.show(std::move(*scene)); !status) return status.error();
  return studio;
}

}  // namespace umbrage
