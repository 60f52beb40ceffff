// FLIP for low dynamic range [Andersson et al. 2020]: the difference that a viewer perceives when flipping between two
// pictures on a screen.
//
// Colour: both pictures are blurred by the contrast sensitivity of the eye at the viewing distance, per opponent
// channel, and compared in a perceptual space. Features: edges and points that only one of the pictures shows increase
// the error. All filters are Gaussians, derivatives of Gaussians or sums of them, hence separable. At the border the
// last pixel is repeated. Grey pictures need only the achromatic channel: the other channels are 0.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "core/check.h"
#include "core/color.h"
#include "reference/metrics.h"

namespace umbrage {
namespace {

using std::numbers::pi;

// The paper's viewer sits 0.7 m from a screen 0.7 m wide of 3840 pixels.
constexpr double kPixelsPerDegree = 3840.0 * (0.7 / 0.7) * pi / 180.0;

// The paper's parameters of the colour difference: exponent, and the fraction of the max difference that is mapped to
// the fraction kPointT of the error's range.
constexpr float kColourExponent = 0.7f, kPointC = 0.4f, kPointT = 0.95f;

// The paper's parameters of the feature difference: exponent, and the width in degrees between the peaks of the
// eye's edge detector, twice its standard deviation.
constexpr float kFeatureExponent = 0.5f;
constexpr double kFeatureWidth = 0.082;

/// A term of a channel's contrast sensitivity: a sqrt(pi / b) exp(-pi^2 r^2 / b), with r in degrees.
struct Sensitivity {
  double a, b;
};
const std::vector<Sensitivity> kAchromatic = {{1.0, 0.0047}};
const std::vector<Sensitivity> kRedGreen = {{1.0, 0.0053}};
const std::vector<Sensitivity> kBlueYellow = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kMaxB = 0.04;

/// A filter along one axis: weights at distances 0, 1, ... towards larger coordinates; towards smaller ones, `sign`
/// times these weights.
struct Filter {
  std::vector<float> weights;
  float sign = 1.0f;
};

/// A term of a blur: `fraction` times the Gaussian along both axes.
struct Blur {
  float fraction;
  Filter gaussian;
};

/// Returns the reach of a filter with a standard deviation in pixels: 3 standard deviations.
int reach(double deviation) { return int(std::ceil(3.0 * deviation)); }

int blur_reach() { return reach(std::sqrt(kMaxB / (2.0 * pi * pi)) * kPixelsPerDegree); }

/// Returns a symmetric filter: weights at distances 0, 1, ..., normalized by their sum over both sides.
Filter even_kernel(const std::vector<double>& weights) {
  double sum = weights[0];
  for (std::size_t k = 1; k < weights.size(); ++k) sum += 2.0 * weights[k];
  Filter kernel;
  for (double w : weights) kernel.weights.push_back(float(w / sum));
  return kernel;
}

std::vector<Blur> blur_of(const std::vector<Sensitivity>& terms) {
  std::vector<double> volumes;
  std::vector<Blur> blurs;
  double volume_sum = 0.0;
  for (const Sensitivity& term : terms) {
    std::vector<double> weights;
    double sum = 0.0;
    for (int k = 0; k <= blur_reach(); ++k) {
      const double degrees = k / kPixelsPerDegree;
      weights.push_back(std::exp(-pi * pi * degrees * degrees / term.b));
      sum += (k == 0 ? 1.0 : 2.0) * weights.back();
    }
    volumes.push_back(term.a * std::sqrt(pi / term.b) * sum * sum);
    volume_sum += volumes.back();
    blurs.push_back({0.0f, even_kernel(weights)});
  }
  for (std::size_t i = 0; i < blurs.size(); ++i) blurs[i].fraction = float(volumes[i] / volume_sum);
  return blurs;
}

/// The feature detectors along their axis, and the Gaussian across it, which both use. Positive weights sum to 1,
/// negative weights to -1.
struct Detectors {
  Filter across, edge, point;
};

Detectors make_detectors() {
  const double deviation = 0.5 * kFeatureWidth * kPixelsPerDegree;
  std::vector<double> gaussian, edge, point;
  double edge_sum = 0.0, positive_sum = 0.0, negative_sum = 0.0;
  for (int k = 0; k <= reach(deviation); ++k) {
    const double g = std::exp(-0.5 * k * k / (deviation * deviation));
    const double second = (k * k / (deviation * deviation) - 1.0) * g;
    gaussian.push_back(g);
    edge.push_back(k * g);
    point.push_back(second);
    edge_sum += k * g;
    (second > 0.0 ? positive_sum : negative_sum) += (k == 0 ? 1.0 : 2.0) * std::abs(second);
  }
  Detectors detectors{even_kernel(gaussian), {{}, -1.0f}, {{}, 1.0f}};
  for (double w : edge) detectors.edge.weights.push_back(float(w / edge_sum));
  for (double w : point) detectors.point.weights.push_back(float(w / (w > 0.0 ? positive_sum : negative_sum)));
  return detectors;
}

/// Returns the reach of the widest filter.
int max_reach() {
  const auto reach = [](const Filter& kernel) { return int(kernel.weights.size()) - 1; };
  static const int result = [&] {
    const Detectors detectors = make_detectors();
    return std::max({blur_reach(), reach(detectors.across), reach(detectors.edge), reach(detectors.point)});
  }();
  return result;
}

/// A row whose end values are repeated on either side, so that filters need no bounds checks.
struct Row {
  explicit Row(int width) : values(width + 2 * max_reach()) {}
  std::vector<float> values;
  float* begin() { return values.data() + max_reach(); }
  const float* begin() const { return values.data() + max_reach(); }
};

/// Filters a plane along its columns. `out` receives row y of the result.
void filter_down(const Plane& plane, int y, const Filter& kernel, Row& out) {
  const int width = plane.width;
  float* sums = out.begin();
  const float* centre = plane.row(y);
  for (int x = 0; x < width; ++x) sums[x] = kernel.weights[0] * centre[x];
  for (int k = 1; k < int(kernel.weights.size()); ++k) {
    const float far = kernel.weights[k], near = kernel.sign * far;
    const float *above = plane.row(std::max(y - k, 0)), *below = plane.row(std::min(y + k, plane.height - 1));
    for (int x = 0; x < width; ++x) sums[x] += near * above[x] + far * below[x];
  }
  std::fill(out.values.data(), sums, sums[0]);
  std::fill(sums + width, out.values.data() + out.values.size(), sums[width - 1]);
}

/// Filters along a row and adds the result to `out`.
void filter_along(const Row& row, const Filter& kernel, float fraction, std::vector<float>& out) {
  const int width = int(out.size());
  const float* centre = row.begin();
  for (int x = 0; x < width; ++x) out[x] += fraction * kernel.weights[0] * centre[x];
  for (int k = 1; k < int(kernel.weights.size()); ++k) {
    const float far = fraction * kernel.weights[k], near = kernel.sign * far;
    for (int x = 0; x < width; ++x) out[x] += near * centre[x - k] + far * centre[x + k];
  }
}

/// Conversions between linear Rec.709 and XYZ relative to white [IEC 61966-2-1], with the numbers that the paper's
/// authors use.
struct Matrices {
  glm::mat3 xyz_from_rgb, rgb_from_xyz;
};

Matrices make_matrices() {
  constexpr std::array<std::array<double, 3>, 3> kXyzFromRgb = {
      {{10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
       {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
       {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}}};
  glm::dmat3 matrix;
  for (int row = 0; row < 3; ++row) {
    const double white = kXyzFromRgb[row][0] + kXyzFromRgb[row][1] + kXyzFromRgb[row][2];
    for (int column = 0; column < 3; ++column) matrix[column][row] = kXyzFromRgb[row][column] / white;
  }
  return {glm::mat3(matrix), glm::mat3(glm::inverse(matrix))};
}

const Matrices& matrices() {
  static const Matrices cached = make_matrices();
  return cached;
}

/// Returns the curve of L*a*b*: a cube root with a linear segment near 0.
float lab_curve(float t) {
  constexpr float kFoot = 6.0f / 29.0f;
  return t > kFoot * kFoot * kFoot ? std::cbrt(t) : t / (3.0f * kFoot * kFoot) + 4.0f / 29.0f;
}

float lightness(float y) { return 116.0f * lab_curve(y) - 16.0f; }

/// Returns L*a*b* of linear light, with chroma adjusted for the Hunt effect: colours are less vivid in the dark.
glm::vec3 hunt_lab(glm::vec3 rgb) {
  const glm::vec3 xyz = matrices().xyz_from_rgb * rgb;
  const glm::vec3 f(lab_curve(xyz.x), lab_curve(xyz.y), lab_curve(xyz.z));
  const float l = 116.0f * f.y - 16.0f, hunt = 0.01f * l;
  return {l, hunt * 500.0f * (f.x - f.y), hunt * 200.0f * (f.y - f.z)};
}

/// Returns the HyAB distance: the difference of lightness is added to the distance of hue and chroma.
float hyab(glm::vec3 a, glm::vec3 b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// Maps a HyAB distance to an error from 0 to 1. Most of the range is for differences smaller than those of pure
/// colours.
float colour_error(float distance) {
  static const float largest =
      std::pow(hyab(hunt_lab({0.0f, 1.0f, 0.0f}), hunt_lab({0.0f, 0.0f, 1.0f})), kColourExponent);
  const float power = std::pow(distance, kColourExponent), knee = kPointC * largest;
  if (power < knee) return power * (kPointT / knee);
  return kPointT + (power - knee) / (largest - knee) * (1.0f - kPointT);
}

/// Returns a picture's opponent channels: YCxCz without the scale and offset of each channel; only Y for a grey
/// picture.
std::vector<Plane> opponent_channels(const Image& image, const ClassMap& classes) {
  const int width = classes.width, height = classes.height;
  const std::size_t channels = image.planes.size();
  std::vector<Plane> out(channels, Plane(width, height));
  tbb::parallel_for(0, height, [&](int y) {
    for (std::size_t c = 0; c < channels; ++c) {
      float* row = out[c].row(y);
      counted_row(image.planes[c].row(y), classes.row(y), width, 1.0f, row);
      for (int x = 0; x < width; ++x) row[x] = std::clamp(row[x], 0.0f, 1.0f);
    }
    if (channels == 1) {
      for (int x = 0; x < width; ++x) out[0].row(y)[x] = linear_from_srgb(out[0].row(y)[x]);
    } else {
      float *r = out[0].row(y), *g = out[1].row(y), *b = out[2].row(y);
      for (int x = 0; x < width; ++x) {
        const glm::vec3 xyz = matrices().xyz_from_rgb * glm::vec3(r[x], g[x], b[x]);
        r[x] = xyz.y;
        g[x] = xyz.x - xyz.y;
        b[x] = xyz.y - xyz.z;
      }
    }
  });
  return out;
}

/// Filtered values of one row of a picture.
struct FilteredRow {
  std::array<std::vector<float>, 3> colour;  ///< blurred opponent channels
  std::array<std::vector<float>, 2> edge, point;
};

/// The filters of all channels.
struct Filters {
  std::array<std::vector<Blur>, 3> blurs = {blur_of(kAchromatic), blur_of(kRedGreen), blur_of(kBlueYellow)};
  Detectors detectors = make_detectors();
};

void filter_row(const Filters& filters, const std::vector<Plane>& channels, int y, Row& scratch,
                FilteredRow& filtered) {
  const int width = channels[0].width;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    filtered.colour[c].assign(width, 0.0f);
    for (const Blur& blur : filters.blurs[c]) {
      filter_down(channels[c], y, blur.gaussian, scratch);
      filter_along(scratch, blur.gaussian, blur.fraction, filtered.colour[c]);
    }
  }
  for (int axis = 0; axis < 2; ++axis) {
    filtered.edge[axis].assign(width, 0.0f);
    filtered.point[axis].assign(width, 0.0f);
  }
  const Detectors& detectors = filters.detectors;
  filter_down(channels[0], y, detectors.across, scratch);
  filter_along(scratch, detectors.edge, 1.0f, filtered.edge[0]);
  filter_along(scratch, detectors.point, 1.0f, filtered.point[0]);
  filter_down(channels[0], y, detectors.edge, scratch);
  filter_along(scratch, detectors.across, 1.0f, filtered.edge[1]);
  filter_down(channels[0], y, detectors.point, scratch);
  filter_along(scratch, detectors.across, 1.0f, filtered.point[1]);
}

/// Returns the perceptual distance of the blurred colours of pixel x.
float colour_distance(const FilteredRow& a, const FilteredRow& b, int x, bool grey) {
  if (grey) return std::abs(lightness(a.colour[0][x]) - lightness(b.colour[0][x]));
  const auto lab = [x](const FilteredRow& filtered) {
    const float y = filtered.colour[0][x];
    const glm::vec3 rgb = matrices().rgb_from_xyz * glm::vec3(y + filtered.colour[1][x], y, y - filtered.colour[2][x]);
    return hunt_lab(glm::clamp(rgb, 0.0f, 1.0f));
  };
  return hyab(lab(a), lab(b));
}

/// Returns the difference of the features of pixel x, 0 to 1.
float feature_error(const FilteredRow& a, const FilteredRow& b, int x) {
  const auto strength = [x](const std::array<std::vector<float>, 2>& feature) {
    return std::sqrt(feature[0][x] * feature[0][x] + feature[1][x] * feature[1][x]);
  };
  const float max =
      std::max(std::abs(strength(a.edge) - strength(b.edge)), std::abs(strength(a.point) - strength(b.point)));
  return std::pow(max / std::numbers::sqrt2_v<float>, kFeatureExponent);
}

}  // namespace

Plane flip_map(const Image& picture, const Image& truth, const ClassMap& classes) {
  check_equal(picture.planes.size(), truth.planes.size(), "planes of the compared pictures");
  const int width = classes.width, height = classes.height;
  Plane map(width, height, 0.0f);
  if (picture.planes.empty()) return map;
  static const Filters filters;
  const bool grey = picture.planes.size() == 1;
  const std::vector<Plane> channels = opponent_channels(picture, classes);
  const std::vector<Plane> reference_channels = opponent_channels(truth, classes);
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const tbb::blocked_range<int>& rows) {
    Row scratch(width);
    FilteredRow filtered, filtered_reference;
    for (int y = rows.begin(); y < rows.end(); ++y) {
      filter_row(filters, channels, y, scratch, filtered);
      filter_row(filters, reference_channels, y, scratch, filtered_reference);
      for (int x = 0; x < width; ++x) {
        if (!is_counted(classes.row(y)[x])) continue;
        const float distance = colour_distance(filtered, filtered_reference, x, grey);
        if (distance == 0.0f) continue;
        map.row(y)[x] = std::pow(colour_error(distance), 1.0f - feature_error(filtered, filtered_reference, x));
      }
    }
  });
  return map;
}

}  // namespace umbrage
