// Tests of umbrage shade on single files: outputs, passes, and files and options that are refused. Pictures from the
// planes that umbrage render writes equal the rendered ones, and the look `comp` leaves a picture without occlusion as
// it is.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "cli_support.h"
#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::text_of;

const std::string kSolids = "scene:solids?detail=2000 --device cpu --resolution 64x48 ";

class ShadeTest : public test::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    good(kSolids + "--passes depth,normal,albedo -o g.exr");
  }
  /// Writes g.exr with `count` bytes from `at` on, relative to the first occurrence of `after`, replaced by `bytes`.
  void write_patched(const std::string& name, const std::string& after, std::size_t at, const std::string& bytes) {
    std::string content = text_of(folder_ / "g.exr");
    const std::size_t start = content.find(after);
    ASSERT_NE(start, std::string::npos);
    content.replace(start + at, bytes.size(), bytes);
    write(name, content);
  }
  /// Writes a PFM with one channel: 64 x 48 pixels of this depth.
  void write_depth(const std::string& name, float depth, int width = 64, int height = 48) {
    std::string bytes = fmt::format("Pf\n{} {}\n-1.0\n", width, height);
    for (int k = 0; k < width * height; ++k) bytes.append(reinterpret_cast<const char*>(&depth), sizeof depth);
    write(name, bytes);
  }
};

TEST_F(ShadeTest, SaysThatAFileHasNoHiddenLines) {
  const std::string command = "shade g.exr --look technical -o a.png --device cpu";
  good(command);
  const auto outcome = run(command + " --set hidden.draw=on");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("hidden draws nothing: the picture has one layer"), std::string::npos) << outcome.err;
}

TEST_F(ShadeTest, WritesPictures) {
  good("shade g.exr -o a.png --device cpu");
  const Image a = image("a.png");
  EXPECT_EQ(a.width, 64);
  EXPECT_EQ(a.height, 48);
  EXPECT_EQ(a.planes.size(), 3u);
  good("g.exr -o b.png --device cpu");
  EXPECT_EQ(text_of(folder_ / "a.png"), text_of(folder_ / "b.png")) << "an image as first word is shaded";
  EXPECT_EQ(good("shade g.exr -o - --device cpu").out, text_of(folder_ / "a.png"));
  const std::string from_input = fmt::format("cd {} && {} shade - -o i.png --device cpu <g.exr",
                                             test::quoted(folder_.string()), test::quoted(test::kProgram));
  EXPECT_EQ(std::system(from_input.c_str()), 0);
  EXPECT_EQ(text_of(folder_ / "i.png"), text_of(folder_ / "a.png"));
  for (const auto& [name, start] :
       {std::pair("c.jpg", "\xff\xd8"), {"c.webp", "RIFF"}, {"c.exr", "v/1"}, {"c.pfm", "PF"}}) {
    good(fmt::format("shade g.exr --device cpu -o {}", name));
    EXPECT_TRUE(text_of(folder_ / name).starts_with(start)) << name;
  }
  EXPECT_EQ(image("c.exr").width, 64);
  good("shade g.exr -o d.png --device cpu --no-background --bits 16");
  EXPECT_EQ(image("d.png").planes.size(), 4u);
  // The picture shows the surfaces: it is not one colour.
  const Plane& red = a.planes[0];
  float darkest = 1.0f, brightest = 0.0f;
  for (int y = 0; y < red.height; ++y)
    for (int x = 0; x < red.width; ++x) {
      darkest = std::min(darkest, red.at(x, y));
      brightest = std::max(brightest, red.at(x, y));
    }
  EXPECT_GT(brightest - darkest, 0.3f);
}

TEST_F(ShadeTest, KeepsTheAlphaOfAFinishedPicture) {
  good(kSolids + "--look lit --no-background --passes color,depth,normal -o b.exr");
  good("shade b.exr -o b.png --device cpu");
  const Image given = image("b.exr"), written = image("b.png");
  ASSERT_TRUE(written.find("color.a"));
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      EXPECT_NEAR(written.plane("color.a").at(x, y), given.plane("color.a").at(x, y), 1.0f / 255.0f);
  good("shade b.exr -o b.jpg --device cpu");
  good("shade b.exr -o studio.png --device cpu --look studio");
  EXPECT_FALSE(image("studio.png").find("color.a"));
}

TEST_F(ShadeTest, WritesPasses) {
  good("shade g.exr -o p.exr --device cpu --passes color,ao,depth,normal");
  const Image given = image("g.exr"), written = image("p.exr");
  for (const char* plane : {"color.r", "color.a", "ao", "depth", "normal.x", "normal.z"})
    EXPECT_TRUE(written.find(plane)) << plane;
  EXPECT_FALSE(written.find("albedo.r"));
  int surfaces = 0, occluded = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const float depth = given.plane("depth").at(x, y);
      EXPECT_EQ(std::isfinite(written.plane("depth").at(x, y)), std::isfinite(depth));
      if (!std::isfinite(depth)) continue;
      EXPECT_NEAR(written.plane("depth").at(x, y), depth, 1e-4f * depth);
      ++surfaces;
      occluded += written.plane("ao").at(x, y) < 0.9f;
    }
  EXPECT_GT(surfaces, 500);
  EXPECT_GT(occluded, 50);
  good("shade g.exr -o all.exr --device cpu --passes all");
  for (const char* plane : {"color.r", "ao", "depth", "albedo.g"}) EXPECT_TRUE(image("all.exr").find(plane)) << plane;
  good("shade g.exr -o ao.png --device cpu --look ao --passes ao");
  EXPECT_EQ(image("ao.png").planes.size(), 1u);
}

TEST_F(ShadeTest, MergesResultsIntoACopyOfTheInput) {
  good("shade g.exr -o m.exr --device cpu --merge --passes ao,color");
  good("shade g.exr -o p.exr --device cpu --passes ao,color");
  const Image given = image("g.exr"), merged = image("m.exr"), alone = image("p.exr");
  const auto expect_equal = [](const Image& a, const std::string& plane, const Image& b, const std::string& other) {
    ASSERT_TRUE(a.find(plane)) << plane;
    ASSERT_TRUE(b.find(other)) << other;
    for (int y = 0; y < a.height; ++y)
      EXPECT_EQ(std::memcmp(a.plane(plane).row(y), b.plane(other).row(y), std::size_t(a.width) * sizeof(float)), 0)
          << plane << " row " << y;
  };
  for (const std::string& plane : given.names) expect_equal(merged, plane, given, plane);
  expect_equal(merged, "umbrage.ao", alone, "ao");
  expect_equal(merged, "umbrage.color.r", alone, "color.r");
  EXPECT_EQ(merged.planes.size(), given.planes.size() + 1 + 4);
  // All results, of a sequence.
  fs::copy_file(folder_ / "g.exr", folder_ / "s.0001.exr");
  good("shade s.####.exr -o t.####.exr --device cpu --merge --half");
  const Image all = image("t.0001.exr");
  for (const char* plane : {"depth", "albedo.g", "umbrage.ao", "umbrage.color.a"})
    EXPECT_TRUE(all.find(plane)) << plane;
  EXPECT_FALSE(all.find("umbrage.depth"));
}

TEST_F(ShadeTest, PrintsTimesAndFacts) {
  const Outcome json = good("shade g.exr -o a.png --device cpu --json");
  EXPECT_NE(json.out.find("\"stage\": \"read\""), std::string::npos) << json.out;
  EXPECT_NE(json.out.find("\"stage\": \"total\""), std::string::npos) << json.out;
  const Outcome verbose = run("shade g.exr -o a.png --device cpu --verbose");
  EXPECT_EQ(verbose.code, 0);
  for (const char* text : {"depth", "cpu: ", "total"}) EXPECT_NE(verbose.err.find(text), std::string::npos) << text;
}

TEST_F(ShadeTest, RefusesBrokenFiles) {
  const std::string whole = text_of(folder_ / "g.exr");
  for (int part = 0; part < 16; ++part) {
    write("cut.exr", whole.substr(0, whole.size() * std::size_t(part) / 16));
    bad("shade cut.exr -o out.png --device cpu", 3, {"cut.exr"});
  }
  write("magic.exr", "v/1\2" + whole.substr(4));
  bad("shade magic.exr -o out.png", 3, {"magic.exr"});
  bad("shade nothere.exr -o out.png", 3, {"nothere.exr"});
  bad("shade . -o out.png", 3, {"."});
  // Claims of 160000 x 160000 pixels, 100 GB, in the data window and in the display window.
  const std::int32_t far_corner[2] = {159999, 159999};
  const std::string claim(reinterpret_cast<const char*>(far_corner), sizeof far_corner);
  for (const char* window : {"dataWindow", "displayWindow"}) {
    constexpr std::size_t kCorner = sizeof "box2i" + 4 + 8;  // type, size of the value, near corner
    write_patched("claim.exr", window, std::strlen(window) + 1 + kCorner, claim);
    bad("shade claim.exr -o out.png", 3, {"claim.exr"});
  }
  write("huge.pfm", "Pf\n160000 160000\n-1.0\n");
  bad("shade huge.pfm -o out.png", 3, {"huge.pfm"});
  write("zero.pfm", "Pf\n0 0\n-1.0\n");
  bad("shade zero.pfm -o out.png", 3, {"zero.pfm"});
}

TEST_F(ShadeTest, RefusesFilesWithoutDepth) {
  good(kSolids + "--passes albedo,normal -o nodepth.exr");
  bad("shade nodepth.exr -o out.png", 3, {"nodepth.exr", "depth", "albedo", "normal"});
  bad("shade g.exr --depth g.exr:nosuch -o out.png", 2, {"'nosuch'", "albedo (RGB)", "depth (Z)"});
  write_depth("small.pfm", 4.0f, 32, 24);
  bad("shade g.exr --depth small.pfm -o out.png", 2, {"32 x 24", "64 x 48"});
}

TEST_F(ShadeTest, PlanesWithoutValuesAreDefined) {
  // No pixel has a surface: a picture of the background, or a sentence that there is none.
  for (const float depth : {std::nanf(""), std::numeric_limits<float>::infinity(), 0.0f}) {
    write_depth("none.pfm", depth);
    const Outcome plain = run("shade none.pfm -o out.png --device cpu");
    EXPECT_TRUE(plain.code == 0 || plain.code == 3) << plain.code << plain.err;
    EXPECT_EQ(fs::exists(folder_ / "out.png"), plain.code == 0);
    fs::remove(folder_ / "out.png");
  }
  write_depth("plane.pfm", 4.0f);
  EXPECT_EQ(run("shade plane.pfm -o plane.png --device cpu --look ao").code, 0);
  const Image flat = image("plane.png");
  for (int x = 8; x < 56; ++x) EXPECT_GT(flat.planes[0].at(x, 24), 0.95f) << "a plane is not occluded";
}

TEST_F(ShadeTest, WarnsAboutOptionsThatDoNothing) {
  write_depth("d.pfm", 4.0f);
  const std::string start = "shade d.pfm --depth-kind planar -o out.png --device cpu --look ao ";
  EXPECT_EQ(run(start).err.find("does nothing"), std::string::npos);
  for (const char* option : {"--near-plane 2", "--far-plane 9", "--cell-size 3", "--memory 5"}) {
    const Outcome outcome = run(start + option);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    EXPECT_NE(outcome.err.find("warning: " + name), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(run("shade d.pfm --depth-kind window --near-plane 2 -o out.png --device cpu").err.find("does nothing"),
            std::string::npos);
}

TEST_F(ShadeTest, RefusesWrongOptions) {
  bad("shade -o out.png", 2, {"name the file", "--depth"});
  bad("shade - -o out.png", 3, {"standard input is empty"});
  bad("shade g.exr", 2, {"--output"});
  bad("shade g.exr -o out.svg", 2, {"out.svg", ".png"});
  bad("shade g.exr -o out.bmp", 2, {"out.bmp"});
  bad("shade g.exr -o no/out.png", 3, {"'no'"});
  bad("shade g.exr -o g.exr", 2, {"g.exr", "input"});
  bad("shade g.exr -o out.png --look nosuch", 2, {"nosuch"});
  bad("shade g.exr -o out.png --passes foo", 2, {"'foo'", "depth"});
  bad("shade g.exr -o out.png --passes ao,depth", 2, {"--passes", ".exr"});
  bad("shade g.exr -o out.png --effects bitmask,denoise", 2, {"--effects", "no picture", "output", "--passes ao"});
  bad("shade g.exr -o out.png --half", 2, {"--half"});
  bad("shade g.exr -o out.jpg --bits 16", 2, {"--bits"});
  bad("shade g.exr -o out.png --picture-quality 50", 2, {"--picture-quality"});
  bad("shade g.exr -o out.png --memory lots", 2, {"--memory", "lots"});
  bad("shade g.exr -o out.png --merge", 2, {"--merge", ".exr"});
  bad("shade g.exr -o out.png --depth-kind far", 2, {"--depth-kind", "planar"});
  bad("shade g.exr -o out.png --fov 200", 2, {"--fov"});
  bad("shade g.exr -o out.png --ao reference", 2, {"reference"});
  bad("shade g.exr -o - --json", 2, {"-o -", "--json"});
  bad("shade g.exr more.exr -o out.png", 2, {"more.exr"});
  write_depth("d.pfm", 4.0f);
  bad("shade d.pfm -o out.exr --merge --device cpu", 2, {"--merge", ".exr"});
}

class ShadeRoundTrip : public test::ProgramTest {
 protected:
  static constexpr const char* kScene = "scene:solids?detail=3000";
  // Pixels as they are, level camera: what is up in the picture is up in the scene.
  static constexpr const char* kView =
      " --resolution 160x120 --anti-aliasing 1 --camera-direction -0.3,0,-1 --ground off --set antialias.search=0";

  /// Returns the max difference of planes of the same names; infinity where one has a value and the other none, or NaN.
  double difference(const Image& a, const Image& b, std::initializer_list<const char*> planes) {
    double worst = 0.0;
    for (const char* name : planes)
      for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
          const double of_a = a.plane(name).at(x, y), of_b = b.plane(name).at(x, y);
          if (of_a == of_b) continue;
          const double apart = std::abs(of_a - of_b);
          worst = std::isnan(apart) ? std::numeric_limits<double>::infinity() : std::max(worst, apart);
        }
    return worst;
  }
};

TEST_F(ShadeRoundTrip, OcclusionEqualsThatOfTheRenderer) {
  const std::string look = " --look ao --ao bitmask --ao-radius 0.4 --set denoise.for_height=0";
  good(kScene + std::string(" -o drawn.exr --passes color,ao,depth,normal") + kView + look);
  good(std::string("shade drawn.exr -o shaded.exr --passes color,ao --set antialias.search=0") + look);
  const Image drawn = image("drawn.exr"), shaded = image("shaded.exr");
  ASSERT_EQ(shaded.width, drawn.width);
  EXPECT_LE(difference(drawn, shaded, {"ao", "color.r", "color.a"}), 1e-3);
  double darkest = 1.0;  // there is occlusion at all
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) darkest = std::min(darkest, double(drawn.plane("ao").at(x, y)));
  EXPECT_LT(darkest, 0.5);
}

TEST_F(ShadeRoundTrip, StudioEqualsThatOfTheRendererWhereTheFileHasAllPlanes) {
  const std::string look =
      " --look studio --ao bitmask --ao-radius 0.4 --ao-scale full --set output.metering=none --set "
      "denoise.for_height=0";
  good(kScene +
       std::string(" -o drawn.exr --passes "
                   "color,depth,normal,albedo,specular,shininess,shadow,shadow1,shadow2,object_id,material_id") +
       kView + look);
  good(std::string("shade drawn.exr -o shaded.exr --set antialias.search=0") + look);
  EXPECT_LE(difference(image("drawn.exr"), image("shaded.exr"), {"color.r", "color.g", "color.b", "color.a"}), 1e-3);
}

TEST_F(ShadeRoundTrip, CompWithoutOcclusionIsThePicture) {
  good(kScene + std::string(" -o drawn.exr --passes color,depth,normal --no-background --look studio") + kView);
  good(kScene + std::string(" -o drawn.png --look studio") + kView);
  good("shade drawn.exr -o same.exr --look comp --ao-strength 0");
  const Image drawn = image("drawn.exr");
  EXPECT_LE(difference(drawn, image("same.exr"), {"color.r", "color.g", "color.b", "color.a"}), 1e-5);
  good("shade --depth drawn.exr:depth --beauty drawn.png -o same.png --ao-strength 0");
  EXPECT_LE(difference(image("drawn.png"), image("same.png"), {"color.r", "color.g", "color.b"}), 1.01 / 255);
  good("shade drawn.exr -o dark.exr");  // comp is the default of a file with a beauty
  const Image dark = image("dark.exr");
  double darker = 0.0;
  for (int y = 0; y < dark.height; ++y)
    for (int x = 0; x < dark.width; ++x) {
      ASSERT_LE(dark.plane("color.g").at(x, y), drawn.plane("color.g").at(x, y) + 1e-5f);
      darker = std::max(darker, double(drawn.plane("color.g").at(x, y) - dark.plane("color.g").at(x, y)));
    }
  EXPECT_GT(darker, 0.05);
}

TEST_F(ShadeRoundTrip, ReductionHalvesThePicture) {
  good(kScene + std::string(" -o drawn.exr --passes color,depth,normal,albedo --look studio") + kView);
  good("shade drawn.exr -o small.exr --passes color,depth --look studio --reduction 2");
  const Image small = image("small.exr");
  EXPECT_EQ(small.width, 80);
  EXPECT_EQ(small.height, 60);
  bad("shade drawn.exr -o small.exr --reduction 9", 2, {"reduction"});
}

}  // namespace
}  // namespace umbrage
