// Captures of metalness, roughness, occlusion and normal maps, on the CPU and on the GPU in both ways.
#include "devices/shared/capture_support.h"

namespace umbrage {
namespace {

using namespace test;

/// Returns a linear texture of 1 x 1 texels.
Texture plain(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return {.name = "plain", .width = 1, .height = 1, .rgba = {r, g, b, 255}, .linear = true};
}

/// The devices that capture: the CPU, and the GPU with rays and by rasterisation if there is one.
std::vector<Device*> capturing_devices() {
  static const std::unique_ptr<Device> cpu = make_cpu_device({});
  std::vector<Device*> all = {cpu.get()};
  for (const VulkanCapture capture : kGpuCaptures)
    if (Device* device = capturing_device(capture)) all.push_back(device);
  return all;
}

/// Returns a camera that sees the square from -1 to 1 at z = 0, from above or from below.
Camera facing_square(float side = 1.0f) {
  return orthographic_camera({0, 0, 5 * side}, {0, 0, 0}, {0, 1, 0}, 2.0f, 1.0f);
}

const CaptureSettings kSettings{.width = 16, .height = 16};

glm::vec3 normal_at(const Image& image, int x, int y) {
  return {image.plane("normal.x").at(x, y), image.plane("normal.y").at(x, y), image.plane("normal.z").at(x, y)};
}

TEST(CaptureMaterials, PlanesHaveFactorsTimesMaps) {
  Scene scene = scene_of({square(1.0f)},
                         {{.metallic = 0.5f, .roughness = 0.8f, .surface_texture = 0, .occlusion_strength = 0.5f}});
  scene.textures = {plain(51, 102, 204)};
  scene.materials[0].surface_texture = 0;  // finish_scene has removed the index of a texture that did not exist
  for (Device* device : capturing_devices()) {
    const Image image = captured(*device, scene, facing_square(), kSettings);
    EXPECT_NEAR(image.plane("metallic").at(8, 8), 0.5f * 0.8f, 1e-6f) << device->name();
    EXPECT_NEAR(image.plane("roughness").at(8, 8), 0.8f * 0.4f, 1e-6f) << device->name();
    EXPECT_NEAR(image.plane("material_ao").at(8, 8), 1.0f - 0.5f * 0.8f, 1e-6f) << device->name();
  }
}

TEST(CaptureMaterials, PlanesExistOnlyWhereAMaterialNeedsThem) {
  const Scene plaster = scene_of({square(1.0f)});
  const Scene mixed = scene_of({square(0.4f, 0.1f), square(1.0f)}, {{.roughness = 0.5f}, {}});
  for (Device* device : capturing_devices()) {
    const Image none = captured(*device, plaster, facing_square(), kSettings);
    for (const char* name : {"metallic", "roughness", "material_ao"})
      EXPECT_EQ(none.find(name), nullptr) << device->name() << ' ' << name;
    const Image both = captured(*device, mixed, facing_square(), kSettings);
    EXPECT_EQ(both.plane("roughness").at(8, 8), 0.5f) << device->name();
    EXPECT_EQ(both.plane("roughness").at(1, 1), kNoRoughness) << device->name();
    EXPECT_EQ(both.find("material_ao"), nullptr);
  }
}

TEST(CaptureMaterials, NormalMapsTurnTheNormal) {
  // The texel's normal is (0.6, 0.2, 0.77), up to rounding to bytes.
  const glm::vec3 texel = glm::vec3(204, 153, 226) / 127.5f - 1.0f;
  const auto turned = [&](float x, float y) { return glm::normalize(glm::vec3(x * texel.x, y * texel.y, texel.z)); };
  struct Case {
    const char* name;
    glm::vec2 u, v;  // directions in which the texture coordinates grow
    float camera;    // side of the camera
    float scale;
    glm::vec3 wanted;  // view space
  };
  const Case cases[] = {
      {"plain", {1, 0}, {0, 1}, 1, 1, turned(1, 1)},
      {"mirrored", {-1, 0}, {0, 1}, 1, 1, turned(-1, 1)},
      {"turned", {0, 1}, {-1, 0}, 1, 1, glm::normalize(glm::vec3(-texel.y, texel.x, texel.z))},
      {"scaled", {1, 0}, {0, 1}, 1, 0.5f, turned(0.5f, 0.5f)},
      // From behind, view x is -x, and bumps are dents.
      {"behind", {1, 0}, {0, 1}, -1, 1, turned(1, -1)},
  };
  for (const Case& each : cases) {
    Mesh mesh = square(1.0f);
    for (std::size_t k = 0; k < mesh.uvs.size(); ++k) {
      const glm::vec2 p(mesh.positions[k]);
      mesh.uvs[k] = 0.5f * glm::vec2(glm::dot(p, each.u), glm::dot(p, each.v)) + 0.5f;
    }
    Scene scene = scene_of({mesh});
    scene.textures = {plain(204, 153, 226)};
    scene.materials[0].normal_texture = 0;
    scene.materials[0].normal_scale = each.scale;
    for (Device* device : capturing_devices()) {
      const Image image = captured(*device, scene, facing_square(each.camera), kSettings);
      const glm::vec3 n = normal_at(image, 8, 8);
      EXPECT_LT(glm::distance(n, each.wanted), 1e-5f)
          << each.name << ' ' << device->name() << ": " << n.x << ' ' << n.y << ' ' << n.z;
    }
  }
}

TEST(CaptureMaterials, TextureCoordinatesWithoutAreaKeepTheNormal) {
  Mesh mesh = square(1.0f);
  for (glm::vec2& uv : mesh.uvs) uv = {0.3f, 0.3f};
  Scene scene = scene_of({mesh});
  scene.textures = {plain(204, 153, 226)};
  scene.materials[0].normal_texture = 0;
  for (Device* device : capturing_devices())
    EXPECT_EQ(normal_at(captured(*device, scene, facing_square(), kSettings), 8, 8), glm::vec3(0, 0, 1))
        << device->name();
}

TEST(CaptureMaterials, NearestTexelsHaveSharpEdges) {
  Scene scene = scene_of({square(1.0f)}, {{.metallic = 1.0f, .roughness = 1.0f}});
  scene.textures = {{.name = "two", .width = 2, .height = 1, .rgba = {0, 51, 0, 255, 0, 204, 0, 255}, .linear = true}};
  scene.materials[0].surface_texture = 0;
  for (const bool nearest : {false, true})
    for (Device* device : capturing_devices()) {
      scene.textures[0].nearest = nearest;
      const Image image = captured(*device, scene, facing_square(), kSettings);
      for (int x = 0; x < 16; ++x) {
        const float sharp = x < 8 ? 0.2f : 0.8f, found = image.plane("roughness").at(x, 8);
        const bool is_sharp = std::abs(found - sharp) < 1e-3f;
        EXPECT_EQ(is_sharp, nearest) << device->name() << ' ' << x << ": " << found;
      }
    }
}

TEST(CaptureMaterials, DevicesAgreeOnACurvedSurface) {
  UMBRAGE_NEEDS_VULKAN(capturing_devices().size() > 1);
  Mesh ball = shapes::sphere(0.9f, 24, 12);
  ball.uvs.clear();
  for (const glm::vec3& p : ball.positions) ball.uvs.emplace_back(3.0f * p.x + p.z, 2.0f * p.y);
  Scene scene = scene_of({ball}, {{.metallic = 1.0f, .roughness = 1.0f}});
  Texture maps{.name = "maps", .width = 8, .height = 8, .rgba = {}, .linear = true}, normals = maps;
  for (unsigned k = 0; k < 64; ++k)
    for (unsigned c = 0; c < 4; ++c) {
      maps.rgba.push_back(std::uint8_t(c == 3 ? 255u : hash(4 * k + c) % 256u));
      normals.rgba.push_back(std::uint8_t(c > 1 ? 255u : 64u + hash(999u + 4 * k + c) % 128u));
    }
  scene.textures = {maps, normals};
  scene.materials[0].surface_texture = 0;
  scene.materials[0].occlusion_strength = 1.0f;
  scene.materials[0].normal_texture = 1;
  const std::vector<Device*> devices = capturing_devices();
  const CaptureSettings settings{.width = 96, .height = 96, .layers = 2, .back_sides = true};
  const Image cpu = captured(*devices[0], scene, facing_square(), settings);
  for (std::size_t d = 1; d < devices.size(); ++d) {
    const Image gpu = captured(*devices[d], scene, facing_square(), settings);
    for (std::size_t p = 0; p < cpu.planes.size(); ++p) {
      if (cpu.names[p].ends_with("shadow")) continue;
      EXPECT_LT(difference(cpu.planes[p], gpu.plane(cpu.names[p]), 1e-3).fraction_over, 0.01)
          << devices[d]->name() << ' ' << cpu.names[p];
    }
  }
}

}  // namespace
}  // namespace umbrage
