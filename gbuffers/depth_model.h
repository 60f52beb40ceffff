// DepthModel: from the stored value of a depth image to view depth.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/pixel_grid.h"
#include "gbuffers/settings.h"

namespace umbrage {

inline constexpr double kNoDepth = std::numeric_limits<double>::infinity();

/// The meaning of `offset + scale * stored`; never kAuto.
struct DepthModel {
  DepthMeaning meaning = DepthMeaning::kPlanar;
  double scale = 1.0, offset = 0.0;
  double near_plane = 0.1, far_plane = kNoDepth;  ///< kWindow, kReversed
  double eye_height = 0.0;                        ///< kHeight: elevation of the camera
  bool orthographic = false;
  bool panorama = false;  ///< kDistance, by PixelGrid::direction
};

/// Returns view depth; infinity where there is no surface. `ray`: length of the pixel's ray at depth 1; 1 for an
/// orthographic camera.
inline double view_depth(const DepthModel& model, double stored, double ray) {
  if (!std::isfinite(stored)) return kNoDepth;
  const double v = model.offset + model.scale * stored, n = model.near_plane, f = model.far_plane;
  switch (model.meaning) {
    case DepthMeaning::kDistance:
      return v > 0.0 ? v / ray : kNoDepth;
    case DepthMeaning::kWindow: {
      if (v >= 1.0) return kNoDepth;
      const double t = std::max(v, 0.0);
      if (model.orthographic) return n + t * (f - n);
      return std::isfinite(f) ? n * f / (f - t * (f - n)) : n / (1.0 - t);
    }
    case DepthMeaning::kReversed: {
      if (v <= 0.0) return kNoDepth;
      const double t = std::min(v, 1.0);
      if (model.orthographic) return f - t * (f - n);
      return std::isfinite(f) ? n * f / (n + t * (f - n)) : n / t;
    }
    case DepthMeaning::kDisparity:
      return v > 0.0 ? 1.0 / v : kNoDepth;
    case DepthMeaning::kHeight:
      return std::max(model.eye_height - v, std::numeric_limits<double>::min());
    case DepthMeaning::kPlanar:
    case DepthMeaning::kAuto:
      break;
  }
  return v > 0.0 ? v : kNoDepth;
}

}  // namespace umbrage
