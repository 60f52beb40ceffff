// Material libraries: options of maps, transparency, and wrong values.
#include "scene/readers/mtl.h"

#include <gtest/gtest.h>

#include "scene/readers/obj_text.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

MtlLibrary library(std::string text) {
  normalize_lines(text);
  return read_mtl(text, "a.mtl");
}

MtlMaterial material(const std::string& lines) {
  const MtlLibrary read = library("newmtl m\n" + lines);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings[0];
  EXPECT_EQ(read.materials.size(), 1u);
  return read.materials.at(0);
}

TEST(Mtl, ReadsOptionsOfMapsInAnyPlace) {
  for (const char* line : {"map_Kd -s 4 2 1 -o 0.5 -0.25 0 my tex.png", "map_Kd my tex.png -o 0.5 -0.25 -s 4 2",
                           "MAP_KD -blendu on -s 4 2 1 \"my tex.png\" -o 0.5 -0.25 0 -cc off -texres 512",
                           "map_Kd\t-o 0.5 -0.25 -s 4 2 -colorspace sRGB my tex.png"}) {
    SCOPED_TRACE(line);
    const MtlMap map = material(line).maps[kMapKd];
    EXPECT_EQ(map.file, "my tex.png");
    EXPECT_EQ(map.scale, glm::vec2(4, 2));
    EXPECT_EQ(map.offset, glm::vec2(0.5f, -0.25f));
  }
  const MtlMaterial all = material(
      "bump -bm 2.5 -imfchan l -mm 0.1 0.8 b.png\nmap_d -imfchan m -clamp on d.png\nnorm n.png\nmap_Ke e.png\n"
      "map_Pr -s 3 r.png\nmap_Pm m-2.png\nmap_Kd\n");
  EXPECT_EQ(all.maps[kMapBump].bump, 2.5f);
  EXPECT_EQ(all.maps[kMapBump].channel, 'l');
  EXPECT_EQ(all.maps[kMapBump].base, 0.1f);
  EXPECT_EQ(all.maps[kMapBump].gain, 0.8f);
  EXPECT_EQ(all.maps[kMapD].channel, 'm');
  EXPECT_TRUE(all.maps[kMapD].clamp);
  EXPECT_EQ(all.maps[kMapPr].scale, glm::vec2(3, 1));
  EXPECT_EQ(all.maps[kMapPm].file, "m-2.png");
  EXPECT_TRUE(all.maps[kMapKd].file.empty());
  EXPECT_TRUE(all.ignored.empty());
}

TEST(Mtl, SeparatesNamesOfMapsFromCommentsAndOptions) {
  const auto name_of = [](const std::string& words) { return material("map_Kd " + words + "\n").maps[kMapKd].file; };
  EXPECT_EQ(name_of("wood.png # oak"), "wood.png");
  EXPECT_EQ(name_of("wood #2.png #oak"), "wood #2.png");
  EXPECT_EQ(name_of("\"a b.png\" foo"), "a b.png");
  EXPECT_EQ(name_of("\"a b\" # -s 2"), "a b");
  EXPECT_EQ(name_of("\"a b.png"), "a b.png");
  EXPECT_EQ(name_of("\""), "");
  EXPECT_EQ(name_of("-gamma 2.2 my wood.png"), "my wood.png");
  EXPECT_EQ(name_of("-space sRGB my wood.png"), "my wood.png");
  EXPECT_EQ(name_of("-flag wood.png # oak"), "wood.png");
  EXPECT_EQ(name_of("-flag wood"), "wood");
}

TEST(Mtl, NamesWhatIsNotDrawn) {
  EXPECT_EQ(material("map_Ks s.png\ndisp d.png\nPc 0.5\nPs 0\nKa 1 1 1\nmap_Ka a.png\nmap_Kd -t 1 1 1 a.png\n").ignored,
            (std::vector<std::string>{"map_Ks", "disp", "Pc", "-t (turbulence) of maps"}));
}

TEST(Mtl, KeepsDefaultsForWrongNumbers) {
  const MtlLibrary read = library(
      "newmtl m\nKd 0.5 x 0.5\nKs 0.2\nNs nan\nPr 3\nd 0.5 # half\nillum two\nfoo 1\n\nKe 1 2\nPm -1\nTf 2 1 1\n");
  ASSERT_EQ(read.warnings.size(), 3u);
  EXPECT_EQ(read.warnings[0],
            "'a.mtl' has something other than a number in line 2 ('Kd 0.5 x 0.5') and in 3 other lines; the default "
            "applies");
  EXPECT_NE(read.warnings[1].find("out of range in line 5 ('Pr 3') and in 2 other lines"), std::string::npos);
  EXPECT_NE(read.warnings[2].find("line 8 ('foo')"), std::string::npos);
  const MtlMaterial& material = read.materials.at(0);
  EXPECT_FALSE(material.diffuse);
  EXPECT_EQ(material.specular, glm::vec3(0.2f));
  EXPECT_FALSE(material.exponent);
  EXPECT_EQ(material.roughness, 1.0f);
  EXPECT_EQ(material.metallic, 0.0f);
  EXPECT_EQ(material.opacity, 0.5f);
  EXPECT_EQ(material.filter, glm::vec3(1.0f));
  EXPECT_EQ(library("Kd 1 1 1\nnewmtl a\nKd 1 0 0\nnewmtl a\nNs 3\n").materials.size(), 1u);
}

TEST(Mtl, MakesTransparentMaterialsBlended) {
  const auto of = [&](const std::string& lines) { return material_of(material(lines)); };
  for (const char* opaque : {"d 1\n", "Tr 0\n", "d 0\nTr 0\n", "d 1\nTr 1\n", "", "Tf 0.5 0.5 0.5\nillum 2\n",
                             "illum 4\n", "illum 4\nKd 0.5 0.5 0.5\nTf 1.00 1.00 1.00\nNi 1.00\n" /* Maya */}) {
    EXPECT_FALSE(of(opaque).blended) << opaque;
    EXPECT_EQ(of(opaque).opacity, 1.0f) << opaque;
  }
  EXPECT_TRUE(of("d 0.15\n").blended);
  EXPECT_EQ(of("d 0.15\n").opacity, 0.15f);
  EXPECT_EQ(of("Tr 0.25\n").opacity, 0.75f);
  EXPECT_EQ(of("d -halo 0.5\n").opacity, 0.5f);
  EXPECT_EQ(of("d 0.5\nTf 1 0.5 0\n").tint, glm::vec3(1, 0.5f, 0));
  for (const char* model : {"4", "6", "7", "9"}) {
    const Material glass = of(std::string("d 1\nTf 0.5 1 1\nNi 1.5\nillum ") + model + "\n");
    EXPECT_TRUE(glass.blended) << model;
    EXPECT_GT(glass.opacity, 0.0f) << "a pane remains visible";
    EXPECT_LT(glass.opacity, 0.3f);
    EXPECT_EQ(glass.tint, glm::vec3(0.5f, 1, 1));
  }
  EXPECT_FALSE(of("Tr 1\n").blended) << "some programs write the opacity as Tr";
  EXPECT_TRUE(is_invisible_by_tr(material("Tr 1\n")));
  EXPECT_FALSE(is_invisible_by_tr(material("Tr 1\nd 0\n")));
  EXPECT_EQ(of("d 0\n").opacity, 0.0f);
}

TEST(Mtl, HighlightsAreAsStrongAsTheStrongestChannel) {
  const auto of = [&](const std::string& lines) { return material_of(material("Ks 0.25 0.75 0.5\n" + lines)); };
  EXPECT_EQ(of("Ns 30\nillum 2\n").specular_strength, 0.75f);
  EXPECT_EQ(of("Ns 30\nillum 2\n").specular_exponent, 30.0f);
  EXPECT_EQ(of("Ns 30\nillum 4\nNi 1.5\n").specular_strength, 0.75f) << "glass";
  for (const char* none : {"Ns 30\nillum 1\n", "Ns 30\nillum 3\n", "Ns 0\nillum 2\n", "illum 2\n"})
    EXPECT_EQ(of(none).specular_strength, 0.0f) << none;
  EXPECT_EQ(of("Ns 1e6\nillum 2\n").specular_exponent, kMaxExponent);
  EXPECT_EQ(of("Ns 0.5\nillum 2\n").specular_exponent, kMinExponent);
}

TEST(Mtl, HasDefaultColors) {
  EXPECT_EQ(material_of(material("")).albedo, glm::vec3(0.8f));
  EXPECT_EQ(material_of(material("map_Kd a.png")).albedo, glm::vec3(1.0f));
}

}  // namespace
}  // namespace umbrage
