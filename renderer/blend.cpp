#include "renderer/blend.h"

#include <algorithm>
#include <array>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr const char* kOpacityPlane = "opacity";
constexpr std::array<const char*, 3> kTransmittancePlanes = {"transmittance.r", "transmittance.g", "transmittance.b"};

void multiply(Plane& plane, const auto& weight) {
  for (int y = 0; y < plane.height; ++y) {
    float* row = plane.row(y);
    for (int x = 0; x < plane.width; ++x) {
      const float factor = weight(x, y);
      row[x] = factor == 0.0f ? 0.0f : row[x] * factor;  // the value may be undefined there
    }
  }
}

/// Returns the index of the plane's colour channel, or -1 if it has none.
int channel_of(std::string_view name) {
  if (name.size() < 2 || name[name.size() - 2] != '.') return -1;
  const std::size_t channel = std::string_view("rgb").find(name.back());
  return channel == std::string_view::npos ? -1 : int(channel);
}

/// Returns the strength of lines of a surface that covers this fraction of a pixel.
float line_weight(float fraction) { return std::min(fraction / kGlassOpacity, 1.0f); }

void copy_rows(const Image& rows, const std::vector<std::string>& names, int first, int height, Image& whole) {
  if (whole.planes.empty()) {
    whole = Image(rows.width, height);
    for (const std::string& name : names)
      whole.add(name) = Plane(rows.width, height, name.starts_with("transmittance") ? 1.0f : 0.0f);
  }
  check_less(first + rows.height, whole.height + 1, "rows of a picture");
  for (const std::string& name : names)
    for (int y = 0; y < rows.height; ++y)
      std::copy_n(rows.plane(name).row(y), rows.width, whole.plane(name).row(first + y));
}

}  // namespace

std::vector<std::string> with_blend_planes(std::vector<std::string> names) {
  names.emplace_back(kOpacityPlane);
  names.insert(names.end(), kTransmittancePlanes.begin(), kTransmittancePlanes.end());
  return names;
}

void BlendedSample::take_front(Image& rows, int first, int height) {
  if (rows.height == 0) return;
  copy_rows(rows, with_blend_planes({}), first, height, weights_);
  Image others(rows.width, rows.height);
  const Plane& opacity = weights_.plane(kOpacityPlane);
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    if (weights_.find(rows.names[k])) continue;
    Plane& plane = others.add(rows.names[k]) = std::move(rows.planes[k]);
    // Colour has straight alpha: its alpha has the weight.
    const bool straight = rows.names[k].starts_with("color.") && channel_of(rows.names[k]) >= 0;
    multiply(plane, [&](int x, int y) {
      const float weight = opacity.row(first + y)[x];
      return straight && weight > 0.0f ? 1.0f : weight;
    });
  }
  rows = std::move(others);
}

void BlendedSample::weigh_behind(Image& rows, int first) const {
  const Plane& opacity = weights_.plane(kOpacityPlane);
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    const int channel = channel_of(rows.names[k]);
    if (channel < 0) {
      multiply(rows.planes[k], [&](int x, int y) { return 1.0f - opacity.row(first + y)[x]; });
      continue;
    }
    const Plane& transmittance = weights_.plane(kTransmittancePlanes[std::size_t(channel)]);
    const bool straight = rows.names[k].starts_with("color.");
    multiply(rows.planes[k], [&](int x, int y) {
      const float passing = transmittance.row(first + y)[x], clear = 1.0f - opacity.row(first + y)[x];
      return straight ? passing / std::max(clear, 1e-6f) : passing;
    });
  }
}

void BlendedSample::take_lines(const Image& rows, const std::vector<std::string>& names, int first, int height) {
  if (rows.height == 0) return;
  copy_rows(rows, names, first, height, lines_);
  const Plane& opacity = weights_.plane(kOpacityPlane);
  for (const std::string& name : names)
    for (int y = first; y < first + rows.height; ++y)
      for (int x = 0; x < rows.width; ++x) lines_.plane(name).row(y)[x] *= line_weight(opacity.row(y)[x]);
}

void BlendedSample::join_lines(Image& rows, int first) const {
  for (const std::string& name : lines_.names)
    for (int y = 0; y < rows.height; ++y) {
      const float *front = lines_.plane(name).row(first + y), *opacity = weights_.plane(kOpacityPlane).row(first + y);
      float* row = rows.plane(name).row(y);
      for (int x = 0; x < rows.width; ++x) row[x] = std::max(row[x] * line_weight(1.0f - opacity[x]), front[x]);
    }
}

}  // namespace umbrage
