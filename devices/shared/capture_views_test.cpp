// Captured layers of back sides and of extra views.
#include "capture_support.h"

namespace umbrage {
namespace {

using namespace test;

// ---- back sides, extra views ----

TEST(CaptureBackSides, AThinSheetLitFromBehindIsDarkInFrontAndLitBehind) {
  for (const bool point : {false, true}) {
    // The sun or a point light is below the sheet; a smaller sheet in between blocks part of its light.
    Scene scene = scene_of({square(4.0f), square(0.5f, -1.0f)}, {Material{.specular_strength = 0.5f}});
    scene.lights = {point ? key_lamp({0, 0, -2}) : key_light({0, 0, -1}), key_light({0, 0, 1})};
    const Picture picture = capture_with({.width = 65, .height = 65, .back_sides = true}, scene, from_above(4.0f));
    ASSERT_EQ(picture.info.more_layers.size(), 1u);
    EXPECT_EQ(picture.info.more_layers[0].kind, LayerKind::kBack);
    EXPECT_EQ(picture.info.more_layers[0].of, 0);
    const double blocked = point ? 1.0 : 0.5;  // half width of the lower sheet's shadow
    long lit = 0, dark = 0;
    for (int y = 0; y < 65; ++y)
      for (int x = 0; x < 65; ++x) {
        const glm::dvec3 p = ray_of(picture.info, x, y).origin;
        for (const char* name : {"depth", "albedo.r", "albedo.g", "albedo.b", "object_id", "material_id"})
          ASSERT_EQ(picture[name].at(x, y), picture[layer_plane(1, name)].at(x, y)) << name;
        ASSERT_EQ(layer_normal(picture, 1, x, y), -picture.normal(x, y));
        ASSERT_EQ(picture["layer1.specular"].at(x, y), 0.0f);
        ASSERT_EQ(picture["shadow"].at(x, y), 0.0f);
        ASSERT_EQ(picture["shadow1"].at(x, y), 1.0f);
        ASSERT_EQ(picture["layer1.shadow1"].at(x, y), 0.0f) << "the upper light does not reach the lower side";
        const double outside = std::max(std::fabs(p.x), std::fabs(p.y)) - blocked;
        if (std::fabs(outside) < 2e-3) continue;
        ASSERT_EQ(picture["layer1.shadow"].at(x, y), outside > 0.0 ? 1.0f : 0.0f) << x << ',' << y;
        (outside > 0.0 ? lit : dark) += 1;
      }
    EXPECT_GT(lit, 500);
    EXPECT_GT(dark, 200);
  }
}

TEST(CaptureBackSides, NoLightArrivesInsideASolid) {
  Scene scene = scene_of({shapes::sphere(1.0f, 48, 24), shapes::box({-3, -3, -1.6f}, {3, 3, -1.2f})});
  scene.lights = {key_light({0.3f, 0.2f, 1.0f}), key_lamp({2.0f, -3.0f, 1.0f}), key_light({-1.0f, 0.1f, -0.2f})};
  const Picture picture = capture_with({.width = 90, .height = 90, .layers = 2, .back_sides = true}, scene,
                                       perspective_camera({3, -4, 5}, {0, 0, -0.5f}, {0, 0, 1}, 40.0f, 1.0f));
  ASSERT_EQ(picture.info.more_layers.size(), 3u);
  EXPECT_EQ(picture.info.more_layers[0].kind, LayerKind::kBehind);
  EXPECT_EQ(picture.info.more_layers[0].of, 0);
  EXPECT_EQ(picture.info.more_layers[1].kind, LayerKind::kBack);
  EXPECT_EQ(picture.info.more_layers[1].of, 0);
  EXPECT_EQ(picture.info.more_layers[2].kind, LayerKind::kBack);
  EXPECT_EQ(picture.info.more_layers[2].of, 1);
  long inside = 0, lit = 0, outer = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 90; ++x) {
      if (!std::isfinite(picture.depth(x, y))) continue;
      // The first surface is the outside of a solid: its back side is inside. The second one is the far side of the
      // solid, seen from inside; its back side is outside again.
      for (const char* name : {"layer2.shadow", "layer2.shadow1", "layer2.shadow2"})
        inside += picture[name].at(x, y) == 0.0f;
      lit += 3;
      outer += std::isfinite(picture["layer3.depth"].at(x, y)) && picture["layer3.shadow2"].at(x, y) == 1.0f;
    }
  EXPECT_GT(lit, 3000);
  EXPECT_EQ(inside, lit);
  EXPECT_GT(outer, 100) << "the light from below and behind reaches what the camera does not see";
}

TEST(CaptureBackSides, OtherLayersAreUnchanged) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture plain = capture_with({.width = 61, .height = 103, .layers = 3}, scene, camera);
  const Picture more =
      capture_with({.width = 61, .height = 103, .layers = 3, .back_sides = true, .extra_views = 2}, scene, camera);
  ASSERT_EQ(more.info.more_layers.size(), 7u);
  ASSERT_EQ(more.planes.planes.size(), plain.planes.planes.size() / 3 * 8);
  for (std::size_t p = 0; p < plain.planes.planes.size(); ++p) {
    ASSERT_EQ(plain.planes.names[p], more.planes.names[p]);
    EXPECT_EQ(test::difference(plain.planes.planes[p], more.planes.planes[p], 0.0).max, 0.0) << plain.planes.names[p];
  }
}

/// Returns a room of 12 x 8 x 5 with a pillar, and in front of the pillar a sheet that hides it from the camera.
Scene room_with_drape() {
  Scene scene = scene_of(
      {parallelogram({-6, 0, -4}, {12, 0, 0}, {0, 0, 8}), parallelogram({-6, 5, -4}, {12, 0, 0}, {0, 0, 8}),
       parallelogram({-6, 0, -4}, {12, 0, 0}, {0, 5, 0}), parallelogram({-6, 0, 4}, {12, 0, 0}, {0, 5, 0}),
       parallelogram({-6, 0, -4}, {0, 5, 0}, {0, 0, 8}), parallelogram({6, 0, -4}, {0, 5, 0}, {0, 0, 8}),
       shapes::box({0.6f, 0, -0.4f}, {1.4f, 5, 0.4f}), parallelogram({-0.5f, 0.5f, -1.5f}, {0, 3.5f, 0}, {0, 0, 3})});
  scene.up = {0, 1, 0};
  return scene;
}

TEST(CaptureExtraViews, AgreeWithTheFirstCameraOnPositions) {
  const Scene scene = room_with_drape();
  for (const bool orthographic : {false, true}) {
    const Camera camera = orthographic ? orthographic_camera({-4.5f, 4.4f, 2.5f}, {2, 0.5f, 0}, {0, 1, 0}, 4.5f, 1.5f)
                                       : perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
    const Picture picture = capture_with({.width = 181, .height = 121, .extra_views = 4}, scene, camera);
    ASSERT_EQ(picture.info.more_layers.size(), 4u);
    const auto plane_of_layer = [&](int layer, const char* name) -> const Plane& {
      return picture[layer_plane(layer, name)];
    };
    const glm::dvec3 axis = ray_of(picture.info, 90, 60).direction, eye = ray_of(picture.info, 90, 60).origin;
    glm::dvec3 common(0.0);
    for (int layer = 1; layer <= 4; ++layer) {
      ASSERT_EQ(picture.info.more_layers[std::size_t(layer) - 1].kind, LayerKind::kOther);
      const PictureInfo other = layer_info(picture.info, layer);
      EXPECT_EQ(other.camera.projection, camera.projection);
      EXPECT_EQ(other.width, 181);
      if (!orthographic) {
        EXPECT_LE(std::max(other.camera.right, other.camera.top), std::tan(glm::radians(55.0f)) * 1.0001f);
      }
      // Where both cameras see a surface, the point of one lies in the plane of the other.
      const glm::dmat4 other_from_world(other.camera.view_from_world);
      long agree = 0, disagree = 0;
      for (int y = 0; y < 121; ++y)
        for (int x = 0; x < 181; ++x) {
          const glm::dvec3 p = ray_of(picture.info, x, y).at(picture.depth(x, y));
          const glm::dvec3 q = glm::dvec3(other_from_world * glm::dvec4(p, 1.0));
          const double spread = orthographic ? 1.0 : -q.z;
          const double u =
              (q.x / spread - other.camera.left) / (double(other.camera.right) - other.camera.left) * 181.0;
          const double v = (other.camera.top - q.y / spread) / (double(other.camera.top) - other.camera.bottom) * 121.0;
          if (!(q.z < 0.0 && u >= 0.0 && u < 181.0 && v >= 0.0 && v < 121.0)) continue;
          const int i = int(u), j = int(v);
          if (plane_of_layer(layer, "object_id").at(i, j) != picture["object_id"].at(x, y)) continue;
          const glm::dvec3 other_point = ray_of(other, i, j).at(plane_of_layer(layer, "depth").at(i, j));
          const glm::dvec3 normal = glm::transpose(glm::dmat3(other_from_world)) * layer_normal(picture, layer, i, j);
          const glm::dvec3 first_normal =
              glm::transpose(glm::dmat3(glm::dmat4(camera.view_from_world))) * picture.normal(x, y);
          // Skips another face of the pillar, and the back side of the sheet.
          if (glm::dot(normal, first_normal) < 0.999) continue;
          const double off = std::fabs(glm::dot(p - other_point, normal));
          (off < 1e-4 * std::max(-q.z, double(picture.depth(x, y))) ? agree : disagree) += 1;
        }
      EXPECT_EQ(disagree, 0) << layer;
      EXPECT_GT(agree, 500) << layer << (orthographic ? " orthographic" : "");
      // The camera sees the point that all cameras look at, which also lies on the first camera's axis.
      const PixelRay middle = ray_of(other, 90, 60);
      const glm::dvec3 d = glm::normalize(middle.direction), e = glm::normalize(axis), w = middle.origin - eye;
      const double de = glm::dot(d, e), bottom = 1.0 - de * de;
      const double along = bottom > 1e-9 ? (de * glm::dot(e, w) - glm::dot(d, w)) / bottom : -1.0;
      if (bottom > 1e-9) {
        const glm::dvec3 c = middle.origin + d * along;
        if (common == glm::dvec3(0.0)) common = c;
        EXPECT_LT(glm::distance(c, common), 1e-3) << layer;
        EXPECT_LT(glm::length(glm::cross(c - eye, e)), 1e-3) << layer;
      }
    }
    ASSERT_NE(common, glm::dvec3(0.0));
    for (int layer = 1; layer <= 4; ++layer) {
      const PixelRay middle = ray_of(layer_info(picture.info, layer), 90, 60);
      const double to_common = glm::dot(common - middle.origin, glm::normalize(middle.direction));
      EXPECT_GT(to_common, 0.0) << layer;
      EXPECT_LT(glm::length(glm::cross(common - middle.origin, glm::normalize(middle.direction))), 2e-3) << layer;
      EXPECT_GT(plane_of_layer(layer, "depth").at(90, 60) * glm::length(middle.direction), to_common) << layer;
      EXPECT_LT(to_common, glm::dot(common - eye, glm::normalize(axis)) * 1.0001) << "no farther than the first";
    }
  }
}

TEST(CaptureExtraViews, ShowSurfacesHiddenFromTheFirstCamera) {
  // The pillar is behind the sheet; it is visible from behind or from the side.
  const Scene scene = room_with_drape();
  const Picture picture = capture_with({.width = 120, .height = 80, .extra_views = 3}, scene,
                                       perspective_camera({-5.5f, 2.2f, 0.0f}, {6, 2.2f, 0}, {0, 1, 0}, 40.0f, 1.5f));
  long seen[4] = {};
  for (int layer = 0; layer < 4; ++layer)
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 120; ++x) seen[layer] += picture[layer_plane(layer, "object_id")].at(x, y) == 6.0f;
  EXPECT_LT(seen[0], 400) << "above and below the sheet";
  EXPECT_GT(seen[1] + seen[2] + seen[3], 1000);
}

TEST(CaptureExtraViews, DoNotDependOnTheirNumberLayersOrGuardBand) {
  const Scene scene = room_with_drape();
  const Camera camera = perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const Picture four = capture_with({.width = 90, .height = 60, .extra_views = 4}, scene, camera);
  const Picture two = capture_with({.width = 90, .height = 60, .layers = 2, .extra_views = 2}, scene, camera);
  for (int view = 0; view < 2; ++view)
    for (const char* name : {"depth", "normal.x", "albedo.g", "object_id"})
      EXPECT_EQ(test::difference(four[layer_plane(1 + view, name)], two[layer_plane(2 + view, name)], 0.0).max, 0.0);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto wide = device->capture(camera, {.width = 90, .height = 60, .extra_views = 4, .guard = 7});
  const PictureInfo inner = inner_info(wide->info);
  ASSERT_EQ(inner.more_layers.size(), 4u);
  for (int view = 0; view < 4; ++view) {
    const Camera &a = inner.more_layers[view].camera, &b = four.info.more_layers[view].camera;
    EXPECT_LT(glm::distance(a.eye(), b.eye()), 1e-4f);
    EXPECT_NEAR(a.left, b.left, 1e-5f * b.right);
    EXPECT_NEAR(a.top, b.top, 1e-5f * b.top);
  }
}

TEST(CaptureExtraViews, ExistEvenIfNothingIsVisible) {
  for (const Scene& scene :
       {scene_of({square(1.0f)}), scene_of({shapes::sphere(1.0f, 16, 8)}), scene_of({square(1e-20f)})})
    for (const Camera& camera : {perspective_camera({0, 0, 5}, {0, 0, 9}, {0, 1, 0}, 40.0f, 1.0f), from_above(3.0f),
                                 perspective_camera({0, 0, 0.5f}, {0, 0, 0}, {0, 1, 0}, 170.0f, 1.0f),
                                 perspective_camera({0, 0, 1e16f}, {0, 0, 0}, {0, 1, 0}, 40.0f, 1.0f),
                                 // On the surface: half of the rays leave it immediately.
                                 perspective_camera({0, 0, 0}, {1, 0.01f, 0.001f}, {0, 0, 1}, 40.0f, 1.0f)}) {
      // A number of threads disables the comparison with the GPU: for a camera on a surface rounding decides what is
      // visible.
      const Picture picture = capture_with({.width = 5, .height = 5, .extra_views = 4}, scene, camera, {.threads = 1});
      ASSERT_EQ(picture.info.more_layers.size(), 4u);
      for (const LayerInfo& layer : picture.info.more_layers) {
        for (int c = 0; c < 16; ++c) EXPECT_TRUE(std::isfinite((&layer.camera.view_from_world[0][0])[c]));
        EXPECT_GT(layer.camera.right, layer.camera.left);
        EXPECT_GT(layer.camera.top, layer.camera.bottom);
      }
    }
}

TEST(CaptureExtraViews, TooManyLayersAreAnError) {
  const Scene scene = scene_of({square(1.0f)});
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto capture_of = [&](const CaptureSettings& settings) { return device->capture(from_above(3.0f), settings); };
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = kMaxLayers}));
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = 4, .back_sides = true}));
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = 4, .extra_views = 4}));
  for (const CaptureSettings& settings :
       {CaptureSettings{.width = 4, .height = 4, .layers = 4, .back_sides = true, .extra_views = 1},
        CaptureSettings{.width = 4, .height = 4, .layers = 5, .back_sides = true},
        CaptureSettings{.width = 4, .height = 4, .layers = 8, .extra_views = 1}}) {
    const auto frame = capture_of(settings);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().kind, ErrorKind::kUsage);
    EXPECT_NE(frame.error().message.find("at most 8"), std::string::npos) << frame.error().message;
  }
}

TEST(CaptureExtraViews, LightsKeepTheirPositions) {
  // The light that a surface receives does not depend on the camera: diffuse light of both views agrees on the same
  // surface.
  Scene scene = room_with_drape();
  scene.lights = {key_lamp({-3.0f, 4.0f, 2.0f}), {.kind = LightKind::kHead, .color = glm::vec3(0.5f)}};
  const Camera camera = perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  for (const char* rig : {"scene", "head", "key"}) {
    auto frame = device->capture(camera, {.width = 181, .height = 121, .extra_views = 2});
    ASSERT_TRUE(frame);
    const Effect& lighting = *find_effect("lighting");
    ParameterBytes params = initial_parameters(lighting.parameters, lighting.params_size);
    ASSERT_TRUE(set_parameter("lighting", *find_parameter(lighting, "rig"), rig, params));
    for (int layer = 0; layer < 3; ++layer) ASSERT_TRUE(device->run(lighting, params, *frame, {.layer = layer}));
    const Picture picture{frame->info, *device->download_all(*frame)};
    for (int layer = 1; layer < 3; ++layer) {
      const PictureInfo other = layer_info(picture.info, layer);
      long agree = 0, disagree = 0;
      for (int y = 0; y < 121; ++y)
        for (int x = 0; x < 181; ++x) {
          const auto plane = [&](const char* name) -> const Plane& { return picture[layer_plane(layer, name)]; };
          if (plane("object_id").at(x, y) != 1.0f) continue;  // the ceiling
          const glm::dvec3 p = ray_of(other, x, y).at(plane("depth").at(x, y));
          const glm::dvec3 q = glm::dvec3(glm::dmat4(camera.view_from_world) * glm::dvec4(p, 1.0));
          const double u = (q.x / -q.z - camera.left) / (camera.right - camera.left) * 181.0;
          const double v = (camera.top - q.y / -q.z) / (camera.top - camera.bottom) * 121.0;
          if (!(q.z < 0.0 && u >= 0.0 && u < 181.0 && v >= 0.0 && v < 121.0)) continue;
          if (picture["object_id"].at(int(u), int(v)) != 1.0f) continue;
          if (picture["shadow"].at(int(u), int(v)) != plane("shadow").at(x, y)) continue;  // near the edge of a shadow
          const double a = picture["direct.g"].at(int(u), int(v)), b = plane("direct.g").at(x, y);
          (std::fabs(a - b) < 0.05 * std::max(a, b) + 0.002 ? agree : disagree) += 1;
        }
      EXPECT_GT(agree, 200) << rig << layer;
      EXPECT_LT(disagree, agree / 50) << rig << layer;
    }
  }
}

}  // namespace
}  // namespace umbrage
