// Shaded files: the reduction of finished pictures, and elevation models against sky-view factors known in closed form.
#include "renderer/shade_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/srgb.h"
#include "devices/cpu/cpu_device.h"
#include "io/image_file.h"
#include "renderer/draw.h"
#include "renderer/reduced_rows.h"
#include "support.h"

namespace umbrage {
namespace {
namespace fs = std::filesystem;

// ---- Reduction

/// Returns random rows of a finished picture.
Image finished(int width, int height) {
  Image image(width, height);
  for (const char* name : {"color.r", "color.g", "color.b", "color.a", "beauty.r", "ao", "depth", "object_id"}) {
    Plane& plane = image.add(name) = Plane(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        plane.at(x, y) = float(test::hash(unsigned(x + 977 * y) + unsigned(image.names.size()) * 7919u) / 4294967295.0);
  }
  return image;
}

/// Reduces an image that arrives in blocks of `rows` rows.
Image reduced(const Image& image, int factor, const Recipe& recipe, int rows) {
  Image whole;
  int next = 0;
  const TakeRows take = reduced_rows(factor, recipe, [&](const PictureInfo& info, const Image& part, int first) {
    if (whole.width == 0) {
      whole = Image(info.width, info.height);
      for (const std::string& name : part.names) whole.add(name) = Plane(info.width, info.height);
    }
    EXPECT_EQ(first, next);
    next += part.height;
    for (std::size_t k = 0; k < part.planes.size(); ++k)
      for (int y = 0; y < part.height; ++y)
        std::copy_n(part.planes[k].row(y), part.width, whole.planes[k].row(first + y));
    return Result<void>();
  });
  const PictureInfo info{.width = image.width, .height = image.height};
  for (int begin = 0; begin < image.height; begin += rows) {
    Image part(image.width, std::min(rows, image.height - begin));
    for (std::size_t k = 0; k < image.planes.size(); ++k) {
      Plane& plane = part.add(image.names[k]) = Plane(part.width, part.height);
      for (int y = 0; y < part.height; ++y) std::copy_n(image.planes[k].row(begin + y), part.width, plane.row(y));
    }
    EXPECT_TRUE(take(info, part, begin));
  }
  EXPECT_EQ(next, whole.height);
  return whole;
}

TEST(ShadeFile, ReductionAveragesLightByAlphaAndLeavesGeometry) {
  const Recipe srgb = *make_shading_recipe({.look = "studio"}), display = *make_shading_recipe({.look = "ao"});
  const Image image = finished(37, 23);
  const int factor = 3;
  for (const Recipe* recipe : {&srgb, &display}) {
    const bool is_srgb = recipe == &srgb;
    const Image small = reduced(image, factor, *recipe, 23);
    ASSERT_EQ(small.width, 12);
    ASSERT_EQ(small.height, 7);
    for (int y = 0; y < small.height; ++y)
      for (int x = 0; x < small.width; ++x) {
        double light = 0.0, alpha = 0.0, beauty = 0.0, ao = 0.0;
        for (int k = 0; k < factor * factor; ++k) {
          const int i = x * factor + k % factor, j = y * factor + k / factor;
          const double a = image.plane("color.a").at(i, j), v = image.plane("color.g").at(i, j);
          light += a * (is_srgb ? (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)) : v);
          alpha += a;
          beauty += image.plane("beauty.r").at(i, j) / 9.0;
          ao += image.plane("ao").at(i, j) / 9.0;
        }
        double expected = light / alpha;
        if (is_srgb) expected = expected <= 0.0031308 ? 12.92 * expected : 1.055 * std::pow(expected, 1 / 2.4) - 0.055;
        ASSERT_NEAR(small.plane("color.g").at(x, y), expected, 1e-5);
        ASSERT_NEAR(small.plane("color.a").at(x, y), alpha / 9.0, 1e-6);
        ASSERT_NEAR(small.plane("beauty.r").at(x, y), beauty, 1e-6);
        ASSERT_NEAR(small.plane("ao").at(x, y), ao, 1e-6);
        ASSERT_EQ(small.plane("depth").at(x, y), image.plane("depth").at(x * factor + 1, y * factor + 1));
        ASSERT_EQ(small.plane("object_id").at(x, y), image.plane("object_id").at(x * factor + 1, y * factor + 1));
      }
  }
}

TEST(ShadeFile, ReductionOfStripsEqualsThatOfTheWhole) {
  const Recipe recipe = *make_shading_recipe({.look = "studio"});
  const Image image = finished(37, 23);
  for (const int factor : {2, 3, 8}) {
    const Image whole = reduced(image, factor, recipe, 23);
    for (const int rows : {1, 4, 10}) {
      const Image strips = reduced(image, factor, recipe, rows);
      ASSERT_EQ(strips.names, whole.names);
      for (std::size_t k = 0; k < whole.planes.size(); ++k)
        for (int y = 0; y < whole.height; ++y)
          for (int x = 0; x < whole.width; ++x) ASSERT_EQ(strips.planes[k].at(x, y), whole.planes[k].at(x, y));
    }
  }
}

// ---- Elevation models

constexpr int kSide = 256;  // cells of one unit
using HeightAt = double (*)(double x, double y);

/// Writes elevations and opens the file. x and y are relative to the middle. Level ground is tilted a little, since a
/// frequent extreme value could mean that there is no data.
Result<GBufferFile> elevation_file(const char* name, const HeightAt& height_at) {
  Image image(kSide, kSide);
  Plane& plane = image.add("depth") = Plane(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      plane.at(x, y) = float(height_at(x + 0.5 - kSide / 2, y + 0.5 - kSide / 2) + 100.0 + 1e-4 * x);
  const fs::path file = fs::path(::testing::TempDir()) / fmt::format("shade_file_{}.exr", name);
  EXPECT_TRUE(write_image(file, image));
  GBufferSettings settings;
  settings.file = file.string();
  settings.depth_kind = "height";
  settings.cell_size = 1.0f;
  return GBufferFile::open(settings, 1e9, ::testing::TempDir());
}

/// Returns the plane `ao` of an elevation model, with many directions and without filters.
Plane sky_view(const GBufferFile& file) {
  Request request;
  request.look = "ao";
  request.occlusion = "bitmask";
  request.occlusion_radius = "100";
  request.settings = {"bitmask.slices=32", "bitmask.steps=96", "denoise.rounds=0"};
  const auto recipe = make_file_recipe(request, file);
  EXPECT_TRUE(recipe) << recipe.error().message;
  const auto device = make_cpu_device({});
  StageTimes times;
  Plane ao;
  const auto status = shade_file(
      *device, file, *recipe, {"ao"},
      [&](const PictureInfo&, const Image& rows, int) {
        ao = rows.planes[0];
        return Result<void>();
      },
      {}, times);
  EXPECT_TRUE(status) << status.error().message;
  return ao;
}

TEST(ShadeFile, OcclusionOfElevationIsTheSkyViewFactor) {
  constexpr int kMiddle = kSide / 2;
  // A trench of infinite length: half the sum of the cosines of the walls' elevations.
  const auto trench = elevation_file("trench", [](double x, double) { return std::abs(x) < 16.0 ? -24.0 : 0.0; });
  ASSERT_TRUE(trench) << trench.error().message;
  EXPECT_EQ(trench->depth_meaning(), DepthMeaning::kHeight);
  const Plane in_trench = sky_view(*trench);
  for (const int x : {-12, -6, 0, 5, 12}) {
    const double left = 16.0 + x + 0.5, right = 16.0 - x - 0.5;
    const double expected = 0.5 * (left / std::hypot(left, 24.0) + right / std::hypot(right, 24.0));
    EXPECT_NEAR(in_trench.at(kMiddle + x, kMiddle), expected, 0.02) << x;
  }
  // A round pit, from its middle: the squared sine of the angle at which the sky begins.
  const auto pit = elevation_file("pit", [](double x, double y) { return std::hypot(x, y) < 20.0 ? -15.0 : 0.0; });
  ASSERT_TRUE(pit);
  const Plane in_pit = sky_view(*pit);
  EXPECT_NEAR(in_pit.at(kMiddle, kMiddle), 400.0 / (400.0 + 225.0), 0.02);
  // A slope hides nothing of the half of the sky that it faces.
  const auto slope = elevation_file("slope", [](double x, double y) { return 0.8 * x + 0.3 * y; });
  ASSERT_TRUE(slope);
  const Plane on_slope = sky_view(*slope);
  for (int y = 40; y < kSide - 40; y += 13)
    for (int x = 40; x < kSide - 40; x += 13) ASSERT_NEAR(on_slope.at(x, y), 1.0, 0.005);
}

TEST(ShadeFile, ElevationIsLitFromTheUpperLeft) {
  // Light from the north-west is the brightest on slopes that face it, and leaves those that face away dark.
  const auto pyramid =
      elevation_file("pyramid", [](double x, double y) { return 0.7 * (64.0 - std::abs(x) - std::abs(y)); });
  ASSERT_TRUE(pyramid);
  Request request;
  request.look = "lit";
  request.occlusion = "none";
  const auto recipe = make_file_recipe(request, *pyramid);
  ASSERT_TRUE(recipe);
  PictureInfo info = pyramid->info();
  ASSERT_TRUE(complete_shading(*recipe, info));
  const float diagonal = std::sqrt(0.5f);
  ASSERT_EQ(info.lights.size(), 1u);
  EXPECT_NEAR(info.lights[0].direction.x, -diagonal * diagonal, 1e-4);
  EXPECT_NEAR(info.lights[0].direction.y, diagonal * diagonal, 1e-4);
  EXPECT_NEAR(info.lights[0].direction.z, diagonal, 1e-4);  // 45 degrees above the horizon
  request.light_direction = {60.0f, 20.0f};
  PictureInfo other = pyramid->info();
  ASSERT_TRUE(complete_shading(*make_file_recipe(request, *pyramid), other));
  EXPECT_GT(other.lights[0].direction.x, 0.7f);
}

TEST(ShadeFile, CompNeedsTheRenderersPicture) {
  const auto flat = elevation_file("flat", [](double, double) { return 0.0; });
  ASSERT_TRUE(flat);
  const auto refused = make_file_recipe({.look = "comp"}, *flat);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("beauty"), std::string::npos);
  EXPECT_EQ(make_file_recipe({}, *flat)->look->name, "studio");
  const auto model = make_recipe({.look = "comp"});
  ASSERT_FALSE(model);
  EXPECT_NE(model.error().message.find("cannot draw a model"), std::string::npos);
}

}  // namespace
}  // namespace umbrage
