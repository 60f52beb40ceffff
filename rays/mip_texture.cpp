#include "rays/mip_texture.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "core/byte_transfer.h"
#include "core/color.h"

namespace umbrage {
namespace {

constexpr int kMaxTaps = 8;  // along the longer axis: an anisotropy of 8, as usual in games

const std::array<float, 256> kLinearFromSrgb = [] {
  std::array<float, 256> t{};
  for (int i = 0; i < 256; ++i) t[i] = linear_from_srgb(float(i) / 255.0f);
  return t;
}();

// n / 255 as a table, because converting costs more than a lookup here.
const std::array<float, 256> kUnitFromByte = [] {
  std::array<float, 256> t{};
  for (int i = 0; i < 256; ++i) t[i] = float(i) * (1.0f / 255.0f);
  return t;
}();

const std::uint8_t* bytes_of(const MipLevel& level, int x, int y) {
  return level.rgba.data() + (std::size_t(y) * level.width + x) * 4;
}

glm::vec4 srgb_texel(const MipLevel& level, int x, int y) {
  const std::uint8_t* p = bytes_of(level, x, y);
  return {kLinearFromSrgb[p[0]], kLinearFromSrgb[p[1]], kLinearFromSrgb[p[2]], kUnitFromByte[p[3]]};
}

struct Bilinear {
  int x0, x1, y0, y1;
  float fx, fy;
};

/// Returns the largest integer not above x, for |x| below 2^31. std::floor is a function call on machines without SSE4.
int floor_of(float x) {
  const int i = int(x);
  return float(i) > x ? i - 1 : i;
}

/// Returns the fractional part of a texture coordinate; 0 if it is not finite or too large to have one.
float fraction_of(float x) {
  constexpr float kNoFraction = 8388608.0f;  // 2^23
  return std::abs(x) < kNoFraction ? x - float(floor_of(x)) : 0.0f;
}

/// Returns the indices of texel `first` and the next one, with repetition; `first` is at least -1 and below `size`.
void neighbours(int first, int size, int& low, int& high) {
  low = first < 0 ? size - 1 : first;
  high = first + 1 >= size ? 0 : first + 1;
}

/// Converts texture coordinates to fractions of the texture from its top left corner. Takes the fractional part first,
/// so that large coordinates keep the bits of their fraction.
glm::vec2 fraction_from_top_left(const MipTexture& texture, glm::vec2 uv) {
  if (texture.levels[0].clamped) return {uv.x, 1.0f - uv.y};
  return {fraction_of(uv.x), 1.0f - fraction_of(uv.y)};
}

/// Returns where a fraction of a side is between the centres of its texels.
float texel_position(float fraction, int size, bool clamped) {
  const float x = fraction * float(size) - 0.5f;
  return clamped ? std::min(std::max(0.0f, x), float(size - 1)) : x;
}

inline Bilinear bilinear_at(const MipLevel& level, glm::vec2 fraction) {
  const float x = texel_position(fraction.x, level.width, level.clamped);
  const float y = texel_position(fraction.y, level.height, level.clamped);
  Bilinear b;
  const int ix = floor_of(x), iy = floor_of(y);
  neighbours(std::min(ix, level.width - 1), level.width, b.x0, b.x1);
  neighbours(std::min(iy, level.height - 1), level.height, b.y0, b.y1);
  b.fx = x - float(ix);
  b.fy = y - float(iy);
  if (level.nearest) {
    b.fx = b.fx < 0.5f ? 0.0f : 1.0f;
    b.fy = b.fy < 0.5f ? 0.0f : 1.0f;
  }
  return b;
}

/// Adds the bilinear value of a level of sRGB values, times a weight, to `sum`. Inlined, because a returned vec4 would
/// be stored in halves, and loading it as a whole would stall.
inline void add_srgb_level(const MipLevel& level, glm::vec2 fraction, float weight, glm::vec4& sum) {
  const Bilinear b = bilinear_at(level, fraction);
  const float lower = b.fy * weight, upper = weight - lower;
  sum += srgb_texel(level, b.x0, b.y0) * (upper - upper * b.fx) + srgb_texel(level, b.x1, b.y0) * (upper * b.fx) +
         srgb_texel(level, b.x0, b.y1) * (lower - lower * b.fx) + srgb_texel(level, b.x1, b.y1) * (lower * b.fx);
}

/// Does the same for a texture of linear values, in integers: a sum of 64 bits holds red, green and blue in 21 bits
/// each, with weights of 12 bits, finer than those of GPUs. Leaves alpha as it is.
inline void add_linear_level(const MipLevel& level, glm::vec2 fraction, float weight, glm::vec4& sum) {
  constexpr float kOne = 4096.0f;
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  const Bilinear b = bilinear_at(level, fraction);
  const auto spread = [&](int x, int y) -> std::uint64_t {
    const std::uint8_t* p = bytes_of(level, x, y);
    return std::uint64_t(p[0]) | std::uint64_t(p[1]) << 21 | std::uint64_t(p[2]) << 42;
  };
  const auto right = std::uint64_t(b.fx * kOne + 0.5f), low = std::uint64_t(b.fy * kOne + 0.5f);
  const std::uint64_t one = std::uint64_t(kOne), corner = (right * low + one / 2) / one;  // the weights sum up to `one`
  const std::uint64_t total = spread(b.x0, b.y0) * (one - right - low + corner) +
                              spread(b.x1, b.y0) * (right - corner) + spread(b.x0, b.y1) * (low - corner) +
                              spread(b.x1, b.y1) * corner;
  const float scale = weight / (255.0f * kOne);
  sum.r += float(int(total & kMask)) * scale;
  sum.g += float(int(total >> 21 & kMask)) * scale;
  sum.b += float(int(total >> 42)) * scale;
}

/// Computes log2(x) of a finite x >= 1, within 5e-5: exact at powers of two, a polynomial between.
float log2_of(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const float t = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u) - 1.0f;
  const float curve = 0.442419f + t * (-0.269578f + t * (0.150533f - t * 0.044874f));
  return float(int(bits >> 23) - 127) + (t + t * (1.0f - t) * curve);
}

/// Averages the texels of a level that a texel of the next one covers: two per axis, three at the end of an odd side.
void average(const MipLevel& level, const ByteTransfer& transfer, int x0, int x1, int y0, int y1, std::uint8_t* out) {
  std::uint32_t weighted[3] = {}, plain[3] = {}, alpha = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const std::uint8_t* p = bytes_of(level, x, y);
      for (int c = 0; c < 3; ++c) {
        plain[c] += transfer.linear[p[c]];
        weighted[c] += transfer.linear[p[c]] * p[3];
      }
      alpha += p[3];
    }
  const auto count = std::uint32_t((x1 - x0) * (y1 - y0));
  for (int c = 0; c < 3; ++c)
    out[c] = transfer.byte[alpha > 0 ? (weighted[c] + alpha / 2) / alpha : (plain[c] + count / 2) / count];
  out[3] = std::uint8_t((alpha + count / 2) / count);
}

/// Averages 2 x 2 opaque texels: `count` times those of two rows.
void average_pairs(const std::uint8_t* upper, const std::uint8_t* lower, int count, bool linear, std::uint8_t* out) {
  if (!linear) {
    const ByteTransfer& transfer = byte_transfer(false);
    for (int x = 0; x < count; ++x, upper += 8, lower += 8) {
      for (int c = 0; c < 3; ++c)
        *out++ = transfer.byte[(transfer.linear[upper[c]] + transfer.linear[upper[c + 4]] + transfer.linear[lower[c]] +
                                transfer.linear[lower[c + 4]] + 2) /
                               4];
      *out++ = 255;
    }
    return;
  }
  constexpr std::uint64_t kMask = 0x00ff00ff00ff00ff, kHalf = 0x00020002;  // every other byte has space for a sum
  const auto mean = [](std::uint64_t a, std::uint64_t b) {
    const std::uint64_t sum = (a & kMask) + (b & kMask);
    return std::uint32_t((sum + (sum >> 32) + kHalf) >> 2 & kMask);
  };
  for (int x = 0; x < count; ++x, out += 4) {
    std::uint64_t a, b;
    std::memcpy(&a, upper + 8 * x, sizeof a);
    std::memcpy(&b, lower + 8 * x, sizeof b);
    const std::uint32_t texel = mean(a, b) | mean(a >> 8, b >> 8) << 8;
    std::memcpy(out, &texel, sizeof texel);
  }
}

bool is_opaque(std::span<const std::uint8_t> rgba) {
  std::uint8_t common = 255;
  for (std::size_t k = 3; k < rgba.size(); k += 4) common &= rgba[k];
  return common == 255;
}

/// Returns the next level, whose texels are written to `rgba`.
MipLevel half_of(const MipLevel& level, bool linear, std::unique_ptr<std::uint8_t[]>& rgba) {
  constexpr int kRows = 32;  // for each thread at least
  const int width = std::max(level.width / 2, 1), height = std::max(level.height / 2, 1);
  const std::size_t size = std::size_t(width) * std::size_t(height) * 4, row_size = std::size_t(level.width) * 4;
  rgba = std::make_unique_for_overwrite<std::uint8_t[]>(size);
  const auto end_of = [](int k, int half, int whole) { return k + 1 == half ? whole : 2 * k + 2; };
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRows), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const int end = end_of(y, height, level.height);
      const std::uint8_t* upper = bytes_of(level, 0, 2 * y);
      std::uint8_t* out = &rgba[std::size_t(y) * std::size_t(width) * 4];
      int x = 0;
      if (level.width > 1 && end - 2 * y == 2 && is_opaque({upper, 2 * row_size})) {
        x = width - level.width % 2;
        average_pairs(upper, upper + row_size, x, linear, out);
      }
      for (; x < width; ++x)
        average(level, byte_transfer(linear), 2 * x, end_of(x, width, level.width), 2 * y, end, out + 4 * x);
    }
  });
  return {width, height, {rgba.get(), size}, false, level.clamped};
}

}  // namespace

MipTexture make_mips(const Texture& texture) {
  MipTexture mips{.levels = {}, .linear = texture.linear};
  mips.levels.push_back({texture.width, texture.height, texture.rgba, texture.nearest, texture.clamped});
  while (mips.levels.back().width > 1 || mips.levels.back().height > 1)
    mips.levels.push_back(half_of(mips.levels.back(), texture.linear, mips.rgba.emplace_back()));
  return mips;
}

MipFootprint footprint_of(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down) {
  MipFootprint out{.width = texture.levels[0].width, .height = texture.levels[0].height, .uv = uv, .axis = right};
  const glm::vec2 size(out.width, out.height);
  float longer = glm::length(right * size), shorter = glm::length(down * size);
  if (shorter > longer) {
    std::swap(longer, shorter);
    out.axis = down;
  }
  const int last = int(texture.levels.size()) - 1;
  out.finer_level = last;
  if (std::isfinite(longer)) {
    // Round to nearest, so that a footprint that is square up to rounding takes one tap.
    const float ratio = std::clamp(longer / std::max(shorter, 1e-6f), 1.0f, longer > 1.0f ? float(kMaxTaps) : 1.0f);
    out.taps = int(ratio + 0.5f);
    const float width = std::max(longer / float(out.taps), 1.0f);
    const float lod = width > 1.0f ? std::clamp(log2_of(width), 0.0f, float(last)) : 0.0f;
    out.finer_level = int(lod);
    out.blend = lod - float(out.finer_level);
    out.level_count = out.blend > 0.0f ? 2 : 1;
  }
  return out;
}

glm::vec4 sample_filtered(const MipTexture& texture, const MipFootprint& f) {
  const float tap_weight = 1.0f / float(f.taps);
  glm::vec4 sum(0.0f);
  for (int i = 0; i < f.taps; ++i) {
    const glm::vec2 at =
        fraction_from_top_left(texture, f.taps > 1 ? f.uv + f.axis * ((float(i) + 0.5f) * tap_weight - 0.5f) : f.uv);
    for (int level = 0; level < f.level_count; ++level) {
      const MipLevel& texels = texture.levels[std::size_t(f.finer_level + level)];
      const float weight = level == 0 ? tap_weight - tap_weight * f.blend : tap_weight * f.blend;
      if (texture.linear)
        add_linear_level(texels, at, weight, sum);
      else
        add_srgb_level(texels, at, weight, sum);
    }
  }
  return sum;
}

glm::vec4 sample_filtered(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down) {
  return sample_filtered(texture, footprint_of(texture, uv, right, down));
}

namespace {

constexpr int kRangeSide = 16;  // of a square of texels with one alpha range

int range_columns(const MipLevel& level) { return (level.width + kRangeSide - 1) / kRangeSide; }

/// Returns the alpha of a texel, in 255ths.
std::uint8_t alpha_of(const MipLevel& level, int x, int y) { return bytes_of(level, x, y)[3]; }

float bilinear_alpha(const MipLevel& level, const Bilinear& b) {
  const auto alpha = [&](int x, int y) { return float(alpha_of(level, x, y)); };
  const float top = alpha(b.x0, b.y0) * (1.0f - b.fx) + alpha(b.x1, b.y0) * b.fx;
  const float bottom = alpha(b.x0, b.y1) * (1.0f - b.fx) + alpha(b.x1, b.y1) * b.fx;
  return (top * (1.0f - b.fy) + bottom * b.fy) / 255.0f;
}

}  // namespace

float sample_alpha(const MipTexture& texture, glm::vec2 uv) {
  return bilinear_alpha(texture.levels[0], bilinear_at(texture.levels[0], fraction_from_top_left(texture, uv)));
}

void add_alpha_ranges(MipTexture& texture) {
  const MipLevel& level = texture.levels[0];
  const int columns = range_columns(level), rows = (level.height + kRangeSide - 1) / kRangeSide;
  texture.alpha_ranges.assign(std::size_t(columns) * std::size_t(rows), {});
  // Bilinear sampling reads the next texels, too, also beyond the square.
  const auto end_of = [](int begin, int size) { return std::min(begin + kRangeSide, size) + 1; };
  tbb::parallel_for(0, rows, [&](int row) {
    AlphaRange* range = &texture.alpha_ranges[std::size_t(row) * std::size_t(columns)];
    for (int x0 = 0, y0 = row * kRangeSide; x0 < level.width; x0 += kRangeSide, ++range)
      for (int y = y0; y < end_of(y0, level.height); ++y)
        for (int x = x0; x < end_of(x0, level.width); ++x) {
          const std::uint8_t alpha = alpha_of(level, x % level.width, y % level.height);
          range->min = std::min(range->min, alpha);
          range->max = std::max(range->max, alpha);
        }
  });
}

AlphaRange whole_range(const MipTexture& texture) {
  AlphaRange whole;
  for (const AlphaRange& range : texture.alpha_ranges)
    whole = {std::min(whole.min, range.min), std::max(whole.max, range.max)};
  return whole;
}

bool alpha_reaches(const MipTexture& texture, glm::vec2 uv, float opacity, float bound) {
  constexpr float kRounding = 1e-6f;  // of bilinear_alpha, relative
  const MipLevel& level = texture.levels[0];
  const Bilinear b = bilinear_at(level, fraction_from_top_left(texture, uv));
  const AlphaRange range =
      texture.alpha_ranges[std::size_t(b.y0 / kRangeSide * range_columns(level) + b.x0 / kRangeSide)];
  if (kUnitFromByte[range.min] * (1.0f - kRounding) * opacity >= bound) return true;
  if (kUnitFromByte[range.max] * (1.0f + kRounding) * opacity < bound) return false;
  return bilinear_alpha(level, b) * opacity >= bound;
}

}  // namespace umbrage
