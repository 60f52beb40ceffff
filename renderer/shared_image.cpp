#include "renderer/shared_image.h"

#include <ImathConfig.h>
#include <half.h>

#include <algorithm>
#include <limits>

#include "core/rows.h"

namespace umbrage {
namespace {

constexpr float kMaxUint8 = 255.0f, kMaxUint16 = 65535.0f;

template <class T, class Number>
void read_as(const SharedImage& image, int channel, Plane& plane, const Number& number) {
  for_rows(0, plane.height, [&](int y) {
    float* to = plane.row(y);
    if constexpr (std::is_same_v<T, float>)
      if (image.pixel_stride == std::ptrdiff_t(sizeof(float))) {
        std::memcpy(to, place_of(image, channel, 0, y), std::size_t(plane.width) * sizeof(float));
        return;
      }
    for (int x = 0; x < plane.width; ++x) to[x] = number(load<T>(image, channel, x, y));
  });
}

template <class T, class Value>
void write_as(const Plane& plane, int channel, const SharedImage& image, const Value& value) {
  for_rows(0, plane.height, [&](int y) {
    const float* from = plane.row(y);
    if constexpr (std::is_same_v<T, float>)
      if (image.pixel_stride == std::ptrdiff_t(sizeof(float))) {
        std::memcpy(place_of(image, channel, 0, y), from, std::size_t(plane.width) * sizeof(float));
        return;
      }
    for (int x = 0; x < plane.width; ++x) store<T>(image, channel, x, y, value(from[x]));
  });
}

/// Converts [0, 1] to an integer from 0 to `max`.
template <class T>
T rounded(float value, float max) {
  return T(value > 0.0f ? std::min(value, 1.0f) * max + 0.5f : 0.0f);
}

}  // namespace

std::size_t size_of(PixelType type) {
  switch (type) {
    case PixelType::kUint8:
      return 1;
    case PixelType::kFloat16:
    case PixelType::kUint16:
      return 2;
    default:
      return 4;
  }
}

SharedImage with_strides(SharedImage image) {
  const auto size = std::ptrdiff_t(size_of(image.type));
  if (image.channel_stride == 0) image.channel_stride = size;
  if (image.pixel_stride == 0)
    image.pixel_stride = image.channel_stride == size || image.channels == 1 ? size * image.channels : size;
  if (image.row_stride == 0) image.row_stride = image.pixel_stride * image.width;
  return image;
}

void read_channel(const SharedImage& image, int channel, Plane& plane) {
  const auto unchanged = [](float value) { return value; };
  switch (image.type) {
    case PixelType::kFloat32:
      return read_as<float>(image, channel, plane, unchanged);
    case PixelType::kFloat16:
      return read_as<std::uint16_t>(image, channel, plane,
                                    [](std::uint16_t bits) { return imath_half_to_float(bits); });
    case PixelType::kUint8:
      return read_as<std::uint8_t>(image, channel, plane, [](std::uint8_t v) { return float(v) / kMaxUint8; });
    case PixelType::kUint16:
      return read_as<std::uint16_t>(image, channel, plane, [](std::uint16_t v) { return float(v) / kMaxUint16; });
    case PixelType::kUint32:
      return read_as<std::uint32_t>(image, channel, plane, [](std::uint32_t v) { return float(v); });
  }
}

void write_channel(const Plane& plane, int channel, const SharedImage& image) {
  switch (image.type) {
    case PixelType::kFloat32:
      return write_as<float>(plane, channel, image, [](float v) { return v; });
    case PixelType::kFloat16:
      return write_as<std::uint16_t>(plane, channel, image, [](float v) { return imath_float_to_half(v); });
    case PixelType::kUint8:
      return write_as<std::uint8_t>(plane, channel, image, [](float v) { return rounded<std::uint8_t>(v, kMaxUint8); });
    case PixelType::kUint16:
      return write_as<std::uint16_t>(plane, channel, image,
                                     [](float v) { return rounded<std::uint16_t>(v, kMaxUint16); });
    case PixelType::kUint32:
      return write_as<std::uint32_t>(plane, channel, image, [](float v) {
        constexpr float kEnd = 4294967296.0f;
        return v > 0.0f ? (v < kEnd ? std::uint32_t(v) : std::numeric_limits<std::uint32_t>::max()) : 0u;
      });
  }
}

void write_id(const SharedImage& image, int x, int y, std::uint32_t id) {
  switch (image.type) {
    case PixelType::kUint8:
      return store(image, 0, x, y, std::uint8_t(std::min(id, 255u)));
    case PixelType::kUint16:
      return store(image, 0, x, y, std::uint16_t(std::min(id, 65535u)));
    case PixelType::kUint32:
      return store(image, 0, x, y, id);
    case PixelType::kFloat16:
      return store(image, 0, x, y, imath_float_to_half(float(id)));
    case PixelType::kFloat32:
      return store(image, 0, x, y, float(id));
  }
}

}  // namespace umbrage
