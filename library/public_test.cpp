// Tests of the public C++ interface; they use only its header.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include "umbrage/umbrage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

namespace {

const std::string kSolids = "scene:solids?detail=3000";

/// Returns the values of a pass. Fails if the picture has no pass of that name and number of channels.
const std::vector<float>& pass(const umb::Picture& picture, const std::string& name, int channels) {
  static const std::vector<float> none;
  for (const auto& each : picture.passes)
    if (each.name == name) {
      EXPECT_EQ(each.channels, channels) << name;
      EXPECT_EQ(each.values.size(), std::size_t(picture.width) * std::size_t(picture.height) * std::size_t(channels));
      return each.values;
    }
  ADD_FAILURE() << "no pass " << name;
  return none;
}

TEST(Public, DrawsAPicture) {
  umb::Picture picture;
  const umb::Outcome outcome =
      umb::render({.model = "scene:solids?detail=7000", .look = "unsharp", .width = 48, .height = 32}, picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 32);
  ASSERT_EQ(picture.rgba.size(), 48u * 32u * 4u);
  float min = 1.0f, max = 0.0f;
  for (const float v : picture.rgba) min = std::min(min, v), max = std::max(max, v);
  EXPECT_LT(min, 0.5f);
  EXPECT_GT(max, 0.9f);
}

TEST(Public, ReportsErrorsAndLeavesThePictureUnchanged) {
  umb::Picture picture{1, 1, {0.25f, 0.5f, 0.75f, 1.0f}, {}};
  const auto refused = [&](const umb::RenderRequest& request, int code, const std::string& text) {
    const umb::Outcome outcome = umb::render(request, picture);
    EXPECT_EQ(outcome.code, code) << text;
    EXPECT_NE(outcome.message.find(text), std::string::npos) << outcome.message;
    EXPECT_EQ(picture.rgba[1], 0.5f);
  };
  refused({.model = "missing.obj"}, 3, "missing.obj");
  refused({.model = "scene:solid"}, 2, "solids");
  refused({.model = ""}, 2, "empty");
  refused({.model = kSolids, .look = "aoo"}, 2, "aoo");
  refused({.model = kSolids, .occlusion = "bitmusk"}, 2, "bitmask");
  refused({.model = kSolids, .settings = {"unsharp.kernel=-1"}}, 2, "unsharp.kernel");
  refused({.model = kSolids, .width = 0}, 2, "`width`");
  refused({.model = kSolids, .width = 16384, .height = 16384}, 2, "16384 x 16384");
  refused({.model = kSolids, .width = 16384, .height = 16384}, 2,
          "at most 67108864 in total; umbrage render draws up to 536870912, in strips");
  refused({.model = kSolids, .width = 8192, .height = 8192, .layers = 2}, 2, "; umbrage render draws up to 536870912");
  refused({.model = kSolids, .device = "gpu"}, 2, "gpu");
  refused({.model = kSolids, .threads = -1}, 2, "`threads`");
  refused({.model = kSolids, .threads = 1025}, 2, "1024");
  refused({.model = kSolids, .camera = {.view_up = {{0, 0, 0}}}}, 2, "`camera.view_up`");
  refused({.model = kSolids, .camera = {.position = {{0, NAN, 0}}}}, 2, "`camera.position`");
  refused({.model = kSolids, .camera = {.view_angle_deg = 180.0f}}, 2, "`camera.view_angle_deg`");
  refused({.model = kSolids, .camera = {.zoom = 0.0f}}, 2, "`camera.zoom`");
  refused({.model = kSolids, .up = {{0, 0, 0}}}, 2, "`up`");
  refused({.model = kSolids, .crease_angle_deg = -1.0f}, 2, "`crease_angle_deg`");
  refused({.model = kSolids, .point_size = "0"}, 2, "`point_size`");
  refused({.model = kSolids, .point_sprites = "cube"}, 2, "`point_sprites`");
  refused({.model = kSolids, .quality = "hi"}, 2, "`quality`");
  refused({.model = kSolids, .anti_aliasing = 0}, 2, "`anti_aliasing`");
  refused({.model = kSolids, .occlusion_radius = "-1"}, 2, "`occlusion_radius`");
  refused({.model = kSolids, .occlusion_scale = "third"}, 2, "`occlusion_scale`");
  refused({.model = kSolids, .ground = "maybe"}, 2, "`ground`");
  refused({.model = kSolids, .background = {{0, 2, 0}}}, 2, "`background`");
  refused({.model = kSolids, .layers = 17}, 2, "`layers`");
  refused({.model = kSolids, .extra_views = 5}, 2, "`extra_views`");
  refused({.model = kSolids, .guard_band = 101.0f}, 2, "`guard_band`");
  refused({.model = kSolids, .passes = {"dept"}}, 2, "depth");
}

TEST(Public, ReturnsPasses) {
  umb::Picture picture;
  const auto outcome = umb::render({.model = kSolids,
                                    .look = "ao",
                                    .width = 40,
                                    .height = 30,
                                    .camera = {.position = {{6, 3, 6}}, .focal_point = {{0, 0.5f, 0}}},
                                    .layers = 2,
                                    .passes = {"normal", "depth", "layer1.depth", "ao"}},
                                   picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  ASSERT_EQ(picture.passes.size(), 4u);
  EXPECT_EQ(picture.passes[0].name, "normal");
  const auto &normal = pass(picture, "normal", 3), &depth = pass(picture, "depth", 1),
             &behind = pass(picture, "layer1.depth", 1);
  pass(picture, "ao", 1);
  int surfaces = 0;
  for (std::size_t k = 0; k < depth.size(); ++k) {
    EXPECT_LE(depth[k], behind[k]);
    const float length = std::hypot(normal[3 * k], normal[3 * k + 1], normal[3 * k + 2]);
    EXPECT_NEAR(length, std::isfinite(depth[k]) ? 1.0f : 0.0f, 1e-4f);
    surfaces += std::isfinite(depth[k]);
  }
  EXPECT_GT(surfaces, 300);
  umb::Picture all;
  ASSERT_EQ(umb::render({.model = kSolids, .look = "ao", .width = 8, .height = 6, .passes = {"all"}}, all).code, 0);
  pass(all, "albedo", 3);
  pass(all, "object_id", 1);
}

TEST(Public, AcceptsTheOptionsOfTheCommandLine) {
  const auto drawn = [](umb::RenderRequest request) {
    request.model = kSolids;
    request.width = 48;
    request.height = 36;
    request.device = "cpu";
    umb::Picture picture;
    const auto outcome = umb::render(request, picture);
    EXPECT_EQ(outcome.code, 0) << outcome.message;
    return picture.rgba;
  };
  const auto plain = drawn({});
  EXPECT_EQ(drawn({}), plain);
  EXPECT_NE(drawn({.camera = {.azimuth_deg = 30.0f}}), plain);
  EXPECT_NE(drawn({.camera = {.zoom = 2.0f}}), plain);
  EXPECT_NE(drawn({.camera = {.orthographic = true}}), plain);
  EXPECT_NE(drawn({.up = {{1, 0, 0}}}), plain);
  EXPECT_NE(drawn({.quality = "draft"}), plain);
  EXPECT_NE(drawn({.anti_aliasing = 2}), plain);
  EXPECT_NE(drawn({.occlusion_radius = "2%"}), plain);
  EXPECT_NE(drawn({.occlusion_scale = "quarter"}), plain);
  EXPECT_NE(drawn({.background = {{1, 0, 0}}}), plain);
  EXPECT_NE(drawn({.light_direction = {{60.0f, 20.0f}}}), plain);
  EXPECT_NE(drawn({.key = 2.0f}), plain);
  EXPECT_NE(drawn({.fill = 0.0f}), plain);
  EXPECT_NE(drawn({.rim = 0.0f}), plain);
  EXPECT_NE(drawn({.shadow_strength = 0.5f}), plain);
  EXPECT_NE(drawn({.occlusion_strength = 0.0f}), plain);
  EXPECT_NE(drawn({.exposure = 0.5f}), plain);
  EXPECT_NE(drawn({.contrast = 1.5f}), plain);
  EXPECT_NE(drawn({.material = "clay"}), plain);
  EXPECT_NE(drawn({.color = {{1, 0, 0}}}), plain);
  EXPECT_NE(drawn({.style = "dark"}), plain);
  EXPECT_NE(drawn({.guard_band = 10.0f}), plain);
  const auto cartoon = drawn({.look = "cartoon"});
  EXPECT_EQ(drawn({.look = "cartoon", .anti_aliasing = 4}), cartoon);
  EXPECT_NE(drawn({.look = "cartoon", .anti_aliasing = 1}), cartoon);
  const auto cut = drawn({.transparent = true});
  float min = 1.0f;
  for (std::size_t k = 3; k < cut.size(); k += 4) min = std::min(min, cut[k]);
  EXPECT_LT(min, 1e-6f);
}

/// A rendered picture, and a request that shades its depth and normals.
struct Rendered {
  umb::Picture picture;
  umb::ShadeRequest request;
};

Rendered rendered_solids(bool orthographic) {
  Rendered r;
  const auto outcome = umb::render({.model = kSolids,
                                    .look = "ao",
                                    .occlusion = "bitmask",
                                    .settings = {"bitmask.radius=0.7", "denoise.rounds=0"},
                                    .width = 64,
                                    .height = 48,
                                    .device = "cpu",
                                    .camera = {.position = {{0, 1, 8}},
                                               .focal_point = {{0, 1, 0}},
                                               .view_angle_deg = 40.0f,
                                               .orthographic = orthographic},
                                    .anti_aliasing = 1,
                                    .passes = {"depth", "normal", "ao"}},
                                   r.picture);
  EXPECT_EQ(outcome.code, 0) << outcome.message;
  umb::ShadeRequest& request = r.request;
  request.width = 64;
  request.height = 48;
  // The same window as orthographic_camera: its height is that of the view at the focal point.
  request.top = std::tan(20.0f * 3.14159265f / 180.0f) * (orthographic ? 8.0f : 1.0f);
  request.bottom = -request.top;
  request.right = request.top * float(request.width) / float(request.height);
  request.left = -request.right;
  request.orthographic = orthographic;
  request.effects = {"bitmask"};
  request.settings = {"bitmask.radius=0.7"};
  request.device = "cpu";
  return r;
}

/// Expects that the request, with these arrays, gives the rendered occlusion.
void expect_same_occlusion(const Rendered& r, const umb::ShadeRequest& request, const std::vector<float>& depths,
                           const umb::PixelArray& normals, double tolerance) {
  umb::ShadeRequest with = request;
  with.arrays = {{.name = "depth", .values = depths.data()}, normals};
  umb::Picture shaded;
  const auto outcome = umb::shade(with, shaded);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  EXPECT_TRUE(shaded.rgba.empty());
  ASSERT_EQ(shaded.passes.size(), 1u);
  const auto &ao = pass(r.picture, "ao", 1), &again = pass(shaded, "ao", 1);
  double sum = 0.0;
  for (std::size_t k = 0; k < ao.size(); ++k) sum += std::fabs(again[k] - ao[k]);
  EXPECT_LE(sum / double(ao.size()), tolerance) << request.orthographic << int(request.depth_kind);
}

// Shading a rendered G-buffer gives the rendered occlusion, whatever the memory layout of the arrays.
TEST(Public, ShadesArraysLikeModels) {
  for (const bool orthographic : {false, true}) {
    const Rendered r = rendered_solids(orthographic);
    const auto &depth = pass(r.picture, "depth", 1), &normal = pass(r.picture, "normal", 3);
    const umb::PixelArray packed = {.name = "normal", .values = normal.data()};
    expect_same_occlusion(r, r.request, depth, packed, 1e-7);
    // Planar, bottom up, in world space with -z up, not of length 1.
    const int width = r.request.width, height = r.request.height;
    const std::size_t pixels = depth.size();
    std::vector<float> planes(3 * pixels);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float* n = &normal[3 * (std::size_t(y) * width + std::size_t(x))];
        const std::size_t at = std::size_t(height - 1 - y) * width + std::size_t(x);
        planes[at] = 3.0f * n[0];
        planes[pixels + at] = 3.0f * n[2];
        planes[2 * pixels + at] = -3.0f * n[1];
      }
    umb::ShadeRequest turned = r.request;
    turned.view_from_normal = {1, 0, 0, 0, 0, -1, 0, 1, 0};
    const umb::PixelArray planar = {.name = "normal",
                                    .values = planes.data() + pixels - width,
                                    .row_stride = -width,
                                    .channel_stride = std::ptrdiff_t(pixels)};
    expect_same_occlusion(r, turned, depth, planar, 1e-5);
  }
}

TEST(Public, ShadesDepthsOfAllKinds) {
  for (const bool orthographic : {false, true}) {
    const Rendered r = rendered_solids(orthographic);
    const auto& depth = pass(r.picture, "depth", 1);
    const umb::PixelArray normals = {.name = "normal", .values = pass(r.picture, "normal", 3).data()};
    umb::ShadeRequest request = r.request;
    request.near_plane = 0.5f;
    for (const float far_plane : {50.0f, std::numeric_limits<float>::infinity()}) {
      if (orthographic && std::isinf(far_plane)) continue;
      request.far_plane = far_plane;
      const int width = request.width, height = request.height;
      std::vector<float> window(depth.size()), reversed(depth.size()), ray(depth.size());
      for (std::size_t k = 0; k < depth.size(); ++k) {
        const double d = depth[k], n = 0.5, f = far_plane;
        double z = (d - n) / (f - n);
        if (!orthographic) z = std::isinf(far_plane) ? 1.0 - n / d : f * (d - n) / (d * (f - n));
        if (std::isinf(depth[k])) z = 1.0;
        window[k] = float(z);
        reversed[k] = float(1.0 - z);
        const double x = request.left + (request.right - request.left) * (double(k % width) + 0.5) / width;
        const double y = request.top + (request.bottom - request.top) * (double(k / width) + 0.5) / height;
        ray[k] = std::isinf(depth[k]) ? -1.0f : float(orthographic ? d : d * std::sqrt(1.0 + x * x + y * y));
      }
      for (const auto& [kind, values] : {std::pair{umb::DepthKind::kWindow, &window},
                                         {umb::DepthKind::kReversed, &reversed},
                                         {umb::DepthKind::kDistance, &ray}}) {
        request.depth_kind = kind;
        expect_same_occlusion(r, request, *values, normals, 2e-3);
      }
    }
  }
}

/// Returns the depth of a sphere in front of a wall.
std::vector<float> sphere_depth(int side) {
  std::vector<float> depth(std::size_t(side) * std::size_t(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const float u = 2.4f * (float(x) + 0.5f) / float(side) - 1.2f, v = 2.4f * (float(y) + 0.5f) / float(side) - 1.2f;
      const float inside = 1.0f - u * u - v * v;
      depth[std::size_t(y) * std::size_t(side) + std::size_t(x)] = inside > 0.0f ? 5.0f - std::sqrt(inside) : 5.2f;
    }
  return depth;
}

TEST(Public, ShadesDepthAloneWithEveryKindOfLook) {
  const int side = 48;
  const auto depth = sphere_depth(side);
  umb::ShadeRequest request;
  request.width = request.height = side;
  request.arrays = {{.name = "depth", .values = depth.data()}};
  request.orthographic = true;
  request.left = request.bottom = -1.2f;
  request.right = request.top = 1.2f;
  for (const char* look : {"studio", "bleeding", "cartoon", "unsharp", "lit", "ao"}) {
    request.look = look;
    request.passes = {"ao"};
    umb::Picture picture;
    const auto outcome = umb::shade(request, picture);
    ASSERT_EQ(outcome.code, 0) << look << ": " << outcome.message;
    ASSERT_EQ(picture.rgba.size(), std::size_t(side) * side * 4);
    float min = 1.0f, max = 0.0f;
    for (std::size_t k = 0; k < picture.rgba.size(); k += 4) {
      ASSERT_TRUE(std::isfinite(picture.rgba[k])) << look;
      min = std::min(min, picture.rgba[k]), max = std::max(max, picture.rgba[k]);
    }
    EXPECT_GT(max - min, 0.1f) << look;
    if (look != std::string("studio") && look != std::string("bleeding")) continue;
    // The wall next to the sphere is darker than the wall in the corner.
    const auto& ao = pass(picture, "ao", 1);
    EXPECT_LT(ao[side / 2 * side + 2], ao[3 * side + 3]) << look;
  }
  // A picture without any surface is valid.
  const std::vector<float> empty(std::size_t(side) * side, std::numeric_limits<float>::infinity());
  request.arrays[0].values = empty.data();
  umb::Picture picture;
  EXPECT_EQ(umb::shade(request, picture).code, 0);
}

TEST(Public, HolesOfADepthMapAreBackground) {
  const int side = 48;
  umb::ShadeRequest request;
  request.width = request.height = side;
  request.orthographic = true;
  request.left = request.bottom = -1.2f;
  request.right = request.top = 1.2f;
  request.transparent = true;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto is_hole = [](int x, int y) { return (x > 30 && y > 30) || (x % 9 == 4 && y % 7 == 3); };
  for (const char* look : {"studio", "bleeding", "cartoon", "unsharp", "lit", "ao"})
    for (const umb::DepthKind kind : {umb::DepthKind::kPlanar, umb::DepthKind::kDistance}) {
      request.look = look;
      request.depth_kind = kind;
      umb::Picture expected;
      for (const float value : {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), 0.0f, -1.0f, 1e10f,
                                65504.0f, std::numeric_limits<float>::max()}) {
        auto depth = sphere_depth(side);
        for (int y = 0; y < side; ++y)
          for (int x = 0; x < side; ++x)
            if (is_hole(x, y)) depth[std::size_t(y) * std::size_t(side) + std::size_t(x)] = value;
        request.arrays = {{.name = "depth", .values = depth.data()}};
        umb::Picture picture;
        const auto outcome = umb::shade(request, picture);
        ASSERT_EQ(outcome.code, 0) << look << ": " << outcome.message;
        if (expected.rgba.empty()) {
          expected = picture;
          // Lines of a look may cover a hole's border.
          EXPECT_LT(picture.rgba[(44 * side + 44) * 4 + 3], 1e-6f) << look;
          EXPECT_GT(picture.rgba[(12 * side + 20) * 4 + 3], 0.999f) << look;
        }
        ASSERT_EQ(picture.rgba, expected.rgba) << look << ", " << value;
      }
    }
}

TEST(Public, ReportsErrorsOfArrays) {
  const auto depth = sphere_depth(8);
  umb::ShadeRequest good;
  good.width = good.height = 8;
  good.arrays = {{.name = "depth", .values = depth.data()}};
  good.look = "ao";
  umb::Picture picture;
  ASSERT_EQ(umb::shade(good, picture).code, 0);
  const auto refused = [&](const auto& change, const std::string& text) {
    umb::ShadeRequest request = good;
    change(request);
    umb::Picture untouched;
    const auto outcome = umb::shade(request, untouched);
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_NE(outcome.message.find(text), std::string::npos) << outcome.message;
    EXPECT_EQ(untouched.width, 0);
  };
  using Request = umb::ShadeRequest;
  refused([](Request& r) { r.width = 0; }, "`width`");
  refused([](Request& r) { r.arrays.clear(); }, "'depth'");
  refused([](Request& r) { r.arrays[0].name = "dept"; }, "depth");
  refused([](Request& r) { r.arrays[0].values = nullptr; }, "no values");
  refused([](Request& r) { r.arrays.push_back(r.arrays[0]); }, "two arrays");
  refused([](Request& r) { r.arrays.push_back({.name = "layer2.depth", .values = r.arrays[0].values}); },
          "layer1.depth");
  refused([](Request& r) { r.depth_kind = umb::DepthKind::kWindow, r.near_plane = 0.0f; }, "near_plane");
  refused([](Request& r) { r.depth_kind = umb::DepthKind::kReversed, r.orthographic = true; }, "far_plane");
  refused([](Request& r) { r.right = r.left = 1.0f; }, "window");
  refused([](Request& r) { r.scene_radius = -1.0f; }, "scene_radius");
  refused([](Request& r) { r.view_from_normal[4] = NAN; }, "view_from_normal");
  refused([](Request& r) { r.look = "aoo"; }, "aoo");
  refused([](Request& r) { r.occlusion = "reference"; }, "reference");
  refused([](Request& r) { r.effects = {"bitmusk"}; }, "bitmask");
  refused([](Request& r) { r.effects = {"output"}; }, "lit.r");
  refused([](Request& r) { r.passes = {"nothing"}; }, "nothing");
  refused([](Request& r) { r.device = "gpu"; }, "gpu");
}

TEST(Public, ReportsProgressOnTheCallingThread) {
  for (const char* occlusion : {"bitmask", "reference"}) {
    std::vector<double> reported;
    const auto thread = std::this_thread::get_id();
    umb::Picture picture;
    const auto outcome = umb::render({.model = kSolids,
                                      .look = "lit",
                                      .occlusion = occlusion,
                                      .width = 160,
                                      .height = 120,
                                      .device = "cpu",
                                      .anti_aliasing = 2,
                                      .progress =
                                          [&](double done) {
                                            EXPECT_EQ(std::this_thread::get_id(), thread);
                                            reported.push_back(done);
                                            return true;
                                          }},
                                     picture);
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    ASSERT_GT(reported.size(), 6u);
    EXPECT_EQ(reported.front(), 0.0);
    EXPECT_EQ(reported.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
    EXPECT_GT(std::count_if(reported.begin(), reported.end(), [](double d) { return d > 0.1 && d < 0.9; }), 2);
  }
}

// Wherever drawing is cancelled, progress is not called again, the picture is unchanged, and the next picture is not
// affected.
TEST(Public, CanBeCancelledAnywhere) {
  int calls = 0, last = 0;
  umb::RenderRequest request = {.model = kSolids,
                                .look = "bleeding",
                                .width = 96,
                                .height = 64,
                                .device = "cpu",
                                .anti_aliasing = 2,
                                .progress = [&](double) { return ++calls != last; }};
  umb::FrameRenderer renderer;
  ASSERT_EQ(renderer.open(request).code, 0);
  umb::Picture whole;
  calls = 0;
  ASSERT_EQ(renderer.draw({}, whole).code, 0);
  const int all = calls;
  ASSERT_GT(all, 10);
  for (last = 1; last <= all; last += 3) {
    umb::Picture picture{1, 1, {0.25f, 0.5f, 0.75f, 1.0f}, {}};
    calls = 0;
    const auto outcome = renderer.draw({}, picture);
    if (calls < last) continue;  // the number of calls within a dispatch depends on time
    EXPECT_EQ(outcome.code, 130);
    EXPECT_EQ(calls, last);
    EXPECT_EQ(picture.rgba.size(), 4u);
  }
  last = 0;
  umb::Picture again;
  ASSERT_EQ(renderer.draw({}, again).code, 0);
  EXPECT_EQ(again.rgba, whole.rgba);
  // Cancelled before the model is read.
  last = 1;
  calls = 0;
  request.model = "missing.obj";
  EXPECT_EQ(umb::render(request, again).code, 130);
}

// Cancelling ends a long dispatch early.
TEST(Public, CanBeCancelledWithinADispatch) {
  using Clock = std::chrono::steady_clock;
  const auto drawn = [&](bool end) {
    const auto start = Clock::now();
    Clock::time_point ended = start;
    umb::RenderRequest request = {.model = kSolids,
                                  .look = "ao",
                                  .occlusion = "bitmask",
                                  .settings = {"bitmask.slices=8", "bitmask.steps=32"},
                                  .width = 512,
                                  .height = 512,
                                  .threads = 1,
                                  .device = "cpu",
                                  .progress = [&](double done) {
                                    ended = Clock::now();
                                    return !end || done < 0.45;
                                  }};
    umb::Picture picture;
    EXPECT_EQ(umb::render(request, picture).code, end ? 130 : 0);
    return std::chrono::duration<double>(end ? Clock::now() - ended : Clock::now() - start).count();
  };
  const double whole = drawn(false);
  EXPECT_LT(drawn(true), 0.25 * whole);
}

TEST(Public, PropagatesExceptionsOfTheCaller) {
  umb::Picture picture;
  int calls = 0;
  const umb::RenderRequest request = {
      .model = kSolids, .look = "ao", .width = 64, .height = 48, .device = "cpu", .progress = [&](double) {
        if (++calls == 4) throw 7;
        return true;
      }};
  EXPECT_THROW(umb::render(request, picture), int);
  EXPECT_EQ(umb::render(request, picture).code, 0);
}

TEST(Public, CamerasAndScenesAreChosenByIndex) {
  umb::RenderRequest request = {
      .model = "scene:room?detail=2000", .look = "ao", .width = 64, .height = 48, .device = "cpu"};
  umb::Picture own, first, second;
  ASSERT_EQ(umb::render(request, own).code, 0);
  request.camera.index = 0;
  ASSERT_EQ(umb::render(request, first).code, 0);
  request.camera.index = 1;
  ASSERT_EQ(umb::render(request, second).code, 0);
  EXPECT_EQ(first.rgba, own.rgba) << "the first view is the default";
  EXPECT_NE(second.rgba, first.rgba);
  request.camera.index = 99;
  const auto wrong_camera = umb::render(request, second);
  EXPECT_EQ(wrong_camera.code, 2);
  EXPECT_NE(wrong_camera.message.find("`camera.index`"), std::string::npos) << wrong_camera.message;
  request.camera = {.index = 0, .position = {{1, 2, 3}}};
  EXPECT_EQ(umb::render(request, second).code, 2);
  request.camera = {};
  request.scene_index = 0;
  EXPECT_EQ(umb::render(request, second).code, 0);
  request.scene_index = 1;
  const auto wrong_scene = umb::render(request, second);
  EXPECT_EQ(wrong_scene.code, 2);
  EXPECT_NE(wrong_scene.message.find("`scene_index`"), std::string::npos) << wrong_scene.message;
}

class PublicFiles : public testing::Test {
 protected:
  std::filesystem::path folder_;
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "umbrage-public-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string start_of(const std::string& name) const {
    std::string text(4, ' ');
    std::ifstream(folder_ / name, std::ios::binary).read(text.data(), 4);
    return text;
  }
};

TEST_F(PublicFiles, DrawsPointsOfTheRequestedSize) {
  const std::string file = (folder_ / "points.xyz").string();
  std::ofstream(file) << "0 0 0\n1 0 0\n0 1 0\n1 1 1\n";
  const auto drawn = [&](const std::string& size, const std::string& sprites) {
    umb::Picture picture;
    const auto outcome = umb::render({.model = file,
                                      .look = "ao",
                                      .width = 40,
                                      .height = 40,
                                      .device = "cpu",
                                      .point_size = size,
                                      .point_sprites = sprites,
                                      .passes = {"depth"}},
                                     picture);
    EXPECT_EQ(outcome.code, 0) << outcome.message;
    const auto& depth = pass(picture, "depth", 1);
    return std::count_if(depth.begin(), depth.end(), [](float d) { return std::isfinite(d); });
  };
  EXPECT_GT(drawn("40%", "sphere"), 2 * drawn("20%", "sphere"));
  EXPECT_NE(drawn("40%", "sphere"), drawn("40%", "disc"));
}

TEST_F(PublicFiles, SavesInTheFormatOfTheName) {
  umb::Picture picture;
  ASSERT_EQ(
      umb::render({.model = kSolids, .look = "ao", .width = 20, .height = 10, .passes = {"depth", "normal"}}, picture)
          .code,
      0);
  const auto save = [&](const std::string& name, const umb::SaveRequest& request = {}) {
    return umb::save(picture, (folder_ / name).string(), request);
  };
  EXPECT_EQ(save("a.png").code, 0);
  EXPECT_EQ(start_of("a.png"), "\x89PNG");
  EXPECT_EQ(save("b.png", {.bits = 16}).code, 0);
  EXPECT_EQ(save("c.pfm").code, 0);
  EXPECT_EQ(start_of("c.pfm").substr(0, 2), "PF");
  EXPECT_EQ(save("d.exr", {.half = true}).code, 0);
  EXPECT_EQ(start_of("d.exr").substr(0, 4), "v/1\x01");
  std::ifstream exr(folder_ / "d.exr", std::ios::binary);
  const std::string header = std::string(std::istreambuf_iterator<char>(exr), {}).substr(0, 600);
  for (const char* channel : {"depth.Z", "normal.X", "normal.Z"})
    EXPECT_NE(header.find(channel), std::string::npos) << channel;
  EXPECT_EQ(save("e.gif").code, 2);
  EXPECT_EQ(save("f.png", {.bits = 9}).code, 2);
  EXPECT_EQ(save("no/folder.png").code, 3);
  picture.passes.resize(1);
  picture.rgba.clear();
  EXPECT_EQ(save("depth.pfm").code, 0);
  EXPECT_EQ(start_of("depth.pfm").substr(0, 2), "Pf");
  picture.passes[0].values.pop_back();
  EXPECT_EQ(save("g.exr").code, 2);
  EXPECT_EQ(umb::save({}, (folder_ / "h.png").string()).code, 2);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 5);
}

TEST(Public, HasAVersion) { EXPECT_EQ(std::string(umb::version()).find('.'), 1u); }

TEST(Public, IdsKeepAllBits) {
  // Two objects on one plane whose ids differ in the last of 32 bits, and no surface in the last column.
  const int width = 12, height = 6;
  const std::uint32_t left = 0xfffffffe, right = 0xffffffff;
  std::vector<float> depth;
  std::vector<std::uint32_t> ids;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      depth.push_back(x == width - 1 ? 0.0f : 3.0f);
      ids.push_back(x < 6 ? left : right);
    }
  umb::ShadeRequest request;
  request.width = width;
  request.height = height;
  request.top = 0.5f, request.bottom = -0.5f, request.right = 1.0f, request.left = -1.0f;
  request.device = "cpu";
  request.effects = {"outline"};
  request.passes = {"object_id", "outline"};
  request.strokes = true;
  request.arrays = {{.name = "depth", .values = depth.data()}, {.name = "object_id", .ids = ids.data()}};
  umb::Picture picture;
  ASSERT_EQ(umb::shade(request, picture).code, 0);
  ASSERT_EQ(picture.passes[0].ids.size(), ids.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      EXPECT_EQ(picture.passes[0].ids[y * width + x], x == width - 1 ? 0 : x < 6 ? left : right) << x << ", " << y;
  EXPECT_GT(picture.passes[1].values[3 * width + 6] + picture.passes[1].values[3 * width + 5], 0.5f) << "a line";
  ASSERT_FALSE(picture.strokes.empty());
  for (const umb::Stroke& stroke : picture.strokes)
    EXPECT_TRUE(std::uint32_t(stroke.object) == left || std::uint32_t(stroke.object) == right) << stroke.object;

  // The same in a file.
  const std::string file = testing::TempDir() + "umbrage_ids.exr";
  ASSERT_EQ(umb::save(picture, file).code, 0);
  {
    Imf::InputFile input(file.c_str());
    ASSERT_NE(input.header().channels().findChannel("object_id"), nullptr);
    EXPECT_EQ(input.header().channels().findChannel("object_id")->type, Imf::UINT);
    std::vector<std::uint32_t> read(ids.size());
    Imf::FrameBuffer pixels;
    pixels.insert("object_id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(read.data()), 4, 4 * width));
    input.setFrameBuffer(pixels);
    input.readPixels(0, height - 1);
    EXPECT_EQ(read, picture.passes[0].ids);
  }
  std::remove(file.c_str());

  // Invalid arrays.
  request.arrays[1] = {.name = "ao", .ids = ids.data()};
  EXPECT_EQ(umb::shade(request, picture).code, 2);
  request.arrays[1] = {.name = "object_id", .values = depth.data(), .ids = ids.data()};
  EXPECT_EQ(umb::shade(request, picture).code, 2);
}

}  // namespace
