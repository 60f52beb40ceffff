// Shaded files: the reduction of finished pictures, elevation models against sky-view factors known in closed form, and
// strips, which must be bitwise equal to whole pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/color.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "renderer/models.h"
#include "renderer/shade_file.h"
#include "renderer/strips.h"
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

namespace {
namespace fs = std::filesystem;

constexpr double kMuch = 6e9, kLittle = 1e6;  // bytes of memory
const std::vector<std::string> kPlanes = {"color.r", "color.g", "color.b", "color.a", "ao", "depth", "normal.x"};

/// Draws a room and writes these planes of it. Returns the file.
fs::path file_of(const char* name, int width, int height, const std::vector<std::string>& planes) {
  const fs::path file = fs::path(::testing::TempDir()) / fmt::format("shade_strips_{}_{}x{}.exr", name, width, height);
  Scene scene = *load_scene("scene:room?detail=3000");
  Request request;
  request.look = "lit";
  request.width = width;
  request.height = height;
  request.quality = "draft";
  const auto device = make_cpu_device({});
  const auto recipe = make_recipe(request);
  EXPECT_TRUE(recipe);
  EXPECT_TRUE(complete_scene(scene, *recipe));
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  const auto frame = draw(*device, scene, *recipe, times);
  EXPECT_TRUE(frame);
  const auto image = device->download(*frame, planes);
  EXPECT_TRUE(image);
  EXPECT_TRUE(write_image(file, *image));
  return file;
}

const std::vector<std::string> kDepth = {"depth"};
const std::vector<std::string> kAll = {"depth",    "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g",
                                       "albedo.b", "color.r",  "color.g",  "color.b",  "object_id"};

GBufferFile opened(const fs::path& path, double memory) {
  GBufferSettings settings;
  settings.file = path.string();
  settings.fov_deg = 40.0f;
  auto file = GBufferFile::open(settings, memory, ::testing::TempDir());
  EXPECT_TRUE(file) << file.error().message;
  return std::move(*file);
}

/// Collects rows to a whole picture.
struct Collected {
  Image image;
  int next = 0;

  TakeRows take() {
    return [this](const PictureInfo& info, const Image& rows, int first) -> Result<void> {
      EXPECT_EQ(first, next);
      if (first == 0) {
        image = Image(rows.width, info.height);
        for (const std::string& name : rows.names) image.add(name) = Plane(rows.width, info.height, -1.0f);
      }
      next = first + rows.height;
      for (std::size_t p = 0; p < rows.planes.size(); ++p)
        for (int y = 0; y < rows.height; ++y)
          std::copy_n(rows.planes[p].row(y), rows.width, image.planes[p].row(first + y));
      return {};
    };
  }
};

void expect_same(const Image& a, const Image& b) { EXPECT_EQ(test::first_difference(a, b), ""); }

/// Shades in strips of `rows` rows; 0: as shade_file plans.
Image shaded(const GBufferFile& file, const Request& request, int rows, const std::optional<SequenceStart>& start = {},
             SequenceStart* used = nullptr) {
  const auto device = make_cpu_device({});
  const auto recipe = make_file_recipe(request, file);
  EXPECT_TRUE(recipe) << recipe.error().message;
  Collected picture;
  StageTimes times;
  const auto shaded_start = rows > 0 ? shade_strips(*device, file, *recipe, rows, kPlanes, picture.take(), start, times)
                                     : shade_file(*device, file, *recipe, kPlanes, picture.take(), start, times);
  EXPECT_TRUE(shaded_start) << shaded_start.error().message;
  EXPECT_EQ(picture.next, file.info().height);
  if (used) *used = *shaded_start;
  return std::move(picture.image);
}

TEST(ShadeStrips, EqualWholePicturesOfEveryLook) {
  const fs::path all = file_of("all", 133, 150, kAll), depth = file_of("depth", 133, 150, kDepth);
  for (const fs::path& path : {all, depth}) {
    const GBufferFile file = opened(path, kMuch);
    for (const Look* look : looks()) {
      if (look->needs_beauty && path == depth) continue;
      SCOPED_TRACE(fmt::format("{} {}", path.filename().string(), look->name));
      Request request;
      request.look = look->name;
      const Image whole = shaded(file, request, 0);
      for (const int rows : {32, 64}) expect_same(whole, shaded(file, request, rows));
    }
  }
}

TEST(ShadeStrips, EqualWholePicturesOfReducedOcclusionAndEffects) {
  const GBufferFile file = opened(file_of("depth", 133, 150, kDepth), kMuch);
  Request half;
  half.look = "bleeding";
  half.occlusion_scale = "half";
  Request radius;
  radius.look = "studio";
  radius.occlusion_radius = "20%";
  Request effects;
  effects.effects = {"hbao", "denoise", "composite", "output"};
  for (const Request& request : {half, radius, effects})
    expect_same(shaded(file, request, 0), shaded(file, request, 16));
}

// With little memory the picture is planned in strips, and its pixels are read from a scratch file.
TEST(ShadeStrips, ArePlannedWhereMemoryIsShort) {
  const fs::path path = file_of("high", 61, 1300, kDepth);
  const GBufferFile much = opened(path, kMuch), little = opened(path, kLittle);
  const auto device = make_cpu_device({});
  for (const char* look : {"ao", "studio", "cartoon"}) {
    SCOPED_TRACE(look);
    Request request;
    request.look = look;
    const auto whole = plan_file_strips(*device, much, *make_file_recipe(request, much));
    const auto strips = plan_file_strips(*device, little, *make_file_recipe(request, little));
    EXPECT_EQ(whole->rows, 0);
    EXPECT_GT(strips->rows, 0);
    EXPECT_TRUE(strips->exceeds);
    expect_same(shaded(much, request, 0), shaded(little, request, 0));
  }
}

// The exposure of the first frame is metered over all strips; later frames use it.
TEST(ShadeStrips, MeterAndStartAsWholePictures) {
  const GBufferFile file = opened(file_of("all", 133, 150, kAll), kMuch);
  Request request;
  request.look = "studio";
  SequenceStart strips;
  shaded(file, request, 32, {}, &strips);
  ASSERT_TRUE(strips.stops);
  EXPECT_NE(*strips.stops, 0.0f);
  EXPECT_EQ(strips.scene_radius, file.info().scene_radius);
  const SequenceStart other{0.5f * strips.scene_radius, *strips.stops + 1.0f, 0.5f, 50.0f};
  SequenceStart used;
  const Image brighter = shaded(file, request, 32, other, &used), usual = shaded(file, request, 32);
  EXPECT_EQ(used.scene_radius, other.scene_radius);
  EXPECT_EQ(used.depth_min, other.depth_min);
  EXPECT_EQ(used.depth_max, other.depth_max);
  double sum = 0.0;
  for (int y = 0; y < usual.height; ++y)
    for (int x = 0; x < usual.width; ++x) sum += brighter.planes[0].at(x, y) - usual.planes[0].at(x, y);
  EXPECT_GT(sum / (usual.width * usual.height), 0.05);
}

TEST(ShadeStrips, EndWhenTheMonitorOrTheReceiverEndsThem) {
  const GBufferFile file = opened(file_of("depth", 133, 150, kDepth), kMuch);
  const auto device = make_cpu_device({});
  const auto recipe = make_file_recipe({.look = "ao"}, file);
  StageTimes times;
  Collected picture;
  double last = 0.0;
  const auto whole = shade_strips(*device, file, *recipe, 32, kPlanes, picture.take(), {}, times, [&](double done) {
    EXPECT_GE(done, last);
    last = done;
    return true;
  });
  EXPECT_TRUE(whole);
  EXPECT_EQ(last, 1.0);
  const auto ended = shade_strips(*device, file, *recipe, 32, kPlanes, Collected().take(), {}, times,
                                  [](double done) { return done < 0.3; });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kInterrupted);
  const auto refused = shade_strips(
      *device, file, *recipe, 32, kPlanes,
      [](const PictureInfo&, const Image&, int) { return Result<void>(file_error("full")); }, {}, times);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "full");
}

}  // namespace

}  // namespace umbrage
