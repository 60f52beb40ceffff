// Materials of formats that Assimp reads: highlight, opacity and emission, from properties set by hand.
#include "importer/import_materials.h"

#include <assimp/material.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <glm/vec3.hpp>

#include "scene/scene.h"

namespace umbrage {
namespace {

/// A material without textures.
struct Source {
  aiMaterial* material = new aiMaterial();  ///< belongs to the aiScene that imported() makes

  Source& color(const char* key, unsigned type, unsigned index, glm::vec3 value) {
    const aiColor3D stored(value.x, value.y, value.z);
    material->AddProperty(&stored, 1, key, type, index);
    return *this;
  }
  Source& number(const char* key, unsigned type, unsigned index, float value) {
    material->AddProperty(&value, 1, key, type, index);
    return *this;
  }
  Source& shading(int model) {
    material->AddProperty(&model, 1, AI_MATKEY_SHADING_MODEL);
    return *this;
  }
  Material imported(const std::string& format = "fbx") const {
    aiScene source;
    source.mNumMaterials = 1;
    source.mMaterials = new aiMaterial* [1] { material };
    Scene scene;
    import_materials(source, "model." + format, format, scene);
    return scene.materials.at(0);
  }
};

TEST(ImportedMaterials, HighlightIsTheStrongestChannelTimesItsStrength) {
  const auto shiny = [](float exponent) {
    Source source;
    source.color(AI_MATKEY_COLOR_SPECULAR, {0.25f, 0.75f, 0.5f}).number(AI_MATKEY_SHININESS, exponent);
    return source;
  };
  const Material plain = shiny(40.0f).imported();
  EXPECT_FLOAT_EQ(plain.specular_strength, 0.75f) << "without a strength in the file";
  EXPECT_FLOAT_EQ(plain.specular_exponent, 40.0f);
  EXPECT_FLOAT_EQ(shiny(40.0f).number(AI_MATKEY_SHININESS_STRENGTH, 0.5f).imported().specular_strength, 0.375f);
  EXPECT_EQ(shiny(40.0f).number(AI_MATKEY_SHININESS_STRENGTH, 0.0f).imported().specular_strength, 0.0f);
  EXPECT_EQ(shiny(40.0f).number(AI_MATKEY_SHININESS_STRENGTH, 3.0f).imported().specular_strength, 1.0f);
  EXPECT_EQ(shiny(1e6f).imported().specular_exponent, kMaxExponent);
  EXPECT_EQ(shiny(0.25f).imported().specular_exponent, kMinExponent);
  EXPECT_EQ(shiny(0.0f).imported().specular_strength, 0.0f) << "an exponent of 0 means no highlight";
  EXPECT_FLOAT_EQ(shiny(40.0f).shading(aiShadingMode_Blinn).imported().specular_strength, 0.75f);
  for (const int model : {aiShadingMode_NoShading, aiShadingMode_Flat, aiShadingMode_Gouraud})
    EXPECT_EQ(shiny(40.0f).shading(model).imported().specular_strength, 0.0f) << model;
}

TEST(ImportedMaterials, OpacityAndEmission) {
  const auto with_opacity = [](float opacity) { return Source().number(AI_MATKEY_OPACITY, opacity).imported(); };
  EXPECT_TRUE(with_opacity(0.25f).blended);
  EXPECT_EQ(with_opacity(0.25f).opacity, 0.25f);
  EXPECT_FALSE(with_opacity(1.0f).blended);
  EXPECT_FALSE(with_opacity(0.0f).blended) << "some exporters write 0 where they mean opaque";
  EXPECT_EQ(with_opacity(0.0f).opacity, 1.0f);
  const auto glow = [] { return Source().color(AI_MATKEY_COLOR_EMISSIVE, {0.5f, 2.0f, -1.0f}); };
  EXPECT_EQ(glow().imported().emission, glm::vec3(0.5f, 2.0f, 0.0f));
  EXPECT_EQ(glow().number(AI_MATKEY_EMISSIVE_INTENSITY, 4.0f).imported().emission, glm::vec3(2.0f, 8.0f, 0.0f));
}

TEST(ImportedMaterials, ColorsOf3dsAreSrgb) {
  const auto grey = [] { return Source().color(AI_MATKEY_COLOR_DIFFUSE, {0.5f, 0.0f, 1.0f}); };
  EXPECT_EQ(grey().imported("dae").albedo, glm::vec3(0.5f, 0.0f, 1.0f));
  EXPECT_NEAR(grey().imported("3ds").albedo.x, 0.21404114f, 1e-6f);
  EXPECT_EQ(Source().imported().albedo, glm::vec3(0.8f)) << "no colour in the file";
  EXPECT_EQ(grey().color(AI_MATKEY_BASE_COLOR, {0.25f, 0.25f, 0.25f}).imported().albedo, glm::vec3(0.25f));
}

}  // namespace
}  // namespace umbrage
