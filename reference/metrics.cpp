// Metrics. score() sums per row and class, then over the rows in order, so that the result is independent of the
// threads. SSIM from means, variances and the covariance under a Gaussian window. The window is separable: sums go down
// the columns first, then along the row. Uses double, since variances are small differences of large sums.
#include "reference/metrics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "core/check.h"

namespace umbrage {
namespace {

/// Sums over pixels; errors are also summed over the planes.
struct Sums {
  long pixels = 0;
  double squares = 0.0, errors = 0.0, ssim = 0.0, flip = 0.0;

  void add(const Sums& other) {
    pixels += other.pixels;
    squares += other.squares;
    errors += other.errors;
    ssim += other.ssim;
    flip += other.flip;
  }
};
using ClassSums = std::array<Sums, kPixelClasses>;

double error_of(const Plane& picture, const Plane& truth, int x, int y) {
  return double(finite_or_zero(picture.row(y)[x])) - finite_or_zero(truth.row(y)[x]);
}

ClassSums sum_row(const Image& picture, const Image& truth, const ClassMap& classes, const Plane& ssim,
                  const Plane& flip, int y) {
  ClassSums sums{};
  for (int x = 0; x < classes.width; ++x) {
    const PixelClass pixel = classes.row(y)[x];
    if (!is_counted(pixel)) continue;
    Sums& sum = sums[int(pixel)];
    ++sum.pixels;
    sum.ssim += ssim.row(y)[x];
    sum.flip += flip.row(y)[x];
    for (std::size_t p = 0; p < picture.planes.size(); ++p) {
      const double error = error_of(picture.planes[p], truth.planes[p], x, y);
      sum.squares += error * error;
      sum.errors += error;
    }
  }
  return sums;
}

/// Returns the absolute errors of each class, over all planes.
std::array<std::vector<float>, kPixelClasses> absolute_errors(const Image& picture, const Image& truth,
                                                              const ClassMap& classes) {
  std::array<std::vector<float>, kPixelClasses> errors;
  for (std::size_t p = 0; p < picture.planes.size(); ++p)
    for (int y = 0; y < classes.height; ++y)
      for (int x = 0; x < classes.width; ++x) {
        const PixelClass pixel = classes.row(y)[x];
        if (!is_counted(pixel)) continue;
        errors[int(pixel)].push_back(float(std::abs(error_of(picture.planes[p], truth.planes[p], x, y))));
      }
  return errors;
}

/// Returns the 99th percentile of `values`, which it reorders.
double percentile_99(std::vector<float>& values) {
  if (values.empty()) return 0.0;
  const std::size_t rank = (values.size() * 99 + 99) / 100;
  std::nth_element(values.begin(), values.begin() + (rank - 1), values.end());
  return values[rank - 1];
}

Scores scores_of(const Sums& sums, std::size_t planes, double p99) {
  Scores scores;
  scores.psnr = std::numeric_limits<double>::infinity();
  if (sums.pixels == 0) return scores;
  const double pixels = double(sums.pixels), values = pixels * double(planes);
  const double mean_square = sums.squares / values;
  scores.pixels = sums.pixels;
  scores.rmse = std::sqrt(mean_square);
  scores.bias = sums.errors / values;
  if (mean_square > 0.0) scores.psnr = -10.0 * std::log10(mean_square);
  scores.ssim = sums.ssim / pixels;
  scores.p99 = p99;
  scores.flip = sums.flip / pixels;
  return scores;
}

void check_planes(const Image& image, const ClassMap& classes) {
  if (image.planes.size() != 1 && image.planes.size() != 3) fail_check("a compared picture has one plane or three");
  for (const Plane& plane : image.planes) {
    check_equal(plane.width, classes.width, "width of a compared picture");
    check_equal(plane.height, classes.height, "height of a compared picture");
  }
}

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

ScoreCard score(const Image& picture, const Image& truth, const ClassMap& classes) {
  check_planes(picture, classes);
  check_planes(truth, classes);
  check_equal(picture.planes.size(), truth.planes.size(), "planes of the compared pictures");

  const Plane ssim = ssim_map(picture, truth, classes);
  const Plane flip = flip_map(picture, truth, classes);
  std::vector<ClassSums> rows(classes.height);
  tbb::parallel_for(0, classes.height, [&](int y) { rows[y] = sum_row(picture, truth, classes, ssim, flip, y); });
  ClassSums by_class{};
  for (const ClassSums& row : rows)
    for (int c = 0; c < kPixelClasses; ++c) by_class[c].add(row[c]);

  auto errors = absolute_errors(picture, truth, classes);
  const std::size_t planes = picture.planes.size();
  ScoreCard card;
  Sums covered;
  std::vector<float> covered_errors;
  for (int c = 0; c < kPixelClasses; ++c) {
    covered.add(by_class[c]);
    covered_errors.insert(covered_errors.end(), errors[c].begin(), errors[c].end());
    card.by_class[c] = scores_of(by_class[c], planes, percentile_99(errors[c]));
  }
  card.covered = scores_of(covered, planes, percentile_99(covered_errors));
  return card;
}

double mean_of(const Image& picture, const ClassMap& classes) {
  double sum = 0.0;
  long count = 0;
  for (const Plane& plane : picture.planes)
    for (int y = 0; y < classes.height; ++y)
      for (int x = 0; x < classes.width; ++x) {
        if (!is_counted(classes.row(y)[x])) continue;
        sum += finite_or_zero(plane.row(y)[x]);
        ++count;
      }
  return count > 0 ? sum / double(count) : 0.0;
}

ScoreCard score_light(const Image& picture, const Image& truth, const ClassMap& classes) {
  check_planes(truth, classes);
  const double mean = mean_of(truth, classes);
  if (!(mean > 0.0)) return score(picture, truth, classes);
  const auto exposed = [&](Image image) {
    for (Plane& plane : image.planes)
      for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x)
          plane.at(x, y) = float(kMiddleGrey / mean * finite_or_zero(plane.at(x, y)));
    return image;
  };
  ScoreCard card = score(exposed(picture), exposed(truth), classes);
  const auto make_relative = [](Scores& scores) {
    scores.rmse /= kMiddleGrey;
    scores.bias /= kMiddleGrey;
    scores.p99 /= kMiddleGrey;
    scores.psnr += 20.0 * std::log10(kMiddleGrey);
  };
  make_relative(card.covered);
  for (Scores& scores : card.by_class) make_relative(scores);
  return card;
}

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
