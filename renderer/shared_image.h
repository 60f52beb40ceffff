// SharedImage: pixels in the caller's memory, in the caller's type and with the caller's strides.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/check.h"
#include "core/image.h"

namespace umbrage {

/// The type of a channel value.
enum class PixelType {
  kFloat32 = 1,
  kFloat16 = 2,
  kUint8 = 3,   ///< 0 to 255 represent 0 to 1; for ids, the id itself
  kUint16 = 4,  ///< 0 to 65535 represent 0 to 1; for ids, the id itself
  kUint32 = 5,  ///< only for ids
};

/// Returns whether the type is an integer type.
inline bool is_whole(PixelType type) { return type != PixelType::kFloat32 && type != PixelType::kFloat16; }

/// Returns the size of one channel value, in bytes.
std::size_t size_of(PixelType type);

/// An image in the caller's memory. Strides are in bytes and may be negative. `data` points to channel 0 of the upper
/// left pixel.
struct SharedImage {
  void* data = nullptr;
  PixelType type = PixelType::kFloat32;
  int width = 0, height = 0, channels = 1;
  std::ptrdiff_t channel_stride = 0, pixel_stride = 0, row_stride = 0;
};

/// Replaces strides of 0 by those of packed data: adjacent channels in a pixel, adjacent pixels in a row, adjacent
/// rows. With another `channel_stride`, the pixels of a channel are adjacent.
SharedImage with_strides(SharedImage image);

/// An image that holds the planes of a pass: "normal" with three channels.
struct NamedImage {
  std::string name;
  SharedImage image;
};

/// Reads one channel: integers as numbers from 0 to 1, floats unchanged.
void read_channel(const SharedImage& image, int channel, Plane& plane);

/// Writes one channel. For 8- and 16-bit integers, values are clamped to [0, 1] and rounded; NaN becomes 0.
void write_channel(const Plane& plane, int channel, const SharedImage& image);

/// Calls take(x, y, id) for each pixel of a one-channel image of integers.
template <class Take>
void read_ids(const SharedImage& image, const Take& take);
/// Writes the id of a pixel, clamped to the range of an integer type.
void write_id(const SharedImage& image, int x, int y, std::uint32_t id);

// ---

/// Returns the address of a channel value. It need not be aligned.
inline std::byte* place_of(const SharedImage& image, int channel, int x, int y) {
  return static_cast<std::byte*>(image.data) + image.channel_stride * channel + image.pixel_stride * x +
         image.row_stride * y;
}
template <class T>
T load(const SharedImage& image, int channel, int x, int y) {
  T value;
  std::memcpy(&value, place_of(image, channel, x, y), sizeof(T));
  return value;
}
template <class T>
void store(const SharedImage& image, int channel, int x, int y, T value) {
  std::memcpy(place_of(image, channel, x, y), &value, sizeof(T));
}

template <class Take>
void read_ids(const SharedImage& image, const Take& take) {
  const auto each = [&]<class T>(T) {
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const T value = load<T>(image, 0, x, y);
        take(x, y, std::uint32_t(value));
      }
  };
  switch (image.type) {
    case PixelType::kUint8:
      return each(std::uint8_t());
    case PixelType::kUint16:
      return each(std::uint16_t());
    case PixelType::kUint32:
      return each(std::uint32_t());
    case PixelType::kFloat16:
    case PixelType::kFloat32:
      fail_check("ids are read from integers");
  }
}

}  // namespace umbrage
