// NumPy arrays, PGM and PPM, ASCII grids and Radiance pictures: types, shapes and headers.
#include <gtest/gtest.h>

#include <Imath/half.h>

#include <algorithm>
#include <cmath>

#include "file_folder.h"
#include "io/layers.h"
#include "layered_files.h"

namespace umbrage {
namespace {

struct Arrays : test::FileFolder {
  Image read(const std::string& name, const std::string& bytes) {
    auto read = read_header(write(name, bytes));
    EXPECT_TRUE(read) << read.error().message;
    if (!read) return {};
    header = std::move(*read);
    std::vector<int> all;
    for (const Channel& channel : header.channels) all.push_back(channel.index);
    auto image = read_channels(header, all);
    EXPECT_TRUE(image) << image.error().message;
    return image ? std::move(*image) : Image();
  }

  void expect_error(const std::string& name, const std::string& bytes, std::string_view words) {
    const auto read = read_header(write(name, bytes));
    const Result<Image> image = read ? read_channels(*read, std::vector<int>{0}) : read.error();
    ASSERT_FALSE(image) << words;
    EXPECT_EQ(image.error().kind, ErrorKind::kFile);
    EXPECT_NE(image.error().message.find(words), std::string::npos) << image.error().message;
    EXPECT_NE(image.error().message.find(name), std::string::npos) << image.error().message;
  }

  LayeredFile header;
};

template <class Value>
std::string swapped(std::vector<Value> values) {
  std::string bytes = test::memory_of(values);
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(Value))
    std::reverse(bytes.begin() + std::ptrdiff_t(i), bytes.begin() + std::ptrdiff_t(i + sizeof(Value)));
  return bytes;
}

template <class Value>
void expect_type(Arrays& test, const std::string& kind, ChannelType type, double max) {
  std::vector<Value> values;
  for (int i = 0; i < 15; ++i) values.push_back(Value(float(i) * (kind[0] == 'u' || kind[0] == 'b' ? 1.0f : -1.5f)));
  for (const bool is_big : {false, true}) {
    const std::string bytes = is_big ? swapped(values) : test::memory_of(values);
    const std::string order = sizeof(Value) == 1 ? "|" : is_big ? ">" : "<";
    const Image image = test.read("x.npy", test::npy_of(order + kind, "3, 5", bytes));
    ASSERT_EQ(image.names, std::vector<std::string>{"Y"}) << kind;
    EXPECT_EQ(test.header.channels[0].type, type) << kind;
    EXPECT_EQ(test.header.channels[0].max_integer, max) << kind;
    for (int i = 0; i < 15; ++i)
      EXPECT_EQ(image.planes[0].at(i % 5, i / 5), float(values[std::size_t(i)])) << kind << i;
  }
}

TEST_F(Arrays, EveryTypeAndByteOrderIsRead) {
  expect_type<std::uint8_t>(*this, "u1", ChannelType::kUint8, 255);
  expect_type<std::uint8_t>(*this, "b1", ChannelType::kUint8, 255);
  expect_type<std::int8_t>(*this, "i1", ChannelType::kInt, 0);
  expect_type<std::uint16_t>(*this, "u2", ChannelType::kUint16, 65535);
  expect_type<std::int16_t>(*this, "i2", ChannelType::kInt, 0);
  expect_type<std::uint32_t>(*this, "u4", ChannelType::kUint32, 0);
  expect_type<std::int32_t>(*this, "i4", ChannelType::kInt, 0);
  expect_type<std::int64_t>(*this, "i8", ChannelType::kInt, 0);
  expect_type<Imath::half>(*this, "f2", ChannelType::kHalf, 0);
  expect_type<float>(*this, "f4", ChannelType::kFloat, 0);
  expect_type<double>(*this, "f8", ChannelType::kDouble, 0);
}

TEST_F(Arrays, ShapesAndOrdersOfAxes) {
  // The element at (y, x, c) of a picture of 5 rows and 6 columns is 100 y + 10 x + c, in each shape and order.
  struct Axes {
    const char* shape;
    std::vector<int> sides;
    int y, x, c;  // axis of each; -1: none
    int channels;
  };
  const Axes all[] = {{"5, 6", {5, 6}, 0, 1, -1, 1},
                      {"5, 6, 3", {5, 6, 3}, 0, 1, 2, 3},
                      {"5, 6, 1", {5, 6, 1}, 0, 1, 2, 1},
                      {"3, 5, 6", {3, 5, 6}, 1, 2, 0, 3},
                      {"1, 5, 6", {1, 5, 6}, 1, 2, -1, 1},
                      {"1, 4, 5, 6", {1, 4, 5, 6}, 2, 3, 1, 4},
                      {"1, 5, 6, 2", {1, 5, 6, 2}, 1, 2, 3, 2},
                      {"1, 1, 5, 6", {1, 1, 5, 6}, 2, 3, -1, 1}};
  for (const Axes& axes : all)
    for (const bool is_fortran : {false, true}) {
      const std::size_t rank = axes.sides.size();
      std::vector<std::size_t> strides(rank);
      std::size_t count = 1;
      for (std::size_t i = 0; i < rank; ++i) {
        const std::size_t axis = is_fortran ? i : rank - 1 - i;
        strides[axis] = count;
        count *= std::size_t(axes.sides[axis]);
      }
      std::vector<float> values(count);
      const auto stride = [&](int axis) { return axis < 0 ? std::size_t(0) : strides[std::size_t(axis)]; };
      for (std::size_t y = 0; y < 5; ++y)
        for (std::size_t x = 0; x < 6; ++x)
          for (std::size_t c = 0; c < std::size_t(axes.channels); ++c)
            values[y * stride(axes.y) + x * stride(axes.x) + c * stride(axes.c)] = float(100 * y + 10 * x + c);
      const Image image = read("x.npy", test::npy_of("<f4", axes.shape, test::memory_of(values), is_fortran));
      ASSERT_EQ(int(image.planes.size()), axes.channels) << axes.shape;
      EXPECT_EQ(image.names[0], axes.channels == 1 ? "Y" : "R");
      for (int c = 0; c < axes.channels; ++c)
        for (int y = 0; y < 5; ++y)
          for (int x = 0; x < 6; ++x)
            ASSERT_EQ(image.planes[std::size_t(c)].at(x, y), float(100 * y + 10 * x + c))
                << axes.shape << (is_fortran ? " Fortran" : "") << ": " << x << ", " << y << ", " << c;
    }
}

TEST_F(Arrays, LaterVersionsOfNpyHaveLongerHeaders) {
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  std::string bytes = test::npy_of("<f4", "2, 3", test::memory_of(values));
  bytes[6] = 2;
  bytes.insert(10, 2, '\0');
  EXPECT_EQ(read("x.npy", bytes).planes[0].at(2, 1), 6.0f);
  bytes[6] = 3;
  EXPECT_EQ(read("x.npy", bytes).planes[0].at(0, 1), 4.0f);
  bytes[6] = 4;
  expect_error("x.npy", bytes, "NPY version 4");
}

TEST_F(Arrays, WhatIsNoPictureIsNamed) {
  const std::string values(4 * 5 * 6 * 7, '\0');
  expect_error("x.npy", test::npy_of("<f4", "5, 6, 7", values), "the shape 5 x 6 x 7");
  expect_error("x.npy", test::npy_of("<f4", "30,", values), "the shape 30");
  expect_error("x.npy", test::npy_of("<f4", "", values), "a single value");
  expect_error("x.npy", test::npy_of("<f4", "0, 6", values), "6 x 0 pixels");
  expect_error("x.npy", test::npy_of("<f4", "5, 70000", values), "cut short");
  expect_error("x.npy", test::npy_of("<f4", "1000000000, 1000000000, 1000000000", values), "damaged");
  expect_error("x.npy", test::npy_of("<f4", "-5, 6", values), "damaged");
  expect_error("x.npy", test::npy_of("<c8", "5, 6", values), "the type '<c8'");
  expect_error("x.npy", test::npy_of("|O", "5, 6", values), "the type '|O'");
  expect_error("x.npy", test::npy_of("<f3", "5, 6", values), "the type '<f3'");
}

TEST_F(Arrays, ArraysOfAnNpzAreParts) {
  const std::vector<float> depth(9 * 10, 2.5f), matrix = {525, 0, 319.5f, 0, 525, 239.5f, 0, 0, 1};
  const std::vector<std::uint8_t> color(9 * 10 * 3, 77);
  const auto entries = std::vector<std::pair<std::string, std::string>>{
      {"intrinsics.npy", test::npy_of("<f4", "3, 3", test::memory_of(matrix))},
      {"depth.npy", test::npy_of("<f4", "1, 9, 10", test::memory_of(depth))},
      {"image.npy", test::npy_of("|u1", "9, 10, 3", test::memory_of(color))},
      {"points.npy", test::npy_of("<f4", "30, 3", test::memory_of(depth))},
      {"notes.txt", "nothing"}};
  const Image image = read("x.npz", test::zip_of(entries));
  EXPECT_EQ(image.names, (std::vector<std::string>{"depth.Y", "image.R", "image.G", "image.B"}));
  EXPECT_EQ(image.width, 10);
  EXPECT_EQ(image.planes[0].at(9, 8), 2.5f);
  EXPECT_EQ(image.planes[3].at(9, 8), 77.0f);
  EXPECT_TRUE(header.channels[1].is_srgb);
  EXPECT_EQ(header.channels[1].max_integer, 255.0);
  ASSERT_TRUE(header.attribute("intrinsics"));
  EXPECT_EQ(*header.attribute("intrinsics"), "525,0,319.5,0,525,239.5,0,0,1");
  ASSERT_TRUE(header.attribute("points"));
  EXPECT_EQ(*header.attribute("points"), "array of 30 x 3");
  expect_error("x.npz", test::zip_of({{"notes.txt", "nothing"}}), "no array that is a picture");
  expect_error("x.npz", test::zip_of({{"a.npy", "no array"}}), "x.npz:a");
  // A directory of two gigabytes in a file of some bytes: refused before memory is requested.
  std::string claims = test::zip_of({entries[1]});
  const std::size_t directory = claims.find("PK\x01\x02");
  constexpr std::size_t kStoredSize = 20, kSize = 24;  // offsets in an entry of the directory
  for (const std::size_t field : {kStoredSize, kSize}) claims.replace(directory + field, 4, "\xff\xff\xff\x7f");
  expect_error("x.npz", claims, "claims 2147483647 bytes");
  std::string changed = test::zip_of({entries[1]});  // a value that does not fit the checksum
  changed[directory - 1] ^= 1;
  expect_error("x.npz", changed, "its array 'depth' is damaged");
}

TEST_F(Arrays, NetpbmCommentsAndMaxima) {
  Image image = read("x.pgm", "P2\n# one\n2 # two\n2\n1000\n0 500 # three\n1000 7\n");
  EXPECT_EQ(header.channels[0].max_integer, 1000.0);
  EXPECT_EQ(header.channels[0].type, ChannelType::kUint16);
  EXPECT_EQ(image.planes[0].at(1, 0), 500.0f);
  EXPECT_EQ(image.planes[0].at(1, 1), 7.0f);
  image = read("x.pgm", std::string("P5 2 1 65535\n\x12\x34\xff\xfe", 17));
  EXPECT_EQ(image.planes[0].at(0, 0), float(0x1234));
  EXPECT_EQ(image.planes[0].at(1, 0), float(0xfffe));
  image = read("x.ppm", "P3 1 1 255 1 2 3");
  EXPECT_EQ(image.names, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(image.planes[2].at(0, 0), 3.0f);
  expect_error("x.pgm", "P2 2 2 100\n1 2 3 101\n", "above 100");
  expect_error("x.pgm", "P5 99999 2 255\n", "99999 x 2");
  expect_error("x.pgm", "P5 60000 60000 255\nabc", "cut short");
  expect_error("x.pgm", "P5 2 2 70000\nabcd", "1 to 65535");
  expect_error("x.pgm", "P5 2 0 255\n", "2 x 0");
  expect_error("x.pgm", "P5 2 99999999999999999999 255\n", "must have width");
}

TEST_F(Arrays, GridsHaveCellsAndNoData) {
  const std::string rows = "1 +2,5 -9999\n4e1 nan 6\n";
  Image image = read("x.asc", "NCOLS 3\nNROWS 2\nXLLCENTER 7\nYLLCENTER 60\nCELLSIZE 0.5\nNODATA_VALUE -9999\n" + rows);
  EXPECT_EQ(image.planes[0].at(1, 0), 2.5f);
  EXPECT_EQ(image.planes[0].at(0, 1), 40.0f);
  EXPECT_TRUE(std::isnan(image.planes[0].at(1, 1)));
  ASSERT_TRUE(header.geo);
  EXPECT_EQ(header.geo->cell_width, 0.5);
  EXPECT_EQ(header.geo->no_data.value_or(0), -9999.0);
  read("x.asc", "ncols 3 nrows 2 dx 3 dy 4 nan 2 3 4 5 6");
  EXPECT_EQ(header.geo->cell_width, 3.0);
  EXPECT_EQ(header.geo->cell_height, 4.0);
  EXPECT_FALSE(header.geo->no_data);
  // Beside a .prj file with a geographic system, cells are in degrees.
  write("x.prj", "GEOGCS[\"WGS 84\"]");
  read("x.asc", "ncols 3\nnrows 2\nyllcorner 59.5\ncellsize 0.5\n" + rows);
  EXPECT_NEAR(header.geo->cell_width, 27900, 3);
  expect_error("x.asc", "ncols 3\nnrows 3\ncellsize 1\n" + rows, "x.asc");
  expect_error("x.asc", "ncols 3\nnrows 2\ncellsize 1\n1 2 3 4 five 6", "row 2, column 2");
  expect_error("x.asc", "ncols 3\nnrows 2\ncellsize 1\n1 2 3 4 5 6 7", "more values than the 3 x 2");
  expect_error("x.asc", "ncols 3\nnrows two\ncellsize 1\n1 2", "no number after 'nrows'");
  expect_error("x.asc", "ncols 60000\nnrows 60000\ncellsize 1\n1 2", "cut short");
  expect_error("x.asc", "ncols 3.5\nnrows 2\ncellsize 1\n1 2", "integers");
}

TEST_F(Arrays, RadianceRunsAreExpanded) {
  // Ten pixels: a run of ten for red and green, literal values for blue, and the exponent 2^1.
  const std::string row =
      std::string("\2\2\0\12", 4) + "\x8a\x40" + "\x8a\x80" + "\x0a" + std::string(10, '\x20') + "\x8a\x81";
  const Image image = read("x.hdr", test::hdr_of(10, 1, row));
  for (int x = 0; x < 10; ++x) {
    EXPECT_EQ(image.planes[0].at(x, 0), 0.5f);
    EXPECT_EQ(image.planes[1].at(x, 0), 1.0f);
    EXPECT_EQ(image.planes[2].at(x, 0), 0.25f);
  }
  expect_error("x.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "32-bit_rle_xyze");
  expect_error("x.hdr", "#?RADIANCE\n\n+Y 1 +X 1\nabcd", "-Y height");
  expect_error("x.hdr", test::hdr_of(20000, 10000, "abcd"), "cut short");
}

TEST_F(Arrays, MapsOfColmap) {
  std::vector<float> values(9 * 4 * 3);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = float(k);
  const Image depth =
      read("x.bin", "9&4&1&" + test::memory_of(std::vector<float>(values.begin(), values.begin() + 36)));
  EXPECT_EQ(depth.names, std::vector<std::string>{"depth.Z"});
  EXPECT_EQ(depth.planes[0].at(8, 3), 35.0f);
  const Image normals = read("x.bin", "9&4&3&" + test::memory_of(values));
  EXPECT_EQ(normals.names, (std::vector<std::string>{"normal.X", "normal.Y", "normal.Z"}));
  EXPECT_EQ(normals.planes[1].at(0, 1), 45.0f);
  expect_error("x.bin", "9&4&3&" + test::memory_of(std::vector<float>(100)), "cut short");
  expect_error("x.bin", "9&4&2&" + test::memory_of(values), "2 channels");
  expect_error("x.bin", "90000000&4&1&" + test::memory_of(values), "90000000");
}

}  // namespace
}  // namespace umbrage
