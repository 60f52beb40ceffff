#include "call_memory.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace umbrage::fuzz {
namespace {

/// Returns the image with strides of 0 replaced by those of a packed image.
UmbImage with_strides(UmbImage image) {
  const auto size = std::ptrdiff_t(bytes_of(image.type));
  if (image.channel_stride == 0) image.channel_stride = size;
  if (image.pixel_stride == 0) image.pixel_stride = size * image.channels;
  if (image.row_stride == 0) image.row_stride = image.pixel_stride * image.width;
  return image;
}

/// Calls `visit` with the address of each value of an image.
template <class Visit>
void for_each_value(const UmbImage& packed, const Visit& visit) {
  const UmbImage image = with_strides(packed);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c)
        visit(static_cast<std::byte*>(image.data) + y * image.row_stride + x * image.pixel_stride +
              c * image.channel_stride);
}

/// Returns the image with memory: a new block that extends exactly from its first byte to its last.
Pixels allocated(UmbImage image, std::size_t offset) {
  const UmbImage full = with_strides(image);
  std::ptrdiff_t first = 0, last = 0;
  const auto reach = [&](std::ptrdiff_t stride, int count) { (stride < 0 ? first : last) += stride * (count - 1); };
  reach(full.channel_stride, full.channels);
  reach(full.pixel_stride, full.width);
  reach(full.row_stride, full.height);
  const auto size = std::size_t(last - first) + bytes_of(image.type);
  Pixels result{image, std::make_shared<Block>(size, offset)};
  result.image.data = result.block->data() - first;
  return result;
}

float any_float(Choices& choose) {
  static const std::vector<float> kSpecial = {0.0f,
                                              -0.0f,
                                              -1.0f,
                                              1e-45f,
                                              1e-38f,
                                              3e38f,
                                              -3e38f,
                                              65536.0f,
                                              16777216.0f,
                                              5e9f,
                                              std::numeric_limits<float>::infinity(),
                                              -std::numeric_limits<float>::infinity(),
                                              std::numeric_limits<float>::quiet_NaN()};
  return choose.one_in(4) ? choose.one_of(kSpecial) : float(choose.below(200)) / 100.0f;
}

/// Fills the image with values from a short list, since choosing each value would use up the bytes of `choose`.
void fill_with_values(Choices& choose, const Pixels& pixels) {
  constexpr int kValues = 16;
  std::byte values[kValues][4];
  for (auto& value : values) {
    const float number = any_float(choose);
    const std::uint32_t integer = choose.below(1u << 31);
    if (pixels.image.type == UMB_TYPE_FLOAT32)
      std::memcpy(value, &number, sizeof number);
    else
      std::memcpy(value, &integer, sizeof integer);
  }
  unsigned state = choose.below(256) + 1;
  for_each_value(pixels.image, [&](std::byte* at) {
    state = state * 1664525u + 1013904223u;
    std::memcpy(at, values[state >> 28], bytes_of(pixels.image.type));
  });
}

}  // namespace

void demand(bool holds, const std::string& sentence) {
  if (holds) return;
  std::fprintf(stderr, "calls: %s\n", sentence.c_str());
  std::abort();
}

unsigned Choices::below(unsigned end) {
  if (end <= 1) return 0;
  std::uint32_t number = next();
  for (unsigned reach = 256; reach < end && reach != 0; reach <<= 8) number = number << 8 | next();
  return number % end;
}

Block::Block(std::size_t size, std::size_t offset)
    : bytes_(new std::byte[size + offset]), size_(size), offset_(offset) {
  fill(std::byte(0));
}

void Block::fill(std::byte value) { std::fill_n(bytes_.get(), size_ + offset_, value); }

std::size_t bytes_of(int type) {
  switch (type) {
    case UMB_TYPE_UINT8:
      return 1;
    case UMB_TYPE_FLOAT16:
    case UMB_TYPE_UINT16:
      return 2;
    default:
      return 4;
  }
}

Pixels valid_image(Choices& choose, int type, int width, int height, int channels) {
  UmbImage image{nullptr, type, width, height, channels, 0, 0, 0};
  const auto size = std::ptrdiff_t(bytes_of(type));
  const std::ptrdiff_t pixel = size * channels, gap = choose.below(2) ? 1 : 5;
  switch (choose.below(9)) {
    case 0:  // plane after plane
      image.channel_stride = size * width * height;
      image.pixel_stride = size;
      break;
    case 1:  // bottom row first
      image.row_stride = -pixel * width;
      break;
    case 2:  // from right to left
      image.pixel_stride = -pixel;
      break;
    case 3:  // reversed in all directions
      image.channel_stride = -size;
      image.pixel_stride = -pixel;
      image.row_stride = -pixel * width;
      break;
    case 4:  // gaps between pixels
      image.pixel_stride = pixel + gap;
      break;
    case 5:  // gaps between rows
      image.row_stride = pixel * width + gap;
      break;
    case 6:  // column by column
      image.row_stride = pixel;
      image.pixel_stride = pixel * height;
      break;
    default:
      break;
  }
  Pixels result = allocated(image, choose.one_in(4) ? 1 + choose.below(3) : 0);
  fill_with_values(choose, result);
  return result;
}

Pixels depth_image(Choices& choose, int width, int height) {
  Pixels result = valid_image(choose, UMB_TYPE_FLOAT32, width, height, 1);
  if (choose.one_in(3)) return result;
  unsigned state = choose.below(256);
  const unsigned odd = choose.below(2) * 9;
  for_each_value(result.image, [&](std::byte* at) {
    state = state * 1664525u + 1013904223u;
    const float depth = state >> 28 < odd ? any_float(choose) : 2.0f + float(state >> 26) / 64.0f;
    std::memcpy(at, &depth, sizeof depth);
  });
  return result;
}

void fill_with_canaries(Pixels& pixels, std::byte value) {
  if (pixels.block) pixels.block->fill(value);
}

std::vector<std::size_t> indices_of_canaries(const Pixels& pixels, std::byte canary) {
  std::vector<std::size_t> found;
  std::size_t number = 0;
  const std::size_t size = bytes_of(pixels.image.type);
  for_each_value(pixels.image, [&](const std::byte* at) {
    if (std::all_of(at, at + size, [&](std::byte b) { return b == canary; })) found.push_back(number);
    ++number;
  });
  return found;
}

bool is_untouched_outside(const NamedPixels& images, const BlockPtr& block, std::byte canary) {
  std::vector<bool> inside(block->size() + block->offset());
  const std::byte* const start = block->data() - block->offset();
  for (const auto& [name, pixels] : images)
    if (pixels.block == block)
      for_each_value(pixels.image, [&](const std::byte* at) {
        std::fill_n(inside.begin() + (at - start), bytes_of(pixels.image.type), true);
      });
  for (std::size_t k = 0; k < inside.size(); ++k)
    if (!inside[k] && start[k] != canary) return false;
  return true;
}

bool is_untouched(Block& block, std::byte canary) {
  const std::byte* const start = block.data() - block.offset();
  return std::all_of(start, start + block.size() + block.offset(), [&](std::byte b) { return b == canary; });
}

std::uint64_t hash_of(Block& block) {
  std::uint64_t hash = 14695981039346656037ull;
  for (std::size_t k = 0; k < block.size(); ++k) hash = (hash ^ std::uint64_t(block.data()[k])) * 1099511628211ull;
  return hash;
}

}  // namespace umbrage::fuzz
