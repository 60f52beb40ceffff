// Draws one scene with varying settings and records the equivalent command line of each picture.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/figures/figures.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage {

/// A picture with its planes.
struct Shot {
  Image image;
  PictureInfo info;
  std::string command;

  float value(const char* plane, int x, int y) const { return image.plane(plane).at(x, y); }
  /// Returns whether a pixel shows a surface.
  bool surface(int x, int y) const;
  /// Returns the world position of the surface at a pixel's centre. Perspective cameras only.
  glm::vec3 world(int x, int y) const;
  /// Returns the rendered picture.
  FigurePicture picture(std::string file, std::string caption) const;
  /// Returns a pass as `umbrage --passes NAME` writes it to a PNG: a vector mapped from [-1, 1] to [0, 1], or one plane
  /// as grey.
  FigurePicture pass(const std::string& name, std::string file, std::string caption) const;
};

/// A prepared scene with the settings of its pictures.
struct Studio {
  Device& device;
  std::string model;
  std::shared_ptr<const Scene> scene;  ///< shared, not copied: the device refers to it
  Request draw;
  Framing framing;

  /// Draws a picture with these settings in addition to the studio's, and downloads these planes in addition to color
  /// and depth. `occlusion`: technique; empty: that of the look.
  Result<Shot> shoot(const std::vector<std::string>& settings, const std::string& occlusion = "",
                     const std::vector<std::string>& planes = {});
  /// Replaces the scene and prepares the device for it.
  Result<void> show(Scene other);
};

/// Returns the first error among some shots, if one failed.
template <class... Shots>
std::optional<Error> error_of(const Shots&... shots) {
  std::optional<Error> first;
  const auto check = [&](const auto& shot) {
    if (!first && !shot) first = shot.error();
  };
  (check(shots), ...);
  return first;
}

/// A figure to draw, with its name.
using FigurePart = std::pair<std::string, std::function<Result<Figure>()>>;

/// Draws figures one after the other.
Result<std::vector<Figure>> figures_of(const std::vector<FigurePart>& parts, const FigureSettings& settings);

/// Loads a model and prepares it for square pictures of `size` pixels per side.
Result<Studio> open_studio(Device& device, const std::string& model, const std::string& look, int size);

}  // namespace umbrage
