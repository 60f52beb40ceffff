// FBX: files made here, as text and as binary; what their meshes become in world space.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "archives.h"
#include "file_folder.h"
#include "importer/importer.h"

namespace umbrage {
namespace {

using Names = std::vector<std::string>;

/// A text file: objects, and connections of children to parents.
std::string fbx(const std::string& objects, const std::vector<std::pair<int, int>>& connections,
                const std::string& settings = "") {
  std::string text = "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7400\n}\nGlobalSettings:  {\n\t" +
                     ("Properties70:  {\n" + settings) + "\t}\n}\nObjects:  {\n" + objects + "}\nConnections:  {\n";
  for (const auto& [child, parent] : connections)
    text += "\tC: \"OO\"," + std::to_string(child) + "," + std::to_string(parent) + "\n";
  return text + "}\n";
}

std::string property(const std::string& name, const std::string& value) {
  return "P: \"" + name + "\", \"\", \"\", \"A\"," + value + "\n";
}

std::string object(const std::string& type, int id, const std::string& name, const std::string& subtype,
                   const std::string& content) {
  return type + ": " + std::to_string(id) + ", \"" + type + "::" + name + "\", \"" + subtype + "\" {\n" + content +
         "}\n";
}

std::string model(int id, const std::string& properties, const std::string& name = "m") {
  return object("Model", id, name, "Mesh", "Properties70:  {\n" + properties + "}\n");
}

std::string array(const std::string& name, const std::string& numbers) {
  const auto count = std::count(numbers.begin(), numbers.end(), ',') + 1;
  return name + ": *" + std::to_string(count) + " {\n\ta: " + numbers + "\n}\n";
}

/// A triangle with corners at 0, +x and +y, of length 1.
std::string triangle(int id) {
  return object("Geometry", id, "g", "Mesh",
                array("Vertices", "0,0,0,1,0,0,0,1,0") + array("PolygonVertexIndex", "0,1,-3"));
}

struct Fbx : test::FileFolder {
  Scene read(const std::string& text, const std::string& name = "a.fbx") {
    Result<Scene> scene = import_in_process(write(name, text), {});
    EXPECT_TRUE(scene) << (scene ? "" : scene.error().message);
    return scene ? *scene : Scene{};
  }
  std::string error_of(const std::string& text) {
    const Result<Scene> scene = import_in_process(write("a.fbx", text), {});
    return scene ? "" : scene.error().message;
  }
  /// Expects that a mesh has a corner at each of these places.
  static void expect_corners(const Scene& scene, std::size_t mesh, const std::vector<glm::vec3>& places) {
    ASSERT_LT(mesh, scene.meshes.size());
    for (const glm::vec3& place : places) {
      float nearest = 1e30f;
      for (const glm::vec3& p : scene.meshes[mesh].positions) nearest = std::min(nearest, glm::distance(p, place));
      EXPECT_LT(nearest, 1e-5f) << place.x << " " << place.y << " " << place.z;
    }
  }
  static bool warns_of(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& each) { return each.find(part) != std::string::npos; });
  }
};

TEST_F(Fbx, HiddenNodesAndTheirChildrenAreNotDrawn) {
  const auto names = [&](const std::string& of_child, const std::string& more = "") {
    const Scene scene = read(fbx(triangle(1) + model(10, property("Visibility", "0"), "hidden") +
                                     model(11, of_child, "child") + model(12, "", "other") + more,
                                 {{1, 10}, {1, 11}, {1, 12}, {10, 0}, {11, 10}, {12, 0}, {12, 20}}));
    Names list;
    for (const Mesh& mesh : scene.meshes) list.push_back(mesh.name);
    return list;
  };
  EXPECT_EQ(names(""), Names({"other"}));
  EXPECT_EQ(names(property("Visibility Inheritance", "0")), Names({"child", "other"}));
  const std::string layer =
      object("CollectionExclusive", 20, "l", "DisplayLayer", "Properties70: {\n" + property("Show", "0") + "}\n");
  EXPECT_EQ(names(property("Visibility Inheritance", "0"), layer), Names({"child"})) << "a hidden layer";
  const Scene all = read(fbx(triangle(1) + model(10, property("Visibility", "0")), {{1, 10}, {10, 0}}));
  EXPECT_EQ(all.meshes.size(), 1u);
  EXPECT_TRUE(warns_of(all, "all parts of the model are hidden"));
}

TEST_F(Fbx, TheFirstLevelOfDetailIsDrawn) {
  const Scene scene = read(fbx(triangle(1) + model(10, "", "group") + object("NodeAttribute", 11, "", "LodGroup", "") +
                                   model(12, "", "fine") + model(13, "", "coarse"),
                               {{10, 0}, {11, 10}, {12, 10}, {13, 10}, {1, 12}, {1, 13}}));
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "fine");
  EXPECT_TRUE(warns_of(scene, "levels of detail"));
}

TEST_F(Fbx, ShapeKeysHaveTheirWeights) {
  const auto corner_at = [&](double percent, const std::string& full) {
    std::string objects = triangle(1) + model(10, "") + object("Deformer", 2, "", "BlendShape", "") +
                          object("Deformer", 3, "", "BlendShapeChannel",
                                 "Properties70: {\n" + property("DeformPercent", std::to_string(percent)) + "}\n" +
                                     array("FullWeights", full));
    std::vector<std::pair<int, int>> links = {{1, 10}, {10, 0}, {2, 1}, {3, 2}};
    for (int k = 0; k < 1 + int(std::count(full.begin(), full.end(), ',')); ++k) {
      objects += object("Geometry", 4 + k, "", "Shape",
                        array("Indexes", "1") + array("Vertices", "0,0," + std::to_string(k == 0 ? 2 : 8)));
      links.emplace_back(4 + k, 3);
    }
    const Scene scene = read(fbx(objects, links));
    return scene.meshes.empty() ? -1.0f : scene.bounds_max.z;
  };
  EXPECT_FLOAT_EQ(corner_at(0.0, "100"), 0.0f);
  EXPECT_FLOAT_EQ(corner_at(50.0, "100"), 1.0f);
  EXPECT_FLOAT_EQ(corner_at(25.0, "50,100"), 1.0f) << "half of the first target";
  EXPECT_FLOAT_EQ(corner_at(75.0, "50,100"), 5.0f) << "between the first and the second";
}

/// A skin of one joint, number 20, that holds the corner at +x.
std::string skin(const std::string& joint, bool has_transform) {
  return object("Deformer", 2, "", "Skin", "") +
         object("Deformer", 3, "", "Cluster",
                array("Indexes", "1") + array("Weights", "0.5") +
                    array("TransformLink", "1,0,0,0,0,1,0,0,0,0,1,0,1,0,0,1") +
                    (has_transform ? array("Transform", "1,0,0,0,0,1,0,0,0,0,1,0,-1,0,0,1") : "")) +
         object("Model", 20, "joint", "LimbNode", "Properties70: {\n" + joint + "}\n");
}

TEST_F(Fbx, SkinsFollowTheirJoints) {
  const std::vector<std::pair<int, int>> links = {{1, 10}, {10, 0}, {2, 1}, {3, 2}, {20, 3}, {20, 0}};
  const std::string posed =
      property("Lcl Translation", "1,0,0") + property("Lcl Scaling", "1,1,1") + property("Lcl Rotation", "0,0,180");
  // The corner is where the joint is; the joint is moved, and the node of the mesh has no effect on it.
  const std::string moved = property("Lcl Translation", "5,0,3");
  expect_corners(read(fbx(triangle(1) + model(10, "") + skin(posed, true), links)), 0,
                 {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  expect_corners(
      read(fbx(triangle(1) + model(10, property("GeometricTranslation", "1,0,0")) + skin(posed, true), links)), 0,
      {{1, 0, 0}, {0, 0, 0}, {1, 1, 0}});
  expect_corners(read(fbx(triangle(1) + model(10, "") + skin(moved, true), links)), 0,
                 {{0, 0, 0}, {5, 0, 3}, {0, 1, 0}});
  expect_corners(read(fbx(triangle(1) + model(10, "") + skin(moved, false), links)), 0,
                 {{0, 0, 0}, {5, 0, 3}, {0, 1, 0}});
}

TEST_F(Fbx, ScaleIsInheritedAsTheNodeSays) {
  const auto bounds_of = [&](int inherit) {
    const Scene scene = read(fbx(triangle(1) + model(10, property("Lcl Scaling", "1,3,1")) +
                                     model(11, property("Lcl Rotation", "0,0,90") + property("Lcl Scaling", "2,1,1") +
                                                   property("InheritType", std::to_string(inherit))),
                                 {{10, 0}, {11, 10}, {1, 11}}));
    return scene.bounds_max - scene.bounds_min;
  };
  // The triangle, turned by 90 degrees, is 1 wide (its y) and 2 high (its x).
  const auto expect_size = [&](int inherit, float x, float y) {
    EXPECT_NEAR(bounds_of(inherit).x, x, 1e-5f) << inherit;
    EXPECT_NEAR(bounds_of(inherit).y, y, 1e-5f) << inherit;
  };
  expect_size(1, 1.0f, 6.0f);  // the parent's scale is that of world space
  expect_size(0, 3.0f, 2.0f);  // of the axes of the child
  expect_size(2, 1.0f, 2.0f);  // none
}

TEST_F(Fbx, PivotsAndOrderOfRotations) {
  const auto read_node = [&](const std::string& properties) {
    return read(fbx(triangle(1) + model(10, properties), {{1, 10}, {10, 0}}));
  };
  expect_corners(read_node(property("RotationPivot", "1,0,0") + property("Lcl Rotation", "0,0,90")), 0,
                 {{1, -1, 0}, {1, 0, 0}, {0, -1, 0}});
  expect_corners(read_node(property("ScalingPivot", "1,0,0") + property("Lcl Scaling", "2,2,2")), 0,
                 {{-1, 0, 0}, {1, 0, 0}, {-1, 2, 0}});
  // x first, then z: +y goes to +z and stays.
  expect_corners(read_node(property("Lcl Rotation", "90,0,90")), 0, {{0, 1, 0}, {0, 0, 1}});
  const std::string order = property("RotationOrder", "5") + property("Lcl Rotation", "90,0,90");
  expect_corners(read_node(order), 0, {{0, 0, 1}, {-1, 0, 0}});
  expect_corners(read_node(order + property("RotationActive", "0")), 0, {{0, 1, 0}, {0, 0, 1}});
}

TEST_F(Fbx, AxesGiveUpAndFront) {
  const auto with_axes = [&](const std::string& up, const std::string& front, const std::string& right) {
    const auto axis = [&](const std::string& name, const std::string& value) {
      return property(name, value.substr(1)) + property(name + "Sign", value.substr(0, 1) + "1");
    };
    return read(fbx(triangle(1) + model(10, ""), {{1, 10}, {10, 0}},
                    axis("UpAxis", up) + axis("FrontAxis", front) + axis("CoordAxis", right)));
  };
  const Scene usual = with_axes("+2", "-1", "+0");
  EXPECT_EQ(usual.up, glm::vec3(0, 0, 1));
  EXPECT_TRUE(usual.has_front);
  expect_corners(usual, 0, {{1, 0, 0}, {0, 1, 0}});
  const Scene turned = with_axes("+1", "+0", "-2");  // faces +x: -z is right of it
  EXPECT_EQ(turned.up, glm::vec3(0, 1, 0));
  expect_corners(turned, 0, {{0, 0, 1}, {0, 1, 0}});
  const Scene mirrored = with_axes("+1", "-2", "+0");  // left-handed
  expect_corners(mirrored, 0, {{1, 0, 0}, {0, 1, 0}});
  const Mesh& mesh = mirrored.meshes.at(0);
  const glm::vec3 a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]],
                  c = mesh.positions[mesh.indices[2]];
  EXPECT_LT(glm::cross(b - a, c - a).z, 0.0f) << "the outer side was +z, and is -z where z is turned round";
}

TEST_F(Fbx, MaterialsOfPolygonsAndLayersOfCorners) {
  const std::string geometry =
      object("Geometry", 1, "g", "Mesh",
             array("Vertices", "0,0,0,1,0,0,1,1,0,0,1,0") + array("PolygonVertexIndex", "0,1,-3,0,2,-4") +
                 "LayerElementMaterial: 0 {\nMappingInformationType: \"ByPolygon\"\nReferenceInformationType: "
                 "\"IndexToDirect\"\n" +
                 array("Materials", "0,1") +
                 "}\nLayerElementUV: 0 {\nMappingInformationType: \"ByPolygonVertex\"\nReferenceInformationType: "
                 "\"IndexToDirect\"\n" +
                 array("UV", "0.25,0.5,0.75,1") + array("UVIndex", "0,1,0,1,0,1") + "}\n");
  const auto material = [&](int id, const std::string& color) {
    return object("Material", id, "c" + std::to_string(id), "",
                  "ShadingModel: \"lambert\"\nProperties70: {\n" + property("DiffuseColor", color) +
                      property("DiffuseFactor", "0.5") + "}\n");
  };
  const Scene scene = read(fbx(geometry + model(10, "") + material(5, "1,0,0") + material(4, "0,1,0"),
                               {{1, 10}, {5, 10}, {4, 10}, {10, 0}}));
  ASSERT_EQ(scene.meshes.size(), 2u);
  for (const Mesh& mesh : scene.meshes) {
    const bool is_first = std::any_of(mesh.positions.begin(), mesh.positions.end(),
                                      [](const glm::vec3& p) { return p == glm::vec3(1, 0, 0); });
    EXPECT_EQ(scene.materials.at(std::size_t(mesh.material)).albedo,
              is_first ? glm::vec3(0.5f, 0, 0) : glm::vec3(0, 0.5f, 0));
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  }
  EXPECT_EQ(scene.materials.size(), 2u);
}

// ---- binary files

TEST_F(Fbx, BinaryFilesAreReadAsThoseInText) {
  const Scene scene = read(test::binary_fbx_triangle());
  expect_corners(scene, 0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(scene.meshes.at(0).name, "node");
}

TEST_F(Fbx, DamagedAndOldFilesAreRefused) {
  const std::string binary = test::binary_fbx_triangle();
  for (std::size_t size = 28; size + 20 < binary.size(); size += 7) EXPECT_NE(error_of(binary.substr(0, size)), "");
  EXPECT_NE(error_of(binary.substr(0, 60)).find("cannot be read as FBX"), std::string::npos);
  std::string old = binary;
  old[23] = char(6100 & 255), old[24] = char(6100 >> 8);
  EXPECT_NE(error_of(old).find("its version is 6100"), std::string::npos) << error_of(old);
  EXPECT_NE(error_of("<html></html>").find("is a web page"), std::string::npos) << error_of("<html></html>");
  // A record that ends before its value does: going back there would read the bytes of the value again, as records.
  const auto with_end_before = [](std::size_t at) {
    std::string overlapping = test::fbx_record(at, "X", test::fbx_text_value(""), 1);
    constexpr std::size_t kSizeOfText = 4;
    overlapping[overlapping.size() - kSizeOfText] = 9;
    return overlapping;
  };
  EXPECT_NE(error_of(test::binary_fbx_triangle(with_end_before)).find("damaged"), std::string::npos);
  const std::string text = fbx(triangle(1) + model(10, ""), {{1, 10}, {10, 0}, {10, 10}, {10, 1}, {99, 10}});
  EXPECT_EQ(read(text).meshes.size(), 1u) << "connections of a circle, and of what does not exist";
}

}  // namespace
}  // namespace umbrage
