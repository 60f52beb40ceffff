// Tests of the program: the files it writes, its output and its lists.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli_support.h"
#include "core/version.h"
#include "effects/effects.h"
#include "generators/builtin.h"
#include "kernel/isa.h"
#include "looks/looks.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::expect_pictures_of;
using test::kSmall;
using test::kSolids;
using test::Outcome;
using test::text_of;
using test::Words;

class Cli : public test::ProgramTest {};

// ---- Rendering

TEST_F(Cli, CurvesInStripsHaveHiddenLines) {
  const std::string line = "scene:solids?detail=7000 --look technical --set hidden.draw=on --resolution 256x200 -o ";
  good(line + "whole.svg");
  run(line + "strips.svg --memory 1M");
  const std::string whole = test::text_of(folder_ / "whole.svg");
  EXPECT_NE(whole.find("class=\"hidden\""), std::string::npos);
  EXPECT_EQ(test::text_of(folder_ / "strips.svg"), whole);
}

TEST_F(Cli, PrintsHelpAndVersion) {
  for (const char* line : {"--help", "-h", "render --help", "list --help", "bench --help", "figures --help"}) {
    const Outcome help = good(line);
    EXPECT_NE(help.out.find("Usage: umbrage"), std::string::npos) << line << ": " << help.out;
  }
  EXPECT_NE(good("--help").out.find("render"), std::string::npos);
  EXPECT_EQ(good("help").out, good("--help").out);
  for (const char* command : {"render", "tune", "help"})
    EXPECT_EQ(good(std::string("help ") + command).out, good(std::string(command) + " --help").out);
  bad("help rendre", 2, {"no command 'rendre'", "did you mean 'render'"});
  for (const auto& [other, own] : {std::pair{"transparent", "no-background"},
                                   {"background", "background-color"},
                                   {"size", "resolution"},
                                   {"width", "resolution"},
                                   {"fov", "camera-view-angle"},
                                   {"zoom", "camera-zoom-factor"}})
    bad(std::string("scene:claw -o claw.png --") + other + " 3", 2, {std::string("did you mean '--") + own + "'"});
  bad("scene:claw -o claw.png --set toon.levels=3", 2, {"did you mean 'steps'"});
  EXPECT_NE(good("render --help").out.find("--resolution"), std::string::npos);
  const std::string version = good("--version").out;
  EXPECT_EQ(version.rfind(fmt::format("umbrage {}\ncommit ", project_version()), 0), 0u) << version;
  EXPECT_NE(version.find(fmt::format("{} (in use)", isa_in_use())), std::string::npos) << version;
  EXPECT_NE(version.find("\ndevices cpu"), std::string::npos) << version;
}

TEST_F(Cli, DrawsABuiltInSceneInEveryFormat) {
  for (const char* extension : {"png", "exr", "pfm"}) {
    const std::string name = fmt::format("out.{}", extension);
    EXPECT_EQ(good(kSolids + " --look ao -o " + name + kSmall).out, "");
    const Image picture = image(name);
    ASSERT_EQ(picture.width, 64);
    ASSERT_EQ(picture.height, 64);
    const Plane& grey = picture.plane("color.r");
    float min = 1.0f, max = 0.0f;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) min = std::min(min, grey.at(x, y)), max = std::max(max, grey.at(x, y));
    EXPECT_LT(min, 0.8f) << name << ": nothing is occluded";
    EXPECT_GT(max, 0.95f) << name << ": nothing is open";
  }
}

TEST_F(Cli, OneNumberIsASquare) {
  good("tri.obj -o out.png --look ao --resolution 24");
  EXPECT_EQ(image("out.png").width, 24);
  EXPECT_EQ(image("out.png").height, 24);
  const auto records = nlohmann::json::parse(
      good("bench tri.obj --effect capture --runs 1 --device cpu --json --resolution 16 --resolution 24x8").out);
  ASSERT_EQ(records.size(), 4u);  // with and without a shadow
  for (const auto& record : records)
    EXPECT_EQ(record.at("height").get<int>(), record.at("width").get<int>() == 16 ? 16 : 8) << record;
  write("mine", "resolution = 20\n");
  good("tri.obj -o out.png --look ao --config mine");
  EXPECT_EQ(image("out.png").height, 20);
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
    good(std::string(line) + " --look unsharp --resolution 8x8 --device cpu");
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
  // The command line takes precedence.
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
  good("tri.obj --look unsharp -o two.exr --passes depth,normal" + kSmall);
  const Image two = image("two.exr");
  EXPECT_EQ(std::set<std::string>(two.names.begin(), two.names.end()),
            (std::set<std::string>{"depth", "normal.x", "normal.y", "normal.z"}));
  EXPECT_EQ(test::difference(two.plane("depth"), all.plane("depth"), 0.0).max, 0.0);
  EXPECT_TRUE(*read_camera(folder_ / "two.exr")) << "the camera is missing";
}

TEST_F(Cli, PassesAsPicturesCanBeSeen) {
  good("tri.obj -o depth.png --passes depth" + kSmall);
  good("tri.obj -o normal.png --passes normal" + kSmall);
  good("tri.obj -o both.exr --passes depth,normal" + kSmall);
  const Image depth = image("depth.png"), normal = image("normal.png"), both = image("both.exr");
  ASSERT_EQ(depth.planes.size(), 1u);
  expect_pictures_of(both.plane("depth"), both.plane("normal.y"), depth, normal);
}

TEST_F(Cli, DepthOfAFlatSceneIsNear) {
  write("flat.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  good("flat.obj -o out.png --passes depth --camera-direction 0,0,-1" + kSmall);
  EXPECT_GT(image("out.png").planes[0].at(32, 32), 0.9f);
}

TEST_F(Cli, JsonHasTheTimeOfEachStage) {
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
  for (const char* stage : {"load", "prepare", "capture", "traced", "average", "output", "write"})
    EXPECT_TRUE(stages.count(stage)) << stage;
}

TEST_F(Cli, BackgroundOptionsApply) {
  good("tri.obj -o color.pfm --background-color 0.25,0.5,0.75" + kSmall);
  EXPECT_EQ(image("color.pfm").plane("color.r").at(0, 0), 0.25f);
  EXPECT_EQ(image("color.pfm").plane("color.b").at(0, 0), 0.75f);
  good("tri.obj -o none.png --no-background" + kSmall);
  const Image none = image("none.png");
  ASSERT_NE(none.find("color.a"), nullptr);
  EXPECT_EQ(none.plane("color.a").at(0, 0), 0.0f);
  EXPECT_EQ(none.plane("color.a").at(32, 32), 1.0f);
}

TEST_F(Cli, TimeDrawsThePicturesOfTheQualityAtLeast) {
  const std::string line = "tri.obj" + kSmall + " --quality high -o ";
  good(line + "plain.png");
  const auto done = run(line + "short.png --time 0.001 --verbose");
  EXPECT_EQ(done.code, 0);
  EXPECT_NE(done.err.find("pictures averaged: "), std::string::npos) << done.err;
  EXPECT_EQ(text_of(folder_ / "short.png"), text_of(folder_ / "plain.png"));
}

TEST_F(Cli, OptionsChangeThePicture) {
  const std::string line = "tri.obj" + kSmall + " --passes depth,ao,color -o ";
  good(line + "plain.exr");
  for (const char* option : {"--look unsharp",
                             "--ao none",
                             "--ao-scale half",
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
  EXPECT_EQ(test::difference(none.plane("ao"), Plane(64, 64, 1.0f), 0.0).max, 0.0);
}

TEST_F(Cli, BitsAndHalfAreWritten) {
  good(kSolids + " -o eight.png --set output.gradient=0" + kSmall);
  good(kSolids + " -o plain.pfm --set output.gradient=0" + kSmall);
  good(kSolids + " -o dithered.png" + kSmall);
  good(kSolids + " -o sixteen.png --bits 16" + kSmall);
  good(kSolids + " -o float.exr" + kSmall);
  good(kSolids + " -o float.pfm" + kSmall);
  good(kSolids + " -o half.exr --half" + kSmall);
  const Image display = image("float.pfm"), light = image("float.exr");
  const auto max_error = [&](const Image& exact, const std::string& other) {
    return test::difference(exact.plane("color.r"), image(other).plane("color.r"), 0.0).max;
  };
  EXPECT_LE(max_error(image("plain.pfm"), "eight.png"), 0.5 / 255 + 1e-6);
  EXPECT_GT(max_error(image("plain.pfm"), "eight.png"), 1e-3);
  // The gradient of the background is dithered, in files of 8 bits only.
  EXPECT_LE(max_error(display, "dithered.png"), 1.0 / 255 + 1e-6);
  EXPECT_GT(max_error(display, "dithered.png"), 0.6 / 255);
  EXPECT_LE(max_error(display, "sixteen.png"), 0.5 / 65535 + 1e-6);
  EXPECT_LE(max_error(light, "half.exr"), 1e-3);
  EXPECT_GT(max_error(light, "half.exr"), 1e-6);
}

TEST_F(Cli, SeveralModelsShareOnePicture) {
  write("other.obj", "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\n");
  good("tri.obj other.obj -o out.exr --passes object_id --resolution 200x60");
  const Image picture = image("out.exr");
  std::set<float> ids;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 200; ++x) ids.insert(picture.plane("object_id").at(x, y));
  EXPECT_EQ(ids, (std::set<float>{-1.0f, 0.0f, 1.0f}));
  write("far.obj", "v 500 0 0\nv 501 0 0\nv 500 1 0\nf 1 2 3\n");
  write("large.obj", "v -200 -200 0\nv 200 -200 0\nv 0 200 0\nf 1 2 3\n");
  for (const char* unrelated : {"far.obj", "large.obj"}) {
    const Outcome outcome = run(fmt::format("tri.obj {} -o out.png{}", unrelated, kSmall));
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find("--same-view"), std::string::npos) << unrelated << ": " << outcome.err;
  }
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
  // A missing material library is a warning too.
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
  // At reduced resolution only techniques and filters run.
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
              !effect->filters_itself && (effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter)
                  ? 1u
                  : 0u)
        << effect->name;
  EXPECT_FALSE(timed_half.count("capture"));
  bad("bench --ao-scale third", 2, {"--ao-scale", "'third'", "quarter"});
  bad("bench --ao-scale half --effect lighting", 2, {"--ao-scale", "'half'", "lighting", "technique or filter"});
  bad("bench --ao-scale half --effect capture", 2, {"capture"});
  bad("bench --effect unshrp", 2, {"'unshrp'", "did you mean 'unsharp'"});
  bad("bench --runs 0", 2, {"--runs", "1 to"});
  bad("bench --runs x", 2, {"--runs", "'x'", "an integer"});
  bad("bench --resolution abc", 2, {"--resolution", "'abc'"});
  bad("bench nothere.obj", 3, {"nothere.obj"});
}

TEST_F(Cli, FiguresRefuseWhatTheyCannotDo) {
  bad("figures --paper unshrp", 2, {"unshrp", "unsharp"});
  bad("figures -o tri.obj", 3, {"tri.obj"});
  bad("figures extra", 2, {"'extra'", "too many"});
}

// ---- Lists

TEST_F(Cli, ListsEverything) {
  Words look_names, effect_names, scene_names, format_names = {".png", ".exr", ".pfm", ".jpg", ".jpeg", ".webp"};
  for (const Look* look : looks()) look_names.emplace_back(look->name);
  for (const Effect* effect : effects()) {
    effect_names.emplace_back(effect->name);
    for (const Parameter& row : effect->parameters)
      effect_names.push_back(fmt::format("{}.{}", effect->name, row.name));
  }
  for (const BuiltinScene& scene : builtin_scenes()) scene_names.push_back(fmt::format("scene:{}", scene.name));
  for (const std::string& format : import_formats()) format_names.push_back("." + format);
  for (const auto& [kind, names] : {std::pair<std::string, Words>{"looks", look_names},
                                    {"effects", effect_names},
                                    {"effects outline", {"outline", "outline.width"}},
                                    {"passes", {"depth", "ao", "color", "all"}},
                                    {"passes cartoon", {"toon_key", "outline"}},
                                    {"scenes", scene_names},
                                    {"devices", {"cpu"}},
                                    {"formats", format_names}}) {
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
  for (const Look* look : scene_looks())
    good(fmt::format("tri.obj -o out.png --resolution 16x16 --look {}", look->name));
  for (std::string_view name : occlusion_names())
    good(fmt::format("tri.obj -o out.png --resolution 16x16 --ao {}", name));
}

}  // namespace
}  // namespace umbrage
