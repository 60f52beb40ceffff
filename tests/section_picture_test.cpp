// Pictures of cut models: both devices, hatching, and the view that does not move.
#include <gtest/gtest.h>

#include <cmath>

#include "draw_picture.h"
#include "renderer/completed_scene.h"
#include "renderer/models.h"
#include "scene/finish.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr const char* kPlanes[] = {"color.r", "color.g", "color.b", "depth", "normal.z"};

Request request_of(const char* look, const std::vector<std::string>& sections) {
  Request request;
  request.width = request.height = 160;
  request.look = look;
  request.sections = sections;
  return request;
}

Image picture(Device& device, const Request& request) {
  auto scene = load_scene("scene:solids");
  EXPECT_TRUE(complete_scene(*scene, *make_recipe(request)));
  EXPECT_TRUE(device.prepare(*scene));
  StageTimes times;
  const auto frame = draw(device, *scene, request, times);
  EXPECT_TRUE(frame) << frame.error().message;
  return *device.download(*frame, std::vector<std::string>(std::begin(kPlanes), std::end(kPlanes)));
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += test::difference(a.planes[c], b.planes[c], 0.1).mean / 3.0;
  return sum;
}

TEST(SectionPicture, BothDevicesSeeTheCutModel) {
  Device* const gpu = test::vulkan_device();
  if (!gpu) GTEST_SKIP() << "no Vulkan device";
  const auto cpu = make_cpu_device();
  for (const char* look : {"studio", "lit", "cartoon", "technical"}) {
    const Request cut = request_of(look, {"x=50%", "0.2,1,0.1,1"});
    const Image a = picture(*cpu, cut), b = picture(*gpu, cut);
    EXPECT_LT(mean_difference(a, b), 0.004) << look;
    EXPECT_GT(mean_difference(a, picture(*cpu, request_of(look, {}))), 0.02) << look << ": the cut shows";
  }
}

TEST(SectionPicture, LooksWithLinesDrawHatching) {
  // Of a box that is cut parallel to the picture, the cap's lines and nothing else are inside of its outline.
  Request request = request_of("technical", {"z<0"});
  request.camera.direction = {0.0f, 0.0f, -1.0f};
  request.camera.orthographic = true;
  request.anti_aliasing = 1;
  request.width = request.height = 480;
  request.settings = {"outline.width=2"};
  const auto dark = [&](const Request& r) {
    Scene scene;
    scene.materials.emplace_back();
    Mesh box;
    box.positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                     {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    box.indices = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                   1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
    scene.meshes = {box};
    finish_scene(scene);
    const auto drawn = test::drawn_picture(std::move(scene), r, {"color.g"});
    int count = 0;  // in the middle row, far from the outline
    bool was_dark = false;
    for (int x = 180; x < 300; ++x) {
      const bool is_dark = drawn.image.planes[0].at(x, 240) < 0.25f;
      count += is_dark && !was_dark;
      was_dark = is_dark;
    }
    return count;
  };
  const int lines = dark(request);
  EXPECT_GE(lines, 5);
  EXPECT_LE(lines, 16);
  request.sections.clear();
  EXPECT_EQ(dark(request), 0);
}

TEST(SectionPicture, KeepsTheScaleOfTheWholeModel) {
  // What the cut does not touch stays where it is in the picture.
  const auto cpu = make_cpu_device();
  const Image whole = picture(*cpu, request_of("lit", {})), cut = picture(*cpu, request_of("lit", {"y<90%"}));
  int same = 0, surfaces = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x) {
      const float a = whole.planes[3].at(x, y), b = cut.planes[3].at(x, y);
      if (!std::isfinite(a) || !std::isfinite(b)) continue;
      ++surfaces;
      same += std::abs(a - b) < 1e-3f * a;
    }
  EXPECT_GT(surfaces, 5000);
  EXPECT_GT(double(same), 0.7 * surfaces);
}

TEST(SectionPicture, ACompletedSceneServesForItsPlanesAlone) {
  auto scene = load_scene("scene:solids");
  const auto recipe = [](const char* plane, const char* look) { return *make_recipe(request_of(look, {plane})); };
  auto completed_scene = completed(*scene, recipe("x=50%", "studio"), 1);
  ASSERT_TRUE(completed_scene);
  EXPECT_TRUE(*completed_scene->serves(recipe("x=50%", "studio"), 1));
  EXPECT_FALSE(*completed_scene->serves(recipe("x=51%", "studio"), 1));
  EXPECT_FALSE(*completed_scene->serves(recipe("x=50%", "cartoon"), 1)) << "hatched";
  EXPECT_FALSE(*completed_scene->serves(*make_recipe(request_of("studio", {})), 1));
}

}  // namespace
}  // namespace umbrage
