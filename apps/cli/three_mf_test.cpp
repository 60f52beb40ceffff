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
  bad("model.3mf -o out.png", 3, {"its objects are placed more than 100000 times"});
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

/// Returns the object 1, two cubes in one mesh: from 0 to 1, triangles 0 to 11, and from -5 to 5.
std::string two_cubes(const std::string& attributes = "") {
  std::string small = cube_3mf(1.0), large = cube_3mf(10.0, {-5, -5, -5});
  const auto part = [](const std::string& of, const std::string& name) {
    const std::size_t start = of.find("<" + name + ">") + name.size() + 2;
    return of.substr(start, of.find("</" + name + ">") - start);
  };
  std::string triangles = part(large, "triangles");
  for (int v = 7; v >= 0; --v)
    for (const char* corner : {"v1", "v2", "v3"}) {
      const std::string old = std::string(corner) + "=\"" + std::to_string(v) + "\"";
      for (std::size_t at = 0; (at = triangles.find(old, at)) != std::string::npos; ++at)
        triangles.replace(at, old.size(), std::string(corner) + "=\"" + std::to_string(v + 8) + "\"");
    }
  return "<object id=\"1\" " + attributes + "><mesh><vertices>" + part(small, "vertices") + part(large, "vertices") +
         "</vertices><triangles>" + part(small, "triangles") + triangles + "</triangles></mesh></object>";
}

constexpr const char* kBuild = "<build><item objectid=\"1\"/></build>";
constexpr std::array<double, 6> kSmall = {0, 0, 0, 1, 1, 1}, kLarge = {-5, -5, -5, 5, 5, 5};

TEST_F(ThreeMf, VolumesOfSlicersThatAreNotTheModelAreLeftOut) {
  const auto config = [](const std::string& kind) {
    return "<config><object id=\"1\"><volume firstid=\"0\" lastid=\"11\"/><volume firstid=\"12\" lastid=\"23\">" +
           kind + "</volume></object></config>";
  };
  for (const auto& [kind, name] : {std::pair("ParameterModifier", "modifiers"),
                                   {"SupportBlocker", "support blockers"},
                                   {"SupportEnforcer", "support enforcers"},
                                   {"NegativeVolume", "negative volumes, which are not cut out"}}) {
    const auto all = info(
        three_mf_of("<resources>" + two_cubes() + "</resources>" + kBuild, "millimeter",
                    {{"Metadata/Slic3r_PE_model.config",
                      config("<metadata type=\"volume\" key=\"volume_type\" value=\"" + std::string(kind) + "\"/>")}}));
    expect_box(all, kSmall);
    ASSERT_EQ(records(all, "warning").size(), 1u);
    EXPECT_NE(all.dump().find("the file's " + std::string(name) + " are left out"), std::string::npos) << all.dump();
  }
  const std::string plain = "<metadata key=\"volume_type\" value=\"ModelPart\"/>",
                    old = "<metadata key=\"modifier\" value=\"1\"/>";
  const std::string model = "<resources>" + two_cubes() + "</resources>" + kBuild;
  expect_box(info(three_mf_of(model, "millimeter", {{"Metadata/Slic3r_PE_model.config", config(plain)}})), kLarge);
  expect_box(info(three_mf_of(model, "millimeter", {{"Metadata/Slic3r_PE_model.config", config(old)}})), kSmall);
}

TEST_F(ThreeMf, PartsOfObjectsThatAreNotTheModelAreLeftOut) {
  const auto model = [](const std::string& of_large, const std::string& inside = "") {
    return "<resources><object id=\"7\">" + cube_3mf(1.0) + "</object><object id=\"8\" " + of_large + ">" + inside +
           cube_3mf(10.0, {-5, -5, -5}) +
           "</object><object id=\"1\"><components><component objectid=\"7\"/><component objectid=\"8\"/></components>"
           "</object></resources>" +
           kBuild;
  };
  for (const char* kind : {"modifier_part", "negative_part", "support_blocker", "support_enforcer", "normal_part"}) {
    const std::string config =
        "<config><object id=\"1\"><part id=\"7\" subtype=\"normal_part\"/><part id=\"8\" subtype=\"" +
        std::string(kind) + "\"/></object></config>";
    expect_box(info(three_mf_of(model(""), "millimeter", {{"Metadata/model_settings.config", config}})),
               std::string(kind) == "normal_part" ? kLarge : kSmall);
  }
  for (const char* type : {"support", "solidsupport", "surface", "other"})
    expect_box(info(three_mf_of(model("type=\"" + std::string(type) + "\""))), kSmall);
  expect_box(info(three_mf_of(model("type=\"model\""))), kLarge);
  expect_box(info(three_mf_of(
                 model("", "<metadatagroup><metadata name=\"cura:infill_mesh\">True</metadata></metadatagroup>"))),
             kSmall);
  const auto all = info(three_mf_of("<resources>" + two_cubes("type=\"surface\"") + "</resources>" + kBuild));
  expect_box(all, kLarge);
  EXPECT_NE(all.dump().find("the file has only surfaces; they are drawn"), std::string::npos) << all.dump();
}

TEST_F(ThreeMf, PartsHaveTheColorsOfTheirFilaments) {
  const std::string volumes =
      "<config><object id=\"1\"><metadata key=\"extruder\" value=\"1\"/><volume firstid=\"0\" lastid=\"11\"/><volume "
      "firstid=\"12\" lastid=\"23\"><metadata key=\"extruder\" value=\"2\"/></volume></object></config>";
  const auto expect_colors = [&](const std::string& name, const std::string& settings, int first, int second) {
    const auto all = info(three_mf_of("<resources>" + two_cubes() + "</resources>" + kBuild, "millimeter",
                                      {{"Metadata/Slic3r_PE_model.config", volumes}, {"Metadata/" + name, settings}}));
    const auto meshes = records(all, "mesh"), materials = records(all, "material");
    ASSERT_EQ(meshes.size(), 2u);
    const char* const kChannels[] = {"albedo_r", "albedo_g", "albedo_b"};
    EXPECT_EQ(materials[meshes[0]["material"].get<int>()][kChannels[first]], 1.0) << all.dump();
    EXPECT_EQ(materials[meshes[1]["material"].get<int>()][kChannels[second]], 1.0) << all.dump();
  };
  expect_colors("project_settings.config", R"({"filament_colour":["#FF0000","#0000FF"]})", 0, 2);
  expect_colors("Slic3r_PE.config", "; filament_colour = #FF0000;#0000FF\n; extruder_colour = \"\";\"\"\n", 0, 2);
  expect_colors("Slic3r_PE.config", "; extruder_colour = \"\";#00FF00\n; filament_colour = #FF0000;#0000FF\n", 0, 1);
}

TEST_F(ThreeMf, BeamsAreDrawn) {
  const auto lattice = [](const std::string& attributes, const std::string& more = "") {
    return "<resources><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"20\" y=\"0\" "
           "z=\"0\"/>"
           "</vertices><triangles/><b:beamlattice radius=\"2\" " +
           attributes + "><b:beams><b:beam v1=\"0\" v2=\"1\" r1=\"1\" r2=\"2\"/><b:beam v1=\"0\" v2=\"9\"/></b:beams>" +
           more + "</b:beamlattice></mesh></object></resources>" + kBuild;
  };
  expect_box(info(three_mf_of(lattice(""))), {-1, -2, -2, 22, 2, 2});
  expect_box(info(three_mf_of(lattice("cap=\"butt\""))), {0, -2, -2, 20, 2, 2});
  expect_box(info(three_mf_of(lattice("cap=\"butt\"", "<b:balls><b:ball vindex=\"0\" r=\"3\"/></b:balls>"))),
             {-3, -3, -3, 20, 3, 3});
}

TEST_F(ThreeMf, WhatIsNotReadIsNamed) {
  const std::string stack = "<s:slicestack id=\"2\"/>", mesh = "<object id=\"1\">" + cube_3mf(1.0) + "</object>";
  write("slices.3mf", three_mf_of("<resources>" + stack + mesh + "</resources>" + kBuild));
  EXPECT_NE(good("info slices.3mf").out.find("the file's slices are not drawn"), std::string::npos);
  write("only.3mf", three_mf_of("<resources>" + stack + "<object id=\"1\"/></resources>" + kBuild));
  bad("only.3mf -o out.png", 3, {"it has only slices"});
  const auto model_with = [&](const std::string& required) {
    return info(zip_of({{"3D/3dmodel.model",
                         "<model xmlns:v=\"http://x/volumetric/2022/01\" xmlns:m=\"http://x/material/2015/02\" "
                         "requiredextensions=\"" +
                             required + "\"><resources>" + mesh + "</resources>" + kBuild + "</model>"}}));
  };
  EXPECT_NE(model_with("m v").dump().find("the extension 'http://x/volumetric/2022/01'"), std::string::npos);
  EXPECT_EQ(records(model_with("m"), "warning").size(), 0u);
}

TEST_F(ThreeMf, AModelOfTransparentColorsIsDrawnOpaque) {
  const auto with_alpha = [&](const std::string& second) {
    const auto mixed = [](int k) { return std::string(k < 2 ? "pid=\"5\" p1=\"1\"" : ""); };
    write("model.3mf", three_mf_of("<resources><basematerials id=\"5\"><base displaycolor=\"#FF000000\"/><base "
                                   "displaycolor=\"#0000FF" +
                                   second + "\"/></basematerials><object id=\"1\" pid=\"5\" pindex=\"0\">" +
                                   cube_3mf(1.0, {}, mixed) + "</object></resources>" + kBuild));
    return good("info model.3mf").out;
  };
  EXPECT_NE(with_alpha("00").find("they are drawn opaque"), std::string::npos);
  EXPECT_EQ(with_alpha("FF").find("they are drawn opaque"), std::string::npos);
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
  std::string changed = whole;
  changed[changed.find("vertex x=\"") + 10] ^= 1;
  write("changed.3mf", changed);
  bad("changed.3mf -o out.png", 3, {"'3D/3dmodel.model' is damaged"});
  std::string far = object_3mf(cube_3mf(1.0));
  far.replace(far.find("v1=\"0\""), 6, "v1=\"9\"");
  write("far.3mf", three_mf_of(far));
  const Outcome outcome = run("far.3mf -o out.png --resolution 32 --look ao");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("1 triangles have vertex indices out of range"), std::string::npos) << outcome.err;
}

TEST_F(ThreeMf, ObjectsOfAnEmptyBuildAreDrawn) {
  const auto all =
      info(three_mf_of("<resources><object id=\"1\">" + cube_3mf(10.0) +
                       "</object><object id=\"2\"><components><component objectid=\"1\" "
                       "transform=\"1 0 0 0 1 0 0 0 1 40 0 0\"/></components></object></resources><build/>"));
  expect_box(all, {40, 0, 0, 50, 10, 10});
  EXPECT_EQ(records(all, "warning").at(0)["text"], "the file's build is empty; all objects are drawn");
}

TEST_F(ThreeMf, MillimetresAndMetresInOneSceneAreNamed) {
  write("mm.3mf", three_mf_of(object_3mf(cube_3mf(10.0))));
  write("m.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  EXPECT_NE(good("info mm.3mf m.gltf").out.find("as 'm.gltf': it is in mm, the other in m, and neither is scaled"),
            std::string::npos);
}

TEST_F(ThreeMf, FormatsThatAreNotReadAreNamed) {
  for (const auto& [format, advice] : {std::pair("brep", "FreeCAD"),
                                       {"FCStd", "FreeCAD"},
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
