// Tests of the guard band. Pixels drawn beyond the border change the picture only through effects that read them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "run_effect.h"
#include "scene/framing.h"
#include "support.h"

namespace umbrage {
namespace {

/// A scene on a device, and cameras that see it.
struct Stage {
  Scene scene;
  std::unique_ptr<Device> device = make_cpu_device();

  Stage() {
    auto made = make_builtin_scene("scene:solids?detail=4000");
    EXPECT_TRUE(made);
    scene = std::move(*made);
    const Camera camera = frame_scene(scene, {}, 100, 100);
    scene.lights = default_lighting(camera, scene.up).lights;
    EXPECT_TRUE(device->prepare(scene));
  }
  Camera camera(int width, int height, bool orthographic = false) const {
    return frame_scene(scene, {.orthographic = orthographic}, width, height);
  }
  Frame capture(const Camera& camera, const CaptureSettings& settings) {
    auto frame = device->capture(camera, settings);
    EXPECT_TRUE(frame);
    return *frame;
  }
  /// Returns `ao` of the unsharp mask.
  Plane unsharp(Frame frame, const std::string& kernel) {
    const Effect& effect = *find_effect("unsharp");
    const auto status = device->run(effect, test::parameters_of(effect, {{"kernel", kernel}}), frame);
    EXPECT_TRUE(status);
    return device->download(frame, {"ao"})->planes[0];
  }
};

double max_window_edge(const Camera& c) {
  return std::max({std::fabs(c.left), std::fabs(c.right), std::fabs(c.bottom), std::fabs(c.top)});
}

void expect_near(const Camera& a, const Camera& b, double error) {
  EXPECT_EQ(a.projection, b.projection);
  EXPECT_EQ(a.view_from_world, b.view_from_world);
  EXPECT_NEAR(a.left, b.left, error);
  EXPECT_NEAR(a.right, b.right, error);
  EXPECT_NEAR(a.bottom, b.bottom, error);
  EXPECT_NEAR(a.top, b.top, error);
}

TEST(GuardBand, WidensThePictureAndItsWindow) {
  PictureInfo inner{.width = 40, .height = 20, .camera = perspective_camera({1, 2, 9}, {0, 0, 0}, {0, 1, 0}, 40, 2)};
  inner.camera.left = -1.0f, inner.camera.right = 3.0f, inner.camera.bottom = -0.5f, inner.camera.top = 1.5f;
  const PictureInfo wide = with_guard(inner, 5);
  EXPECT_EQ(wide.width, 50);
  EXPECT_EQ(wide.height, 30);
  EXPECT_EQ(wide.guard, 5);
  EXPECT_EQ(wide.inner_width(), 40);
  EXPECT_EQ(wide.inner_height(), 20);
  Camera expected = inner.camera;  // one pixel is a tenth of a unit
  expected.left = -1.5f, expected.right = 3.5f, expected.bottom = -1.0f, expected.top = 2.0f;
  expect_near(wide.camera, expected, 1e-6);
  expect_near(with_guard(inner, 0).camera, inner.camera, 0.0);
}

TEST(GuardBand, TheInnerCameraComesBack) {
  for (const bool orthographic : {false, true})
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {191, 347}, {1920, 1080}, {16384, 1}})
      for (const int guard : {0, 1, 7, 200, 16384}) {
        const float aspect = float(width) / float(height);
        Camera camera = orthographic ? orthographic_camera({5, 4, 3}, {0, 0, 0}, {0, 1, 0}, 7.0f, aspect)
                                     : perspective_camera({5, 4, 3}, {0, 0, 0}, {0, 1, 0}, 35.0f, aspect);
        camera.left += 0.3f * (camera.right - camera.left);  // off centre
        const PictureInfo wide = with_guard({.width = width, .height = height, .camera = camera}, guard);
        SCOPED_TRACE(fmt::format("{} x {}, {} more", width, height, guard));
        EXPECT_EQ(wide.inner_width(), width);
        EXPECT_EQ(wide.inner_height(), height);
        constexpr double kRoundings = 8 * 6e-8;  // relative to the window with the guard band
        expect_near(inner_camera(wide), camera, kRoundings * max_window_edge(wide.camera));
      }
}

TEST(GuardBand, IsCutOff) {
  Stage stage;
  const Frame frame = stage.capture(stage.camera(60, 40), {.width = 60, .height = 40, .layers = 2, .guard = 9});
  EXPECT_EQ(frame.info.width, 78);
  EXPECT_EQ(frame.info.height, 58);
  EXPECT_EQ(frame.info.inner_width(), 60);
  const Image image = *stage.device->download_all(frame);
  EXPECT_EQ(image.width, 60);
  EXPECT_EQ(image.height, 40);
  for (const Plane& plane : image.planes) {
    EXPECT_EQ(plane.width, 60);
    EXPECT_EQ(plane.height, 40);
  }
}

TEST(GuardBand, PixelsInsideAreThoseWithoutIt) {
  Stage stage;
  for (const bool orthographic : {false, true})
    for (const int guard : {1, 16, 150}) {
      const Camera camera = stage.camera(121, 83, orthographic);
      const CaptureSettings plain{.width = 121, .height = 83, .layers = 2};
      CaptureSettings guarded = plain;
      guarded.guard = guard;
      const Image a = *stage.device->download_all(stage.capture(camera, plain));
      const Image b = *stage.device->download_all(stage.capture(camera, guarded));
      ASSERT_EQ(a.names, b.names);
      for (std::size_t p = 0; p < a.planes.size(); ++p) {
        const std::string& name = a.names[p];
        const bool depth = name.ends_with("depth"), normal = name.find("normal") != std::string::npos;
        // Objects stand on the table, where rounding decides which of the two coincident surfaces is the second one.
        if (name.starts_with("layer1.") && !depth && !normal) continue;
        // Rounding of a ray changes a normal that is interpolated over a small triangle more than the position of the
        // hit.
        const float bound = depth ? 1e-6f : normal ? 1e-4f : 0.0f;
        long differing = 0;
        for (int y = 0; y < a.height; ++y)
          for (int x = 0; x < a.width; ++x) {
            const float u = a.planes[p].at(x, y), v = b.planes[p].at(x, y);
            differing += !(u == v || std::fabs(u - v) <= bound * std::max(std::fabs(u), 1.0f));
          }
        // Rounding of the window affects each ray, and decides which surface a ray hits at a silhouette.
        EXPECT_LE(differing, a.width * a.height / 500) << name << ", guard " << guard;
      }
    }
}

TEST(GuardBand, FractionsOfThePictureKeepTheirSize) {
  Stage stage;
  const Camera camera = stage.camera(100, 100);
  const Frame frame = stage.capture(camera, {.width = 100, .height = 100, .guard = 25});
  const Plane fraction = stage.unsharp(frame, "12%"), pixels = stage.unsharp(frame, "12"),
              larger = stage.unsharp(frame, "18");
  EXPECT_EQ(test::difference(fraction, pixels, 0.0).max, 0.0);
  EXPECT_GT(test::difference(fraction, larger, 1e-3).fraction_over, 0.01);
}

TEST(GuardBand, BordersAreAsTheMiddleOfALargerPicture) {
  Stage stage;
  constexpr int kWidth = 70, kHeight = 50, kGuard = 12, kKernel = 2 * kGuard - 1;
  // The camera is so close that the scene extends beyond the picture's borders.
  Camera camera = frame_scene(stage.scene, {.zoom = 3.0f}, kWidth, kHeight);
  const PictureInfo wide = with_guard({.width = kWidth, .height = kHeight, .camera = camera}, kGuard);
  const std::string kernel = std::to_string(kKernel);
  const Plane guarded =
      stage.unsharp(stage.capture(camera, {.width = kWidth, .height = kHeight, .guard = kGuard}), kernel);
  const Plane larger =
      cropped(stage.unsharp(stage.capture(wide.camera, {.width = wide.width, .height = wide.height}), kernel), kGuard);
  EXPECT_EQ(test::difference(guarded, larger, 0.0).max, 0.0);
  // Without the guard band the window ends at the border.
  const Plane bare = stage.unsharp(stage.capture(camera, {.width = kWidth, .height = kHeight}), kernel);
  double at_border = 0.0, inside = 0.0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int to_border = std::min({x, y, kWidth - 1 - x, kHeight - 1 - y});
      double& max = to_border < kGuard ? at_border : inside;
      if (to_border == 0 || to_border >= kGuard)
        max = std::max(max, std::fabs(double(bare.at(x, y)) - larger.at(x, y)));
    }
  EXPECT_GT(at_border, 0.02);
  EXPECT_LT(inside, 0.02);
}

TEST(GuardBand, UploadedPlanesHaveOneToo) {
  const auto device = make_cpu_device();
  GBuffer g = test::bumpy_gbuffer(37, 23, 3);
  g.info.guard = 4;
  auto frame = device->upload(g);
  ASSERT_TRUE(frame);
  Image ao(37, 23);
  ao.add("ao") = Plane(37, 23, 0.25f);
  ao.plane("ao").at(4, 4) = 0.75f;
  ASSERT_TRUE(device->add(ao, *frame));
  const Image image = *device->download(*frame, {"depth", "ao"});
  EXPECT_EQ(image.width, 29);
  EXPECT_EQ(image.height, 15);
  EXPECT_EQ(test::difference(image.planes[0], cropped(g.layers[0].plane("depth"), 4), 0.0).max, 0.0);
  EXPECT_EQ(image.plane("ao").at(0, 0), 0.75f);
  EXPECT_EQ(image.plane("ao").at(28, 14), 0.25f);
}

TEST(GuardBand, NeutralPlanesAreCutOffToo) {
  Stage stage;
  Frame frame = stage.capture(stage.camera(20, 10), {.width = 20, .height = 10, .guard = 3});
  const Effect& composite = *find_effect("composite");
  ASSERT_TRUE(stage.device->run(composite, test::parameters_of(composite, {}), frame));
  const Image image = *stage.device->download(frame, {"indirect.g", "ao", "lit.r"});
  for (const Plane& plane : image.planes) EXPECT_EQ(plane.width, 20);
  EXPECT_EQ(image.plane("indirect.g").at(19, 9), 0.0f);
  EXPECT_EQ(image.plane("ao").at(19, 9), 1.0f);
  // A plane that is added later replaces the neutral plane.
  Image made(26, 16);
  made.add("ao") = Plane(26, 16, 0.5f);
  ASSERT_TRUE(stage.device->add(made, frame));
  const Image all = *stage.device->download_all(frame);
  EXPECT_EQ(std::count(all.names.begin(), all.names.end(), "ao"), 1);
  EXPECT_EQ(all.plane("ao").at(0, 0), 0.5f);
}

TEST(GuardBand, ThreadsDoNotMatter) {
  Stage stage;
  const Camera camera = stage.camera(61, 47);
  const CaptureSettings settings{.width = 61, .height = 47, .layers = 2, .guard = 10};
  const Image all = *stage.device->download_all(stage.capture(camera, settings));
  stage.device = make_cpu_device({.threads = 1});
  ASSERT_TRUE(stage.device->prepare(stage.scene));
  const Image one = *stage.device->download_all(stage.capture(camera, settings));
  for (std::size_t p = 0; p < all.planes.size(); ++p)
    EXPECT_EQ(test::difference(all.planes[p], one.planes[p], 0.0).max, 0.0) << all.names[p];
}

}  // namespace
}  // namespace umbrage
