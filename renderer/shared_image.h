// SharedImage: pixels in memory of somebody else's, in the types and with the strides that they have there.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/check.h"
#include "core/image.h"

namespace umbrage {

enum class PixelType {
  kFloat32 = 1,
  kFloat16 = 2,
  kUint8 = 3,   ///< 0 to 255 mean 0 to 1; of ids the number itself
  kUint16 = 4,  ///< 0 to 65535 mean 0 to 1; of ids the number itself
  kUint32 = 5,  ///< of ids alone
};

/// Whether it is one of integers.
inline bool is_whole(PixelType type) { return type != PixelType::kFloat32 && type != PixelType::kFloat16; }

/// Bytes of one number.
std::size_t size_of(PixelType type);

/// Strides are in bytes, and may be negative. `data` is channel 0 of the upper left pixel.
struct SharedImage {
  void* data = nullptr;
  PixelType type = PixelType::kFloat32;
  int width = 0, height = 0, channels = 1;
  std::ptrdiff_t channel_stride = 0, pixel_stride = 0, row_stride = 0;
};

/// The same with strides in place of those that are 0: channels side by side, then pixels, then rows.
SharedImage with_strides(SharedImage image);

/// An image that stands for the planes of a pass: "normal" with three channels.
struct NamedImage {
  std::string name;
  SharedImage image;
};

/// Reads one channel as numbers from 0 to 1, or floats as they are.
void read_channel(const SharedImage& image, int channel, Plane& plane);

/// Writes one channel. Of integers values are clamped to 0 to 1 and rounded, NaN is 0.
void write_channel(const Plane& plane, int channel, const SharedImage& image);

/// Calls take(x, y, id) for one channel of integers.
template <class Take>
void read_ids(const SharedImage& image, const Take& take);
/// The id of a pixel, in its type's range.
void write_id(const SharedImage& image, int x, int y, std::uint32_t id);

// ---

/// Pixels need not be aligned.
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
