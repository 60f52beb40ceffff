// Metrics. score() sums per row and class, then over the rows in order, so that the result is independent of the
// threads.
#include "reference/metrics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

}  // namespace umbrage
