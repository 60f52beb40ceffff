// Legends of a picture: a colour bar of its values, a scale bar, and the directions of the axes.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/drawing.h"
#include "core/result.h"
#include "scene/value_colors.h"

namespace umbrage::cli {

/// What the options ask for.
struct LegendSettings {
  bool color_bar = false, scale_bar = false, axes = false;
  std::string title;        ///< of the colour bar; empty: the name of the field
  std::string length_unit;  ///< of the model's lengths, for the scale bar; empty: none
  float font_size = 0.0f;   ///< pixels; 0: by the size of the picture
  DrawnColor ink{};         ///< of lines and texts

  bool any() const { return color_bar || scale_bar || axes; }
};

/// Returns black or white, whichever is easier to read on a background.
DrawnColor ink_on(const DrawnColor& background);

/// Min width and height of a picture with legends, pixels: letters in a smaller one cannot be read.
inline constexpr int kMinLegendSide = 84;

/// Returns the size of the font of a picture, pixels, whose shorter side is `side`.
float font_size_for(const LegendSettings& settings, float side);

/// Returns the fraction of a picture's width at the right, and of its height at the bottom, that legends take.
glm::vec2 legend_space(const LegendSettings& settings, int width, int height);

/// A tick of a colour bar.
struct Tick {
  double place = 0.0;  ///< 0 at the low end, 1 at the high end
  std::string label;
};

/// The ticks of a colour bar, in ascending order.
struct Ticks {
  std::vector<Tick> all;
  std::string factor;  ///< of the labels, as text; empty: 1
};

/// Returns ticks at round numbers, about `max_count` at most. Bands have ticks at each n-th of their limits.
Ticks ticks_of(const ValueColors& values, int max_count);

/// Returns the largest of 1, 2 and 5 times a power of ten that is at most `max`, which is above 0.
double round_length(double max);

/// Returns a layer for each legend of a picture of width x height pixels: "color-bar", "scale-bar" and "axes".
/// `camera`: of the picture. In perspective the scale holds at the depth of the scene's centre. Errors: kUsage if there
/// are no values for a colour bar, or the centre is not in front of a perspective camera; kFile if the font is not
/// installed.
Result<std::vector<DrawnLayer>> legends_of(const LegendSettings& settings, const Scene& scene, const Camera& camera,
                                           int width, int height);

}  // namespace umbrage::cli
