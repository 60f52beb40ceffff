// The pose of DAE files, which Assimp reads: skins.
#include <gtest/gtest.h>

#include <string>

#include "file_folder.h"
#include "importer/importer.h"

namespace umbrage {
namespace {

std::string source(const std::string& id, const std::string& numbers, int count, int stride) {
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
  return "<geometry id=\"" + id + "\"><mesh>" + source(id + "-p", positions, 3, 3) + "<vertices id=\"" + id +
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
      source("b", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", 1, 16) + source("w", "1", 1, 1) +
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

}  // namespace
}  // namespace umbrage
