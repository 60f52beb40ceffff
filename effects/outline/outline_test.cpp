// Tests `outline` in both modes, and compares mode `paper` with a literal port of listing 3 of [Lajzer and Nottingham].
#include <algorithm>

#include "effects/outline/outline_test_scenes.h"

namespace umbrage {
namespace {

using namespace test;

constexpr double kMinCover = 0.02;  // min fraction covered of a pixel that counts as part of a line

Plane lines_of(const GBuffer& g, const Settings& settings = {}) {
  return test::run_effect(*find_effect("outline"), g, settings, {}).plane("outline");
}

/// Returns the number of pixels of lines, in the part of the picture that `where` selects.
long count(
    const Plane& lines, const std::function<bool(int, int)>& where = [](int, int) { return true; }) {
  long n = 0;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) n += lines.at(x, y) > kMinCover && where(x, y);
  return n;
}

TEST(Outline, BackgroundAloneHasNoLine) {
  const GBuffer g = seen({67, 29}, [](const dvec3&, const dvec3&) { return Hit{}; });
  for (const char* mode : {"robust", "paper"})
    test::on_every_target("outline", g, {{"mode", mode}}, [&](const Image& image) {
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) ASSERT_EQ(image.plane("outline").at(x, y), 0.0f);
    });
}

TEST(Outline, TinyPicturesAreFine) {
  for (const auto& [width, height] : {std::pair(1, 1), {3, 2}, {2, 17}})
    for (const char* mode : {"robust", "paper"})
      for (const bool orthographic : {false, true}) {
        const GBuffer g = seen({width, height, orthographic}, box({0, 0, -kFocus}, rotation(33, 38), 0.8));
        test::on_every_target("outline", g, {{"mode", mode}, {"width", "16"}},
                              [&, w = width, h = height](const Image& image) {
                                for (int y = 0; y < h; ++y)
                                  for (int x = 0; x < w; ++x) {
                                    ASSERT_GE(image.plane("outline").at(x, y), 0.0f);
                                    ASSERT_LE(image.plane("outline").at(x, y), 1.0f);
                                  }
                              });
      }
}

// The planes `line` are left out if lines are black, since `output` then draws black, and everything if they are
// transparent.
TEST(Outline, ColourAndOpacityAreWritten) {
  const GBuffer g = seen({96, 96}, box({0, 0, -kFocus}, rotation(33, 38), 1.0));
  const Effect& effect = *find_effect("outline");
  for (const char* mode : {"robust", "paper"}) {
    const Plane full = lines_of(g, {{"mode", mode}});
    EXPECT_GT(count(full), 100);
    const Settings half = {{"mode", mode}, {"r", "0.5"}, {"b", "0.25"}, {"opacity", "0.5"}};
    test::on_every_target("outline", g, half, [&](const Image& image) {
      for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
          ASSERT_EQ(image.plane("outline").at(x, y), 0.5f * full.at(x, y));
          ASSERT_EQ(image.plane("line.r").at(x, y), 0.5f);
          ASSERT_EQ(image.plane("line.g").at(x, y), 0.0f);
          ASSERT_EQ(image.plane("line.b").at(x, y), 0.25f);
        }
    });
    const auto made = [&](const Settings& settings) {
      return test::written_planes(effect, test::parameters_of(effect, settings));
    };
    const auto black = made({{"mode", mode}});
    EXPECT_EQ(std::count(black.begin(), black.end(), "line.r"), 0);
    EXPECT_TRUE(made({{"mode", mode}, {"r", "0.5"}, {"opacity", "0"}}).empty());
  }
}

// --- mode `paper` --------------------------------------------------------------------------------------------------

/// Result of listing 3 at a pixel.
struct Listing3 {
  double illum;
  bool close;  // a value is so close to its threshold that rounding decides
};

/// Returns the result of listing 3, computed in double. Texture coordinates are clamped to the border.
Listing3 toon_outlining(const GBuffer& g, int px, int py) {
  const Image& image = g.layers[0];
  const double far_plane = g.info.depth_max / 0.9, near_plane = far_plane * 2.0 / 15.0;
  const auto s_depth = [&](int x, int y) {
    const double z = image.planes[0].at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
    if (!std::isfinite(z)) return 1.0;
    const double clipped = std::clamp(z, near_plane, far_plane);
    const double linear = (clipped - near_plane) / (far_plane - near_plane);
    return g.info.camera.projection == Projection::kOrthographic ? linear : linear * far_plane / clipped;
  };
  const auto s_norm = [&](int x, int y) {
    x = std::clamp(x, 0, image.width - 1);
    y = std::clamp(y, 0, image.height - 1);
    return dvec3(image.planes[1].at(x, y), image.planes[2].at(x, y), image.planes[3].at(x, y));
  };
  const auto cleared = [&](int x, int y) { return s_norm(x, y) == dvec3(0.0); };

  double darkness_depth = 0.0, darkness_norm = 0.0;
  bool close = false;
  const double base_depth = s_depth(px, py);
  const dvec3 base_norm = s_norm(px, py);
  const double threshold_depth = 0.05 * (1.0 - base_depth), threshold_norm = 0.95;
  const int offsets[8][2] = {{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}, {1, 0}, {1, 1}};
  for (const auto& offset : offsets) {
    const double depth = s_depth(px + offset[0], py + offset[1]);
    const dvec3 norm = s_norm(px + offset[0], py + offset[1]);
    const double apart = std::fabs(depth - base_depth), alike = glm::dot(norm, base_norm);
    if (apart > threshold_depth) darkness_depth += 1.0;
    // Where neither is a surface, the listing would normalize zero vectors.
    const bool neither = cleared(px, py) && cleared(px + offset[0], py + offset[1]);
    if (!neither && alike < threshold_norm) darkness_norm += 1.0;
    const bool both_far = apart == 0.0 && threshold_depth == 0.0;
    close |= (!both_far && std::fabs(apart - threshold_depth) < 2e-6) || std::fabs(alike - threshold_norm) < 2e-6;
  }
  return {std::max(0.0, 1.0 - (darkness_depth + darkness_norm)), close};
}

TEST(Outline, PaperIsListing3) {
  for (const bool orthographic : {false, true}) {
    const Lens lens{190, 140, orthographic};
    GBuffer traced = seen(lens, together({box({-0.6, 0.3, -kFocus}, rotation(33, 38, 7), 0.7),
                                          sphere({0.8, -0.3, -5.0}, 0.6, 1), ground(12.0, 0.0, 12.0, 2)}));
    traced.info.depth_max = 12.0f;
    GBuffer bumpy = test::bumpy_gbuffer(97, 61, 5);
    bumpy.info.camera.projection = traced.info.camera.projection;
    for (const GBuffer* g : {&traced, &bumpy})
      test::on_every_target("outline", *g, {{"mode", "paper"}}, [&](const Image& image) {
        long wrong = 0, black = 0, close = 0;
        for (int y = 0; y < image.height; ++y)
          for (int x = 0; x < image.width; ++x) {
            const Listing3 listing = toon_outlining(*g, x, y);
            black += listing.illum < 1.0;
            close += listing.close;
            wrong += !listing.close && 1.0 - image.plane("outline").at(x, y) != listing.illum;
          }
        EXPECT_EQ(wrong, 0);
        EXPECT_GT(black, 500);
        EXPECT_LT(close, 100);
      });
  }
}

TEST(Outline, PaperThresholdsAreParameters) {
  const GBuffer g = seen({128, 128}, box({0, 0, -kFocus}, rotation(33, 38), 1.0));
  const auto drawn = [&](const char* depth, const char* normal) {
    return count(lines_of(g, {{"mode", "paper"}, {"paper_depth", depth}, {"paper_normal", normal}}));
  };
  const long both = drawn("0.05", "0.95"), silhouettes = drawn("0.05", "-1"), creases = drawn("1", "0.95");
  EXPECT_GT(silhouettes, 100);
  EXPECT_GT(creases, silhouettes);  // normals also separate the cube from the background
  EXPECT_GE(both, creases);
  EXPECT_LT(silhouettes, both);
}

}  // namespace
}  // namespace umbrage
