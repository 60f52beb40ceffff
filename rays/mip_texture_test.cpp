// Mip levels against means in double precision.
#include "rays/mip_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

}  // namespace
}  // namespace umbrage
