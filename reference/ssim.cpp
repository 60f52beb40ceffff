// SSIM from means, variances and the covariance under a Gaussian window. The window is separable: sums go down the
// columns first, then along the row. Uses double, since variances are small differences of large sums.
#include "reference/metrics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace umbrage {
namespace {

// The window and the constants of the paper, for values in [0, 1].
constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

enum Moment { kWeight, kA, kB, kAA, kBB, kAB, kMoments };

std::array<double, kRadius + 1> window() {
  std::array<double, kRadius + 1> weights;
  for (int k = 0; k <= kRadius; ++k) weights[k] = std::exp(-0.5 * k * k / (kSigma * kSigma));
  return weights;
}

/// The counted values of two planes, and their weight: 1 where a pixel counts, else 0.
struct Pair {
  Plane a, b, weight;
};

Pair counted_pair(const Plane& a, const Plane& b, const ClassMap& classes) {
  const int width = classes.width, height = classes.height;
  Pair pair{Plane(width, height), Plane(width, height), Plane(width, height)};
  tbb::parallel_for(0, height, [&](int y) {
    const PixelClass* row = classes.row(y);
    counted_row(a.row(y), row, width, 0.0f, pair.a.row(y));
    counted_row(b.row(y), row, width, 0.0f, pair.b.row(y));
    for (int x = 0; x < width; ++x) pair.weight.row(y)[x] = is_counted(row[x]) ? 1.0f : 0.0f;
  });
  return pair;
}

/// Weighted sums of each column around one row, with kRadius zeros on either side.
using Columns = std::array<std::vector<double>, kMoments>;

void sum_columns(const Pair& pair, int y, const std::array<double, kRadius + 1>& weights, Columns& columns) {
  const int width = pair.a.width;
  std::array<double*, kMoments> sums;
  for (int m = 0; m < kMoments; ++m) {
    columns[m].assign(width + 2 * kRadius, 0.0);
    sums[m] = columns[m].data() + kRadius;
  }
  for (int row = std::max(y - kRadius, 0); row <= std::min(y + kRadius, pair.a.height - 1); ++row) {
    const double w = weights[std::abs(row - y)];
    const float *rows_a = pair.a.row(row), *rows_b = pair.b.row(row), *rows_weight = pair.weight.row(row);
    for (int x = 0; x < width; ++x) {
      const double a = rows_a[x], b = rows_b[x];
      sums[kWeight][x] += w * rows_weight[x];
      sums[kA][x] += w * a;
      sums[kB][x] += w * b;
      sums[kAA][x] += w * a * a;
      sums[kBB][x] += w * b * b;
      sums[kAB][x] += w * a * b;
    }
  }
}

/// Adds up a row of column sums under the window.
void sum_row(const std::vector<double>& columns, const std::array<double, kRadius + 1>& weights,
             std::vector<double>& out) {
  const int width = int(out.size());
  const double* centre = columns.data() + kRadius;
  for (int x = 0; x < width; ++x) out[x] = weights[0] * centre[x];
  for (int k = 1; k <= kRadius; ++k)
    for (int x = 0; x < width; ++x) out[x] += weights[k] * (centre[x - k] + centre[x + k]);
}

double similarity(double a, double b, double aa, double bb, double ab) {
  const double var_a = std::max(aa - a * a, 0.0), var_b = std::max(bb - b * b, 0.0), cov = ab - a * b;
  return (2.0 * a * b + kC1) * (2.0 * cov + kC2) / ((a * a + b * b + kC1) * (var_a + var_b + kC2));
}

}  // namespace

Plane ssim_map(const Image& picture, const Image& truth, const ClassMap& classes) {
  const int width = classes.width, height = classes.height;
  const auto weights = window();
  const float plane_weight = 1.0f / float(std::max<std::size_t>(picture.planes.size(), 1));
  Plane map(width, height, picture.planes.empty() ? 1.0f : 0.0f);
  for (std::size_t p = 0; p < picture.planes.size(); ++p) {
    const Pair pair = counted_pair(picture.planes[p], truth.planes[p], classes);
    tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const tbb::blocked_range<int>& rows) {
      Columns columns;
      std::array<std::vector<double>, kMoments> sums;
      for (auto& sum : sums) sum.resize(width);
      for (int y = rows.begin(); y < rows.end(); ++y) {
        sum_columns(pair, y, weights, columns);
        for (int m = 0; m < kMoments; ++m) sum_row(columns[m], weights, sums[m]);
        const PixelClass* row = classes.row(y);
        for (int x = 0; x < width; ++x) {
          if (!is_counted(row[x])) {
            map.row(y)[x] += plane_weight;
            continue;
          }
          const double scale = 1.0 / sums[kWeight][x];
          map.row(y)[x] +=
              plane_weight * float(similarity(sums[kA][x] * scale, sums[kB][x] * scale, sums[kAA][x] * scale,
                                              sums[kBB][x] * scale, sums[kAB][x] * scale));
        }
      }
    });
  }
  return map;
}

}  // namespace umbrage
