// What Assimp reads: the pose of DAE files, and materials from properties set by hand: highlight, opacity and emission.
#include <gtest/gtest.h>

#include <assimp/material.h>
#include <assimp/scene.h>
#include <glm/vec3.hpp>
#include <string>

#include "file_folder.h"
#include "importer/import_materials.h"
#include "importer/importer.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

std::string dae_source(const std::string& id, const std::string& numbers, int count, int stride) {
  std::string params;
  for (int k = 0; k < stride && stride <= 3; ++k)
    params += "<param name=\"" + std::string(1, "XYZ"[k]) + "\" type=\"float\"/>";
  if (stride == 1) params = "<param name=\"W\" type=\"float\"/>";
  if (stride == 16) params = "<param name=\"T\" type=\"float4x4\"/>";
  return "<source id=\"" + id + "\"><float_array id=\"" + id + "-a\" count=\"" + std::to_string(count * stride) +
         "\">" + numbers + "</float_array><technique_common><accessor source=\"#" + id + "-a\" count=\"" +
         std::to_string(count) + "\" stride=\"" + std::to_string(stride) + "\">" + params +
         "</accessor></technique_common></source>";
}

std::string geometry(const std::string& id, const std::string& positions) {
  return "<geometry id=\"" + id + "\"><mesh>" + dae_source(id + "-p", positions, 3, 3) + "<vertices id=\"" + id +
         "-v\"><input semantic=\"POSITION\" source=\"#" + id +
         "-p\"/></vertices><triangles count=\"1\"><input "
         "semantic=\"VERTEX\" source=\"#" +
         id + "-v\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry>";
}

std::string dae(const std::string& geometries, const std::string& controller, const std::string& nodes) {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset><up_axis>Y_UP</up_axis></asset><library_geometries>" +
         geometries + "</library_geometries><library_controllers><controller id=\"c\">" + controller +
         "</controller></library_controllers><library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

struct AssimpPose : test::FileFolder {
  Scene read(const std::string& text) {
    Result<Scene> scene = import_in_process(write("a.dae", text), {});
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }
};

const std::string kTriangle = "0 0 0 1 0 0 0 1 0";

TEST_F(AssimpPose, SkinsFollowTheirJoints) {
  const std::string skin =
      "<skin source=\"#g\"><bind_shape_matrix>2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1</bind_shape_matrix><source id=\"j\">"
      "<Name_array id=\"ja\" count=\"1\">joint</Name_array><technique_common><accessor source=\"#ja\" count=\"1\" "
      "stride=\"1\"><param name=\"JOINT\" type=\"name\"/></accessor></technique_common></source>" +
      dae_source("b", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", 1, 16) + dae_source("w", "1", 1, 1) +
      "<joints><input semantic=\"JOINT\" source=\"#j\"/><input semantic=\"INV_BIND_MATRIX\" source=\"#b\"/></joints>"
      "<vertex_weights count=\"3\"><input semantic=\"JOINT\" source=\"#j\" offset=\"0\"/><input semantic=\"WEIGHT\" "
      "source=\"#w\" offset=\"1\"/><vcount>1 1 1</vcount><v>0 0 0 0 0 0</v></vertex_weights></skin>";
  const Scene scene = read(dae(geometry("g", kTriangle), skin,
                               "<node id=\"joint\" sid=\"joint\" type=\"JOINT\"><translate>5 0 3</translate></node>"
                               "<node id=\"m\"><translate>0 0 100</translate><instance_controller url=\"#c\"><skeleton>"
                               "#joint</skeleton></instance_controller></node>"));
  // The bind shape matrix doubles the mesh, the joint moves it, and its own node does not.
  EXPECT_NEAR(scene.bounds_min.x, 5.0f, 1e-5f);
  EXPECT_NEAR(scene.bounds_max.x, 7.0f, 1e-5f);
  EXPECT_NEAR(scene.bounds_max.y, 2.0f, 1e-5f);
  EXPECT_NEAR(scene.bounds_max.z, 3.0f, 1e-5f);
  EXPECT_TRUE(scene.has_front);
}

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

TEST_F(AssimpPose, MorphsHaveTheirWeights) {
  const auto size_of = [&](const std::string& method, const std::string& weights) {
    const std::string morph =
        "<morph source=\"#g\" method=\"" + method +
        "\"><source id=\"t\"><IDREF_array id=\"ta\" count=\"2\">deep high</IDREF_array></source>" +
        dae_source("w", weights, 2, 1) +
        "<targets><input semantic=\"MORPH_TARGET\" source=\"#t\"/><input semantic=\"MORPH_WEIGHT\" source=\"#w\"/>"
        "</targets></morph>";
    const Scene scene = read(
        dae(geometry("g", kTriangle) + geometry("deep", "0 0 8 1 0 0 0 1 0") + geometry("high", "0 0 0 1 0 0 0 5 0"),
            morph, "<node id=\"m\"><instance_controller url=\"#c\"/></node>"));
    EXPECT_EQ(scene.triangle_count(), 1u);
    return scene.bounds_max - scene.bounds_min;
  };
  EXPECT_EQ(size_of("NORMALIZED", "0 0"), glm::vec3(1, 1, 0));
  EXPECT_EQ(size_of("NORMALIZED", "0.25 0"), glm::vec3(1, 1, 2));
  EXPECT_EQ(size_of("NORMALIZED", "0.5 0.5"), glm::vec3(1, 3, 4));
  EXPECT_EQ(size_of("RELATIVE", "0 0.5"), glm::vec3(1.5f, 3.5f, 0));
}

}  // namespace
}  // namespace umbrage
