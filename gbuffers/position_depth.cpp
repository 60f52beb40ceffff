#include "gbuffers/position_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace umbrage {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The values of the positions, by axis.
using Axes = std::array<const TapValues*, 3>;

double depth_of(const Axes& axes, const PositionConvention& position, std::size_t tap, std::size_t k) {
  const glm::dvec3 p((*axes[0])[tap][k], (*axes[1])[tap][k], (*axes[2])[tap][k]);
  if (p == glm::dvec3(0.0)) return kNan;
  const double depth = glm::dot(position.forward, p - position.eye);
  return depth > 0.0 && !is_never_depth(depth) ? depth : kNan;
}

/// Returns the fraction of positions that are in front of the camera.
double fraction_in_front(const Samples& samples, const PositionConvention& position) {
  const Axes axes = samples.find_three(Role::kPosition);
  std::size_t front = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) front += std::size_t(depth_of(axes, position, kCenter, k) > 0.0);
  return samples.size() == 0 ? 0.0 : double(front) / double(samples.size());
}

}  // namespace

void use_positions(const Samples& samples, const std::optional<ProjectionFit>& fit, const KnownCamera& known,
                   PositionConvention& position, DepthValues& values, DepthModel& model) {
  if (fit) {
    position = {fit->forward, fit->eye};
  } else {
    std::vector<PositionConvention> choices;
    if (known.has_view) {
      const glm::dmat4 view(known.camera.view_from_world);
      choices.push_back({-glm::dvec3(view[0][2], view[1][2], view[2][2]), glm::dvec3(known.camera.eye())});
    }
    choices.push_back({{0.0, 0.0, -1.0}, {}});
    choices.push_back({{0.0, 0.0, 1.0}, {}});
    position = *std::max_element(choices.begin(), choices.end(), [&](const auto& a, const auto& b) {
      return fraction_in_front(samples, a) < fraction_in_front(samples, b);
    });
  }
  model = DepthModel{};
  values.max_integer = 0.0;
  values.taps.assign(samples.size(), {});
  const Axes axes = samples.find_three(Role::kPosition);
  std::vector<double> depths;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (std::size_t tap = 0; tap < kTaps; ++tap) values.taps[k][tap] = depth_of(axes, position, tap, k);
    if (std::isfinite(values.taps[k][kCenter])) depths.push_back(values.taps[k][kCenter]);
  }
  values.surfaces = depths.size();
  if (depths.empty()) return;
  values.min = *std::min_element(depths.begin(), depths.end());
  values.max = *std::max_element(depths.begin(), depths.end());
}

}  // namespace umbrage
