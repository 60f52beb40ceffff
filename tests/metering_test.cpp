// Metering of pictures of 100 metered pixels, against stops calculated by hand.
#include "looks/metering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace umbrage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kSide = 30;  // one pixel in 3 is metered, across and down: 100 in all

/// Some of the metered pixels and their luminance.
struct Part {
  int count;
  float luminance;
};

/// Returns the planes of a grey picture, row by row in the order of the parts. Pixels that are not metered are black.
Image picture_of(const std::vector<Part>& parts) {
  Image image(kSide, kSide);
  for (const std::string& name : kMeteredPlanes) image.add(name) = Plane(kSide, kSide, name == "depth" ? 1.0f : 0.0f);
  int pixel = 0;
  for (const Part& part : parts)
    for (int k = 0; k < part.count; ++k, ++pixel)
      for (int c = 0; c < 3; ++c)
        image.planes[std::size_t(c)].at(pixel % 10 * 3 + 1, pixel / 10 * 3 + 1) = part.luminance;
  EXPECT_EQ(pixel, 100);
  return image;
}

float stops_of(const Image& image, Exposure by, float usual = 0.0f) {
  Metering metering;
  metering.add(image, 0, image.height);
  return metering.stops(usual, by);
}

float by_picture(const std::vector<Part>& parts, float usual = 0.0f) {
  return stops_of(picture_of(parts), Exposure::kPicture, usual);
}
float by_median(const std::vector<Part>& parts, float usual = 0.0f) {
  return stops_of(picture_of(parts), Exposure::kMedian, usual);
}

TEST(MeteringNumbers, ByPicture) {
  const float white = kMeteredWhite;
  ASSERT_FLOAT_EQ(white, 0.72f);
  ASSERT_FLOAT_EQ(kMeteredGrey, 0.2f);
  // One stop below white: 70 % of it is corrected, whether 3 % are highlights or none.
  EXPECT_NEAR(by_picture({{100, white / 2}}), 0.7, 1e-5);
  EXPECT_NEAR(by_picture({{97, white / 2}, {3, 16.0f * white}}), 0.7, 1e-5);
  // With 4 %, white is 4 stops too bright. The mean of the logarithms is -1.474 + 0.04 * 5 = -1.274, which is 1.048
  // stops too bright, but only one stop beyond white is allowed: 0.7 * -3.
  EXPECT_NEAR(by_picture({{96, white / 2}, {4, 16.0f * white}}), -2.1, 1e-5);
  // 17 % are black and count as 1e-4 of the bright ones: the mean of the logarithms is log2 0.72 - 0.17 * 13.288 =
  // -2.733, and grey is at -2.322.
  EXPECT_NEAR(by_picture({{17, 0.0f}, {83, white}}), 0.7 * 0.41093, 1e-4);
  // Half the picture is black: the limit of one stop beyond white.
  EXPECT_NEAR(by_picture({{50, 0.0f}, {50, white}}), 0.7, 1e-5);
  // The correction is that of the usual stops, at most 2.5 either way.
  EXPECT_NEAR(by_picture({{100, white / 2}}, -1.0f), -1.0 + 0.7 * 2.0, 1e-5);
  EXPECT_NEAR(by_picture({{100, white / 8}}), 0.7 * 3.0, 1e-5);
  EXPECT_NEAR(by_picture({{100, white / 16}}, 0.5f), 0.5 + 0.7 * 3.5, 1e-5);
  EXPECT_NEAR(by_picture({{100, white / 32}}, 0.5f), 3.0, 1e-5);
  EXPECT_NEAR(by_picture({{100, white * 32}}, 0.5f), -2.0, 1e-5);
}

TEST(MeteringNumbers, ByMedian) {
  const float median = kMeteredMedian;
  ASSERT_FLOAT_EQ(median, 0.38f);
  // One stop below: 90 % of it is corrected, whatever the 3 % that are highlights.
  EXPECT_NEAR(by_median({{100, median / 2}}), 0.9, 1e-5);
  EXPECT_NEAR(by_median({{97, median / 2}, {3, 16.0f}}), 0.9, 1e-5);
  // With 4 % they count, and are 2 stops above their bound.
  EXPECT_NEAR(by_median({{96, median / 2}, {4, 4.0f}}), 0.9 * -2.0, 1e-5);
  // The 50th of 100 is the median.
  EXPECT_NEAR(by_median({{50, median / 2}, {50, median}}), 0.9, 1e-5);
  EXPECT_NEAR(by_median({{49, median / 2}, {51, median}}), 0.0, 1e-5);
  EXPECT_NEAR(by_median({{100, median / 2}}, -1.0f), -1.0 + 0.9 * 2.0, 1e-5);
  EXPECT_NEAR(by_median({{100, median / 16}}, 0.5f), 3.0, 1e-5);
  EXPECT_NEAR(by_median({{100, median * 16}}, 0.5f), -2.0, 1e-5);
}

TEST(MeteringNumbers, LuminanceOfSurfacesInOnePixelOfThree) {
  // Pure colours have the luminance of Rec.709. All is one stop below white then.
  const float weights[] = {0.2126f, 0.7152f, 0.0722f};
  for (std::size_t c = 0; c < 3; ++c) {
    Image image = picture_of({{100, 0.0f}});
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide; x += 3) image.planes[c].at(x, y) = 0.5f * kMeteredWhite / weights[c];
    EXPECT_NEAR(stops_of(image, Exposure::kPicture), 0.7, 1e-4) << c;
    // The background and what is not finite do not count.
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide / 2; x += 3) {
        image.planes[c].at(x, y) = x == 1 ? std::nanf("") : 100.0f;
        if (x > 1) image.planes[3].at(x, y) = kInfinity;
      }
    EXPECT_NEAR(stops_of(image, Exposure::kPicture), 0.7, 1e-4) << c;
    // Rows may come in pieces.
    for (const int rows : {1, 4, 7}) {
      Metering metering;
      for (int first = 0; first < kSide; first += rows) {
        const int count = std::min(rows, kSide - first);
        Image part(kSide, count);
        for (std::size_t p = 0; p < 4; ++p) {
          Plane& plane = part.add(kMeteredPlanes[p]);
          for (int y = 0; y < count; ++y) std::copy_n(image.planes[p].row(first + y), kSide, plane.row(y));
        }
        metering.add(part, first, kSide);
      }
      EXPECT_NEAR(metering.stops(0.0f, Exposure::kPicture), 0.7, 1e-4) << rows;
      EXPECT_EQ(metering.stops(0.25f, Exposure::kPicture), 0.25f) << "the rows are cleared";
    }
  }
}

}  // namespace
}  // namespace umbrage
