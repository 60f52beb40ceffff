// Draws one scene again and again with other settings, and knows the command line that draws the same.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/figures/figures.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage {

/// One picture with the planes behind it.
struct Shot {
  Image image;
  PictureInfo info;
  std::string command;

  float value(const char* plane, int x, int y) const { return image.plane(plane).at(x, y); }
  bool surface(int x, int y) const;
  /// Where the surface at a pixel's centre lies. Perspective cameras only.
  glm::vec3 world(int x, int y) const;
  /// The finished picture.
  FigurePicture picture(std::string file, std::string caption) const;
  /// A pass as `umbrage --passes NAME` writes it to a PNG: `normal` moved from [-1, 1] to [0, 1], or a plane as grey.
  FigurePicture pass(const std::string& name, std::string file, std::string caption) const;
};

struct Studio {
  Device& device;
  std::string model;
  std::shared_ptr<const Scene> scene;  ///< which the device looks at where it lies
  Request draw;
  Framing framing;

  /// A picture with these settings besides the studio's own, and these planes besides color and depth. `occlusion`
  /// empty: the look's own.
  Result<Shot> shoot(const std::vector<std::string>& settings, const std::string& occlusion = "",
                     const std::vector<std::string>& planes = {});
  /// Puts up another scene.
  Result<void> show(Scene other);
};

/// The first error of some shots, if any of them failed.
template <class... Shots>
std::optional<Error> error_of(const Shots&... shots) {
  std::optional<Error> first;
  const auto look_at = [&](const auto& shot) {
    if (!first && !shot) first = shot.error();
  };
  (look_at(shots), ...);
  return first;
}

Result<Studio> open_studio(Device& device, const std::string& model, const std::string& look, int size);

}  // namespace umbrage
