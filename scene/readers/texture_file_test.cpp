// Decoder for Radiance pictures: exposure and the run lengths of both encodings, against values written by hand.
#include "scene/readers/texture_file.h"

#include <gtest/gtest.h>

namespace umbrage {
namespace {

using namespace std::string_literals;

Result<Panorama> decoded(const std::string& header, int width, const std::string& pixels) {
  const std::string bytes =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + header + "\n-Y 1 +X " + std::to_string(width) + "\n" + pixels;
  return decode_radiance({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "test.hdr", 1 << 20);
}

std::vector<float> rgb_of(const std::string& header, int width, const std::string& pixels) {
  const auto panorama = decoded(header, width, pixels);
  EXPECT_TRUE(panorama) << (panorama ? "" : panorama.error().message);
  return panorama ? panorama->rgb : std::vector<float>();
}

TEST(Radiance, PixelsAreDividedByAllExposures) {
  const std::string pixel = "\x80\x40\x20\x81";  // 1, 0.5, 0.25
  EXPECT_EQ(rgb_of("EXPOSURE=4\n", 1, pixel), (std::vector<float>{0.25f, 0.125f, 0.0625f}));
  EXPECT_EQ(rgb_of("EXPOSURE= 0.5\n", 1, pixel), (std::vector<float>{2.0f, 1.0f, 0.5f}));
  EXPECT_EQ(rgb_of("EXPOSURE=4\nEXPOSURE=2\n", 1, pixel), (std::vector<float>{0.125f, 0.0625f, 0.03125f}));
}

TEST(Radiance, ConsecutiveRepeatsAreDigitsOfOneCount) {
  // Red once, repeated 44 + 1 * 256 = 300 times; green once, repeated 3 times: its count begins with the lowest digit.
  const std::string red = "\x80\0\0\x81"s, green = "\0\x80\0\x81"s;
  const std::string row = red + "\1\1\1\x2c" + "\1\1\1\1" + green + "\1\1\1\3";
  const std::vector<float> rgb = rgb_of("", 305, row);
  ASSERT_EQ(rgb.size(), 3u * 305);
  for (std::size_t x = 0; x < 305; ++x) {
    ASSERT_EQ(rgb[3 * x], x < 301 ? 1.0f : 0.0f) << x;
    ASSERT_EQ(rgb[3 * x + 1], x < 301 ? 0.0f : 1.0f) << x;
    ASSERT_EQ(rgb[3 * x + 2], 0.0f) << x;
  }
  // The third digit counts 65536s.
  const std::string three_digits = red + "\1\1\1\2" + "\1\1\1\0"s + "\1\1\1\1";
  EXPECT_FALSE(decoded("", 60000, three_digits)) << "2 + 65536 pixels in a row of 60000";
  // A count may not exceed the row, and a row does not begin with a repeat.
  EXPECT_TRUE(decoded("", 301, red + "\1\1\1\x2c" + "\1\1\1\1"));
  EXPECT_FALSE(decoded("", 300, red + "\1\1\1\x2c" + "\1\1\1\1"));
  EXPECT_FALSE(decoded("", 4, "\1\1\1\4"));
}

TEST(Radiance, RunsOfAChannelEndWithTheRow) {
  // Rows of 8 to 32767 pixels may store the channels one after the other. Codes above 128 are runs, others literals.
  const std::string start = "\2\2\0\x8"s, exponents = "\x88\x81";
  const std::string row = start + "\x83\x80\5\0\1\2\3\4"s + "\x88\0"s + "\x8\0\0\0\0\0\0\0\x40"s + exponents;
  std::vector<float> expected(24, 0.0f);
  for (std::size_t x = 0; x < 3; ++x) expected[3 * x] = 1.0f;
  for (std::size_t x = 3; x < 8; ++x) expected[3 * x] = float(x - 3) / 128.0f;
  expected[3 * 7 + 2] = 0.5f;
  EXPECT_EQ(rgb_of("", 8, row), expected);
  // The longest literal has 128 pixels.
  std::string longest = "\2\2\0\x80"s;
  for (const char value : {'\x80', '\x40', '\0', '\x81'}) longest += '\x80' + std::string(128, value);
  const std::vector<float> rgb = rgb_of("", 128, longest);
  ASSERT_EQ(rgb.size(), 3u * 128);
  EXPECT_EQ(std::vector<float>(rgb.end() - 3, rgb.end()), (std::vector<float>{1.0f, 0.5f, 0.0f}));
  EXPECT_FALSE(decoded("", 8, start + "\x89\x80"));     // 9 pixels
  EXPECT_FALSE(decoded("", 8, start + "\0\x80"s));      // none
  EXPECT_FALSE(decoded("", 8, "\2\2\0\x9"s + "\x88"));  // another width
}

}  // namespace
}  // namespace umbrage
