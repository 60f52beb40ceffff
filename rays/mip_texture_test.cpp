// Filtered texture lookup: the test of alpha against a bound, which mostly reads ranges of alpha instead of texels.
#include "rays/mip_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace umbrage {
namespace {

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
