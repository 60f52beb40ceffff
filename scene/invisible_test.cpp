// Models of which nothing would be seen.
#include <gtest/gtest.h>

#include "scene/finish.h"

namespace umbrage {
namespace {

/// Two meshes with a material each; the second material has a texture of one texel.
Scene scene_of(float opacity, std::uint8_t alpha) {
  Scene scene;
  scene.materials.resize(2);
  for (Material& material : scene.materials) material.blended = true;
  scene.materials[0].opacity = 0.0f;
  scene.materials[1].opacity = opacity;
  scene.materials[1].texture = 0;
  scene.textures.push_back({.width = 1, .height = 1, .rgba = {255, 255, 255, alpha}});
  for (int k = 0; k < 2; ++k) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs.resize(3);
    mesh.indices = {0, 1, 2};
    mesh.material = k;
  }
  return scene;
}

bool shows(Scene scene) {
  const bool shown = show_if_invisible(scene);
  for (const Material& material : scene.materials) EXPECT_EQ(material.blended || material.alpha_mask, !shown);
  return shown;
}

TEST(Invisible, AModelIsOpaqueIfNothingOfItWouldBeSeen) {
  EXPECT_TRUE(shows(scene_of(0.0f, 255)));
  EXPECT_TRUE(shows(scene_of(1.0f, 0)));
  EXPECT_FALSE(shows(scene_of(1.0f, 255))) << "one of two is seen";
  EXPECT_FALSE(shows(scene_of(0.5f, 10)));
  Scene cut = scene_of(1.0f, 100);
  cut.materials[1].blended = false;
  cut.materials[1].alpha_mask = true;
  EXPECT_TRUE(shows(cut));
  cut.materials[1].alpha_cutoff = 0.25f;
  EXPECT_FALSE(shows(cut));
  cut.meshes[1].uvs.clear();
  cut.materials[1].alpha_cutoff = 0.5f;
  EXPECT_FALSE(shows(cut)) << "without texture coordinates there is no texture";
}

}  // namespace
}  // namespace umbrage
