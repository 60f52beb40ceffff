// Widths of the classes of pixels, in pictures that are wider than high or the other way round.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "reference/metrics.h"

namespace umbrage {
namespace {

/// Returns an orthographic view of bars at depth 10 before a wall at depth 20. `on_bar`: whether a pixel shows a bar.
GBuffer bars_before_wall(int width, int height, const std::function<bool(int x, int y)>& on_bar) {
  GBuffer g;
  g.info.width = width;
  g.info.height = height;
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4.0f, float(width) / float(height));
  Image& layer = g.layers.emplace_back(width, height);
  for (const char* name : {"normal.x", "normal.y", "normal.z"})
    layer.add(name) = Plane(width, height, name == std::string("normal.z") ? 1.0f : 0.0f);
  Plane& depth = layer.add("depth");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) depth.at(x, y) = on_bar(x, y) ? 10.0f : 20.0f;
  return g;
}

/// Sizes in pixels: of the picture, and of its classes.
struct Sizes {
  int width, height;
  int thin;        // max width of a thin object: a hundredth of the height, at least 2
  int silhouette;  // on either side: 2 in 1024 rows, at least 1
  int border;      // 4 % of the shorter side
};
constexpr Sizes kSizes[] = {{300, 600, 6, 1, 12}, {900, 400, 4, 1, 16}, {200, 1024, 10, 2, 8}, {1200, 200, 2, 1, 8}};

TEST(Classify, BordersAreAFractionOfTheShorterSide) {
  for (const Sizes& size : kSizes) {
    const ClassMap map = classify(bars_before_wall(size.width, size.height, [](int, int) { return false; }));
    int wrong = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const bool near_border = std::min({x, y, size.width - 1 - x, size.height - 1 - y}) < size.border;
        wrong += map.row(y)[x] != (near_border ? PixelClass::kBorder : PixelClass::kOpen);
      }
    EXPECT_EQ(wrong, 0) << size.width << " x " << size.height;
  }
}

TEST(Classify, ThinnessAndSilhouettesAreFractionsOfTheHeight) {
  for (const Sizes& size : kSizes)
    for (const bool upright : {true, false})
      for (const int more : {0, 1}) {
        SCOPED_TRACE(testing::Message() << size.width << " x " << size.height << ' ' << upright << ' ' << more);
        const int first = (upright ? size.width : size.height) / 2, end = first + size.thin + more;
        const ClassMap map = classify(bars_before_wall(size.width, size.height, [&](int x, int y) {
          const int at = upright ? x : y;
          return at >= first && at < end;
        }));
        // Along a line across the bar.
        const int length = upright ? size.width : size.height;
        for (int at = size.border; at < length - size.border; ++at) {
          const bool on_bar = at >= first && at < end;
          const int to_edge = on_bar ? std::min(at - first, end - 1 - at) : at < first ? first - 1 - at : at - end;
          const PixelClass expected = on_bar && more == 0         ? PixelClass::kThin
                                      : to_edge < size.silhouette ? PixelClass::kSilhouette
                                                                  : PixelClass::kOpen;
          const PixelClass found = upright ? map.row(size.height / 2)[at] : map.row(at)[size.width / 2];
          ASSERT_EQ(found, expected) << at;
        }
      }
}

TEST(Classify, DiagonalBarsAreThinByTheirWidthAcross) {
  // Bars where x + y is in a range. A diagonal step changes x + y by 2, so that a bar of 2 n values is n pixels wide.
  // The max is that of upright bars, divided by the root of 2: 6 and 10 pixels become 4 and 7.
  for (const auto& [size, max] : {std::pair{kSizes[0], 4}, {kSizes[2], 7}})
    for (const int more : {0, 1}) {
      const int middle = (size.width + size.height) / 2, values = 2 * (max + more);
      const auto on_bar = [&](int x, int y) { return x + y >= middle && x + y < middle + values; };
      const ClassMap map = classify(bars_before_wall(size.width, size.height, on_bar));
      // Near the border, a run of pixels across the bar may leave the picture.
      const int margin = size.border + max;
      int wrong = 0;
      for (int y = margin; y < size.height - margin; ++y)
        for (int x = margin; x < size.width - margin; ++x)
          wrong += (map.row(y)[x] == PixelClass::kThin) != (on_bar(x, y) && more == 0);
      EXPECT_EQ(wrong, 0) << size.width << " x " << size.height << ", " << values << " values";
    }
}

}  // namespace
}  // namespace umbrage
