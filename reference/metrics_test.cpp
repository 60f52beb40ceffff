// Image metrics on pictures with known results: closed forms, direct implementations in double, and analytic scenes.
#include "reference/metrics.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kPi = std::numbers::pi;

float random_value(unsigned seed, int x, int y) {
  return float(test::hash(seed * 0x9e3779b9u + unsigned(y) * 8191u + unsigned(x)) >> 8) / float(1 << 24);
}

using Texel = std::function<float(int x, int y)>;

void fill(Plane& plane, const Texel& texel) {
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) plane.at(x, y) = texel(x, y);
}

Image grey(int width, int height, const Texel& texel) {
  Image image(width, height);
  fill(image.add("ao"), texel);
  return image;
}

Image flat(int width, int height, float value) {
  return grey(width, height, [value](int, int) { return value; });
}

Image colour(int width, int height, const Texel& r, const Texel& g, const Texel& b) {
  Image image(width, height);
  fill(image.add("r"), r);
  fill(image.add("g"), g);
  fill(image.add("b"), b);
  return image;
}

Image flat_colour(int width, int height, glm::vec3 c) {
  return colour(
      width, height, [c](int, int) { return c.x; }, [c](int, int) { return c.y; }, [c](int, int) { return c.z; });
}

ClassMap all_open(int width, int height) {
  return {width, height, std::vector<PixelClass>(std::size_t(width) * height, PixelClass::kOpen)};
}

/// Makes a map with holes of background: a block and scattered single pixels.
ClassMap with_holes(int width, int height) {
  ClassMap map = all_open(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if ((x < 6 && y > height / 2) || random_value(7, x, y) < 0.1f)
        map.classes[std::size_t(y) * width + x] = PixelClass::kBackground;
  return map;
}

Texel noise(unsigned seed) {
  return [seed](int x, int y) { return random_value(seed, x, y); };
}

/// Returns smooth waves with a little noise, similar to real pictures.
Texel waves(unsigned seed) {
  return [seed](int x, int y) {
    return 0.5f + 0.3f * std::sin(0.4f * float(x) + float(seed)) * std::cos(0.3f * float(y)) +
           0.2f * (random_value(seed, x, y) - 0.5f);
  };
}

bool same_bits(const void* a, const void* b, std::size_t bytes) { return std::memcmp(a, b, bytes) == 0; }

void expect_same(const Scores& a, const Scores& b) {
  EXPECT_EQ(a.pixels, b.pixels);
  const std::array<double, 6> first = {a.rmse, a.bias, a.psnr, a.ssim, a.p99, a.flip};
  const std::array<double, 6> second = {b.rmse, b.bias, b.psnr, b.ssim, b.p99, b.flip};
  EXPECT_TRUE(same_bits(first.data(), second.data(), sizeof first));
}

void expect_same(const ScoreCard& a, const ScoreCard& b) {
  expect_same(a.covered, b.covered);
  for (int c = 0; c < kPixelClasses; ++c) expect_same(a.by_class[c], b.by_class[c]);
}

// ---- errors

TEST(Metrics, ConstantOffset) {
  for (const float c : {0.1f, -0.25f, 0.003f}) {
    const Scores s = score(flat(40, 30, 0.5f + c), flat(40, 30, 0.5f), all_open(40, 30)).covered;
    EXPECT_EQ(s.pixels, 1200);
    EXPECT_NEAR(s.rmse, std::abs(c), 1e-7);
    EXPECT_NEAR(s.bias, c, 1e-7);
    EXPECT_NEAR(s.psnr, -20.0 * std::log10(std::abs(c)), 1e-3);
    EXPECT_NEAR(s.p99, std::abs(c), 1e-7);
  }
}

TEST(Metrics, SomePixelsOff) {
  constexpr int kSide = 100;
  constexpr float kError = -0.5f;
  for (const int off : {90, 100, 110, 2500}) {
    const Image picture = grey(kSide, kSide, [off](int x, int y) {
      // 7919 is coprime to the number of pixels, so that this scatters exactly `off` of them.
      return 0.75f + ((y * kSide + x) * 7919 % (kSide * kSide) < off ? kError : 0.0f);
    });
    const Scores s = score(picture, flat(kSide, kSide, 0.75f), all_open(kSide, kSide)).covered;
    const double fraction = off / double(kSide * kSide);
    EXPECT_NEAR(s.rmse, -kError * std::sqrt(fraction), 1e-9);
    EXPECT_NEAR(s.bias, kError * fraction, 1e-9);
    EXPECT_EQ(s.p99, off <= 100 ? 0.0 : 0.5) << off;
  }
}

TEST(Metrics, PercentileIsTheSmallestErrorThat99PercentDoNotExceed) {
  for (const int size : {1, 2, 50, 99, 100, 101, 130, 149, 160, 199, 200, 201, 301}) {
    // The errors 1, 2, ..., in another order: 103 is a prime that divides no size.
    const Image picture = grey(size, 1, [size](int x, int) { return float((x * 103 + 7) % size + 1) / 512.0f; });
    int rank = 0;
    while (100 * rank < 99 * size) ++rank;
    EXPECT_EQ(score(picture, flat(size, 1, 0.0f), all_open(size, 1)).covered.p99, rank / 512.0) << size;
  }
}

TEST(Metrics, EqualPicturesHaveNoError) {
  const Image grey_picture = grey(33, 21, noise(1)), colours = colour(33, 21, noise(1), noise(2), noise(3));
  for (const Image& picture : {grey_picture, colours}) {
    const Scores s = score(picture, picture, with_holes(33, 21)).covered;
    EXPECT_EQ(s.rmse, 0.0);
    EXPECT_EQ(s.bias, 0.0);
    EXPECT_EQ(s.psnr, kInfinity);
    EXPECT_NEAR(s.ssim, 1.0, 1e-7);
    EXPECT_EQ(s.p99, 0.0);
    EXPECT_EQ(s.flip, 0.0);
  }
}

TEST(Metrics, ChannelsHaveEqualWeight) {
  const Image truth = flat_colour(30, 30, {0.5f, 0.5f, 0.5f});
  const Image picture = flat_colour(30, 30, {0.5f, 0.625f, 0.25f});
  const Scores s = score(picture, truth, all_open(30, 30)).covered;
  EXPECT_EQ(s.pixels, 900);
  EXPECT_NEAR(s.rmse, std::sqrt((0.125 * 0.125 + 0.25 * 0.25) / 3.0), 1e-9);
  EXPECT_NEAR(s.bias, (0.125 - 0.25) / 3.0, 1e-9);
  EXPECT_EQ(s.p99, 0.25);
  double ssim = 0.0;
  for (int c = 0; c < 3; ++c) {
    Image a(30, 30), b(30, 30);
    a.add("ao") = picture.planes[c];
    b.add("ao") = truth.planes[c];
    ssim += score(a, b, all_open(30, 30)).covered.ssim / 3.0;
  }
  EXPECT_NEAR(s.ssim, ssim, 1e-6);
}

TEST(Metrics, LightErrorsAreRelativeToTheMean) {
  const ClassMap map = with_holes(40, 30);
  const auto times = [](Image image, float factor) {
    for (Plane& plane : image.planes)
      for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) plane.at(x, y) *= factor;
    return image;
  };
  const Image truth = colour(40, 30, waves(1), waves(2), noise(3)),
              picture = colour(40, 30, noise(4), waves(5), waves(6));
  const ScoreCard card = score_light(picture, truth, map);
  // The scores do not depend on the unit of light.
  const ScoreCard brighter = score_light(times(picture, 16.0f), times(truth, 16.0f), map);
  EXPECT_NEAR(brighter.covered.rmse, card.covered.rmse, 1e-6);
  EXPECT_NEAR(brighter.covered.flip, card.covered.flip, 1e-6);
  EXPECT_NEAR(brighter.covered.ssim, card.covered.ssim, 1e-6);
  // Errors are those of score(), relative to the mean.
  const double mean = mean_of(truth, map);
  const ScoreCard plain = score(picture, truth, map);
  for (int c = 0; c < kPixelClasses; ++c) {
    EXPECT_NEAR(card.by_class[c].rmse, plain.by_class[c].rmse / mean, 1e-5);
    EXPECT_NEAR(card.by_class[c].p99, plain.by_class[c].p99 / mean, 1e-5);
  }
  EXPECT_NEAR(card.covered.bias, plain.covered.bias / mean, 1e-5);
  EXPECT_NEAR(card.covered.psnr, -20.0 * std::log10(card.covered.rmse), 1e-9);
  // FLIP shows the reference's mean as middle grey.
  EXPECT_NEAR(
      card.covered.flip,
      score(times(picture, float(kMiddleGrey / mean)), times(truth, float(kMiddleGrey / mean)), map).covered.flip,
      1e-6);
  EXPECT_NEAR(score_light(times(picture, 0.0f), truth, map).covered.bias, -1.0, 1e-6);
  EXPECT_NEAR(score_light(times(truth, 3.0f), truth, map).covered.bias, 2.0, 1e-6);
  // Errors cannot be relative to the mean of a black reference.
  EXPECT_EQ(score_light(picture, times(truth, 0.0f), map).covered.rmse,
            score(picture, times(truth, 0.0f), map).covered.rmse);
}

TEST(Metrics, ClassesAreScoredSeparately) {
  ClassMap map = all_open(40, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      PixelClass& pixel = map.classes[y * 40 + x];
      if (x < 10) pixel = PixelClass::kBorder;
      if (x >= 30) pixel = y < 20 ? PixelClass::kThin : PixelClass::kBackground;
    }
  const Image picture = grey(40, 40, [](int x, int) { return x < 10 ? 0.5f : x >= 30 ? 0.75f : 0.25f; });
  const ScoreCard card = score(picture, flat(40, 40, 0.25f), map);
  const Scores &border = card.by_class[int(PixelClass::kBorder)], &thin = card.by_class[int(PixelClass::kThin)],
               &silhouette = card.by_class[int(PixelClass::kSilhouette)], &open = card.by_class[int(PixelClass::kOpen)];
  EXPECT_EQ(border.pixels, 400);
  EXPECT_EQ(thin.pixels, 200);
  EXPECT_EQ(silhouette.pixels, 0);
  EXPECT_EQ(open.pixels, 800);
  EXPECT_EQ(card.covered.pixels, 1400);
  EXPECT_EQ(border.bias, 0.25);
  EXPECT_EQ(border.p99, 0.25);
  EXPECT_EQ(thin.rmse, 0.5);
  EXPECT_EQ(thin.p99, 0.5);
  EXPECT_EQ(open.rmse, 0.0);
  EXPECT_EQ(open.psnr, kInfinity);
  EXPECT_GT(border.flip, 0.0);
  EXPECT_NEAR(card.covered.bias, (400 * 0.25 + 200 * 0.5) / 1400.0, 1e-12);
  EXPECT_EQ(card.covered.p99, 0.5);
  // No pixels to count.
  EXPECT_EQ(silhouette.rmse, 0.0);
  EXPECT_EQ(silhouette.psnr, kInfinity);
  EXPECT_EQ(silhouette.ssim, 1.0);
  EXPECT_EQ(silhouette.flip, 0.0);
}

TEST(Metrics, BackgroundChangesNothing) {
  const ClassMap map = with_holes(37, 29);
  const Image truth = colour(37, 29, waves(1), waves(2), waves(3));
  const Image picture = colour(37, 29, waves(4), waves(5), waves(6));
  const ScoreCard before = score(picture, truth, map);
  EXPECT_GT(before.covered.flip, 0.0);
  Image changed = picture;
  for (int y = 0; y < 29; ++y)
    for (int x = 0; x < 37; ++x)
      if (map.row(y)[x] == PixelClass::kBackground)
        for (Plane& plane : changed.planes) plane.at(x, y) = (x + y) % 3 == 0 ? kNaN : (x + y) % 3 == 1 ? -9.0f : 9.0f;
  expect_same(score(changed, truth, map), before);
}

TEST(Metrics, NonFiniteValuesCountAsZero) {
  Image picture = grey(32, 32, waves(1)), zeroed = picture;
  picture.planes[0].at(3, 4) = kNaN;
  picture.planes[0].at(20, 20) = kInfinity;
  picture.planes[0].at(31, 0) = -kInfinity;
  for (const auto& [x, y] : {std::pair{3, 4}, {20, 20}, {31, 0}}) zeroed.planes[0].at(x, y) = 0.0f;
  const Image truth = grey(32, 32, waves(2));
  expect_same(score(picture, truth, all_open(32, 32)), score(zeroed, truth, all_open(32, 32)));
  expect_same(score(truth, picture, all_open(32, 32)), score(truth, zeroed, all_open(32, 32)));
}

TEST(Metrics, SmallestPictures) {
  const Scores one = score(flat(1, 1, 0.5f), flat(1, 1, 0.25f), all_open(1, 1)).covered;
  EXPECT_EQ(one.pixels, 1);
  EXPECT_EQ(one.rmse, 0.25);
  EXPECT_EQ(one.p99, 0.25);
  EXPECT_NEAR(one.ssim, (2.0 * 0.5 * 0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4), 1e-6);
  EXPECT_GT(one.flip, 0.0);
  const Scores none = score(flat(0, 0, 0.0f), flat(0, 0, 0.0f), all_open(0, 0)).covered;
  EXPECT_EQ(none.pixels, 0);
  EXPECT_EQ(none.ssim, 1.0);
  EXPECT_EQ(none.psnr, kInfinity);
  const ClassMap background{2, 1, {PixelClass::kBackground, PixelClass::kBackground}};
  EXPECT_EQ(score(flat(2, 1, 0.0f), flat(2, 1, 1.0f), background).covered.pixels, 0);
}

TEST(Metrics, SameBitsOnAnyNumberOfThreads) {
  constexpr int kWidth = 203, kHeight = 151;
  const GBuffer gbuffer = test::bumpy_gbuffer(kWidth, kHeight, 3);
  const Image truth = colour(kWidth, kHeight, waves(1), waves(2), waves(3));
  const Image picture = colour(kWidth, kHeight, waves(4), waves(5), waves(6));
  struct Run {
    ClassMap map;
    ScoreCard card;
    Plane flip;
  };
  const auto run = [&](int threads) {
    Run out;
    const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      out.map = classify(gbuffer);
      out.card = score(picture, truth, out.map);
      out.flip = flip_map(picture, truth, out.map);
    });
    return out;
  };
  const Run one = run(1);
  for (const int threads : {2, 3, 8}) {
    const Run many = run(threads);
    EXPECT_EQ(one.map.classes, many.map.classes);
    expect_same(one.card, many.card);
    for (int y = 0; y < kHeight; ++y) EXPECT_TRUE(same_bits(one.flip.row(y), many.flip.row(y), kWidth * sizeof(float)));
  }
}

// ---- SSIM

/// Computes SSIM by its definition: Gaussian windows of 11 x 11 over covered pixels, two passes for the variances.
double direct_ssim(const Plane& a, const Plane& b, const ClassMap& map) {
  double total = 0.0;
  int pixels = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      if (map.row(y)[x] == PixelClass::kBackground) continue;
      const auto mean = [&](const std::function<double(int, int)>& value) {
        double sum = 0.0, weights = 0.0;
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i) {
            const int u = x + i, v = y + j;
            if (u < 0 || v < 0 || u >= map.width || v >= map.height) continue;
            if (map.row(v)[u] == PixelClass::kBackground) continue;
            const double w = std::exp(-(i * i + j * j) / (2.0 * 1.5 * 1.5));
            sum += w * value(u, v);
            weights += w;
          }
        return sum / weights;
      };
      const double ma = mean([&](int u, int v) { return a.at(u, v); });
      const double mb = mean([&](int u, int v) { return b.at(u, v); });
      const double va = mean([&](int u, int v) { return (a.at(u, v) - ma) * (a.at(u, v) - ma); });
      const double vb = mean([&](int u, int v) { return (b.at(u, v) - mb) * (b.at(u, v) - mb); });
      const double cov = mean([&](int u, int v) { return (a.at(u, v) - ma) * (b.at(u, v) - mb); });
      total += (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
      ++pixels;
    }
  return total / pixels;
}

TEST(Metrics, SsimOfConstants) {
  for (const auto& [a, b] : {std::pair{0.2, 0.4}, {0.0, 1.0}, {0.9, 0.85}}) {
    const Scores s = score(flat(25, 25, float(a)), flat(25, 25, float(b)), with_holes(25, 25)).covered;
    EXPECT_NEAR(s.ssim, (2 * a * b + 1e-4) / (a * a + b * b + 1e-4), 1e-6);
  }
}

TEST(Metrics, SsimOfANegativeIsBelowZero) {
  const auto checks = [](float amplitude) {
    return grey(40, 40, [=](int x, int y) { return 0.5f + ((x / 2 + y / 2) % 2 == 0 ? amplitude : -amplitude); });
  };
  const double ssim = score(checks(0.4f), checks(-0.4f), all_open(40, 40)).covered.ssim;
  EXPECT_LT(ssim, -0.9);
  EXPECT_GE(ssim, -1.0);
}

TEST(Metrics, SsimMatchesItsDefinition) {
  const Image a = grey(23, 17, noise(1)), b = grey(23, 17, waves(2));
  for (const ClassMap& map : {all_open(23, 17), with_holes(23, 17)})
    EXPECT_NEAR(score(a, b, map).covered.ssim, direct_ssim(a.planes[0], b.planes[0], map), 1e-6);
}

TEST(Metrics, SsimKeepsSmallVariances) {
  // A ripple of 1e-4 on 0.9. Its variance is the difference of two squares that are 1e8 times larger.
  const Image a = grey(23, 17, [](int x, int) { return 0.9f + (x % 2 ? 1e-4f : -1e-4f); });
  const Image b = grey(23, 17, [](int, int y) { return 0.9f + (y % 2 ? 1e-4f : -1e-4f); });
  const ClassMap map = all_open(23, 17);
  const double exact = direct_ssim(a.planes[0], b.planes[0], map);
  EXPECT_NEAR(score(a, b, map).covered.ssim, exact, 1e-6);
  EXPECT_LT(exact, 1.0 - 1e-5);
}

// ---- FLIP, implemented directly in double: two-dimensional kernels, pixel by pixel

using Colour = std::array<double, 3>;

/// A picture as a matrix of colours; the last pixel is repeated beyond the border.
struct Matrix {
  int width, height;
  std::vector<Colour> texels;
  const Colour& at(int x, int y) const {
    return texels[std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1)];
  }
};

constexpr double kDegree = 3840.0 * kPi / 180.0;  // pixels

double curve(double t) { return t > std::pow(6.0 / 29.0, 3) ? std::cbrt(t) : t * 841.0 / 108.0 + 4.0 / 29.0; }

/// Returns XYZ relative to white at D65, with the matrix of the sRGB primaries in decimals.
Colour relative_xyz(const Colour& c) {
  return {(0.4123865632 * c[0] + 0.3575914909 * c[1] + 0.1804504912 * c[2]) / 0.950428545,
          0.2126368254 * c[0] + 0.7151829819 * c[1] + 0.0721801928 * c[2],
          (0.0193306202 * c[0] + 0.1191971636 * c[1] + 0.9503725870 * c[2]) / 1.088900371};
}

Colour lab_hunt(const Colour& rgb) {
  const Colour xyz = relative_xyz(rgb);
  const double l = 116.0 * curve(xyz[1]) - 16.0;
  return {l, 0.01 * l * 500.0 * (curve(xyz[0]) - curve(xyz[1])), 0.01 * l * 200.0 * (curve(xyz[1]) - curve(xyz[2]))};
}

double direct_colour_error(const Colour& rgb_a, const Colour& rgb_b) {
  const auto hyab = [](const Colour& a, const Colour& b) {
    return std::abs(a[0] - b[0]) + std::sqrt(std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
  };
  const double largest = std::pow(hyab(lab_hunt({0, 1, 0}), lab_hunt({0, 0, 1})), 0.7);
  const double e = std::pow(hyab(lab_hunt(rgb_a), lab_hunt(rgb_b)), 0.7);
  return e < 0.4 * largest ? 0.95 * e / (0.4 * largest) : 0.95 + 0.05 * (e - 0.4 * largest) / (0.6 * largest);
}

/// Returns the colour of a pixel, linear light, after filtering with the contrast sensitivity.
Colour direct_filtered_colour(const Matrix& ycxcz, int x, int y) {
  constexpr int kRadius = 10;
  constexpr std::array<std::array<double, 4>, 3> kTerms = {
      {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
  Colour sums{}, weights{};
  for (int j = -kRadius; j <= kRadius; ++j)
    for (int i = -kRadius; i <= kRadius; ++i)
      for (int c = 0; c < 3; ++c) {
        const auto [a1, b1, a2, b2] = kTerms[c];
        const double z = (i * i + j * j) / (kDegree * kDegree);
        const double w = a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * z / b1) +
                         a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * z / b2);
        sums[c] += w * ycxcz.at(x + i, y + j)[c];
        weights[c] += w;
      }
  const double fy = (sums[0] / weights[0] + 16.0) / 116.0;
  const double rx = (fy + sums[1] / weights[1] / 500.0) * 0.950428545, ry = fy,
               rz = (fy - sums[2] / weights[2] / 200.0) * 1.088900371;
  return {std::clamp(3.241003275 * rx - 1.537398934 * ry - 0.498615861 * rz, 0.0, 1.0),
          std::clamp(-0.969224334 * rx + 1.875930071 * ry + 0.041554224 * rz, 0.0, 1.0),
          std::clamp(0.055639423 * rx - 0.204011202 * ry + 1.057148933 * rz, 0.0, 1.0)};
}

/// Returns the magnitude of the response to edges (order 1) or points (order 2) in a pixel.
double direct_feature(const Matrix& ycxcz, int x, int y, int order) {
  const double sd = 0.5 * 0.082 * kDegree;
  const int radius = int(std::ceil(3.0 * sd));
  const auto kernel = [&](int i, int j) {
    const double g = std::exp(-(i * i + j * j) / (2.0 * sd * sd));
    return order == 1 ? -i * g : (i * i / (sd * sd) - 1.0) * g;
  };
  double positive_sum = 0.0, negative_sum = 0.0, along_x = 0.0, along_y = 0.0;
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i)
      (kernel(i, j) > 0.0 ? positive_sum : negative_sum) += std::abs(kernel(i, j));
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) {
      const double w = kernel(i, j) / (kernel(i, j) > 0.0 ? positive_sum : negative_sum);
      along_x += w * (ycxcz.at(x + i, y + j)[0] + 16.0) / 116.0;
      along_y += w * (ycxcz.at(x + j, y + i)[0] + 16.0) / 116.0;
    }
  return std::hypot(along_x, along_y);
}

Matrix direct_ycxcz(const Image& image, const ClassMap& map) {
  Matrix out{map.width, map.height, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      Colour c;
      for (int i = 0; i < 3; ++i) {
        c[i] = std::clamp<double>(image.planes[image.planes.size() == 1 ? 0 : i].at(x, y), 0.0, 1.0);
        if (image.planes.size() == 1) c[i] = c[i] <= 0.04045 ? c[i] / 12.92 : std::pow((c[i] + 0.055) / 1.055, 2.4);
        if (map.row(y)[x] == PixelClass::kBackground) c[i] = 1.0;
      }
      const Colour xyz = relative_xyz(c);
      out.texels.push_back({116.0 * xyz[1] - 16.0, 500.0 * (xyz[0] - xyz[1]), 200.0 * (xyz[1] - xyz[2])});
    }
  return out;
}

/// Returns the max difference between flip_map() and the direct implementation, over covered pixels.
double flip_difference(const Image& picture, const Image& truth, const ClassMap& map) {
  const Plane fast = flip_map(picture, truth, map);
  const Matrix a = direct_ycxcz(picture, map), b = direct_ycxcz(truth, map);
  double max = 0.0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      if (map.row(y)[x] == PixelClass::kBackground) {
        EXPECT_EQ(fast.at(x, y), 0.0f);
        continue;
      }
      const double edge = std::abs(direct_feature(a, x, y, 1) - direct_feature(b, x, y, 1));
      const double point = std::abs(direct_feature(a, x, y, 2) - direct_feature(b, x, y, 2));
      const double feature = std::sqrt(std::max(edge, point) / std::sqrt(2.0));
      const double error = std::pow(
          direct_colour_error(direct_filtered_colour(a, x, y), direct_filtered_colour(b, x, y)), 1.0 - feature);
      max = std::max(max, std::abs(error - fast.at(x, y)));
    }
  return max;
}

TEST(Metrics, FlipMatchesThePaper) {
  constexpr int kWidth = 27, kHeight = 22;
  const Texel step = [](int x, int y) { return x + y > 24 ? 0.9f : 0.1f; };
  for (const ClassMap& map : {all_open(kWidth, kHeight), with_holes(kWidth, kHeight)}) {
    EXPECT_LT(flip_difference(grey(kWidth, kHeight, waves(1)), grey(kWidth, kHeight, waves(2)), map), 1e-4);
    EXPECT_LT(flip_difference(grey(kWidth, kHeight, step), flat(kWidth, kHeight, 0.5f), map), 1e-4);
    EXPECT_LT(flip_difference(colour(kWidth, kHeight, waves(1), waves(2), noise(3)),
                              colour(kWidth, kHeight, waves(4), step, waves(5)), map),
              1e-4);
  }
}

TEST(Metrics, FlipOfConstants) {
  const auto flip = [](const Image& a, const Image& b) { return score(a, b, all_open(30, 30)).covered.flip; };
  // White and black differ only in L*, by 100. L*a*b* of pure green is (87.73, -86.18, 83.18), of pure
  // blue (32.30, 79.19, -107.86), as in published tables.
  const double chroma = std::hypot(0.8773 * -86.18 - 0.3230 * 79.19, 0.8773 * 83.18 - 0.3230 * -107.86);
  const double largest = std::pow(87.73 - 32.30 + chroma, 0.7);
  const double expected = 0.95 + 0.05 * (std::pow(100.0, 0.7) - 0.4 * largest) / (0.6 * largest);
  EXPECT_NEAR(flip(flat(30, 30, 0.0f), flat(30, 30, 1.0f)), expected, 1e-4);
  EXPECT_NEAR(flip(flat(30, 30, 0.0f), flat(30, 30, 1.0f)), direct_colour_error({0, 0, 0}, {1, 1, 1}), 1e-5);
  // The scale ends at pure green against pure blue.
  EXPECT_NEAR(flip(flat_colour(30, 30, {0, 1, 0}), flat_colour(30, 30, {0, 0, 1})), 1.0, 1e-5);
  // Values outside [0, 1] are displayed as 0 or 1.
  EXPECT_NEAR(flip(flat(30, 30, -3.0f), flat(30, 30, 7.0f)), flip(flat(30, 30, 0.0f), flat(30, 30, 1.0f)), 1e-7);
  EXPECT_EQ(flip(flat(30, 30, 1.0f), flat(30, 30, 7.0f)), 0.0);
}

TEST(Metrics, FlipIsSymmetric) {
  const Image a = colour(31, 26, waves(1), waves(2), waves(3)), b = colour(31, 26, waves(4), noise(5), waves(6));
  const Plane forward = flip_map(a, b, with_holes(31, 26)), backward = flip_map(b, a, with_holes(31, 26));
  for (int y = 0; y < 26; ++y) EXPECT_TRUE(same_bits(forward.row(y), backward.row(y), 31 * sizeof(float)));
}

TEST(Metrics, FlipTreatsGreyAsDisplayValues) {
  // A grey picture holds display values; light passes through the sRGB curve first.
  const Texel a = waves(1), b = waves(2);
  const auto light = [](const Texel& shown) {
    return [shown](int x, int y) {
      const double v = shown(x, y);
      return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    };
  };
  const ClassMap map = all_open(40, 30);
  const double shown = score(grey(40, 30, a), grey(40, 30, b), map).covered.flip;
  const double linear =
      score(colour(40, 30, light(a), light(a), light(a)), colour(40, 30, light(b), light(b), light(b)), map)
          .covered.flip;
  EXPECT_GT(shown, 0.1);
  EXPECT_NEAR(shown, linear, 1e-5);
}

TEST(Metrics, FlipRatesALineAboveAHaze) {
  constexpr int kSide = 81;
  constexpr double kSpread = 8.0;  // pixels
  const auto shown = [](double light) {
    return float(light <= 0.0031308 ? light * 12.92 : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055);
  };
  const Image truth = flat(kSide, kSide, shown(0.2));
  const Image line = grey(kSide, kSide, [&](int x, int) { return shown(x == 40 ? 0.7 : 0.2); });
  const Image haze = grey(kSide, kSide, [&](int x, int) {
    const double u = (x - 40) / kSpread;
    return shown(0.2 + 0.5 * std::exp(-0.5 * u * u) / (kSpread * std::sqrt(2.0 * kPi)));
  });
  const Plane sharp = flip_map(line, truth, all_open(kSide, kSide));
  const Plane soft = flip_map(haze, truth, all_open(kSide, kSide));
  EXPECT_GT(sharp.at(40, 40), 3.0f * soft.at(40, 40));
  EXPECT_GT(soft.at(40, 40), 0.0f);
}

// ---- classes, on analytic scenes

struct Hit {
  double t = kInfinity;
  glm::dvec3 normal{0.0};
  int object = -1;
};

/// A function that returns the first hit of a ray, in view space.
using Scene = std::function<Hit(glm::dvec3 origin, glm::dvec3 direction)>;

Hit nearer(const Hit& a, const Hit& b) { return a.t <= b.t ? a : b; }

Hit hit_plane(glm::dvec3 o, glm::dvec3 d, glm::dvec3 normal, double offset, int object) {
  normal = glm::normalize(normal);
  const double t = (offset - glm::dot(normal, o)) / glm::dot(normal, d);
  if (!(t > 0.0)) return {};
  return {t, glm::dot(normal, d) < 0.0 ? normal : -normal, object};
}

/// Intersects a sphere, or an infinite cylinder around `axis` (of length 1).
Hit hit_round(glm::dvec3 o, glm::dvec3 d, glm::dvec3 centre, double radius, int object, glm::dvec3 axis = {0, 0, 0}) {
  const auto across = [axis](glm::dvec3 v) { return v - axis * glm::dot(axis, v); };
  const glm::dvec3 from = across(o - centre), along = across(d);
  const double a = glm::dot(along, along), b = glm::dot(from, along), c = glm::dot(from, from) - radius * radius;
  const double root = b * b - a * c;
  if (!(root > 0.0)) return {};
  const double t = (-b - std::sqrt(root)) / a;
  return {t, glm::normalize(from + t * along), object};
}

/// A rendered scene.
struct Cast {
  GBuffer gbuffer;
  std::vector<int> objects;
  int object(int x, int y) const { return objects[std::size_t(y) * gbuffer.info.width + x]; }
};

/// Renders a scene around depth 10. The window is 8 high there.
Cast cast(int width, int height, Projection projection, const Scene& scene, double scale = 1.0) {
  Cast out;
  out.gbuffer.info.width = width;
  out.gbuffer.info.height = height;
  const bool perspective = projection == Projection::kPerspective;
  Camera& camera = out.gbuffer.info.camera;
  camera.projection = projection;
  camera.top = float(perspective ? 0.4 : 4.0 * scale);
  camera.bottom = -camera.top;
  camera.right = camera.top * float(width) / float(height);
  camera.left = -camera.right;
  Image& layer = out.gbuffer.layers.emplace_back(width, height);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) layer.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double half = perspective ? 0.4 : 4.0;
      const double u = half * (2.0 * (x + 0.5) - width) / height, v = half * (1.0 - 2.0 * (y + 0.5) / height);
      const Hit hit = perspective ? scene({0, 0, 0}, {u, v, -1}) : scene({u, v, 0}, {0, 0, -1});
      layer.planes[0].at(x, y) = float(hit.t * scale);
      for (int i = 0; i < 3; ++i) layer.planes[1 + i].at(x, y) = float(hit.normal[i]);
      out.objects.push_back(hit.object);
    }
  return out;
}

constexpr std::array<Projection, 2> kProjections = {Projection::kPerspective, Projection::kOrthographic};

int count(const ClassMap& map, PixelClass pixel) { return int(std::ranges::count(map.classes, pixel)); }

Scene sphere_before_wall(double radius, double gap) {
  return [=](glm::dvec3 o, glm::dvec3 d) {
    return nearer(hit_round(o, d, {0.1, -0.2, -10}, radius, 1), hit_plane(o, d, {0, 0, 1}, -10 - gap, 0));
  };
}

/// Returns whether a pixel within `reach` along each axis shows another object.
bool near_other(const Cast& picture, int x, int y, int reach) {
  const PictureInfo& info = picture.gbuffer.info;
  for (int j = std::max(y - reach, 0); j <= std::min(y + reach, info.height - 1); ++j)
    for (int i = std::max(x - reach, 0); i <= std::min(x + reach, info.width - 1); ++i)
      if (picture.object(i, j) != picture.object(x, y)) return true;
  return false;
}

bool beside_other(const Cast& picture, int x, int y) {
  const PictureInfo& info = picture.gbuffer.info;
  const int object = picture.object(x, y);
  return (x > 0 && picture.object(x - 1, y) != object) || (x + 1 < info.width && picture.object(x + 1, y) != object) ||
         (y > 0 && picture.object(x, y - 1) != object) || (y + 1 < info.height && picture.object(x, y + 1) != object);
}

/// Expects silhouettes on both sides of all borders between objects, and nowhere else. If only a few pixels of an
/// object are side by side, they may count as thin.
void expect_outlines(const Cast& picture) {
  const PictureInfo& info = picture.gbuffer.info;
  const ClassMap map = classify(picture.gbuffer);
  int missed = 0, false_positives = 0, outlines = 0;
  for (int y = 0; y < info.height; ++y)
    for (int x = 0; x < info.width; ++x) {
      const PixelClass pixel = map.row(y)[x];
      if (pixel == PixelClass::kBorder) continue;
      if (picture.object(x, y) < 0) {
        EXPECT_EQ(pixel, PixelClass::kBackground);
        continue;
      }
      const bool outline = pixel == PixelClass::kSilhouette || pixel == PixelClass::kThin;
      if (beside_other(picture, x, y)) {
        ++outlines;
        missed += !outline;
      } else if (!near_other(picture, x, y, info.height / 256)) {
        false_positives += outline;
      }
    }
  EXPECT_GT(outlines, info.height / 2);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(false_positives, 0);
}

TEST(MetricsClasses, SphereHasASilhouetteAllAround) {
  for (const Projection projection : kProjections)
    for (const int size : {128, 300, 512}) {
      SCOPED_TRACE(size);
      expect_outlines(cast(size, size, projection, sphere_before_wall(2.0, 2.0)));
      expect_outlines(cast(size, size, projection, sphere_before_wall(1.0, 30.0)));
      expect_outlines(cast(size, size, projection, [](glm::dvec3 o, glm::dvec3 d) {
        return hit_round(o, d, {0.1, -0.2, -10}, 2.0, 1);
      }));
      // The gap behind the widest part is an eighth of the radius.
      if (size == 512) expect_outlines(cast(size, size, projection, sphere_before_wall(3.0, 0.375)));
    }
}

TEST(MetricsClasses, SilhouetteWidthFollowsTheResolution) {
  // The middle row shows wall, sphere, wall. Silhouettes have 1 pixel on either side at size 256, and 2 at 1024.
  for (const auto& [size, width] : {std::pair{256, 1}, {1024, 2}}) {
    const ClassMap map = classify(cast(size, size, Projection::kPerspective, sphere_before_wall(2.0, 3.0)).gbuffer);
    EXPECT_EQ(std::count(map.row(size / 2), map.row(size / 2) + size, PixelClass::kSilhouette), 4 * width) << size;
  }
}

TEST(MetricsClasses, HalfSunkSphereHasNoSilhouette) {
  // This is true only in orthographic views: in perspective, the outline is in front of the circle where the sphere
  // meets the wall.
  for (const double radius : {0.1, 0.5, 2.0}) {
    const Scene scene = sphere_before_wall(radius, 0.0);
    const ClassMap map = classify(cast(400, 400, Projection::kOrthographic, scene).gbuffer);
    EXPECT_EQ(count(map, PixelClass::kOpen) + count(map, PixelClass::kBorder), 400 * 400) << radius;
  }
}

TEST(MetricsClasses, GrazingPlaneHasNoSilhouette) {
  for (const Projection projection : kProjections)
    for (const double tilt : {0.0, 0.3, 1.0, 3.0, 10.0, 30.0})
      for (const double turn : {0.0, 0.7, 2.0}) {
        // In perspective the plane must not end within the picture.
        if (projection == Projection::kPerspective && tilt > 2.0) continue;
        const glm::dvec3 normal(tilt * std::cos(turn), tilt * std::sin(turn), 1.0);
        const ClassMap map = classify(cast(200, 160, projection, [&](glm::dvec3 o, glm::dvec3 d) {
                                        return hit_plane(o, d, normal, -150.0, 0);
                                      }).gbuffer);
        EXPECT_EQ(count(map, PixelClass::kOpen) + count(map, PixelClass::kBorder), 200 * 160) << tilt << " " << turn;
      }
}

TEST(MetricsClasses, GrazingPlanesHaveSilhouettesOnlyAtSteps) {
  test::at_grazing_angles({.width = 200, .height = 160, .error_deg = 2.0}, [](const test::TiltedPlane& plane) {
    const ClassMap map = classify(test::seen(plane));
    EXPECT_EQ(count(map, PixelClass::kOpen) + count(map, PixelClass::kBorder), 200 * 160);
  });
  test::at_grazing_angles({.width = 200, .height = 160, .step_px = 20.0}, [](const test::TiltedPlane& plane) {
    const ClassMap map = classify(test::seen(plane));
    for (int y = 10; y < 150; ++y)
      for (int x = 10; x < 190; ++x)
        ASSERT_EQ(map.row(y)[x], x == 99 || x == 100 ? PixelClass::kSilhouette : PixelClass::kOpen) << x << ", " << y;
  });
}

TEST(MetricsClasses, GroundHasASilhouetteAtTheHorizon) {
  // The horizon lies between rows 149 and 150, just above the middle of the picture.
  const Cast ground = cast(300, 300, Projection::kPerspective, [](glm::dvec3 o, glm::dvec3 d) {
    return hit_plane(o, d, {0, 1, 0}, -1.0, 0);
  });
  const ClassMap map = classify(ground.gbuffer);
  for (int x = 20; x < 280; ++x) {
    EXPECT_EQ(map.row(149)[x], PixelClass::kBackground);
    EXPECT_EQ(map.row(150)[x], PixelClass::kSilhouette);
    for (int y = 151; y < 280; ++y) EXPECT_EQ(map.row(y)[x], PixelClass::kOpen);
  }
}

TEST(MetricsClasses, CreasesHaveNoSilhouette) {
  // Three random planes that all face the camera: the farthest hit forms a convex corner, the nearest a concave one.
  for (unsigned seed = 0; seed < 24; ++seed) {
    std::array<glm::dvec3, 3> normals;
    for (unsigned i = 0; i < 3; ++i) {
      const double turn = 2.0 * kPi * (i + 0.8 * random_value(seed, 1, int(i))) / 3.0;
      // Steeper planes would face away, or reach the camera, in a corner of the picture.
      const double tilt = 0.2 + 1.3 * random_value(seed, 2, int(i));
      normals[i] = glm::dvec3(tilt * std::cos(turn), tilt * std::sin(turn), 1.0);
    }
    for (const Projection projection : kProjections)
      for (const bool convex : {false, true}) {
        const Cast corner = cast(220, 180, projection, [&](glm::dvec3 o, glm::dvec3 d) {
          Hit found{convex ? 0.0 : kInfinity};
          for (int i = 0; i < 3; ++i) {
            const double offset = glm::dot(glm::normalize(normals[i]), glm::dvec3(0.2, 0.1, -10.0));
            const Hit hit = hit_plane(o, d, normals[i], offset, i);
            if (convex ? hit.t > found.t : hit.t < found.t) found = hit;
          }
          return found;
        });
        for (int i = 0; i < 3; ++i) EXPECT_GT(std::ranges::count(corner.objects, i), 0);
        const ClassMap map = classify(corner.gbuffer);
        EXPECT_EQ(count(map, PixelClass::kOpen) + count(map, PixelClass::kBorder), 220 * 180)
            << "seed " << seed << (projection == Projection::kOrthographic ? " ortho" : " persp")
            << (convex ? " convex" : " concave");
      }
  }
}

TEST(MetricsClasses, RodIsThinAtAnyResolution) {
  // In front of a wall, a rod with a width of 0.8 % of the height is thin, a rod with a width of 4 % is not.
  for (const Projection projection : kProjections)
    for (const double angle : {0.0, 0.4, kPi / 4.0, kPi / 2.0, 2.5})
      for (const int size : {512, 1024}) {
        SCOPED_TRACE(testing::Message() << angle << " at " << size);
        const auto rod = [&](double fraction) {
          return cast(size, size, projection, [&, radius = 0.5 * fraction * 8.0](glm::dvec3 o, glm::dvec3 d) {
            return nearer(hit_round(o, d, {0.01, 0.02, -10}, radius, 1, {std::cos(angle), std::sin(angle), 0}),
                          hit_plane(o, d, {0, 0, 1}, -11, 0));
          });
        };
        const Cast narrow = rod(0.008), wide = rod(0.04);
        const ClassMap map = classify(narrow.gbuffer), wide_map = classify(wide.gbuffer);
        int pixels = 0, thin = 0, thin_wall = 0, thin_wide = 0;
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            if (map.row(y)[x] == PixelClass::kBorder) continue;
            const bool on_rod = narrow.object(x, y) == 1, is_thin = map.row(y)[x] == PixelClass::kThin;
            pixels += on_rod;
            thin += on_rod && is_thin;
            thin_wall += !on_rod && is_thin;
            thin_wide += wide_map.row(y)[x] == PixelClass::kThin;
          }
        EXPECT_GT(pixels, 3 * size);
        EXPECT_EQ(thin, pixels);
        EXPECT_EQ(thin_wall, 0);
        EXPECT_EQ(thin_wide, 0);
      }
}

TEST(MetricsClasses, BorderIsAFractionOfTheShorterSide) {
  const Scene wall = [](glm::dvec3 o, glm::dvec3 d) { return hit_plane(o, d, {0, 0, 1}, -10, 0); };
  const ClassMap map = classify(cast(200, 100, Projection::kPerspective, wall).gbuffer);
  EXPECT_EQ(map.width, 200);
  EXPECT_EQ(map.height, 100);
  EXPECT_EQ(map.row(50)[3], PixelClass::kBorder);
  EXPECT_EQ(map.row(50)[4], PixelClass::kOpen);
  EXPECT_EQ(map.row(95)[100], PixelClass::kOpen);
  EXPECT_EQ(map.row(96)[100], PixelClass::kBorder);
  EXPECT_EQ(count(map, PixelClass::kOpen), 192 * 92);
  EXPECT_EQ(classify(cast(1, 1, Projection::kPerspective, wall).gbuffer).classes,
            std::vector<PixelClass>{PixelClass::kBorder});
}

TEST(MetricsClasses, ScaleOfTheSceneChangesNothing) {
  for (const Projection projection : kProjections) {
    const auto map = [&](double scale) {
      return classify(cast(256, 256, projection, sphere_before_wall(2.0, 0.5), scale).gbuffer).classes;
    };
    const auto unscaled = map(1.0);
    EXPECT_EQ(unscaled, map(0x1p-20));
    EXPECT_EQ(unscaled, map(0x1p+20));
  }
}

TEST(MetricsClasses, AnyInputHasAClass) {
  const GBuffer hostile = test::hostile_gbuffer(90, 70, 5);
  const ClassMap map = classify(hostile);
  const Plane& depth = hostile.layers[0].plane("depth");
  for (int y = 0; y < 70; ++y)
    for (int x = 0; x < 90; ++x) {
      const bool surface = std::isfinite(depth.at(x, y)) && depth.at(x, y) > 0.0f;
      EXPECT_EQ(map.row(y)[x] != PixelClass::kBackground, surface);
    }
  // A picture without normals has silhouettes, too; a picture without depth has none.
  GBuffer without_planes = cast(256, 256, Projection::kPerspective, sphere_before_wall(2.0, 2.0)).gbuffer;
  const int outlines = count(classify(without_planes), PixelClass::kSilhouette);
  GBuffer no_normals = without_planes;
  no_normals.layers[0] = Image(256, 256);
  no_normals.layers[0].add("depth") = without_planes.layers[0].plane("depth");
  EXPECT_GE(count(classify(no_normals), PixelClass::kSilhouette), outlines);
  without_planes.layers[0] = Image(256, 256);
  EXPECT_EQ(count(classify(without_planes), PixelClass::kBackground), 256 * 256);
  without_planes.layers.clear();
  EXPECT_EQ(count(classify(without_planes), PixelClass::kBackground), 256 * 256);
}

}  // namespace
}  // namespace umbrage
