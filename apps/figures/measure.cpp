#include "apps/figures/measure.h"

#include <algorithm>

#include "renderer/times.h"

namespace umbrage {

Plane min_near(const Plane& plane, int columns, int rows) {
  const auto along = [](const Plane& in, int reach, int step_x, int step_y) {
    Plane out = in;
    for (int y = 0; y < in.height; ++y)
      for (int x = 0; x < in.width; ++x)
        for (int k = -reach; k <= reach; ++k) {
          const int u = x + k * step_x, v = y + k * step_y;
          if (u >= 0 && v >= 0 && u < in.width && v < in.height) out.at(x, y) = std::min(out.at(x, y), in.at(u, v));
        }
    return out;
  };
  return along(along(plane, columns, 1, 0), rows, 0, 1);
}

Mask eroded(const Image& image, const Mask& mask, int reach) {
  Plane plane(image.width, image.height, 0.0f);
  for_each_pixel(image, &mask, [&](int x, int y) { plane.at(x, y) = 1.0f; });
  const Plane min = min_near(plane, reach, reach);
  return mask_of(image, [&](int x, int y) { return min.at(x, y) > 0.0f; });
}

double brightness(const Image& image, int x, int y) {
  double sum = 0.0;
  for (const char* name : {"color.r", "color.g", "color.b"})
    sum += std::clamp(image.plane(name).at(x, y), 0.0f, 1.0f) / 3.0;
  return sum;
}

double mean_brightness(const Image& image, const Mask& mask) {
  return mean(image, mask, [&](int x, int y) { return brightness(image, x, y); });
}

double brightness_drop(const Image& from, const Image& to, const Mask& mask) {
  return mean_brightness(from, mask) - mean_brightness(to, mask);
}

double black_fraction(const Image& image, const Mask& mask) {
  constexpr double kBlack = 0.5 / 255.0;
  return mean(image, mask, [&](int x, int y) { return brightness(image, x, y) < kBlack; });
}

double changed_fraction(const Image& a, const Image& b, const Mask& mask) {
  return mean(a, mask, [&](int x, int y) { return brightness(a, x, y) != brightness(b, x, y); });
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Result<double> time_of(Device& device, const Effect& effect, const EffectSettings& settings, Frame& frame, int runs) {
  std::vector<double> ms;
  for (int i = 0; i < runs; ++i) {
    StageTimes times;
    if (auto status = device.run(effect, params_of(settings, effect.name), frame); !status) return status.error();
    times.done("run");
    ms.push_back(times.total());
  }
  return median(ms);
}

}  // namespace umbrage
