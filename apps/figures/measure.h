// Measurements for the numbers of figures: pixel masks, means over masks, times of effects.
#pragma once
#include <cmath>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/image.h"
#include "core/result.h"
#include "looks/settings.h"

namespace umbrage {

/// The pixels that a measurement covers: nonzero entries, row by row from the top.
using Mask = std::vector<char>;

/// Calls visit(x, y) for the pixels of a mask, or for all pixels if it is null.
template <class Visit>
void for_each_pixel(const Image& image, const Mask* mask, const Visit& visit) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (!mask || (*mask)[std::size_t(y) * image.width + x]) visit(x, y);
}

/// Returns the mask of the pixels for which belongs(x, y) is true.
template <class Test>
Mask mask_of(const Image& image, const Test& belongs) {
  Mask mask(std::size_t(image.width) * image.height);
  for_each_pixel(image, nullptr, [&](int x, int y) { mask[std::size_t(y) * image.width + x] = belongs(x, y); });
  return mask;
}

/// Returns the mean of value(x, y) over a mask; NaN if the mask is empty.
template <class Value>
double mean(const Image& image, const Mask& mask, const Value& value) {
  double sum = 0.0;
  long count = 0;
  for_each_pixel(image, &mask, [&](int x, int y) { sum += value(x, y), ++count; });
  return count > 0 ? sum / double(count) : std::nan("");
}

/// The three planes of a vector, such as `normal` or `tangent`.
struct VectorPlanes {
  const Plane &x, &y, &z;
  VectorPlanes(const Image& image, const std::string& name)
      : x(image.plane(name + ".x")), y(image.plane(name + ".y")), z(image.plane(name + ".z")) {}
  glm::vec3 at(int column, int row) const { return {x.at(column, row), y.at(column, row), z.at(column, row)}; }
};

/// Returns, for each pixel, the min of a plane within `columns` columns and `rows` rows.
Plane min_near(const Plane& plane, int columns, int rows);

/// Returns the pixels of a mask for which all pixels within `reach` rows and columns are in the mask too.
Mask eroded(const Image& image, const Mask& mask, int reach);

/// Returns the mean of the three color planes of a pixel, each clamped to [0, 1].
double brightness(const Image& image, int x, int y);
double mean_brightness(const Image& image, const Mask& mask);

/// Returns by how much the mean brightness of `to` is below that of `from`.
double brightness_drop(const Image& from, const Image& to, const Mask& mask);

/// Returns the fraction of a mask's pixels whose brightness is below half a step of an 8-bit picture.
double black_fraction(const Image& image, const Mask& mask);

/// Returns the fraction of a mask's pixels whose brightness differs between `a` and `b`.
double changed_fraction(const Image& a, const Image& b, const Mask& mask);

double median(std::vector<double> values);

/// Returns the mean of the three color planes over a mask, each clamped to [0, 1].
glm::dvec3 mean_color(const Image& image, const Mask& mask);

/// Returns the angle between the hues of two colors, 0 to 180 degrees. The mean of a color's channels does not count.
double hue_difference_deg(glm::dvec3 a, glm::dvec3 b);

/// Returns the number of pixels whose value exceeds eight times the median of the 5 x 5 pixels around them, and eight
/// times `min_median`. Pixels within two of the border do not count.
long count_sparks(const Plane& plane, float min_median);

/// Returns the distance in which a profile falls from 90 % to 10 % of its max, behind the max, in entries; NaN if it
/// does not fall so far. Values between two entries are interpolated.
double width_of_fall(const std::vector<double>& profile);

/// Returns the median time of an effect on a frame, in milliseconds.
Result<double> time_of(Device& device, const Effect& effect, const EffectSettings& settings, Frame& frame, int runs);

}  // namespace umbrage
