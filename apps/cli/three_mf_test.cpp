// 3MF: units, transforms, components, materials and colours are those of the file; formats that are not read are named.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "archives.h"
#include "run_program.h"

namespace umbrage::test {
namespace {

class ThreeMf : public ProgramTest {
 protected:
  /// Writes a file and returns the records of `info --json`.
  nlohmann::json info(const std::string& file) {
    write("model.3mf", file);
    return nlohmann::json::parse(good("info model.3mf --json").out, nullptr, false);
  }
  nlohmann::json records(const nlohmann::json& all, const std::string& what) {
    nlohmann::json found = nlohmann::json::array();
    for (const auto& each : all)
      if (each["what"] == what) found.push_back(each);
    return found;
  }
  void expect_box(const nlohmann::json& all, const std::array<double, 6>& box) {
    const auto model = all.at(0);
    const char* names[] = {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z"};
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(model[names[k]].get<double>(), box[k], 1e-3) << names[k];
  }
};

TEST_F(ThreeMf, UnitsAreConvertedToMillimetres) {
  for (const auto& [unit, length] : {std::pair("micron", 0.001),
                                     {"millimeter", 1.0},
                                     {"centimeter", 10.0},
                                     {"inch", 25.4},
                                     {"foot", 304.8},
                                     {"meter", 1000.0}}) {
    SCOPED_TRACE(unit);
    const auto all = info(three_mf_of(object_3mf(cube_3mf(10.0)), unit));
    expect_box(all, {0, 0, 0, 10 * length, 10 * length, 10 * length});
    EXPECT_EQ(all.at(0)["units"], "mm");
    EXPECT_EQ(all.at(0)["up"], "+Z");
  }
}

TEST_F(ThreeMf, TransformsAndComponentsPlaceObjects) {
  const std::string resources = "<resources><object id=\"1\">" + cube_3mf(10.0) +
                                "</object><object id=\"2\"><components><component objectid=\"1\"/>"
                                "<component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 40 0 0\"/></components>"
                                "</object><object id=\"3\">" +
                                cube_3mf(90.0) + "</object></resources>";
  const auto all =
      info(three_mf_of(resources + "<build><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 2 0 0 5\"/></build>"));
  expect_box(all, {0, 0, 5, 40, 10, 25});
  EXPECT_EQ(all.at(0)["triangles"], 24) << "an object outside of the build is not drawn";
  EXPECT_EQ(all.at(0)["objects"], 2);
}

TEST_F(ThreeMf, ComponentsThatMultiplyAreRefused) {
  std::string objects = "<object id=\"0\"/>";
  for (int level = 1; level <= 60; ++level) {
    const std::string lower = "<component objectid=\"" + std::to_string(level - 1) + "\"/>";
    objects += "<object id=\"" + std::to_string(level) + "\"><components>" + lower + lower + "</components></object>";
  }
  write("model.3mf", three_mf_of("<resources>" + objects + "</resources><build><item objectid=\"60\"/></build>"));
  bad("model.3mf -o out.png", 3, {"its objects are placed more than 1000000 times"});
}

TEST_F(ThreeMf, PartsInOtherFilesAreRead) {
  const std::string part =
      "<?xml version=\"1.0\"?><model><resources><object id=\"7\">" + cube_3mf(5.0) + "</object></resources></model>";
  const auto all = info(three_mf_of(
      "<resources><object id=\"1\"><components><component q:path=\"/3D/Objects/a.model\" objectid=\"7\"/></components>"
      "</object></resources><build><item objectid=\"1\"/></build>",
      "millimeter", {{"3D/Objects/a.model", part}}));
  expect_box(all, {0, 0, 0, 5, 5, 5});
}

TEST_F(ThreeMf, MaterialsAndColorsAreThoseOfTriangles) {
  const std::string bases =
      "<basematerials id=\"5\"><base name=\"Red\" displaycolor=\"#FF0000\"/><base name=\"Blue\" "
      "displaycolor=\"#0000FFFF\"/></basematerials>";
  const auto mixed = [](int k) { return std::string(k < 2 ? "pid=\"5\" p1=\"1\"" : ""); };
  auto all = info(three_mf_of("<resources>" + bases + "<object id=\"1\" pid=\"5\" pindex=\"0\">" +
                              cube_3mf(1.0, {}, mixed) + "</object></resources><build><item objectid=\"1\"/></build>"));
  const auto meshes = records(all, "mesh"), materials = records(all, "material");
  ASSERT_EQ(meshes.size(), 2u);
  EXPECT_EQ(meshes[0]["triangles"], 10);
  EXPECT_EQ(materials[meshes[0]["material"].get<int>()]["albedo_r"], 1.0);
  EXPECT_EQ(meshes[1]["triangles"], 2);
  EXPECT_EQ(materials[meshes[1]["material"].get<int>()]["albedo_b"], 1.0);

  const auto colored = [](int k) { return std::string(k < 6 ? "pid=\"7\" p1=\"0\"" : "pid=\"7\" p1=\"1\""); };
  all =
      info(three_mf_of("<resources><m:colorgroup id=\"7\"><m:color color=\"#00FF00\"/><m:color color=\"#FF00FF\"/>"
                       "</m:colorgroup><object id=\"1\">" +
                       cube_3mf(1.0, {}, colored) + "</object></resources><build><item objectid=\"1\"/></build>"));
  EXPECT_EQ(records(all, "mesh").at(0)["colors"], true);
  good("model.3mf -o out.png --resolution 32 --look ao --passes albedo");
  const Image picture = image("out.png");
  int green = 0, magenta = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const float r = picture.plane("color.r").at(x, y), g = picture.plane("color.g").at(x, y);
      green += g > 0.99f && r<0.01f, magenta += r> 0.99f && g < 0.01f;
    }
  EXPECT_GT(green, 20);
  EXPECT_GT(magenta, 20);
}

TEST_F(ThreeMf, DamagedFilesAreRefused) {
  const std::string whole = three_mf_of(object_3mf(cube_3mf(1.0)));
  for (std::size_t size = 1; size < whole.size(); size += 211) {
    write("cut.3mf", whole.substr(0, size));
    bad("cut.3mf -o out.png", 3, {"'cut.3mf' cannot be read as 3MF"});
  }
  const auto refused = [&](const std::string& model, const std::string& reason) {
    write("wrong.3mf", three_mf_of(model));
    bad("wrong.3mf -o out.png", 3, {"'wrong.3mf'", reason});
  };
  refused("<resources", "invalid XML");
  refused("<build><item objectid=\"4\"/></build>", "has no object '4'");
  refused("<resources/>", "has no triangles");
  refused(
      "<resources><object id=\"1\"><components><component objectid=\"1\"/></components></object></resources><build>"
      "<item objectid=\"1\"/></build>",
      "contain each other");
  write("empty.3mf", zip_of({{"a.txt", "hello"}}));
  bad("empty.3mf -o out.png", 3, {"'3D/3dmodel.model' is missing"});
  std::string far = object_3mf(cube_3mf(1.0));
  far.replace(far.find("v1=\"0\""), 6, "v1=\"9\"");
  write("far.3mf", three_mf_of(far));
  const Outcome outcome = run("far.3mf -o out.png --resolution 32 --look ao");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("1 triangles have vertex indices out of range"), std::string::npos) << outcome.err;
}

TEST_F(ThreeMf, FormatsThatAreNotReadAreNamed) {
  for (const auto& [format, advice] : {std::pair("step", "FreeCAD"),
                                       {"STP", "FreeCAD"},
                                       {"usdz", ".glb"},
                                       {"blend", "Blender"},
                                       {"amf", ".3mf"},
                                       {"wrl", ".glb"},
                                       {"x3d", ".glb"},
                                       {"zip", "unpack"}}) {
    const std::string name = std::string("model.") + format;
    write(name, "x");
    bad(name + " -o out.png", 3, {"'" + name + "' is ", "that is not read", advice});
  }
}

}  // namespace
}  // namespace umbrage::test
