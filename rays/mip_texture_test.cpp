// Mip levels against means in double precision. The test of alpha against a bound, which mostly reads ranges of alpha.
#include "rays/mip_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/color.h"
#include "core/hash.h"

namespace umbrage {
namespace {

enum class Alpha { kOpaque, kAny, kClear };

/// A texture of random texels. kAny: opaque in its lower half.
Texture random_texture(int width, int height, bool linear, Alpha alpha) {
  Texture texture{.name = {}, .width = width, .height = height, .rgba = {}, .linear = linear};
  for (std::uint32_t k = 0; k < std::uint32_t(4 * width * height); ++k) {
    const bool random = k % 4 < 3 || (alpha == Alpha::kAny && k < std::uint32_t(2 * width * height));
    texture.rgba.push_back(random ? std::uint8_t(hash(k, 7)) : alpha == Alpha::kClear ? std::uint8_t(0) : 255);
  }
  return texture;
}

/// Returns the largest difference of a level to the means of the texels of the finer one, in units of a byte.
double largest_error(const MipLevel& finer, const MipLevel& level, bool linear) {
  double error = 0.0;
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      const int x1 = x + 1 == level.width ? finer.width : 2 * x + 2,
                y1 = y + 1 == level.height ? finer.height : 2 * y + 2;
      double weighted[3] = {}, plain[3] = {}, alpha = 0.0, count = 0.0;
      for (int j = 2 * y; j < y1; ++j)
        for (int i = 2 * x; i < x1; ++i, ++count) {
          const std::uint8_t* p = &finer.rgba[std::size_t(4 * (j * finer.width + i))];
          for (int c = 0; c < 3; ++c) {
            const double light = linear ? p[c] / 255.0 : double(linear_from_srgb(float(p[c]) / 255.0f));
            plain[c] += light;
            weighted[c] += light * p[3];
          }
          alpha += p[3];
        }
      const std::uint8_t* out = &level.rgba[std::size_t(4 * (y * level.width + x))];
      for (int c = 0; c < 3; ++c) {
        const double mean = alpha > 0.0 ? weighted[c] / alpha : plain[c] / count;
        error = std::max(error, std::abs(255.0 * (linear ? mean : double(srgb_from_linear(float(mean)))) - out[c]));
      }
      error = std::max(error, std::abs(alpha / count - out[3]));
    }
  return error;
}

TEST(MipTexture, LevelsAreMeansOfLinearLightWeightedByAlpha) {
  constexpr int kSizes[][2] = {{64, 32}, {7, 10}, {10, 7}, {1, 9}, {8, 1}, {3, 3}};
  constexpr double kMaxError = 0.58;  // half a byte, and roundings to 16 bits, of which a dark byte of sRGB spans 20
  for (const auto& [width, height] : kSizes)
    for (const bool linear : {false, true})
      for (const Alpha alpha : {Alpha::kOpaque, Alpha::kAny, Alpha::kClear}) {
        const Texture texture = random_texture(width, height, linear, alpha);
        const MipTexture mips = make_mips(texture);
        ASSERT_EQ(mips.levels.back().width * mips.levels.back().height, 1);
        for (std::size_t k = 0; k + 1 < mips.levels.size(); ++k)
          EXPECT_LE(largest_error(mips.levels[k], mips.levels[k + 1], linear), kMaxError)
              << width << " x " << height << ", level " << k + 1 << ", linear " << linear << ", alpha " << int(alpha);
      }
}

/// Returns a texture whose alpha has discs of full, no and random alpha.
Texture spotted(int width, int height, std::mt19937& random) {
  Texture texture{.width = width, .height = height};
  texture.rgba.resize(std::size_t(width) * std::size_t(height) * 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int kind = (int(std::hypot(x % 40 - 20, y % 30 - 15)) / 6 + x / 40) % 3;
      texture.rgba[std::size_t(y * width + x) * 4 + 3] = kind == 0 ? 0 : kind == 1 ? 255 : std::uint8_t(random());
    }
  return texture;
}

TEST(MipTexture, AlphaReachesABoundWhereTheSampleDoes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> anywhere(-1.5f, 2.5f);
  int reached = 0, count = 0;
  for (const auto& [width, height] : {std::pair(128, 64), {67, 41}, {1, 9}, {8, 1}})
    for (const bool nearest : {false, true})
      for (const bool clamped : {false, true}) {
        Texture texture = spotted(width, height, random);
        texture.nearest = nearest;
        texture.clamped = clamped;
        MipTexture mips = make_mips(texture);
        add_alpha_ranges(mips);
        for (const float opacity : {1.0f, 0.7f})
          for (const float bound : {0.0f, 0.002f, 128.0f / 255.0f, 0.5f, 0.998f, 1.0f})
            for (int k = 0; k < 2000; ++k) {
              const glm::vec2 uv(anywhere(random), anywhere(random));
              const bool expected = sample_alpha(mips, uv) * opacity >= bound;
              ASSERT_EQ(alpha_reaches(mips, uv, opacity, bound), expected)
                  << width << " x " << height << ", at " << uv.x << ", " << uv.y << ", bound " << bound;
              reached += expected;
              ++count;
            }
        for (const float odd : {1e9f, -3e30f, std::numeric_limits<float>::quiet_NaN()})
          EXPECT_EQ(alpha_reaches(mips, {odd, 0.4f}, 1.0f, 0.5f), sample_alpha(mips, {odd, 0.4f}) >= 0.5f) << odd;
      }
  EXPECT_GT(reached, count / 4);
  EXPECT_LT(reached, count * 3 / 4);
}

TEST(MipTexture, TheRangeOfAlphaContainsEveryTexel) {
  Texture texture{.width = 19, .height = 11};
  texture.rgba.assign(19 * 11 * 4, 90);
  texture.rgba[(10 * 19 + 18) * 4 + 3] = 80;
  texture.rgba[3] = 100;
  MipTexture mips = make_mips(texture);
  add_alpha_ranges(mips);
  EXPECT_EQ(whole_range(mips).min, 80);
  EXPECT_EQ(whole_range(mips).max, 100);
}

}  // namespace
}  // namespace umbrage
