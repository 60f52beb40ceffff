#include "devices/cpu/soften.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace umbrage {
namespace {

constexpr int kReach = 2;
constexpr std::array<float, 2 * kReach + 1> kWeights = {0.5f, 1.0f, 1.0f, 1.0f, 0.5f};  // any four in a row count alike
constexpr float kOffPlane = 1.5f;                                                       // pixel sizes
constexpr float kFacing = 0.8f;                                                         // cosine
constexpr int kSegment = 32;  // pixels that are looked at together, to see whether there is anything to do

/// What says whether two pixels lie on one plane.
struct Geometry {
  const Plane &depth, &nx, &ny, &nz;
  float left, top, per_x, per_y;
  bool orthographic;

  Geometry(const PictureInfo& info, const Image& image)
      : depth(image.plane("depth")),
        nx(image.plane("normal.x")),
        ny(image.plane("normal.y")),
        nz(image.plane("normal.z")),
        left(info.camera.left),
        top(info.camera.top),
        per_x((info.camera.right - info.camera.left) / float(info.width)),
        per_y((info.camera.top - info.camera.bottom) / float(info.height)),
        orthographic(info.camera.projection == Projection::kOrthographic) {}

  /// How far a pixel's point lies along a normal.
  float along(int x, int y, float a, float b, float c) const {
    const float z = depth.at(x, y);
    const float spread = orthographic ? 1.0f : z;
    const float px = (left + (float(x) + 0.5f) * per_x) * spread, py = (top - (float(y) + 0.5f) * per_y) * spread;
    return a * px + b * py - c * z;
  }
};

/// One pixel, along a row (dx 1) or a column (dy 1).
float softened(const Geometry& g, const Plane& in, int x, int y, int dx, int dy) {
  const float a = g.nx.at(x, y), b = g.ny.at(x, y), c = g.nz.at(x, y);
  const float here = g.along(x, y, a, b, c);
  const float size = g.per_x * (g.orthographic ? 1.0f : g.depth.at(x, y));
  float sum = 0.0f, weights = 0.0f;
  for (int k = -kReach; k <= kReach; ++k) {
    const int i = x + k * dx, j = y + k * dy;
    if (i < 0 || i >= in.width || j < 0 || j >= in.height) continue;
    const bool alike = std::fabs(g.along(i, j, a, b, c) - here) < kOffPlane * size &&
                       a * g.nx.at(i, j) + b * g.ny.at(i, j) + c * g.nz.at(i, j) > kFacing;
    if (!alike && k != 0) continue;
    sum += kWeights[k + kReach] * in.at(i, j);
    weights += kWeights[k + kReach];
  }
  return sum / weights;
}

/// Whether all pixels that pixels x0 to x1 of a row read have one value.
bool flat(const Plane& in, int x0, int x1, int y, int dx, int dy) {
  const float first = in.at(x0, y);
  const int from = std::max(x0 - kReach * dx, 0), to = std::min(x1 + kReach * dx, in.width);
  for (int j = std::max(y - kReach * dy, 0); j <= std::min(y + kReach * dy, in.height - 1); ++j) {
    bool all = true;
    for (int i = from; i < to; ++i) all &= in.row(j)[i] == first;
    if (!all) return false;
  }
  return true;
}

void soften(const Geometry& g, const Plane& in, Plane& out, int dx, int dy) {
  tbb::parallel_for(tbb::blocked_range<int>(0, in.height, 16), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y)
      for (int x0 = 0; x0 < in.width; x0 += kSegment) {
        const int x1 = std::min(x0 + kSegment, in.width);
        if (flat(in, x0, x1, y, dx, dy)) {
          std::copy(in.row(y) + x0, in.row(y) + x1, out.row(y) + x0);
          continue;
        }
        for (int x = x0; x < x1; ++x)
          out.at(x, y) = std::isfinite(g.depth.at(x, y)) ? softened(g, in, x, y, dx, dy) : in.at(x, y);
      }
  });
}

}  // namespace

void soften_shadows(const PictureInfo& info, std::span<const std::string> names, Image& image) {
  const Geometry geometry(info, image);
  for (const std::string& name : names) {
    Plane& plane = image.plane(name);
    Plane across(plane.width, plane.height);
    soften(geometry, plane, across, 1, 0);
    soften(geometry, across, plane, 0, 1);
  }
}

}  // namespace umbrage
