// Files shaded in strips: bitwise identical to those shaded whole, for all looks.
#include "renderer/shade_strips.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "io/image_file.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage {
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
  complete_scene(scene, *recipe);
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

void expect_same(const Image& a, const Image& b) {
  ASSERT_EQ(a.names, b.names);
  ASSERT_EQ(a.height, b.height);
  for (std::size_t p = 0; p < a.planes.size(); ++p) {
    int differing = 0;
    for (int y = 0; y < a.height; ++y)
      differing += std::memcmp(a.planes[p].row(y), b.planes[p].row(y), std::size_t(a.width) * sizeof(float)) != 0;
    EXPECT_EQ(differing, 0) << "rows of " << a.names[p] << " differ";
  }
}

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
