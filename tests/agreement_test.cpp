// What pictures of one scene agree on of the lines that they have (looks/agreement.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "looks/frames.h"

namespace umbrage {
namespace {

constexpr int kSize = 64;
constexpr float kWidth = 3.0f;  // of a line, pixels

struct Stroke {
  glm::vec2 from, to;
};

/// How a picture that has its samples at `offset` shows strokes: antialiased, with blunt ends.
/// Those of less than a pixel are one wide, and as much lighter.
Plane drawn(const std::vector<Stroke>& strokes, glm::vec2 offset, float opacity = 1.0f, float width = kWidth) {
  Plane plane(kSize, kSize, 0.0f);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (const Stroke& s : strokes) {
        const glm::vec2 at = glm::vec2(float(x) + 0.5f, float(y) + 0.5f) + offset, way = s.to - s.from;
        const float length = std::sqrt(way.x * way.x + way.y * way.y),
                    along = ((at - s.from).x * way.x + (at - s.from).y * way.y) / length;
        const float off = std::abs((at - s.from).x * way.y - (at - s.from).y * way.x) / length;
        const float across = std::clamp(0.5f * std::max(width, 1.0f) + 0.5f - off, 0.0f, 1.0f);
        const float within = std::clamp(std::min(along, length - along) + 0.5f, 0.0f, 1.0f);
        plane.at(x, y) = std::max(plane.at(x, y), opacity * std::min(width, 1.0f) * across * within);
      }
  return plane;
}

/// A picture of these lines, of root 0.5, before a surface of root 0.9.
Image picture_of(const Plane& lines) {
  Image image(kSize, kSize);
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    Plane& plane = image.add(name) = Plane(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const float root = 0.9f * (1.0f - lines.at(x, y)) + 0.5f * lines.at(x, y);
        plane.at(x, y) = root * root;
      }
  }
  image.add("color.a") = Plane(kSize, kSize, 1.0f);
  image.add("outline") = lines;
  return image;
}

/// The sum of four pictures, each with its own strokes, sampled as the frames of a picture are.
PictureSum sum_of(const std::vector<std::vector<Stroke>>& pictures, float opacity = 1.0f, float width = kWidth) {
  PictureSum total{.for_eye = true, .opacity = opacity, .line_px = width};
  const int count = int(pictures.size());
  for (int k = count - 1; k >= 0; --k) {
    const glm::vec2 offset = frame_offset(k, count);
    add_picture(total, picture_of(drawn(pictures[k], offset, opacity, width)), offset);
  }
  return total;
}

Plane lines_of(const PictureSum& total) {
  return mean_planes(total, std::vector<std::string>{"outline"}).plane("outline");
}

Plane agreed(const std::vector<std::vector<Stroke>>& pictures, float width = kWidth) {
  PictureSum total = sum_of(pictures, 1.0f, width);
  agree_on_lines(total);
  return lines_of(total);
}

float most_apart(const Plane& a, const Plane& b) {
  float most = 0.0f;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) most = std::max(most, std::abs(a.at(x, y) - b.at(x, y)));
  return most;
}

const Stroke kThrough = {{-5.0f, 20.0f}, {70.0f, 27.0f}};
const Stroke kCrumb = {{30.0f, 44.0f}, {36.0f, 48.0f}};

// Of what a picture shows, moved to the pixels' centres, no more than interpolation softens.
constexpr float kSoft = 0.2f;

TEST(AgreedLines, WhereAllHaveThemTheyAreTheMean) {
  const std::vector<std::vector<Stroke>> all(4, {kThrough, {{10.0f, 40.0f}, {50.0f, 60.0f}}});
  const PictureSum total = sum_of(all);
  EXPECT_EQ(most_apart(agreed(all), lines_of(total)), 0.0f);
}

TEST(AgreedLines, ALineThatOneLacksIsWhole) {
  for (int lacking = 0; lacking < 4; ++lacking) {
    std::vector<std::vector<Stroke>> pictures(4, {kThrough});
    pictures[lacking].clear();
    EXPECT_LT(most_apart(agreed(pictures), drawn({kThrough}, {0, 0})), kSoft) << lacking;
  }
}

TEST(AgreedLines, ALineThatTwoHaveIsWhole) {
  EXPECT_LT(most_apart(agreed({{kThrough}, {}, {kThrough}, {}}), drawn({kThrough}, {0, 0})), kSoft);
}

TEST(AgreedLines, WhatOneHasAloneIsNotThere) {
  for (int having = 0; having < 4; ++having) {
    std::vector<std::vector<Stroke>> pictures(4, {kThrough});
    pictures[having].push_back(kCrumb);
    const Plane lines = agreed(pictures);
    for (int y = 40; y < 54; ++y)
      for (int x = 26; x < 42; ++x) EXPECT_EQ(lines.at(x, y), 0.0f) << having << ": " << x << ", " << y;
    EXPECT_LT(most_apart(lines, drawn({kThrough}, {0, 0})), kSoft);
  }
}

TEST(AgreedLines, ACrumbThatTwoHaveIsNotThere) {
  EXPECT_LT(
      most_apart(agreed({{kThrough, kCrumb}, {kThrough}, {kThrough, kCrumb}, {kThrough}}), drawn({kThrough}, {0, 0})),
      kSoft);
}

// Two ends weigh more than a gap that is short.
TEST(AgreedLines, OneThatClosesAGapIsTaken) {
  const std::vector<Stroke> open = {{{-5.0f, 30.0f}, {26.0f, 30.0f}}, {{38.0f, 30.0f}, {70.0f, 30.0f}}};
  const std::vector<Stroke> closed = {{{-5.0f, 30.0f}, {70.0f, 30.0f}}};
  EXPECT_LT(most_apart(agreed({open, open, closed, open}), drawn(closed, {0, 0})), kSoft);
}

// Each has a gap elsewhere: none of them alone is whole.
TEST(AgreedLines, TwoTogetherCloseGapsThatEachHas) {
  const auto cut = [](float from, float to) {
    return std::vector<Stroke>{{{-5.0f, 30.0f}, {from, 30.0f}}, {{to, 30.0f}, {70.0f, 30.0f}}};
  };
  EXPECT_LT(most_apart(agreed({cut(16, 24), cut(40, 48), cut(16, 48), cut(14, 50)}),
                       drawn({{{-5.0f, 30.0f}, {70.0f, 30.0f}}}, {0, 0})),
            kSoft);
}

// No grey threads: a fold whose line is found elsewhere in each of two pictures is one line or the other.
TEST(AgreedLines, LinesThatLieAsideAreOneOfThem) {
  const Stroke high = {{-5.0f, 30.0f}, {70.0f, 30.0f}}, low = {{-5.0f, 33.5f}, {70.0f, 33.5f}};
  const Plane lines = agreed({{high}, {low}, {high}, {low}});
  EXPECT_LT(std::min(most_apart(lines, drawn({high}, {0, 0})), most_apart(lines, drawn({low}, {0, 0}))), kSoft);
}

// Each place has a picture of its own.
TEST(AgreedLines, PlacesApartChooseApart) {
  const Stroke gap[] = {{{-5.0f, 12.0f}, {26.0f, 12.0f}}, {{38.0f, 12.0f}, {70.0f, 12.0f}}};
  const Stroke closed = {{-5.0f, 12.0f}, {70.0f, 12.0f}}, low = {{-5.0f, 50.0f}, {70.0f, 50.0f}};
  const std::vector<Stroke> crumb = {closed, low, kCrumb}, open = {gap[0], gap[1], low}, cut = {gap[0], gap[1]};
  EXPECT_LT(most_apart(agreed({crumb, open, cut, open}), drawn({closed, low}, {0, 0})), kSoft);
}

TEST(AgreedLines, ThinLinesAreAskedToo) {
  const std::vector<Stroke> open = {{{-5.0f, 30.2f}, {26.0f, 32.4f}}, {{38.0f, 33.2f}, {70.0f, 35.5f}}};
  const std::vector<Stroke> closed = {{{-5.0f, 30.2f}, {70.0f, 35.5f}}};
  for (const float width : {1.0f, 0.5f, 0.3f, 0.2f}) {
    const float soft = 0.5f * width;  // of so thin lines interpolation takes more
    EXPECT_LT(most_apart(agreed({closed, closed, {}, closed}, width), drawn(closed, {0, 0}, 1.0f, width)), soft)
        << width;
    EXPECT_LT(most_apart(agreed({open, open, closed, open}, width), drawn(closed, {0, 0}, 1.0f, width)), soft) << width;
  }
}

// A ring has no end.
TEST(AgreedLines, ARingThatTwoHaveIsWhole) {
  std::vector<Stroke> ring;
  constexpr int kCorners = 12;
  const auto corner = [](int k) {
    const float angle = 6.2831853f * float(k) / kCorners;
    return glm::vec2(32.0f + 6.0f * std::cos(angle), 32.0f + 6.0f * std::sin(angle));
  };
  for (int k = 0; k < kCorners; ++k) ring.push_back({corner(k), corner(k + 1)});
  EXPECT_LT(most_apart(agreed({ring, {}, ring, {}}), drawn(ring, {0, 0})), 1.5f * kSoft);
}

// A stroke beside a line that closes a hole with it, as at a fold that is found twice.
TEST(AgreedLines, LinesThatAreDoubledYieldToOne) {
  const Stroke line = {{-5.0f, 30.0f}, {70.0f, 30.0f}};
  const std::vector<Stroke> twice = {
      line, {{27.0f, 29.0f}, {28.0f, 24.0f}}, {{28.0f, 24.5f}, {33.0f, 24.5f}}, {{33.0f, 24.0f}, {34.0f, 29.0f}}};
  EXPECT_LT(most_apart(agreed({twice, {line}, twice, {line}}), drawn({line}, {0, 0})), kSoft);
}

TEST(AgreedLines, TheyCoverNoMoreThanTheirOpacity) {
  PictureSum total = sum_of({{kThrough}, {kThrough}, {}, {kThrough}}, 0.4f);
  agree_on_lines(total);
  const Plane lines = lines_of(total);
  EXPECT_LT(most_apart(lines, drawn({kThrough}, {0, 0}, 0.4f)), 0.4f * kSoft);
  float most = 0.0f;
  for (int y = 0; y < kSize; ++y) most = std::max(most, *std::max_element(lines.row(y), lines.row(y) + kSize));
  EXPECT_FLOAT_EQ(most, 0.4f);
}

// The colour beside and under a line is what the pictures have there, whether the line was in their mean or not.
TEST(AgreedLines, ColourIsThatOfSurfaceAndLine) {
  for (const std::vector<Stroke>& odd : {std::vector<Stroke>{}, {kThrough, kCrumb}}) {
    PictureSum total = sum_of({{kThrough}, odd, {kThrough}, {kThrough}});
    agree_on_lines(total);
    const Plane lines = lines_of(total), mean = sum_of({{kThrough}, odd, {kThrough}, {kThrough}}).sum.plane("outline");
    for (const PictureSum& sum : {total, rows_of(total, 0, kSize)}) {
      const GBuffer picture = mean_picture(sum, PictureInfo{.width = kSize, .height = kSize}, glm::vec3(0.25f));
      for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
          if (mean.at(x, y) > 3.9f) continue;  // under it nothing is known
          const float root = 0.9f * (1.0f - lines.at(x, y)) + 0.5f * lines.at(x, y);
          EXPECT_NEAR(picture.layers[0].plane("lit.g").at(x, y), root * root, 2e-3f) << x << ", " << y;
        }
    }
  }
}

TEST(AgreedLines, PixelsThatAreNoNumbersHaveNoLine) {
  PictureSum total{.for_eye = true, .opacity = 1.0f, .line_px = kWidth};
  Plane lines(kSize, kSize, std::nanf(""));
  for (int k = 3; k >= 0; --k) add_picture(total, picture_of(lines), frame_offset(k, 4));
  for (const LinePicture& picture : total.lines)
    EXPECT_EQ(std::count(picture.cover.begin(), picture.cover.end(), 0), kSize * kSize);
}

TEST(AgreedLines, TwoPicturesHaveNoMajority) {
  const PictureSum total = sum_of({{kThrough}, {}});
  EXPECT_EQ(most_apart(agreed({{kThrough}, {}}), lines_of(total)), 0.0f);
}

TEST(AgreedLines, ManyPicturesAreAskedInPart) {
  std::vector<std::vector<Stroke>> pictures(kMostLinePictures + 8, {kThrough});
  for (std::size_t k = 0; k < pictures.size(); k += 5) pictures[k].push_back(kCrumb);
  PictureSum total = sum_of(pictures);
  EXPECT_EQ(int(total.lines.size()), kMostLinePictures);
  agree_on_lines(total);
  EXPECT_TRUE(total.lines.empty());
  EXPECT_LT(most_apart(lines_of(total), drawn({kThrough}, {0, 0})), kSoft);
}

// Sizes at which rows and columns around a pixel are beyond the picture.
TEST(AgreedLines, PicturesMayBeOfAnySize) {
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(1, 9), glm::ivec2(9, 1), glm::ivec2(2, 3),
                                glm::ivec2(5, 4), glm::ivec2(5, 5), glm::ivec2(6, 7)}) {
    std::vector<LinePicture> pictures;
    for (int k = 0; k < 4; ++k)
      pictures.push_back(
          {frame_offset(k, 4), std::vector<std::uint8_t>(std::size_t(size.x) * size.y, k == 1 ? 0 : 255)});
    Plane mean(size.x, size.y, 0.75f);
    const Plane lines = agreed_lines(pictures, mean, 1.0f, 2.0f);
    // Where there is more than a border all of it is in dispute: it is one picture everywhere.
    const bool more = size.x > 4 && size.y > 4;
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) EXPECT_EQ(lines.at(x, y), more ? 1.0f : 0.75f) << size.x << ',' << size.y;
  }
}

// At the border samples of what is beyond are missing.
TEST(AgreedLines, LinesAlongTheBorderAreTheMean) {
  for (const float y : {-1.0f, 0.4f, 1.2f}) {
    const std::vector<std::vector<Stroke>> all(4, {{{-5.0f, y}, {70.0f, y}}, {{y, -5.0f}, {y, 70.0f}}});
    EXPECT_EQ(most_apart(agreed(all), lines_of(sum_of(all))), 0.0f) << y;
  }
}

}  // namespace
}  // namespace umbrage
