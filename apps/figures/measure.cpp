#include "apps/figures/measure.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <numbers>

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

glm::dvec3 mean_color(const Image& image, const Mask& mask) {
  const auto channel = [&](const char* name) {
    const Plane& plane = image.plane(name);
    return mean(image, mask, [&](int x, int y) { return std::clamp(plane.at(x, y), 0.0f, 1.0f); });
  };
  return {channel("color.r"), channel("color.g"), channel("color.b")};
}

double hue_difference_deg(glm::dvec3 a, glm::dvec3 b) {
  const auto chroma = [](glm::dvec3 v) { return glm::normalize(v - (v.x + v.y + v.z) / 3.0); };
  return std::acos(std::clamp(glm::dot(chroma(a), chroma(b)), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

long count_sparks(const Plane& plane, float min_median) {
  constexpr int kReach = 2;
  constexpr float kFactor = 8.0f;
  long count = 0;
  for (int y = kReach; y < plane.height - kReach; ++y)
    for (int x = kReach; x < plane.width - kReach; ++x) {
      if (!(plane.at(x, y) > kFactor * min_median)) continue;
      std::array<float, (2 * kReach + 1) * (2 * kReach + 1)> near;
      std::size_t k = 0;
      for (int j = -kReach; j <= kReach; ++j)
        for (int i = -kReach; i <= kReach; ++i) near[k++] = plane.at(x + i, y + j);
      const auto middle = near.begin() + near.size() / 2;
      std::nth_element(near.begin(), middle, near.end());
      count += plane.at(x, y) > kFactor * *middle;
    }
  return count;
}

double width_of_fall(const std::vector<double>& profile) {
  if (profile.empty()) return std::nan("");
  const auto max = std::max_element(profile.begin(), profile.end());
  const auto crossing = [&](double level) {
    for (auto at = max; at + 1 < profile.end(); ++at)
      if (at[1] < level) return double(at - profile.begin()) + (*at - level) / (*at - at[1]);
    return std::nan("");
  };
  return crossing(0.1 * *max) - crossing(0.9 * *max);
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
