// Blended surfaces: the planes of their weights, the blended picture, and lines of and behind them.
#include "renderer/blend.h"

#include <gtest/gtest.h>

#include "core/color.h"
#include "devices/shared/capture_support.h"
#include "draw_picture.h"
#include "renderer/strips.h"

namespace umbrage {
namespace {

using test::square;

constexpr glm::vec3 kRed{0.8f, 0.1f, 0.1f};

/// Returns a white wall at z = 0, with smaller panes in front of it, one for each material.
Scene wall_behind(const std::vector<Material>& panes) {
  std::vector<Mesh> meshes{square(2.0f)};
  std::vector<Material> materials{{.albedo = glm::vec3(0.8f)}};
  for (std::size_t k = 0; k < panes.size(); ++k) {
    meshes.push_back(square(1.0f, 0.5f + 0.5f * float(k)));
    materials.push_back(panes[k]);
  }
  return test::scene_of(std::move(meshes), std::move(materials));
}

Material pane(float opacity, glm::vec3 albedo = kRed, glm::vec3 tint = glm::vec3(1.0f)) {
  return {.albedo = albedo, .blended = true, .opacity = opacity, .tint = tint};
}

Image captured_from_front(const Scene& scene, bool blended) {
  const auto device = make_cpu_device();
  const Camera camera = orthographic_camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 4.0f, 1.0f);
  CaptureSettings settings{.width = 32, .height = 32, .blended = blended};
  settings.lighting.emplace().lights = {test::key_light({0, 0, 1})};
  return test::captured(*device, scene, camera, settings);
}

TEST(Blend, WeightsAreProductsAlongTheRay) {
  const glm::vec3 blue(0.1f, 0.1f, 0.9f), tint(0.5f, 1.0f, 0.25f);
  const Scene scene = wall_behind({pane(0.25f, kRed, tint), pane(0.5f, blue)});
  const Image front = captured_from_front(scene, true), behind = captured_from_front(scene, false);
  EXPECT_FLOAT_EQ(front.plane("opacity").at(16, 16), 1.0f - 0.75f * 0.5f);
  const char* names[3][2] = {
      {"transmittance.r", "albedo.r"}, {"transmittance.g", "albedo.g"}, {"transmittance.b", "albedo.b"}};
  for (int c = 0; c < 3; ++c) {
    EXPECT_FLOAT_EQ(front.plane(names[c][0]).at(16, 16), 0.75f * 0.5f * tint[c]);
    // The nearer pane covers one half, the other a quarter of the rest.
    EXPECT_NEAR(front.plane(names[c][1]).at(16, 16), (0.5f * blue[c] + 0.125f * kRed[c]) / 0.625f, 1e-6f);
    EXPECT_FLOAT_EQ(behind.plane(names[c][1]).at(16, 16), 0.8f);
  }
  EXPECT_FLOAT_EQ(front.plane("opacity").at(2, 2), 0.0f) << "beside the panes";
  EXPECT_FLOAT_EQ(front.plane("transmittance.g").at(2, 2), 1.0f);
  EXPECT_EQ(behind.find("opacity"), nullptr);
  EXPECT_LT(front.plane("depth").at(16, 16), behind.plane("depth").at(16, 16) - 0.9f);
  EXPECT_FLOAT_EQ(behind.plane("shadow").at(16, 16), 0.0f) << "a pane of half opacity casts a shadow";
}

TEST(Blend, OpaqueAndClearSurfacesAreNotBlended) {
  EXPECT_FALSE(has_blended(wall_behind({pane(1.0f)})));
  EXPECT_TRUE(has_blended(wall_behind({pane(0.9f)})));
  EXPECT_FALSE(has_blended(wall_behind({{.opacity = 0.5f}})));
  // Nearly opaque texels of a blended texture are opaque.
  Scene scene = wall_behind({pane(1.0f)});
  scene.materials[1].texture = 0;
  scene.textures.push_back({.width = 4, .height = 1, .rgba = std::vector<std::uint8_t>(16, 255)});
  EXPECT_FALSE(has_blended(scene));
  scene.textures[0].rgba[11] = scene.textures[0].rgba[15] = 0;
  EXPECT_TRUE(has_blended(scene));
  const Image behind = captured_from_front(scene, false);
  EXPECT_NE(behind.plane("depth").at(12, 16), behind.plane("depth").at(20, 16));
}

TEST(Blend, GlassReflectsMoreAtGrazingAngles) {
  Material glass = pane(0.1f);
  glass.glass = true;
  const Image front = captured_from_front(wall_behind({glass}), true);
  EXPECT_NEAR(front.plane("opacity").at(16, 16), 0.1f + 0.9f * kGlassReflectance, 1e-6f);
  Scene tilted = wall_behind({});
  tilted.materials.push_back(glass);
  tilted.meshes.push_back(test::parallelogram({-1, -0.1f, 0.5f}, {2, 0, 0}, {0, 0.2f, 2}));
  tilted.meshes.back().material = 1;
  finish_scene(tilted);
  EXPECT_GT(captured_from_front(tilted, true).plane("opacity").at(16, 16), 0.5f);
}

/// Returns the request of a square picture of the wall from in front.
Request front_request(const char* look, int size) {
  Request request;
  request.look = look;
  request.width = request.height = size;
  request.ground = "off";
  request.camera.position = {0, 0, 6};
  request.camera.focal_point = {0, 0, 0};
  return request;
}

/// Draws a red surface in front of a wall, with the look `lit`. Returns the linear colour of the middle pixel.
glm::vec3 middle_of(const Scene& scene) {
  const auto picture = test::drawn_picture(scene, front_request("lit", 64), {"color.r", "color.g", "color.b"});
  glm::vec3 color;
  for (int c = 0; c < 3; ++c) color[c] = linear_from_srgb(picture.image.planes[std::size_t(c)].at(32, 32));
  return color;
}

TEST(Blend, PictureIsWeightedSum) {
  const glm::vec3 opaque = middle_of(wall_behind({{.albedo = kRed}})), nothing = middle_of(wall_behind({}));
  const glm::vec3 blended = middle_of(wall_behind({pane(0.4f)}));
  const glm::vec3 tinted = middle_of(wall_behind({pane(0.4f, kRed, {0.5f, 0.5f, 1.0f})}));
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(blended[c], 0.4f * opaque[c] + 0.6f * nothing[c], 0.02f) << c;
    EXPECT_NEAR(tinted[c], 0.4f * opaque[c] + 0.6f * nothing[c] * (c == 2 ? 1.0f : 0.5f), 0.02f) << c;
  }
  EXPECT_GT(nothing.y, opaque.y + 0.1f) << "the test distinguishes the two pictures";
}

TEST(Blend, LinesOfPaneAndOfWhatIsBehind) {
  Scene scene = test::scene_of({square(3.0f, -3.0f), square(0.3f), square(1.0f, 0.5f)},
                               {{.albedo = glm::vec3(0.8f)}, {.albedo = kRed}, pane(0.3f, {0.2f, 0.4f, 0.8f})});
  const auto picture = test::drawn_picture(scene, front_request("cartoon", 128), {"outline", "depth"});
  const Plane& lines = picture.image.plane("outline");
  int crossed = 0;  // by the row through the middle: two sides of the square behind and two of the pane
  for (int x = 1; x < 128; ++x) crossed += (lines.at(x, 64) > 0.05f) != (lines.at(x - 1, 64) > 0.05f);
  EXPECT_EQ(crossed, 8);
}

TEST(Blend, NoSeamWhereOpacityBecomesFull) {
  // The opacity falls from 1 to 0 across the pane.
  Scene scene = wall_behind({pane(1.0f)});
  scene.materials[1].texture = 0;
  Texture& ramp =
      scene.textures.emplace_back(Texture{.width = 64, .height = 1, .rgba = std::vector<std::uint8_t>(256, 255)});
  for (std::size_t x = 0; x < 64; ++x)
    ramp.rgba[4 * x + 3] = std::uint8_t(x < 2 ? 255 : x > 61 ? 0 : 255 - (x - 2) * 255 / 60);
  for (const char* look : {"lit", "cartoon"}) {
    Request request = front_request(look, 128);
    request.anti_aliasing = 1;
    const auto picture = test::drawn_picture(scene, request, {"color.g"});
    const Plane& green = picture.image.plane("color.g");
    for (int x = 23; x < 105; ++x) {
      if (x > 34 && x < 92) continue;  // the wall has the shadow of the half with an opacity above 0.5
      const float bend = green.at(x - 1, 64) - 2.0f * green.at(x, 64) + green.at(x + 1, 64);
      EXPECT_LT(std::fabs(bend), look == std::string("lit") ? 0.02f : 0.15f) << look << " at " << x;
    }
  }
}

TEST(Blend, LinesOfOneSampleAreDrawnOverTheMean) {
  const Scene scene = wall_behind({pane(0.5f)});
  Request request;
  request.look = "cartoon";
  request.width = request.height = 32;
  request.anti_aliasing = 1;
  const auto plan = make_plan(*make_recipe(request), scene, 1);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->has_blended);
  EXPECT_FALSE(plan->lines.empty());
}

TEST(Blend, StripsAreTheSame) {
  const Scene scene = wall_behind({pane(0.25f), pane(0.5f, {0.1f, 0.1f, 0.9f})});
  for (const char* look : {"studio", "cartoon"}) {
    Request request;
    request.look = look;
    request.width = 70;
    request.height = 150;
    request.ground = "off";
    const std::vector<std::string> planes = {"color.r", "color.g", "color.b", "color.a", "depth"};
    const auto whole = test::drawn_picture(scene, request, planes);
    const auto device = make_cpu_device();
    ASSERT_TRUE(device->prepare(scene));
    const auto plan = make_plan(*make_recipe(request), scene, device->threads());
    ASSERT_TRUE(plan);
    EXPECT_TRUE(plan->has_blended);
    StageTimes times;
    const auto take = [&](const PictureInfo&, const Image& part, int first) -> Result<void> {
      for (const std::string& name : planes)
        for (int y = 0; y < part.height; ++y)
          for (int x = 0; x < part.width; ++x) {
            const float expected = whole.image.plane(name).at(x, first + y), value = part.plane(name).at(x, y);
            if (expected != value) return file_error("{} differs at {}, {}", name, x, first + y);
          }
      return {};
    };
    const auto status = draw_strips(*device, *plan, 64, planes, false, take, times);
    EXPECT_TRUE(status) << look << ": " << (status ? "" : status.error().message);
  }
}

/// A device that cannot draw strips, and so captures all pixels of blended surfaces.
class WithoutStrips final : public Device {
 public:
  explicit WithoutStrips(Device& device) : Device({.name = "cpu", .threads = device.threads()}), device_(device) {}
  Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor) override {
    return device_.prepare(scene, monitor);
  }
  Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                        const ProgressMonitor& monitor) override {
    EXPECT_FALSE(settings.strip);
    return device_.capture(camera, settings, monitor);
  }
  Result<Frame> upload(GBuffer gbuffer, const Strip*) override { return device_.upload(std::move(gbuffer)); }
  Frame branch(const Frame& frame) override { return device_.branch(frame); }
  Result<void> add(Image planes, Frame& frame) override { return device_.add(std::move(planes), frame); }
  Result<void> add_planes_of(const Frame& from, const std::vector<std::string>& names, Frame& frame) override {
    return device_.add_planes_of(from, names, frame);
  }
  Result<RunState> run(const Effect& effect, const ParameterBytes& params, Frame& frame, const EffectRun& settings,
                       const ProgressMonitor& monitor) override {
    return device_.run(effect, params, frame, settings, monitor);
  }
  Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) override {
    return device_.reduced(frame, factor, names);
  }
  std::vector<std::string> plane_names(const Frame& frame) const override { return device_.plane_names(frame); }

 private:
  Result<Image> read(const Frame& frame, const std::vector<std::string>& names, bool) override {
    return device_.download(frame, names);
  }

  Device& device_;
};

/// Expects that a picture, whose further samples are drawn in strips, equals one that is drawn in strips as a whole,
/// and one of a device that cannot draw strips.
void expect_same_in_strips(const Scene& scene, const Request& request) {
  SCOPED_TRACE(fmt::format("{} x {}, guard band {}", request.width, request.height, request.guard_band));
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto plan = make_plan(*make_recipe(request), scene, device->threads());
  ASSERT_TRUE(plan->marked && plan->has_blended);
  StageTimes times;
  const auto drawn = draw(*device, scene, *plan, times);
  ASSERT_TRUE(drawn) << drawn.error().message;
  const std::vector<std::string> names = {"color.r", "color.g", "color.a"};
  const Image whole = *device->download(drawn->frame, names);
  int rows = 0;
  const auto compare = [&](const PictureInfo&, const Image& part, int first) -> Result<void> {
    rows += part.height;
    for (const std::string& name : names)
      for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < request.width; ++x)
          if (part.plane(name).at(x, y) != whole.plane(name).at(x, first + y))
            return file_error("{} differs at {}, {}", name, x, first + y);
    return {};
  };
  const auto status = draw_strips(*device, *plan, 64, names, false, compare, times);
  EXPECT_TRUE(status) << (status ? "" : status.error().message);
  EXPECT_EQ(rows, request.height);
  WithoutStrips without(*device);
  const auto other = draw(without, scene, *plan, times);
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_TRUE(compare({}, *device->download(other->frame, names), 0)) << "without strips";
}

// Few rows are drawn at once, and blended surfaces show in some of them.
TEST(Blend, LowPictures) {
  const Scene scene = wall_behind({pane(0.4f)});
  for (const auto& [width, height] : {std::pair{40, 30}, {61, 41}, {64, 64}, {90, 65}, {33, 131}}) {
    Request request = front_request("studio", width);
    request.height = height;
    expect_same_in_strips(scene, request);
  }
}

// Further samples are drawn in strips, of which some have rows of the guard band alone.
TEST(Blend, GuardBandsOfAllSizes) {
  const Scene scene = wall_behind({pane(0.4f)});
  for (const float guard : {6.6f, 15.0f, 40.0f}) {
    Request request = front_request("studio", 96);
    request.height = 480;
    request.guard_band = guard;
    expect_same_in_strips(scene, request);
  }
}

}  // namespace
}  // namespace umbrage
