// Small layered image files of every format, for tests of their readers.
#pragma once
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "archives.h"

namespace umbrage::test {

/// Returns the bytes of values as they are in memory.
template <class Value>
std::string memory_of(const std::vector<Value>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// Returns an NPY file of version 1. `descr`: type such as "<f4"; `shape`: text such as "2, 3".
inline std::string npy_of(std::string_view descr, std::string_view shape, std::string_view values,
                          bool is_fortran = false) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", descr,
                                 is_fortran ? "True" : "False", shape);
  while ((text.size() + 11) % 64 != 0) text += ' ';
  text += '\n';
  std::string bytes("\x93NUMPY\x01\0", 8);
  bytes += char(text.size() & 0xff);
  bytes += char(text.size() >> 8);
  return bytes + text + std::string(values);
}

/// Settings of write_tiff.
struct TiffOptions {
  int samples = 1, bits = 32, format = SAMPLEFORMAT_IEEEFP;
  int compression = COMPRESSION_NONE, planar = PLANARCONFIG_CONTIG, photometric = PHOTOMETRIC_MINISBLACK;
  int tile = 0;  ///< side of the tiles; 0: strips
  int rows_per_strip = 3;
  int predictor = 1;
  bool is_big = false;      ///< BigTIFF
  bool big_endian = false;  ///< byte order of the file
};

/// Writes a TIFF. `values`: interleaved samples in the machine's byte order, without padding. `add_tags` may set
/// further tags.
template <class AddTags>
void write_tiff(const std::filesystem::path& file, int width, int height, const std::string& values,
                const TiffOptions& options, AddTags&& add_tags) {
  const std::string mode = std::string("w") + (options.is_big ? "8" : "4") + (options.big_endian ? "b" : "l");
  TIFF* tiff = TIFFOpen(file.c_str(), mode.c_str());
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, options.samples);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, options.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, options.format);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, options.photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, options.planar);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, options.compression);
  if (options.predictor > 1) TIFFSetField(tiff, TIFFTAG_PREDICTOR, options.predictor);
  if (options.tile > 0) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, options.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, options.tile);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, options.rows_per_strip);
  }
  add_tags(tiff);
  const std::size_t sample = std::size_t(options.bits) / 8, count = std::size_t(options.samples);
  const bool is_planar = options.planar == PLANARCONFIG_SEPARATE && count > 1;
  const std::size_t in_block = is_planar ? 1 : count;  // samples per pixel of a row or tile
  const auto copy = [&](int x, int y, std::size_t plane, char* to) {
    const char* from =
        values.data() + ((std::size_t(y) * std::size_t(width) + std::size_t(x)) * count + plane) * sample;
    std::copy_n(from, sample * in_block, to);
  };
  for (std::size_t plane = 0; plane < (is_planar ? count : 1); ++plane) {
    if (options.tile == 0) {
      std::string row(std::size_t(width) * in_block * sample, '\0');
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) copy(x, y, plane, row.data() + std::size_t(x) * in_block * sample);
        TIFFWriteScanline(tiff, row.data(), std::uint32_t(y), std::uint16_t(plane));
      }
      continue;
    }
    const int side = options.tile;
    for (int y0 = 0; y0 < height; y0 += side)
      for (int x0 = 0; x0 < width; x0 += side) {
        std::string tile(std::size_t(side) * std::size_t(side) * in_block * sample, '\0');
        for (int y = y0; y < std::min(y0 + side, height); ++y)
          for (int x = x0; x < std::min(x0 + side, width); ++x)
            copy(x, y, plane, tile.data() + std::size_t((y - y0) * side + x - x0) * in_block * sample);
        TIFFWriteTile(tiff, tile.data(), std::uint32_t(x0), std::uint32_t(y0), 0, std::uint16_t(plane));
      }
  }
  TIFFClose(tiff);
}

inline void write_tiff(const std::filesystem::path& file, int width, int height, const std::string& values,
                       const TiffOptions& options) {
  write_tiff(file, width, height, values, options, [](TIFF*) {});
}

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the bytes of a TIFF, by way of a file in `folder`.
inline std::string tiff_of(const std::filesystem::path& folder, int width, int height, const std::string& values,
                           const TiffOptions& options) {
  const std::filesystem::path file = folder / "bytes.tif";
  write_tiff(file, width, height, values, options);
  std::string bytes = content_of(file);
  std::filesystem::remove(file);
  return bytes;
}

/// Returns an HDR picture without compression. `pixels`: 4 bytes each.
inline std::string hdr_of(int width, int height, const std::string& pixels) {
  return fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", height, width) + pixels;
}

}  // namespace umbrage::test
