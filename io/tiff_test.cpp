// TIFF: types, layouts, georeference and sparse files.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <Imath/half.h>

#include <cmath>

#include "file_folder.h"
#include "io/geo_tags.h"
#include "io/layers.h"
#include "layered_files.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 19, kHeight = 33;

struct TiffLayers : test::FileFolder {
  fs::path file() const { return folder / "x.tif"; }

  static std::vector<int> all_of(const LayeredFile& header) {
    std::vector<int> all;
    for (const Channel& channel : header.channels) all.push_back(channel.index);
    return all;
  }

  LayeredFile header() const {
    auto header = read_header(file());
    EXPECT_TRUE(header) << header.error().message;
    return header ? std::move(*header) : LayeredFile();
  }

  void expect_error(std::string_view words) const {
    auto header = read_header(file());
    const Result<Image> image = header ? read_channels(*header, all_of(*header)) : header.error();
    ASSERT_FALSE(image) << words;
    EXPECT_EQ(image.error().kind, ErrorKind::kFile);
    EXPECT_NE(image.error().message.find(words), std::string::npos) << image.error().message;
    EXPECT_NE(image.error().message.find("x.tif"), std::string::npos) << image.error().message;
  }

  /// Writes and reads `samples` channels of a type in every layout. `value(i)`: the value of sample number i.
  template <class Value>
  void expect_values(int samples, int format, Value (*value)(int)) const {
    std::vector<Value> values;
    for (int i = 0; i < kWidth * kHeight * samples; ++i) values.push_back(value(i));
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS})
      for (const int tile : {0, 16})
        for (const bool is_big : {false, true})
          for (const bool big_endian : {false, true})
            for (const int planar : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE}) {
              const bool has_predictor = compression == COMPRESSION_LZW || compression == COMPRESSION_ADOBE_DEFLATE;
              // libtiff 4.5 writes the predictor for floats wrongly if the byte order is not the machine's.
              const bool is_real = format == SAMPLEFORMAT_IEEEFP;
              const bool has_own = has_predictor && sizeof(Value) < 8 && !(is_real && big_endian);
              const int predictor = !has_own ? 1 : is_real ? 3 : 2;
              test::write_tiff(file(), kWidth, kHeight, test::memory_of(values),
                               {.samples = samples,
                                .bits = int(8 * sizeof(Value)),
                                .format = format,
                                .compression = compression,
                                .planar = planar,
                                .tile = tile,
                                .predictor = predictor,
                                .is_big = is_big,
                                .big_endian = big_endian});
              const LayeredFile read = header();
              ASSERT_EQ(read.channels.size(), std::size_t(samples));
              const auto image = read_channels(read, all_of(read));
              ASSERT_TRUE(image) << image.error().message;
              for (int i = 0; i < kWidth * kHeight * samples; ++i)
                ASSERT_EQ(image->planes[std::size_t(i % samples)].at(i / samples % kWidth, i / samples / kWidth),
                          float(value(i)))
                    << compression << ", tile " << tile << ", planar " << planar << ", big " << is_big << big_endian
                    << ": sample " << i;
            }
  }
};

TEST_F(TiffLayers, EveryTypeIsReadInEveryLayout) {
  expect_values<std::uint8_t>(3, SAMPLEFORMAT_UINT, [](int i) { return std::uint8_t(i * 7); });
  expect_values<std::int8_t>(1, SAMPLEFORMAT_INT, [](int i) { return std::int8_t(i * 5 - 60); });
  expect_values<std::uint16_t>(4, SAMPLEFORMAT_UINT, [](int i) { return std::uint16_t(i * 31); });
  expect_values<std::int16_t>(1, SAMPLEFORMAT_INT, [](int i) { return std::int16_t(i * 31 - 9000); });
  expect_values<std::uint32_t>(2, SAMPLEFORMAT_UINT, [](int i) { return 0xf0000000u + std::uint32_t(i) * 4096; });
  expect_values<std::int32_t>(1, SAMPLEFORMAT_INT, [](int i) { return i * -1000; });
  expect_values<Imath::half>(1, SAMPLEFORMAT_IEEEFP, [](int i) { return Imath::half(float(i) * 0.25f - 8.0f); });
  expect_values<float>(5, SAMPLEFORMAT_IEEEFP, [](int i) { return float(i) * -0.7f; });
  expect_values<double>(1, SAMPLEFORMAT_IEEEFP, [](int i) { return double(i) * 1e-3; });
}

TEST_F(TiffLayers, ChannelsAreNamedByTheirMeaning) {
  const auto names = [&](const test::TiffOptions& options, std::vector<std::uint16_t> extras) {
    test::write_tiff(file(), 2, 2, std::string(std::size_t(4 * options.samples), '\0'), options, [&](TIFF* tiff) {
      if (!extras.empty()) TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, int(extras.size()), extras.data());
    });
    std::string joined;
    for (const Channel& channel : header().channels) joined += channel.full_name() + " ";
    return joined;
  };
  const int kUint = SAMPLEFORMAT_UINT, kRgb = PHOTOMETRIC_RGB;
  EXPECT_EQ(names({.samples = 1, .bits = 8, .format = kUint}, {}), "Y ");
  EXPECT_EQ(names({.samples = 2, .bits = 8, .format = kUint}, {EXTRASAMPLE_UNASSALPHA}), "Y A ");
  EXPECT_EQ(names({.samples = 3, .bits = 8, .format = kUint}, {0, 0}), "Y band2 band3 ");
  EXPECT_EQ(names({.samples = 3, .bits = 8, .format = kUint, .photometric = kRgb}, {}), "R G B ");
  EXPECT_EQ(names({.samples = 5, .bits = 8, .format = kUint, .photometric = kRgb}, {EXTRASAMPLE_ASSOCALPHA, 0}),
            "R G B A band5 ");
  EXPECT_TRUE(header().channels[0].is_srgb);
  EXPECT_EQ(header().channels[0].max_integer, 255.0);
}

TEST_F(TiffLayers, FewBitsAndInvertedGreyAreRead) {
  // 1 bit, 0 is white: the pixels 1 0 1 1 0 0 0 0 1 of a row in two bytes.
  TIFF* tiff = TIFFOpen(file().c_str(), "w");
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 9);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISWHITE);
  char row[] = {char(0b10110000), char(0b10000000)};
  TIFFWriteScanline(tiff, row, 0, 0);
  TIFFClose(tiff);
  const auto image = read_channels(header(), std::vector<int>{0});
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(header().channels[0].max_integer, 1.0);
  for (int x = 0; x < 9; ++x) EXPECT_EQ(image->planes[0].at(x, 0), std::string_view("010011110")[std::size_t(x)] - '0');
}

/// Sets a tag that libtiff does not know.
template <class Value>
void set_tag(TIFF* tiff, std::uint32_t tag, TIFFDataType type, std::vector<Value> values) {
  static char name[] = "geo";
  const TIFFFieldInfo info{tag, TIFF_VARIABLE2, TIFF_VARIABLE2, type, FIELD_CUSTOM, 1, 1, name};
  TIFFMergeFieldInfo(tiff, &info, 1);
  TIFFSetField(tiff, tag, std::uint32_t(values.size()), values.data());
}

struct GeoTags {
  std::vector<double> scale, tie, matrix, doubles;
  std::vector<std::uint16_t> keys;
  std::string no_data;
};

void write_geo(const fs::path& file, int width, int height, const GeoTags& tags) {
  test::write_tiff(file, width, height, std::string(std::size_t(4 * width * height), '\0'), {}, [&](TIFF* tiff) {
    if (!tags.scale.empty()) set_tag(tiff, 33550, TIFF_DOUBLE, tags.scale);
    if (!tags.tie.empty()) set_tag(tiff, 33922, TIFF_DOUBLE, tags.tie);
    if (!tags.matrix.empty()) set_tag(tiff, 34264, TIFF_DOUBLE, tags.matrix);
    if (!tags.keys.empty()) set_tag(tiff, 34735, TIFF_SHORT, tags.keys);
    if (!tags.doubles.empty()) set_tag(tiff, 34736, TIFF_DOUBLE, tags.doubles);
    if (!tags.no_data.empty())
      set_tag(tiff, 42113, TIFF_ASCII,
              std::vector<char>(tags.no_data.c_str(), tags.no_data.c_str() + tags.no_data.size() + 1));
  });
}

TEST_F(TiffLayers, CellSizesAreInMetres) {
  const auto geo = [&](const GeoTags& tags) {
    write_geo(file(), 10, 20, tags);
    const LayeredFile read = header();
    EXPECT_TRUE(read.geo);
    return read.geo.value_or(GeoRaster{});
  };
  const std::vector<double> scale = {2, 3, 0}, tie = {0, 0, 0, 500000, 4600000, 0};
  // Keys: version 1.1.0, their number, then key, location, count, value.
  const GeoRaster metres = geo({.scale = scale, .tie = tie, .keys = {1, 1, 0, 1, 1024, 0, 1, 1}, .no_data = "-9999"});
  EXPECT_EQ(metres.cell_width, 2.0);
  EXPECT_EQ(metres.cell_height, 3.0);
  EXPECT_EQ(metres.no_data.value_or(0), -9999.0);
  EXPECT_EQ(metres.value_unit, 1.0);

  const GeoRaster feet = geo({.scale = scale,
                              .tie = tie,
                              .keys = {1, 1, 0, 3, 1024, 0, 1, 1, 3076, 0, 1, 9002, 4099, 0, 1, 9003},
                              .no_data = "nan"});
  EXPECT_DOUBLE_EQ(feet.cell_width, 2 * 0.3048);
  EXPECT_DOUBLE_EQ(feet.cell_height, 3 * 0.3048);
  EXPECT_DOUBLE_EQ(feet.value_unit, 1200.0 / 3937.0);
  EXPECT_TRUE(std::isnan(feet.no_data.value_or(0)));

  const GeoRaster own = geo(
      {.scale = scale, .tie = tie, .doubles = {7.0, 10.5}, .keys = {1, 1, 0, 2, 3076, 0, 1, 32767, 3077, 34736, 1, 1}});
  EXPECT_DOUBLE_EQ(own.cell_width, 21.0);
  EXPECT_FALSE(own.no_data);

  // A raster rotated by 30 degrees with cells of 4 x 5.
  const double c = std::cos(0.5235987755982988), s = std::sin(0.5235987755982988);
  const GeoRaster rotated = geo({.matrix = {4 * c, 5 * s, 0, 9, 4 * s, -5 * c, 0, 8, 0, 0, 1, 0, 0, 0, 0, 1}});
  EXPECT_NEAR(rotated.cell_width, 4, 1e-9);
  EXPECT_NEAR(rotated.cell_height, 5, 1e-9);
}

TEST_F(TiffLayers, DegreesBecomeMetresAtTheCentre) {
  // One arc second at 60 degrees north; the raster's centre is at 60. WGS 84 there (geodetic tables): a degree of
  // longitude is 55800 m, one of latitude 111412 m.
  const double second = 1.0 / 3600.0;
  write_geo(file(), 10, 20,
            {.scale = {second, second, 0},
             .tie = {0, 0, 0, 10, 60 + 10 * second, 0},
             .keys = {1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326}});
  const LayeredFile read = header();
  ASSERT_TRUE(read.geo);
  EXPECT_NEAR(read.geo->cell_width * 3600, 55800, 5);
  EXPECT_NEAR(read.geo->cell_height * 3600, 111412, 5);
  double width = 0, height = 0;
  metres_per_degree(0, width, height);
  EXPECT_NEAR(width, 111320, 1);
  EXPECT_NEAR(height, 110574, 1);
}

TEST_F(TiffLayers, DamagedGeoTagsAreHarmless) {
  const double nan = std::nan("");
  for (const GeoTags& tags : {GeoTags{.scale = {nan, -1, 0}}, GeoTags{.scale = {0, 0, 0}, .keys = {1}},
                              GeoTags{.scale = {1, 1, 1}, .keys = {1, 1, 0, 9, 2055, 34736, 1, 900, 1024, 0, 1, 2}},
                              GeoTags{.matrix = std::vector<double>(16, nan), .no_data = "none"}}) {
    write_geo(file(), 4, 4, tags);
    const LayeredFile read = header();
    ASSERT_TRUE(read.geo);
    EXPECT_TRUE(std::isfinite(read.geo->cell_width) && read.geo->cell_width > 0.0);
    EXPECT_TRUE(std::isfinite(read.geo->cell_height) && read.geo->cell_height > 0.0);
    EXPECT_FALSE(read.geo->no_data);
  }
}

TEST_F(TiffLayers, OmittedTilesHaveNoData) {
  TIFF* tiff = TIFFOpen(file().c_str(), "w");
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 48);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 16);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
  set_tag(tiff, 42113, TIFF_ASCII, std::vector<char>{'-', '5', '\0'});
  std::vector<float> tile(256, 2.5f);
  TIFFWriteEncodedTile(tiff, 1, tile.data(), 1024);
  TIFFClose(tiff);
  const auto image = read_channels(header(), std::vector<int>{0});
  ASSERT_TRUE(image) << image.error().message;
  for (int x = 0; x < 48; ++x) EXPECT_EQ(image->planes[0].at(x, 7), x / 16 == 1 ? 2.5f : -5.0f) << x;
}

TEST_F(TiffLayers, WhatCannotBeReadIsNamed) {
  const std::string values(4 * 64, '\0');
  test::write_tiff(file(), 4, 4, values, {.bits = 64, .format = SAMPLEFORMAT_COMPLEXIEEEFP});
  expect_error("samples of format 6");
  test::write_tiff(file(), 4, 4, values, {.bits = 8, .format = SAMPLEFORMAT_UINT},
                   [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_BOTLEFT); });
  expect_error("orientation 4");
  test::write_tiff(file(), 4, 4, values,
                   {.samples = 3, .bits = 8, .format = SAMPLEFORMAT_UINT, .photometric = PHOTOMETRIC_CIELAB});
  expect_error("photometric interpretation 8");
  // The width and height in the directory, 65537 each.
  test::write_tiff(file(), 4, 4, values, {.bits = 8, .format = SAMPLEFORMAT_UINT});
  std::string bytes = test::content_of(file());
  for (const std::string& tag :
       {std::string("\0\1\3\0\1\0\0\0\4\0\0\0", 12), std::string("\1\1\3\0\1\0\0\0\4\0\0\0", 12)}) {
    const std::size_t at = bytes.find(tag);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, 12, tag.substr(0, 2) + std::string("\4\0\1\0\0\0\1\0\1\0", 10));
  }
  write("x.tif", bytes);
  expect_error("65537 x 65537");
}

TEST_F(TiffLayers, CutFileIsOneTrueSentence) {
  // Directory first, so that rows are missing and not the directory.
  std::string bytes("II*\0\x08\0\0\0\x09\0", 10);
  const auto entry = [&](int tag, int type, std::uint32_t value) {
    bytes += test::memory_of(std::vector<std::uint16_t>{std::uint16_t(tag), std::uint16_t(type)});
    bytes += test::memory_of(std::vector<std::uint32_t>{1, value});
  };
  const std::uint32_t start = 10 + 9 * 12 + 4, width = 20, height = 30;
  entry(TIFFTAG_IMAGEWIDTH, TIFF_LONG, width);
  entry(TIFFTAG_IMAGELENGTH, TIFF_LONG, height);
  entry(TIFFTAG_BITSPERSAMPLE, TIFF_SHORT, 8);
  entry(TIFFTAG_COMPRESSION, TIFF_SHORT, COMPRESSION_NONE);
  entry(TIFFTAG_PHOTOMETRIC, TIFF_SHORT, PHOTOMETRIC_MINISBLACK);
  entry(TIFFTAG_STRIPOFFSETS, TIFF_LONG, start);
  entry(TIFFTAG_SAMPLESPERPIXEL, TIFF_SHORT, 1);
  entry(TIFFTAG_ROWSPERSTRIP, TIFF_LONG, height);
  entry(TIFFTAG_STRIPBYTECOUNTS, TIFF_LONG, width * height);
  bytes += std::string(4, '\0') + std::string(width * height, 'x');
  write("x.tif", bytes);
  EXPECT_EQ(read_channels(header(), std::vector{0})->planes[0].at(3, 29), float('x'));
  write("x.tif", bytes.substr(0, bytes.size() - 300));
  expect_error("row 0 is missing or damaged");
  expect_error("x.tif");
}

}  // namespace
}  // namespace umbrage
