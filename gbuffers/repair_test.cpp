// Tests the repair of averaged edges with a ball and a slab before a tilted wall, whose depth, normals and ids at the
// centre of every pixel are known.
#include "gbuffers/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace umbrage {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
constexpr int kWidth = 160, kHeight = 120;
constexpr double kTop = 0.5;  // half the window's height at depth 1
constexpr float kPixelSize = float(2.0 * kTop / kHeight);
constexpr const char* kNormals[] = {"normal.x", "normal.y", "normal.z"};

struct Hit {
  double depth = kNone;
  glm::dvec3 normal{0.0};
  int id = -1;
};

void take_nearer(Hit& nearest, const Hit& other) {
  if (other.depth > 0.0 && other.depth < nearest.depth) nearest = other;
}

Hit hit_plane(const glm::dvec3& ray, const glm::dvec3& point, const glm::dvec3& normal, int id) {
  return {glm::dot(point, normal) / glm::dot(ray, normal), normal, id};
}

/// Returns what the ray through a point of the picture hits; x and y in pixels. `open`: there is no wall.
Hit hit_at(double x, double y, bool open) {
  const glm::dvec3 ray((x - 0.5 * kWidth) * kPixelSize, (0.5 * kHeight - y) * kPixelSize, -1.0);
  Hit nearest;
  if (!open) nearest = hit_plane(ray, {0, 0, -9}, glm::normalize(glm::dvec3(0.2, 0.1, 1.0)), 0);
  const glm::dvec3 center(-0.7, 0.1, -4.0);
  const double a = glm::dot(ray, ray), b = glm::dot(ray, center), c = glm::dot(center, center) - 0.81;
  if (const double root = b * b - a * c; root > 0.0) {
    const double depth = (b - std::sqrt(root)) / a;
    take_nearer(nearest, {depth, glm::normalize(ray * depth - center), 4});
  }
  const glm::dvec3 facing = glm::normalize(glm::dvec3(-0.3, 0.2, 1.0));
  const Hit slab = hit_plane(ray, {1.2, 0.0, -5.0}, facing, 9);
  const glm::dvec3 at = ray * slab.depth;  // a slab that is turned in the picture
  const double u = 0.8 * (at.x - 1.2) + 0.6 * at.y, v = -0.6 * (at.x - 1.2) + 0.8 * at.y;
  if (std::abs(u) < 0.6 && std::abs(v) < 0.9) take_nearer(nearest, slab);
  return nearest;
}

/// How a renderer fills the pixels.
struct Filled {
  int samples = 1;           ///< per row and column of a pixel, which are averaged
  bool depth = true;         ///< depth and ids are averaged too, not only normals
  double background = 1e10;  ///< depth where there is no surface, before the average
  bool open = false;
};

Image rendered(const Filled& filled) {
  Image image(kWidth, kHeight);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "object_id"})
    image.add(name) = Plane(kWidth, kHeight);
  const int n = filled.samples;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      Hit mean{0.0, glm::dvec3(0.0), 0};
      double ids = 0.0;
      for (int k = 0; k < n * n; ++k) {
        const Hit hit = hit_at(x + (k % n + 0.5) / n, y + (k / n + 0.5) / n, filled.open);
        mean.depth += (std::isfinite(hit.depth) ? hit.depth : filled.background) / (n * n);
        mean.normal += hit.normal;
        ids += double(hit.id) / (n * n);
      }
      const Hit middle = hit_at(x + 0.5, y + 0.5, filled.open);
      if (!filled.depth || n == 1) mean.depth = middle.depth, ids = middle.id;
      if (mean.depth == filled.background) mean.depth = kNone;
      if (glm::length(mean.normal) > 0.0) mean.normal = glm::normalize(mean.normal);
      image.plane("depth").at(x, y) = float(mean.depth);
      for (int c = 0; c < 3; ++c) image.plane(kNormals[c]).at(x, y) = float(mean.normal[c]);
      image.plane("object_id").at(x, y) = float(ids);
    }
  return image;
}

Image repaired(const Image& image, const EdgeRepair& repair) {
  return repaired_rows(image, {0, image.height}, repair, kPixelSize, false);
}

/// The pixels whose values belong to none of the surfaces that they show.
struct Wrong {
  int depth = 0, normal = 0, id = 0;
};

/// Depth is wrong if it is off by 2 %: more than the ball bends in a pixel, except at its outline.
Wrong wrong_pixels(const Image& image, bool open) {
  constexpr int kSamples = 8;  // per row and column of a pixel
  Wrong wrong;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float depth = image.plane("depth").at(x, y), id = image.plane("object_id").at(x, y);
      glm::dvec3 normal;
      for (int c = 0; c < 3; ++c) normal[c] = image.plane(kNormals[c]).at(x, y);
      bool depth_found = false, normal_found = false, id_found = false;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const Hit hit = hit_at(x + (k % kSamples + 0.5) / kSamples, y + (k / kSamples + 0.5) / kSamples, open);
        const bool surface = std::isfinite(hit.depth);
        depth_found |= surface ? std::abs(depth / hit.depth - 1.0) <= 0.02 : !std::isfinite(depth);
        normal_found |= glm::length(normal - hit.normal) <= 0.25;
        id_found |= std::abs(id - float(hit.id)) <= 0.01f;
      }
      wrong.depth += !depth_found;
      wrong.normal += !normal_found;
      wrong.id += !id_found;
    }
  return wrong;
}

TEST(Repair, MixedPixelsGetOneOfTheirSurfaces) {
  for (const int samples : {2, 4, 8}) {
    SCOPED_TRACE(samples);
    const Image averaged = rendered({.samples = samples});
    const Wrong before = wrong_pixels(averaged, false), after = wrong_pixels(repaired(averaged, {true, true}), false);
    EXPECT_GT(before.depth, 150);
    EXPECT_GT(before.id, 150);
    // What remains is at corners of the slab and at the outline of the ball, where its plane is a poor prediction.
    EXPECT_LT(after.depth, before.depth / 8);
    EXPECT_LT(after.normal, before.normal / 4);
    EXPECT_LT(after.id, before.id / 4);  // less than 4 % of another object leaves no trace in depth
  }
}

TEST(Repair, MixturesWithABackgroundAreRecognisedByItsValue) {
  for (const double background : {0.0, 65504.0, 1e10}) {
    SCOPED_TRACE(background);
    const Image averaged = rendered({.samples = 4, .background = background, .open = true});
    const Wrong before = wrong_pixels(averaged, true), after = wrong_pixels(repaired(averaged, {true, false}), true);
    EXPECT_GT(before.depth, 150);
    EXPECT_LT(after.depth, before.depth / 6);
  }
}

TEST(Repair, NormalsThatMixBothSidesAreReplaced) {
  const Image cycles = rendered({.samples = 4, .depth = false});
  const Image fixed = repaired(cycles, {false, true});
  const Wrong before = wrong_pixels(cycles, false), after = wrong_pixels(fixed, false);
  EXPECT_GT(before.normal, 50);
  EXPECT_LT(after.normal, before.normal / 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(fixed.plane("depth").at(x, y), cycles.plane("depth").at(x, y));
}

TEST(Repair, IsNeededOnlyWhereMostEdgesAreAveraged) {
  const auto needed = [](const Filled& filled) { return count_edges(rendered(filled), kPixelSize, false).needed(); };
  EXPECT_EQ(needed({.samples = 1}), (EdgeRepair{false, false}));
  EXPECT_TRUE(needed({.samples = 4}).depth);
  EXPECT_TRUE(needed({.samples = 4, .open = true}).depth);
  EXPECT_TRUE(needed({.samples = 4, .background = 0.0, .open = true}).depth);
  EXPECT_EQ(needed({.samples = 4, .depth = false}), (EdgeRepair{false, true}));
  EXPECT_EQ(count_edges(Image(rendered({.samples = 4})), 100.0f * kPixelSize, false).needed(), EdgeRepair());
}

TEST(Repair, SharpPicturesStayAlmostUnchanged) {
  const Image sharp = rendered({});
  const Image after = repaired(sharp, {true, true});
  int changed = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      changed += after.plane("depth").at(x, y) != sharp.plane("depth").at(x, y) ||
                 after.plane("normal.x").at(x, y) != sharp.plane("normal.x").at(x, y);
  EXPECT_LT(changed, kWidth * kHeight / 500);
}

TEST(Repair, NormalsOfThinFoldsStay) {
  // A ridge of two pixels before a wall: what is beside the discontinuity turns from pixel to pixel.
  Image fold = rendered({});
  const float angles[] = {0.9f, 0.3f, -0.5f, -1.1f};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int k = x - 60;
      const bool on_fold = k >= 0 && k < 4;
      fold.plane("depth").at(x, y) = on_fold ? 5.0f : 9.0f;
      fold.plane("normal.x").at(x, y) = on_fold ? std::sin(angles[k]) : 0.0f;
      fold.plane("normal.y").at(x, y) = 0.0f;
      fold.plane("normal.z").at(x, y) = on_fold ? std::cos(angles[k]) : 1.0f;
    }
  const Image after = repaired(fold, {false, true});
  for (int x = 60; x < 64; ++x) EXPECT_EQ(after.plane("normal.x").at(x, 50), fold.plane("normal.x").at(x, 50)) << x;
}

TEST(Repair, TerrainIsNotAveraged) {
  Image terrain(kWidth, kHeight);
  Plane& depth = terrain.add("depth") = Plane(kWidth, kHeight);
  const auto noise = [](int x, int y) {
    auto h = std::uint32_t(x) * 0x9e3779b1u ^ std::uint32_t(y) * 0x85ebca77u;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return float(h ^ (h >> 15)) / 4294967296.0f;
  };
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      depth.at(x, y) = 9.0f;
      for (int size = 1; size <= 32; size *= 2) {  // half as steep at each half of the size
        const float u = float(x) / float(size), v = float(y) / float(size);
        const int i = int(u), j = int(v);
        const float a = std::lerp(noise(i, j), noise(i + 1, j), u - float(i)),
                    b = std::lerp(noise(i, j + 1), noise(i + 1, j + 1), u - float(i));
        depth.at(x, y) += 0.6f * std::pow(float(size), 0.6f) * std::lerp(a, b, v - float(j));
      }
    }
  const EdgeCounts counts = count_edges(terrain, kPixelSize, false);
  EXPECT_GT(counts.rough, 50);
  EXPECT_FALSE(counts.needed().depth) << counts.mixed << ' ' << counts.sharp << ' ' << counts.rough;
}

TEST(Repair, StripsEqualTheWholePicture) {
  Image averaged = rendered({.samples = 4});
  averaged.plane("depth").at(40, 40) = std::numeric_limits<float>::quiet_NaN();
  averaged.plane("depth").at(90, 51) = -3.0f;
  averaged.plane("normal.y").at(70, 30) = kNone;
  const Image whole = repaired(averaged, {true, true});
  for (const int rows : {1, 7, 64}) {
    for (int begin = 0; begin < kHeight; begin += rows) {
      const Rows own{begin, std::min(begin + rows, kHeight)};
      const Rows read{std::max(own.begin - kRepairMargin, 0), std::min(own.end + kRepairMargin, kHeight)};
      Image part(kWidth, read.count());
      for (std::size_t k = 0; k < averaged.names.size(); ++k) {
        Plane& plane = part.add(averaged.names[k]) = Plane(kWidth, read.count());
        for (int y = 0; y < read.count(); ++y)
          std::copy_n(averaged.planes[k].row(read.begin + y), kWidth, plane.row(y));
      }
      const Image strip =
          repaired_rows(part, {own.begin - read.begin, own.end - read.begin}, {true, true}, kPixelSize, false);
      ASSERT_EQ(strip.height, own.count());
      for (std::size_t k = 0; k < whole.names.size(); ++k)
        for (int y = 0; y < own.count(); ++y)
          ASSERT_EQ(std::memcmp(strip.planes[k].row(y), whole.planes[k].row(begin + y), sizeof(float) * kWidth), 0)
              << rows << ' ' << begin + y << ' ' << whole.names[k];
    }
  }
}

}  // namespace
}  // namespace umbrage
