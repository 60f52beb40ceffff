// The program as people run it: what it writes, what it prints, how it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "effects/effects.h"
#include "generators/builtin.h"
#include "io/image_file.h"
#include "looks/looks.h"
#include "run_program.h"
#include "scene/readers/import.h"
#include "support.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::quoted;
using test::text_of;
using test::Words;
using test::words_of;

class Cli : public test::ProgramTest {};

const std::string kSmall = " --resolution 64x64";
const std::string kSolids = "scene:solids?detail=2000";

// ---- what it draws
// -----------------------------------------------------------------------------------------------------

TEST_F(Cli, SaysWhoItIs) {
  for (const char* line : {"--help", "-h", "render --help", "list --help", "bench --help", "figures --help"}) {
    const Outcome help = good(line);
    EXPECT_NE(help.out.find("Usage: umbrage"), std::string::npos) << line << ": " << help.out;
  }
  EXPECT_NE(good("--help").out.find("render"), std::string::npos);
  EXPECT_NE(good("render --help").out.find("--resolution"), std::string::npos);
  const std::string version = good("--version").out;
  EXPECT_EQ(version.rfind("umbrage ", 0), 0u);
  EXPECT_NE(version.find_first_of("0123456789"), std::string::npos);
}

TEST_F(Cli, DrawsABuiltInSceneInEveryFormat) {
  for (const char* ending : {"png", "exr", "pfm"}) {
    const std::string name = fmt::format("out.{}", ending);
    EXPECT_EQ(good(kSolids + " --look ao -o " + name + kSmall).out, "");
    const Image picture = image(name);
    ASSERT_EQ(picture.width, 64);
    ASSERT_EQ(picture.height, 64);
    const Plane& grey = picture.plane("color.r");
    float least = 1.0f, most = 0.0f;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) least = std::min(least, grey.at(x, y)), most = std::max(most, grey.at(x, y));
    EXPECT_LT(least, 0.8f) << name << ": nothing is occluded";
    EXPECT_GT(most, 0.95f) << name << ": nothing is open";
  }
}

TEST_F(Cli, DrawsAFile) {
  good("render tri.obj -o out.png" + kSmall);
  EXPECT_EQ(image("out.png").width, 64);
  good("tri.obj -o out.exr --resolution 30,20 --passes object_id");
  const Image ids = image("out.exr");
  EXPECT_EQ(ids.width, 30);
  EXPECT_EQ(ids.height, 20);
  long drawn = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x) drawn += ids.plane("object_id").at(x, y) == 0.0f;
  EXPECT_GT(drawn, 50) << "the model is not in the picture";
  EXPECT_LT(drawn, 550) << "the model fills the picture";
}

TEST_F(Cli, EveryWayToWriteAnOptionMeansTheSame) {
  good("render tri.obj --output one.png --resolution 64,64 --look unsharp --set unsharp.kernel=9");
  const std::string one = text_of(folder_ / "one.png");
  ASSERT_FALSE(one.empty());
  for (const char* line : {"tri.obj -o two.png --resolution 64x64 --look unsharp --set unsharp.kernel=9",
                           "tri.obj -otwo.png --resolution=64x64 --look=unsharp --set=unsharp.kernel=9",
                           "--look=unsharp --set unsharp.kernel=9 --resolution=64,64 -o two.png tri.obj",
                           "render --output=two.png --set unsharp.kernel=5 --set unsharp.kernel=9 --look unsharp "
                           "--resolution 64x64 tri.obj"}) {
    good(line);
    EXPECT_EQ(text_of(folder_ / "two.png"), one) << line;
    fs::remove(folder_ / "two.png");
  }
}

TEST_F(Cli, OptionsMayStandBeforeTheModel) {
  for (const char* line : {"--set unsharp.kernel=5 tri.obj -o a.png", "--set=unsharp.kernel=5 tri.obj -o a.png",
                           "-o a.png --set unsharp.kernel=5 --set unsharp.strength=1 tri.obj"})
    good(std::string(line) + " --look ao --resolution 8x8 --device cpu");
}

TEST_F(Cli, ThreadsDoNotChangeThePicture) {
  const std::string line = kSolids + " --resolution 90x70 --passes all -o ";
  good(line + "all.exr");
  good(line + "one.exr --threads 1");
  good(line + "two.exr", "UMBRAGE_NUM_THREADS=2");
  good(line + "cpu.exr", "UMBRAGE_DEVICE=cpu");
  for (const char* name : {"one.exr", "two.exr", "cpu.exr"})
    EXPECT_EQ(text_of(folder_ / name), text_of(folder_ / "all.exr")) << name;
}

TEST_F(Cli, TheEnvironmentNamesDeviceThreadsAndVerbosity) {
  const std::string line = "tri.obj -o out.png" + kSmall;
  EXPECT_NE(run(line, "UMBRAGE_NUM_THREADS=1 UMBRAGE_VERBOSE=1").err.find("1 threads"), std::string::npos);
  EXPECT_NE(run(line + " --verbose", "UMBRAGE_NUM_THREADS=1").err.find("1 threads"), std::string::npos);
  // What is said on the command line counts.
  good(line + " --device cpu", "UMBRAGE_DEVICE=nonsense");
  good(line + " --threads 1", "UMBRAGE_NUM_THREADS=nonsense");
  fs::remove(folder_ / "out.png");
  bad(line, 2, {"device", "'nonsense'", "cpu"}, "UMBRAGE_DEVICE=nonsense");
  bad(line, 2, {"threads", "'nonsense'"}, "UMBRAGE_NUM_THREADS=nonsense");
}

TEST_F(Cli, PassesArePlanes) {
  good("tri.obj --look unsharp -o all.exr --passes all" + kSmall);
  const Image all = image("all.exr");
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "specular", "shininess", "shadow",
                           "object_id", "material_id", "direct.r", "ambient.b", "ao", "lit.g", "color.r"})
    EXPECT_NE(all.find(name), nullptr) << name;
  good("tri.obj -o two.exr --passes depth,normal" + kSmall);
  const Image two = image("two.exr");
  EXPECT_EQ(std::set<std::string>(two.names.begin(), two.names.end()),
            (std::set<std::string>{"depth", "normal.x", "normal.y", "normal.z"}));
  EXPECT_EQ(test::difference(two.plane("depth"), all.plane("depth"), 0.0).most, 0.0);
  EXPECT_TRUE(*read_camera(folder_ / "two.exr")) << "the camera is missing";
}

TEST_F(Cli, PassesAsPicturesCanBeSeen) {
  good("tri.obj -o depth.png --passes depth" + kSmall);
  good("tri.obj -o normal.png --passes normal" + kSmall);
  good("tri.obj -o both.exr --passes depth,normal" + kSmall);
  const Image depth = image("depth.png"), normal = image("normal.png"), both = image("both.exr");
  ASSERT_EQ(depth.planes.size(), 1u);
  float nearest = 1e9f, farthest = 0.0f, light = 0.0f, dark = 1.0f;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float d = both.plane("depth").at(x, y), grey = depth.planes[0].at(x, y);
      if (!std::isfinite(d)) {
        ASSERT_EQ(grey, 0.0f);
        continue;
      }
      ASSERT_NEAR(normal.plane("color.g").at(x, y), both.plane("normal.y").at(x, y) * 0.5f + 0.5f, 0.003f);
      if (d < nearest) nearest = d, light = grey;
      if (d > farthest) farthest = d, dark = grey;
    }
  EXPECT_GT(light, dark + 0.3f) << "near is light";
}

TEST_F(Cli, DepthOfAFlatSceneIsNear) {
  write("flat.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  good("flat.obj -o out.png --passes depth --camera-direction 0,0,-1" + kSmall);
  EXPECT_GT(image("out.png").planes[0].at(32, 32), 0.9f);
}

TEST_F(Cli, JsonTellsTheTimeOfEachStage) {
  const Outcome outcome = good("tri.obj -o out.png --json" + kSmall);
  const auto records = nlohmann::json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(records.is_array()) << outcome.out;
  ASSERT_GE(records.size(), 5u);
  double sum = 0.0;
  std::set<std::string> stages;
  for (const auto& record : records) {
    ASSERT_TRUE(record.is_object());
    EXPECT_GE(record.at("ms").get<double>(), 0.0);
    stages.insert(record.at("stage").get<std::string>());
    if (record != records.back()) sum += record.at("ms").get<double>();
  }
  EXPECT_EQ(records.back().at("stage"), "total");
  EXPECT_NEAR(records.back().at("ms").get<double>(), sum, 0.01);
  for (const char* stage : {"load", "prepare", "capture", "bitmask", "average", "output", "write"})
    EXPECT_TRUE(stages.count(stage)) << stage;
}

TEST_F(Cli, BackgroundIsAsAsked) {
  good("tri.obj -o color.exr --background-color 0.25,0.5,0.75" + kSmall);
  EXPECT_EQ(image("color.exr").plane("color.r").at(0, 0), 0.25f);
  EXPECT_EQ(image("color.exr").plane("color.b").at(0, 0), 0.75f);
  good("tri.obj -o none.png --no-background" + kSmall);
  const Image none = image("none.png");
  ASSERT_NE(none.find("color.a"), nullptr);
  EXPECT_EQ(none.plane("color.a").at(0, 0), 0.0f);
  EXPECT_EQ(none.plane("color.a").at(32, 32), 1.0f);
}

TEST_F(Cli, OptionsChangeThePicture) {
  const std::string line = "tri.obj" + kSmall + " --passes depth,ao,color -o ";
  good(line + "plain.exr");
  for (const char* option : {"--look unsharp",
                             "--ao none",
                             "--ao-scale full",
                             "--ao-radius 0.01",
                             "--ao-radius 90%",
                             "--set bitmask.steps=3",
                             "--ground off",
                             "--quality draft",
                             "--quality high",
                             "--anti-aliasing 3",
                             "--ao hemisphere",
                             "--up -Y",
                             "--camera-position 3,4,5",
                             "--camera-focal-point 1,1,0",
                             "--camera-view-up 1,1,0",
                             "--camera-view-angle 70",
                             "--camera-direction -1,-1,-1",
                             "--camera-azimuth-angle 40",
                             "--camera-elevation-angle -25",
                             "--camera-zoom-factor 2",
                             "--camera-orthographic",
                             "--background-color 0,0,0"}) {
    good(line + "other.exr " + option);
    EXPECT_NE(text_of(folder_ / "other.exr"), text_of(folder_ / "plain.exr")) << option;
  }
  good(line + "none.exr --ao none");
  const Image none = image("none.exr");
  EXPECT_EQ(test::difference(none.plane("ao"), Plane(64, 64, 1.0f), 0.0).most, 0.0);
}

TEST_F(Cli, BitsAndHalfAreWritten) {
  good(kSolids + " -o eight.png" + kSmall);
  good(kSolids + " -o sixteen.png --bits 16" + kSmall);
  good(kSolids + " -o float.exr" + kSmall);
  good(kSolids + " -o half.exr --half" + kSmall);
  const Image exact = image("float.exr"), eight = image("eight.png"), sixteen = image("sixteen.png"),
              half = image("half.exr");
  const auto off = [&](const Image& other) {
    return test::difference(exact.plane("color.r"), other.plane("color.r"), 0.0).most;
  };
  EXPECT_LE(off(eight), 0.5 / 255 + 1e-6);
  EXPECT_GT(off(eight), 1e-3);
  EXPECT_LE(off(sixteen), 0.5 / 65535 + 1e-6);
  EXPECT_LE(off(half), 1e-3);
  EXPECT_GT(off(half), 1e-6);
}

TEST_F(Cli, SeveralModelsShareOnePicture) {
  write("other.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n");
  good("tri.obj other.obj -o out.exr --passes object_id --resolution 200x60");
  const Image picture = image("out.exr");
  std::set<float> ids;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 200; ++x) ids.insert(picture.plane("object_id").at(x, y));
  EXPECT_EQ(ids, (std::set<float>{-1.0f, 0.0f, 1.0f}));
}

TEST_F(Cli, NamesMayHaveSpacesAndQuotes) {
  write("my 'odd' model.obj", text_of(folder_ / "tri.obj"));
  const Outcome outcome = run(Words{"my 'odd' model.obj", "-o", "my picture $HOME.png", "--resolution", "8x8"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(image("my picture $HOME.png").width, 8);
}

TEST_F(Cli, MissingTexturesAreAWarning) {
  write("tri.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd nothere.png\n");
  write("skin.obj", "mtllib tri.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl skin\nf 1/1 2/2 3/3\n");
  const Outcome outcome = run("skin.obj -o out.png" + kSmall);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err.rfind("umbrage: warning: ", 0), 0u) << outcome.err;
  EXPECT_NE(outcome.err.find("nothere.png"), std::string::npos) << outcome.err;
  EXPECT_EQ(image("out.png").width, 64);
  // A material library that is missing, too.
  write("lib.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\n");
  const Outcome library = run("lib.obj -o out.png" + kSmall);
  EXPECT_EQ(library.code, 0);
  EXPECT_NE(library.err.find("gone.mtl"), std::string::npos) << library.err;
}

TEST_F(Cli, AnOlderPictureIsReplacedOrKept) {
  write("out.png", "older");
  good("tri.obj -o out.png" + kSmall);
  EXPECT_EQ(image("out.png").width, 64);
  write("out.png", "older");
  bad("nothere.obj -o out.png", 3, {"nothere.obj"});
  EXPECT_EQ(text_of(folder_ / "out.png"), "older");
}

TEST_F(Cli, AnInterruptLeavesNothingBehind) {
  const auto before = files();
  const Outcome outcome =
      run("scene:terrain?detail=9000000 -o out.png --resolution 8000x8000", "timeout --preserve-status -s INT 0.5");
  EXPECT_EQ(outcome.code, 130);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(files(), before);
}

TEST_F(Cli, BenchTimesEffects) {
  const auto records =
      nlohmann::json::parse(good("bench tri.obj --resolution 32,16 --runs 1 --json").out, nullptr, false);
  ASSERT_TRUE(records.is_array());
  std::set<std::string> timed;
  for (const auto& record : records) {
    timed.insert(record.at("effect").get<std::string>());
    EXPECT_EQ(record.at("device"), "cpu");
    EXPECT_EQ(record.at("width"), 32);
    EXPECT_EQ(record.at("height"), 16);
    EXPECT_GE(record.at("threads").get<int>(), 1);
    EXPECT_TRUE(record.at("setting").is_string());
    EXPECT_LE(record.at("ms_min").get<double>(), record.at("ms").get<double>());
  }
  EXPECT_TRUE(timed.count("capture"));
  for (const Effect* effect : effects()) EXPECT_TRUE(timed.count(std::string(effect->name))) << effect->name;
  // At reduced resolution techniques and filters alone.
  const auto half = nlohmann::json::parse(good("bench tri.obj --resolution 32,16 --runs 1 --json --ao-scale half").out,
                                          nullptr, false);
  std::set<std::string> timed_half;
  for (const auto& record : half) {
    timed_half.insert(record.at("effect").get<std::string>());
    EXPECT_EQ(record.at("scale"), "half");
    EXPECT_EQ(record.at("width"), 32);
  }
  for (const Effect* effect : effects())
    EXPECT_EQ(timed_half.count(std::string(effect->name)),
              effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter ? 1u : 0u)
        << effect->name;
  EXPECT_FALSE(timed_half.count("capture"));
  bad("bench --ao-scale third", 2, {"--ao-scale", "'third'", "quarter"});
  bad("bench --ao-scale half --effect lighting", 2, {"--ao-scale", "'half'", "lighting", "technique or filter"});
  bad("bench --ao-scale half --effect capture", 2, {"capture"});
  bad("bench --effect unshrp", 2, {"'unshrp'", "did you mean 'unsharp'"});
  bad("bench --runs 0", 2, {"--runs", "1 to"});
  bad("bench --runs x", 2, {"--runs", "'x'", "whole number"});
  bad("bench --resolution abc", 2, {"--resolution", "'abc'"});
  bad("bench nothere.obj", 3, {"nothere.obj"});
}

TEST_F(Cli, FiguresRefuseWhatTheyCannotDo) {
  bad("figures --paper unshrp", 2, {"unshrp", "unsharp"});
  bad("figures -o tri.obj", 3, {"tri.obj"});
  bad("figures extra", 2, {"'extra'", "too many"});
}

// ---- what it lists
// -----------------------------------------------------------------------------------------------------

TEST_F(Cli, ListsWhatThereIs) {
  Words looks_there, effects_there, scenes_there, formats_there = {".png", ".exr", ".pfm"};
  for (const Look* look : looks()) looks_there.emplace_back(look->name);
  for (const Effect* effect : effects()) {
    effects_there.emplace_back(effect->name);
    for (const Parameter& row : effect->parameters)
      effects_there.push_back(fmt::format("{}.{}", effect->name, row.name));
  }
  for (const BuiltinScene& scene : builtin_scenes()) scenes_there.push_back(fmt::format("scene:{}", scene.name));
  for (const std::string& format : import_formats()) formats_there.push_back("." + format);
  for (const auto& [kind, names] : {std::pair<std::string, Words>{"looks", looks_there},
                                    {"effects", effects_there},
                                    {"scenes", scenes_there},
                                    {"devices", {"cpu"}},
                                    {"formats", formats_there}}) {
    const std::string plain = good("list " + kind).out;
    const auto records = nlohmann::json::parse(good("list " + kind + " --json").out, nullptr, false);
    ASSERT_TRUE(records.is_array()) << kind;
    std::set<std::string> listed;
    for (const auto& record : records) {
      listed.insert(record.at("name").get<std::string>());
      EXPECT_FALSE(record.at("summary").get<std::string>().empty()) << record;
    }
    for (const std::string& name : names) {
      EXPECT_TRUE(listed.count(name)) << kind << ": " << name;
      EXPECT_NE(("\n" + plain).find("\n" + name + " "), std::string::npos) << kind << ": " << name;
    }
    EXPECT_EQ(std::size_t(std::count(plain.begin(), plain.end(), '\n')), records.size()) << kind;
  }
}

TEST_F(Cli, ListedScenesAndLooksCanBeDrawn) {
  for (const Look* look : looks()) good(fmt::format("tri.obj -o out.png --resolution 16x16 --look {}", look->name));
  for (std::string_view name : occlusion_names())
    good(fmt::format("tri.obj -o out.png --resolution 16x16 --ao {}", name));
}

// ---- what it refuses
// ---------------------------------------------------------------------------------------------------

TEST_F(Cli, RefusesModelsThatAreNone) {
  const std::string random = [] {
    std::string bytes(4000, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = char(test::hash(unsigned(i) + 17u));
    return bytes;
  }();
  for (const std::string& format : import_formats()) {
    write("random." + format, random);
    write("empty." + format, "");
    write("words." + format, "This is a letter, not a model.\nYours\n");
    for (const char* name : {"random", "empty", "words"}) {
      const std::string file = fmt::format("{}.{}", name, format);
      bad(file + " -o out.png", 3, {file});
    }
  }
  fs::create_directory(folder_ / "folder.obj");
  write("notes.txt", "hello\n");
  write("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n");
  write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  bad("nothere.obj -o out.png", 3, {"nothere.obj", "no such file"});
  bad("no/where.obj -o out.png", 3, {"no/where.obj", "no such file"});
  bad("folder.obj -o out.png", 3, {"folder.obj", "folder"});
  bad("notes.txt -o out.png", 3, {"notes.txt", ".obj", ".ply"});
  bad("lines.obj -o out.png", 3, {"lines.obj", "no triangles"});
  bad("range.obj -o out.png", 3, {"range.obj", "out of range"});
  bad("nan.obj -o out.png", 3, {"nan.obj", "not finite"});
  bad("line.obj -o out.png", 3, {"line.obj", "degenerate"});
  bad("tri.obj nothere.obj -o out.png", 3, {"nothere.obj"});
}

TEST_F(Cli, RefusesModelsThatAreCutShort) {
  // Files that say they hold 1000 triangles and end before.
  const std::string stl = std::string(80, ' ') + std::string("\xe8\x03\0\0", 4) + std::string(120, '\1');
  write("cut.stl", stl);
  write("cut.ply",
        "ply\nformat ascii 1.0\nelement vertex 3000\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n");
  write("cut.off", "OFF\n3000 1000 0\n0 0 0\n1 0 0\n0 1 0\n");
  write("cut.glb", std::string("glTF\2\0\0\0\0\x10\0\0\0\x08\0\0JSON{\"asset\":{\"version\":\"2.0\"}", 47));
  write("cut.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"meshes\": [");
  write("cut.dae",
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\"><library_geo");
  for (const char* name : {"cut.stl", "cut.ply", "cut.off", "cut.glb", "cut.gltf", "cut.dae"})
    bad(std::string(name) + " -o out.png", 3, {name});
}

TEST_F(Cli, RefusesResolutions) {
  for (const char* text : {"0x0", "-5x5", "100000x100000", "16385x16384", "abc", "64", "64x", "x64", "64x64x64",
                           "1e2x64", "64.5x64", "99999999999x1"})
    bad_option(std::string("--resolution ") + text, {"--resolution", fmt::format("'{}'", text), "16384"});
}

TEST_F(Cli, RefusesPlacesToWrite) {
  fs::create_directory(folder_ / "folder");
  write("file", "a file");
  const auto to = [&](const std::string& place, const Words& texts) { bad(Words{"tri.obj", "-o", place}, 3, texts); };
  to("nofolder/out.png", {"nofolder/out.png", "does not exist"});
  to("file/out.png", {"file/out.png", "not a folder"});
  to("folder", {"folder", "is a folder"});
  to("folder/", {"folder", "is a folder"});
  to("", {"empty"});
  bad("tri.obj -o out", 2, {"'out'", ".png", ".exr", ".pfm"});
  bad("tri.obj -o out.jpg", 2, {"'out.jpg'", ".png", ".exr", ".pfm"});
  bad("tri.obj -o out.pgn", 2, {"did you mean 'png'"});
  to("/proc/out.png", {"/proc/out.png", "cannot be written"});
  if (::geteuid() != 0) {  // nothing is forbidden to root
    fs::create_directory(folder_ / "locked");
    fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    to("locked/out.png", {"locked", "ermission"});
  }
}

TEST_F(Cli, RefusesPlacesBeyondReach) {
  bad_option("--camera-position 1e19,0,0", {"--camera-position", "'1e19,0,0'", "1e+15"});
  bad_option("--camera-focal-point 0,1e30,0", {"--camera-focal-point", "1e+15"});
  bad_option("--ao-radius 0", {"--ao-radius", "'0'"});
  bad_option("--passes depth,depth", {"'depth'", "twice"});
  bad_option("--half", {"--half", ".exr"});
  bad("tri.obj -o out.exr --bits 16", 2, {"--bits", ".png"});
}

TEST_F(Cli, PassColorKeepsItsChannels) {
  good("tri.obj -o out.png --passes color --background-color 1,0.5,0" + kSmall);
  const auto image = read_image(folder_ / "out.png");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_NEAR(image->plane("color.r").at(0, 0), 1.0f, 1e-3);
  EXPECT_NEAR(image->plane("color.g").at(0, 0), 0.5f, 3e-3);
  EXPECT_NEAR(image->plane("color.b").at(0, 0), 0.0f, 1e-3);
}

TEST_F(Cli, RefusesNamesThatDoNotExist) {
  bad_option("--lok ao", {"'--lok'", "did you mean '--look'"});
  bad_option("--resolutoin=8x8", {"'--resolutoin'", "did you mean '--resolution'"});
  bad_option("--fooo", {"'--fooo'", "umbrage render --help"});
  bad_option("--xyzzy", {"'--xyzzy'", "umbrage render --help"});
  bad_option("-q", {"'-q'", "umbrage render --help"});
  bad_option("--look unshap", {"'unshap'", "did you mean 'unsharp'"});
  bad_option("--look xyzzy", {"'xyzzy'", "there are", "ao", "unsharp"});
  bad_option("--ao unshrp", {"'unshrp'", "did you mean 'unsharp'"});
  bad_option("--ao xyzzy", {"'xyzzy'", "there are", "unsharp", "none"});
  bad_option("--device cpuu", {"'cpuu'", "did you mean 'cpu'"});
  bad_option("--device xyzzy", {"'xyzzy'", "there are", "cpu"});
  bad_option("--passes dept", {"'dept'", "did you mean 'depth'"});
  bad_option("--passes xyzzy", {"'xyzzy'", "there are", "normal"});
  good("tri.obj -o half.exr --look bleeding --ao-scale half --passes ao,indirect" + kSmall);
  bad_option("--look bleeding --ao-scale half --passes denoise_ao", {"'bleeding'", "'denoise_ao'"});
  // What other looks write.
  bad_option("--look bleeding --passes outline", {"'bleeding'", "'outline'", "the look cartoon does"});
  bad_option("--look bleeding --passes zzz", {"'zzz'", "there are", "indirect"});
  bad_option("--set unshar.kernel=4", {"'unshar'", "did you mean 'unsharp'"});
  bad_option("--set unsharp.kernal=4", {"'kernal'", "did you mean 'kernel'"});
  bad_option("--set composite.mode=multipl", {"'multipl'", "did you mean 'multiply'"});
  bad("scene:solid -o out.png", 2, {"'solid'", "did you mean 'solids'"});
  bad("scene:xyzzy -o out.png", 2, {"'xyzzy'", "there are", "atrium"});
  bad("scene:solids?detail=3 -o out.png", 2, {"'3'", "1000"});
  bad("scene:solids?colour=red -o out.png", 2, {"'colour=red'", "detail"});
  bad("rendr tri.obj -o out.png", 2, {"'rendr'", "did you mean 'render'"});
  bad("list lokos", 2, {"'lokos'", "did you mean 'looks'"});
  bad("list xyzzy", 2, {"'xyzzy'", "effects"});
}

TEST_F(Cli, RefusesOptionsWithNothingInThem) {
  for (const char* option : {"--ao-scale", "--layers", "--ao", "--look", "--ao-radius", "--camera-zoom-factor", "--up",
                             "--passes", "--set", "--resolution"}) {
    bad_option(option + std::string("="), {option, "needs a value"});
    bad(Words{"tri.obj", "-o", "out.png", option, ""}, 2, {option, "needs a value"});
  }
}

TEST_F(Cli, RefusesValues) {
  bad_option("--set unsharp.kernel", {"'unsharp.kernel'", "effect.parameter=value"});
  bad_option("--set unsharp.kernel=0", {"unsharp.kernel", "'0'", "1 to 1023 px"});
  bad_option("--set unsharp.kernel=abc", {"unsharp.kernel", "'abc'", "1 to 1023 px"});
  bad_option("--set unsharp.white_edge=maybe", {"'maybe'", "on or off"});
  bad_option("--ao-radius -1", {"--ao-radius", "'-1'"});
  bad_option("--ao-radius 0", {"--ao-radius", "'0'"});
  bad_option("--ao-scale third", {"--ao-scale", "'third'", "full, half or quarter"});
  bad_option("--ao reference --ao-scale half", {"--ao-scale", "'half'", "reference"});
  bad_option("--ao-radius wide", {"--ao-radius", "'wide'", "5%"});
  bad_option("--threads -1", {"--threads", "'-1'", "0 to 1024"});
  bad_option("--threads x", {"--threads", "'x'", "0 to 1024"});
  bad_option("--threads 1.5", {"--threads", "'1.5'", "whole number"});
  bad_option("--threads 99999", {"--threads", "'99999'", "0 to 1024"});
  bad_option("--bits 7", {"--bits", "7", "8 or 16"});
  bad_option("--bits many", {"--bits", "'many'", "whole number"});
  bad_option("--verbose=perhaps", {"--verbose", "'perhaps'"});
  bad_option("--passes all", {"--passes all", ".exr"});
  bad_option("--passes depth,normal", {"depth,normal", ".exr"});
  for (const char* option : {"--camera-position", "--camera-focal-point"})
    for (const char* text : {"1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0", ",,", "1;2;3"})
      bad_option(fmt::format("{} {}", option, text), {option, fmt::format("'{}'", text), "three numbers"});
  for (const char* option : {"--camera-direction", "--camera-view-up", "--up"})
    for (const char* text : {"0,0,0", "W", "+W", "1,2", "nan,1,0"})
      bad_option(fmt::format("{} {}", option, text), {option, fmt::format("'{}'", text), "+Y"});
  for (const char* text : {"0", "180", "-30", "wide", "nan"})
    bad_option(fmt::format("--camera-view-angle {}", text), {"--camera-view-angle", fmt::format("'{}'", text), "179"});
  bad_option("--camera-position 1,2,3 --camera-focal-point 1,2,3", {"--camera-position", "'1,2,3'", "its own place"});
  bad_option("--look= studio", {"--look needs a value after its '='"});
  bad_option("--set toon.bands=2.5", {"toon.bands", "'2.5'", "a whole number from"});
  bad("tri.obj -o out.bmp", 2, {"'out.bmp'", ".png, .exr or .pfm"});
  bad_option("--camera-zoom-factor 0", {"--camera-zoom-factor", "'0'"});
  bad_option("--camera-azimuth-angle x", {"--camera-azimuth-angle", "'x'"});
  bad_option("--camera-elevation-angle 1e9", {"--camera-elevation-angle", "'1e9'"});
  for (const char* text : {"2,0,0", "-0.1,0,0", "red", "1,1", "nan,0,0"})
    bad_option(fmt::format("--background-color {}", text),
               {"--background-color", fmt::format("'{}'", text), "three numbers from 0 to 1"});
}

TEST_F(Cli, RefusesWhatIsMissingOrTooMuch) {
  bad("", 2, {"name a model", "umbrage --help"});
  bad("render", 2, {"required", "umbrage render --help"});
  bad("-o out.png", 2, {"MODEL", "required"});
  bad("tri.obj", 2, {"--output", "required"});
  bad("tri.obj -o", 2, {"--output", "needs a value"});
  bad_option("--set", {"--set", "needs a value"});
  bad_option("--look", {"--look", "needs a value"});
  bad_option("-o other.png", {"--output", "twice"});
  bad_option("--look ao --look unsharp", {"--look", "twice"});
  bad("list", 2, {"required", "umbrage list --help"});
  bad("list looks extra", 2, {"'extra'", "too many"});
  bad("list looks extra more", 2, {"'extra'", "too many"});
}

// ---- depth layers, guard band, the reference
// ---------------------------------------------------------------------------

TEST_F(Cli, LayersArePlanes) {
  good(kSolids + " --layers 4 --passes depth,layer1.depth,layer3.normal,layer2.object_id -o x.exr" + kSmall);
  const Image some = image("x.exr");
  EXPECT_EQ(std::set<std::string>(some.names.begin(), some.names.end()),
            (std::set<std::string>{"depth", "layer1.depth", "layer3.normal.x", "layer3.normal.y", "layer3.normal.z",
                                   "layer2.object_id"}));
  long behind = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float first = some.plane("depth").at(x, y), second = some.plane("layer1.depth").at(x, y);
      if (!std::isfinite(second)) continue;
      ++behind;
      ASSERT_LT(first, second) << x << ',' << y;
    }
  EXPECT_GT(behind, 1000);
  good(kSolids + " --layers 3 --passes all -o all.exr" + kSmall);
  const Image all = image("all.exr");
  for (const char* name :
       {"depth", "layer1.depth", "layer2.depth", "layer1.normal.y", "layer2.albedo.r", "layer1.specular",
        "layer1.shininess", "layer2.shadow", "layer1.object_id", "layer2.material_id", "ao", "color.r"})
    EXPECT_NE(all.find(name), nullptr) << name;
  EXPECT_EQ(all.find("layer3.depth"), nullptr);
  EXPECT_EQ(test::difference(all.plane("layer1.depth"), some.plane("layer1.depth"), 0.0).most, 0.0);
  // Layers do not change the picture.
  good(kSolids + " -o one.png" + kSmall);
  good(kSolids + " -o many.png --layers 16" + kSmall);
  EXPECT_EQ(text_of(folder_ / "one.png"), text_of(folder_ / "many.png"));
}

TEST_F(Cli, LayersAsPicturesCanBeSeen) {
  const std::string line = kSolids + " --layers 2 --resolution 64x64 -o ";
  good(line + "depth.png --passes layer1.depth");
  good(line + "normal.png --passes layer1.normal");
  good(line + "both.exr --passes layer1.depth,layer1.normal");
  const Image depth = image("depth.png"), normal = image("normal.png"), both = image("both.exr");
  float nearest = 1e9f, farthest = 0.0f, light = 0.0f, dark = 1.0f;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float d = both.plane("layer1.depth").at(x, y), grey = depth.planes[0].at(x, y);
      if (!std::isfinite(d)) {
        ASSERT_EQ(grey, 0.0f);
        continue;
      }
      ASSERT_NEAR(normal.plane("color.g").at(x, y), both.plane("layer1.normal.y").at(x, y) * 0.5f + 0.5f, 0.003f);
      if (d < nearest) nearest = d, light = grey;
      if (d > farthest) farthest = d, dark = grey;
    }
  EXPECT_GT(light, dark + 0.3f) << "near is light";
}

TEST_F(Cli, RefusesLayers) {
  for (const char* text : {"0", "17", "-1", "1.5", "x", "nan", "1e9"})
    bad_option(fmt::format("--layers {}", text), {"--layers", fmt::format("'{}'", text), "from 1 to 16"});
  bad("tri.obj -o out.png --passes layer2.depth", 2, {"'layer2.depth'", "--layers 1", "--layers 3"});
  bad("tri.obj -o out.exr --layers 3 --passes depth,layer3.normal", 2, {"'layer3.normal'", "--layers 4"});
  bad("tri.obj -o out.exr --layers 3 --passes layer2.dept", 2, {"'layer2.dept'", "did you mean 'layer2.depth'"});
  bad("tri.obj -o out.exr --passes layer16.depth", 2, {"'layer16.depth'"});
  // Found before the model is read.
  bad("nothere.obj -o out.png --layers 16 --resolution 8192x8192", 2, {"16 layers", "8192 x 8192", "at most"});
  bad("nothere.obj -o out.png --guard-band 100% --resolution 8192x8192", 2, {"24576 x 24576", "at most"});
}

TEST_F(Cli, ExtraViewsAreLayers) {
  good(kSolids + " --layers 2 --extra-views 2 --passes depth,layer1.depth,layer2.depth,layer3.normal -o x.exr" +
       kSmall);
  const Image planes = image("x.exr");
  long others = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      others += std::isfinite(planes.plane("layer2.depth").at(x, y)) &&
                planes.plane("layer2.depth").at(x, y) != planes.plane("depth").at(x, y);
  EXPECT_GT(others, 500);
  // They do not change a picture that reads one layer.
  good(kSolids + " -o one.png" + kSmall);
  good(kSolids + " -o many.png --extra-views 4" + kSmall);
  EXPECT_EQ(text_of(folder_ / "one.png"), text_of(folder_ / "many.png"));
  for (const char* text : {"5", "-1", "1.5", "x", "nan"})
    bad_option(fmt::format("--extra-views {}", text), {"--extra-views", fmt::format("'{}'", text), "from 0 to 4"});
  bad("nothere.obj -o out.png --layers 8 --extra-views 1", 2, {"8 layers and 1 extra view are 9", "at most 8"});
}

TEST_F(Cli, RefusesGuardBands) {
  for (const char* text : {"-1", "-1%", "101%", "5%%", "5%5", "abc", "%", "nan%", "5 %"})
    bad(Words{"tri.obj", "-o", "out.png", "--guard-band", text}, 2,
        {"--guard-band", fmt::format("'{}'", text), "0% to 100%"});
}

TEST_F(Cli, TheGuardBandIsNotWritten) {
  const std::string line = "tri.obj --resolution 60x40 --passes depth,ao --layers 2 -o ";
  good(line + "plain.exr");
  for (const char* band : {"10%", "100%", "0.1%"}) {
    good(line + "guarded.exr --guard-band " + band);
    const Image plain = image("plain.exr"), guarded = image("guarded.exr");
    ASSERT_EQ(guarded.width, 60);
    ASSERT_EQ(guarded.height, 40);
    EXPECT_LT(test::difference(plain.plane("depth"), guarded.plane("depth"), 1e-5).share_over, 0.01) << band;
    const auto a = read_camera(folder_ / "plain.exr"), b = read_camera(folder_ / "guarded.exr");
    ASSERT_TRUE(a && *a && b && *b) << band;
    EXPECT_EQ((*a)->view_from_world, (*b)->view_from_world);
    for (const auto edge : {&Camera::left, &Camera::right, &Camera::bottom, &Camera::top})
      EXPECT_NEAR((**a).*edge, (**b).*edge, 1e-5f) << band;
  }
}

TEST_F(Cli, TheGuardBandIsSeenByEffects) {
  // Zoomed in, the scene goes on beyond the picture; with the band its border is shaded as if it were the middle.
  const std::string line =
      kSolids + " --look ao --camera-zoom-factor 2 --resolution 64x64 --passes ao --set unsharp.kernel=15 -o ";
  good(line + "plain.exr");
  good(line + "guarded.exr --guard-band 15%");
  const Image plain = image("plain.exr"), guarded = image("guarded.exr");
  double border = 0.0, middle = 0.0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double apart = std::fabs(double(plain.planes[0].at(x, y)) - guarded.planes[0].at(x, y));
      const bool inside = std::min({x, y, 63 - x, 63 - y}) >= 8;
      (inside ? middle : border) += apart > 0.02;
    }
  EXPECT_GT(border, 50);
  EXPECT_LT(middle, 20);
}

TEST_F(Cli, TheReferenceIsATechnique) {
  const std::string few = " --resolution 24x24 --ao reference --set reference.samples=2";
  for (const Look* look : looks()) good(fmt::format("{} -o out.png --look {}{}", kSolids, look->name, few));
  good(kSolids + " -o out.exr --passes ao,bent_normal" + few);
  const Image planes = image("out.exr");
  EXPECT_EQ(std::set<std::string>(planes.names.begin(), planes.names.end()),
            (std::set<std::string>{"ao", "bent_normal.x", "bent_normal.y", "bent_normal.z"}));
  good(kSolids + " -o light.exr --look lit --set reference.light=bounce --passes all" + few);
  const Image light = image("light.exr");
  float most = 0.0f;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) most = std::max(most, light.plane("indirect.g").at(x, y));
  EXPECT_GT(most, 0.0f);
  good(kSolids + " -o plain.exr --look lit --passes all" + few);
  EXPECT_EQ(test::difference(image("plain.exr").plane("indirect.g"), Plane(24, 24, 0.0f), 0.0).most, 0.0);
  EXPECT_GT(test::difference(image("plain.exr").plane("lit.g"), light.plane("lit.g"), 0.0).most, 0.01);
}

TEST_F(Cli, TheReferenceBouncesLightWhereTheLookDoes) {
  const std::string few = " --resolution 24x24 --ao reference --passes all --set reference.samples=2";
  const auto brightest = [&](const std::string& options) {
    good(kSolids + " -o light.exr" + options + few);
    const Image light = image("light.exr");
    float most = 0.0f;
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) most = std::max(most, light.plane("indirect.g").at(x, y));
    return most;
  };
  EXPECT_GT(brightest(" --look bleeding"), 0.0f);
  EXPECT_GT(brightest(" --look bleeding-paper"), 0.0f);
  EXPECT_EQ(brightest(" --look bleeding --set reference.light=off"), 0.0f);
  EXPECT_EQ(brightest(" --look lit"), 0.0f);
}

TEST_F(Cli, RefusesReferencesThatCannotBe) {
  bad_option("--ao refrence", {"'refrence'", "did you mean 'reference'"});
  bad_option("--ao reference --set reference.samples=0", {"reference.samples", "'0'", "1 to 4096"});
  bad_option("--ao reference --set reference.samples=5000", {"reference.samples", "'5000'", "1 to 4096"});
  bad_option("--ao reference --set reference.lights=on", {"'lights'", "did you mean 'light'"});
  bad_option("--ao reference --set reference.light=bounced", {"'bounced'", "did you mean 'bounce'"});
  bad_option("--ao reference --ao-radius 0", {"--ao-radius", "'0'"});
  bad_option("--ao reference --ao-radius=-1", {"--ao-radius", "'-1'"});
  bad_option("--ao reference --ao-radius 1e9", {"--ao-radius", "larger than the scene"});
  bad_option("--ao reference --set reference.radius=1e9", {"reference.radius", "larger than the scene"});
}

TEST_F(Cli, LinesAloneHaveAlpha) {
  good(kSolids +
       " --look cartoon --passes outline --set outline.width=2 --set outline.r=1 --set outline.b=0.25 -o lines.png" +
       kSmall);
  const Image lines = image("lines.png");
  ASSERT_NE(lines.find("color.a"), nullptr);
  double least = 1.0, most = 0.0;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) {
      least = std::min<double>(least, lines.plane("color.a").at(x, y));
      most = std::max<double>(most, lines.plane("color.a").at(x, y));
      EXPECT_EQ(lines.plane("color.r").at(x, y), 1.0f);
      EXPECT_NEAR(lines.plane("color.b").at(x, y), 0.537, 0.003);  // 0.25 as sRGB
    }
  EXPECT_EQ(least, 0.0);
  EXPECT_GT(most, 0.9);
}

}  // namespace
}  // namespace umbrage
