// What the figures' numbers are made of: masks of pixels, means over them, times of effects.
#pragma once
#include <cmath>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/image.h"
#include "core/result.h"

namespace umbrage {

/// Which pixels a number is read from.
using Mask = std::vector<char>;

/// Calls visit(x, y) for the pixels of a mask, or for all.
template <class Visit>
void each(const Image& image, const Mask* mask, const Visit& visit) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (!mask || (*mask)[std::size_t(y) * image.width + x]) visit(x, y);
}

template <class Test>
Mask mask_of(const Image& image, const Test& belongs) {
  Mask mask(std::size_t(image.width) * image.height);
  each(image, nullptr, [&](int x, int y) { mask[std::size_t(y) * image.width + x] = belongs(x, y); });
  return mask;
}

/// Mean of value(x, y) over a mask; no number where it is empty.
template <class Value>
double mean(const Image& image, const Mask& mask, const Value& value) {
  double sum = 0.0;
  long count = 0;
  each(image, &mask, [&](int x, int y) { sum += value(x, y), ++count; });
  return count > 0 ? sum / double(count) : std::nan("");
}

/// The three planes of a vector, `normal` or `tangent`.
struct VectorPlanes {
  const Plane &x, &y, &z;
  VectorPlanes(const Image& image, const std::string& name)
      : x(image.plane(name + ".x")), y(image.plane(name + ".y")), z(image.plane(name + ".z")) {}
  glm::vec3 at(int column, int row) const { return {x.at(column, row), y.at(column, row), z.at(column, row)}; }
};

/// The least value of a plane within so many columns and rows.
Plane least_near(const Plane& plane, int columns, int rows);

/// Which pixels have no other kind within `reach` rows and columns.
Mask eroded(const Image& image, const Mask& mask, int reach);

/// Mean of the finished picture's three colours, each cut to [0, 1].
double brightness(const Image& image, int x, int y);
double mean_brightness(const Image& image, const Mask& mask);

/// How much a picture is darker than another.
double fall(const Image& from, const Image& to, const Mask& mask);

/// Share of a mask's pixels that are as good as black.
double black_share(const Image& image, const Mask& mask);

/// Share of a mask's pixels that differ at all.
double changed_share(const Image& a, const Image& b, const Mask& mask);

double median(std::vector<double> values);

/// Median time of an effect on a frame that it has been run on before.
Result<double> time_of(Device& device, const Effect& effect, const ParameterBytes& params, Frame& frame, int runs);

}  // namespace umbrage
