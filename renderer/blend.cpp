#include "renderer/blend.h"

#include <algorithm>
#include <array>

#include "core/lists.h"
#include "core/strip.h"

namespace umbrage {
namespace {

constexpr const char* kOpacityPlane = "opacity";
constexpr std::array<const char*, 3> kTransmittancePlanes = {"transmittance.r", "transmittance.g", "transmittance.b"};

/// Multiplies rows of a plane by a weight.
void multiply(Plane& plane, const Rows& rows, const auto& weight) {
  for (int y = rows.begin; y < rows.end; ++y) {
    float* row = plane.row(y);
    for (int x = 0; x < plane.width; ++x) {
      const float factor = weight(x, y);
      row[x] = factor == 0.0f ? 0.0f : row[x] * factor;  // the value may be undefined there
    }
  }
}

/// Returns the rows of a picture, which begin with `first`, that are rows of `part`, too, which begins with `begin`.
Rows rows_in(const Image& rows, int first, const Image& part, int begin) {
  return {std::max(begin - first, 0), std::min(begin - first + part.height, rows.height)};
}

/// Returns the index of the plane's colour channel, or -1 if it has none.
int channel_of(std::string_view name) {
  if (name.size() < 2 || name[name.size() - 2] != '.') return -1;
  const std::size_t channel = std::string_view("rgb").find(name.back());
  return channel == std::string_view::npos ? -1 : int(channel);
}

/// Returns the strength of lines of a surface that covers this fraction of a pixel.
float line_weight(float fraction) { return std::min(fraction / kGlassOpacity, 1.0f); }

}  // namespace

std::vector<std::string> with_blend_planes(std::vector<std::string> names) {
  names.emplace_back(kOpacityPlane);
  names.insert(names.end(), kTransmittancePlanes.begin(), kTransmittancePlanes.end());
  return names;
}

void BlendedSample::take_front(Image& rows, const std::vector<std::string>& lines, int first) {
  const std::vector<std::string> weight_names = with_blend_planes({});
  Image weights(rows.width, rows.height), own_lines = weights, others = weights;
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    const std::string& name = rows.names[k];
    Image& to = contains(weight_names, name) ? weights : contains(lines, name) ? own_lines : others;
    to.add(name) = std::move(rows.planes[k]);
  }
  rows = std::move(others);
  const Plane& opacity = weights.plane(kOpacityPlane);
  const Rows all{0, rows.height};
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    // Colour has straight alpha: its alpha has the weight.
    const bool straight = rows.names[k].starts_with("color.") && channel_of(rows.names[k]) >= 0;
    multiply(rows.planes[k], all, [&](int x, int y) {
      const float weight = opacity.row(y)[x];
      return straight && weight > 0.0f ? 1.0f : weight;
    });
  }
  if (!own_lines.planes.empty()) {
    for (Plane& plane : own_lines.planes)
      multiply(plane, all, [&](int x, int y) { return line_weight(opacity.row(y)[x]); });
    own_lines.add(kOpacityPlane) = opacity;
    lines_[first] = std::move(own_lines);
  }
  weights_[first] = std::move(weights);
}

void BlendedSample::weigh_behind(Image& rows, int first) {
  for (const auto& [begin, weights] : weights_) {
    const Rows both = rows_in(rows, first, weights, begin);
    const int offset = first - begin;  // of a row in the weights
    const Plane& opacity = weights.plane(kOpacityPlane);
    for (std::size_t k = 0; k < rows.names.size(); ++k) {
      const int channel = channel_of(rows.names[k]);
      if (channel < 0) {
        multiply(rows.planes[k], both, [&](int x, int y) { return 1.0f - opacity.row(y + offset)[x]; });
        continue;
      }
      const Plane& transmittance = weights.plane(kTransmittancePlanes[std::size_t(channel)]);
      const bool straight = rows.names[k].starts_with("color.");
      multiply(rows.planes[k], both, [&](int x, int y) {
        const float passing = transmittance.row(y + offset)[x], clear = 1.0f - opacity.row(y + offset)[x];
        return straight ? passing / std::max(clear, 1e-6f) : passing;
      });
    }
  }
  std::erase_if(weights_, [&](const auto& each) {
    return each.first >= first && each.first + each.second.height <= first + rows.height;
  });
}

void BlendedSample::join_lines(Image& rows, int first) const {
  for (const auto& [begin, lines] : lines_)
    for (const std::string& name : lines.names) {
      if (name == kOpacityPlane) continue;
      const Rows both = rows_in(rows, first, lines, begin);
      for (int y = both.begin; y < both.end; ++y) {
        const int in_front = y + first - begin;
        const float *front = lines.plane(name).row(in_front), *opacity = lines.plane(kOpacityPlane).row(in_front);
        float* row = rows.plane(name).row(y);
        for (int x = 0; x < rows.width; ++x) row[x] = std::max(row[x] * line_weight(1.0f - opacity[x]), front[x]);
      }
    }
}

}  // namespace umbrage
