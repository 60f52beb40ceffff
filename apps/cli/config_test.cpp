// Tests of the configuration file: what it sets, what overrides it, and errors that name file and line.
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSmall = " --resolution 32x24 --look ao --device cpu";

class Config : public test::ProgramTest {
 protected:
  /// Checks that a command refuses this line of its configuration file, with file and line before the text.
  void refused(const std::string& command, const std::string& line, const std::string& text, int code = 2) {
    write("wrong", "# a comment\n" + line + "\n");
    bad(command + " --config wrong", code, {"umbrage: 'wrong', line 2: " + text});
  }
};

TEST_F(Config, ConfigurationFileSetsOptions) {
  write("mine",
        "# a comment\nresolution = 20x10  # at its end\ndevice = cpu\t# after a tab\n\n[render] # and here\nlook = "
        "\"unsharp\" # "
        "too\nset = "
        "unsharp.kernel=7\n[compare]\nsamples = 16\n");
  good("tri.obj -o a.png --config mine");
  EXPECT_EQ(image("a.png").width, 20);
  good("tri.obj -o b.png --resolution 20x10 --look unsharp --set unsharp.kernel=7 --device cpu");
  EXPECT_EQ(test::text_of(folder_ / "a.png"), test::text_of(folder_ / "b.png"));
  good("tri.obj -o c.png --config=mine --resolution 30x10");
  EXPECT_EQ(image("c.png").width, 30) << "the command line wins";
  good("tri.obj -o c.png --config=mine --ao none");  // unused settings of the file cause no warning
  good("tri.obj -o d.png --look ao --device cpu --resolution 16x16 --config none");
  bad("tri.obj -o e.png --config mine", 2, {"there is no device 'nowhere'"}, "UMBRAGE_DEVICE=nowhere");

  // The default file is optional.
  fs::create_directories(root_ / "config/umbrage");
  std::ofstream(root_ / "config/umbrage/config") << "look = ao\nresolution = 24x8\n";
  good("tri.obj -o f.png --device cpu");
  good("list looks");
  EXPECT_EQ(image("f.png").width, 24);

  write("wrong1", "look ao\n");
  bad("tri.obj -o x.png --config wrong1", 2, {"'wrong1', line 1", "option = value"});
  write("wrong2", "\nlok = ao\n");
  bad("tri.obj -o x.png --config wrong2", 2, {"'wrong2', line 2", "no option 'lok'", "look"});
  write("wrong3", "[rendre]\n");
  bad("tri.obj -o x.png --config wrong3", 2, {"'wrong3', line 1", "did you mean 'render'"});
  write("wrong4", "[render] look = ao\n");
  bad("tri.obj -o x.png --config wrong4", 2, {"'wrong4', line 1: 'look = ao' follows [render]"});
  write("wrong5", "look = \"ao\" bogus\n");
  bad("tri.obj -o x.png --config wrong5", 2, {"'wrong5', line 1: 'bogus' follows \"ao\""});
  bad("tri.obj -o x.png --config nothere", 3, {"'nothere'"});
}

// The viewer saves such files.
TEST_F(Config, ConfigurationMayBeJson) {
  write("mine.json", R"({"resolution": "20x10", "anti-aliasing": 2, "look": "ao", "no-background": false,
                         "ao": "bitmask", "set": ["bitmask.steps=4", "bitmask.slices=2"],
                         "render": {"resolution": "24x12"}})");
  good("tri.obj -o json.png --device cpu --config mine.json");
  good(
      "tri.obj -o same.png --device cpu --config none --resolution 24x12 --anti-aliasing 2 --look ao --ao bitmask "
      "--set bitmask.steps=4 --set bitmask.slices=2");
  EXPECT_EQ(image("json.png").width, 24);
  EXPECT_EQ(test::text_of(folder_ / "json.png"), test::text_of(folder_ / "same.png"));
  const auto refuses = [&](const std::string& text, const std::string& message) {
    write("wrong.json", text);
    bad("tri.obj -o x.png --config wrong.json", 2, {message});
  };
  refuses("{\"look\": ", "'wrong.json' is not valid JSON");
  refuses("{\"lok\": \"ao\"}", "'wrong.json', lok: there is no option 'lok'");
  refuses("{\"rendre\": {\"look\": \"ao\"}}", "did you mean 'render'");
  refuses("{\"look\": null}", "'wrong.json', look: an option takes a text");
  refuses("{\"layers\": 17}", "'wrong.json', layers: --layers cannot be '17'");
}

// Lines of a repeatable option add up within one heading. Values on the command line replace them.
TEST_F(Config, ConfigurationLinesOfRepeatableOptionsAddUp) {
  write("mine", "resolution = 24x24\n[bench]\nresolution = 32x32\nresolution = 40x40\n[render]\nresolution = 48x48\n");
  const auto sizes = [&](const std::string& more) {
    std::set<int> widths;
    const std::string out =
        good("bench tri.obj --effect capture --runs 1 --device cpu --json --config mine" + more).out;
    for (const auto& record : nlohmann::json::parse(out)) widths.insert(record.at("width").get<int>());
    return widths;
  };
  EXPECT_EQ(sizes(""), (std::set<int>{32, 40}));
  EXPECT_EQ(sizes(" --resolution 16x16"), (std::set<int>{16}));
  good("tri.obj -o g.png --config mine");
  EXPECT_EQ(image("g.png").width, 48);
}

TEST_F(Config, InvalidConfigurationValuesNameTheLine) {
  const std::string render = "tri.obj -o x.png";
  refused(render, "layers = 17", "--layers cannot be '17': it takes an integer from 1 to 16");
  refused(render, "camera-zoom-factor = near", "--camera-zoom-factor cannot be 'near': it takes a number from 0.001");
  refused(render, "ao-radius = wide", "--ao-radius cannot be 'wide'");
  refused(render, "ground = maybe", "--ground cannot be 'maybe': it takes auto, on or off");
  refused(render, "resolution = 64x", "--resolution cannot be '64x'");
  refused(render, "guard-band = 200%", "--guard-band cannot be '200%'");
  refused(render, "background-color = 2,0,0", "--background-color cannot be '2,0,0'");
  refused(render, "set = unsharp.kernel=0", "unsharp.kernel cannot be '0'");
  refused(render, "look = nothing", "there is no look 'nothing'");
  refused(render, "ao = nothing", "there is no occlusion technique 'nothing'");
  refused(render, "quality = best", "--quality cannot be 'best'");
  refused(render, "turntable = 0", "--turntable cannot be '0': it takes an integer from 1 to 100000");
  refused(render, "frame-rate = 1e4", "--frame-rate cannot be '1e4': it takes a number from 0.1 to 1000");
  refused(render, "bits = 12", "--bits cannot be '12': it takes 8 or 16");
  refused(render, "memory = much", "--memory cannot be 'much'");
  refused(render, "half = perhaps", "--half cannot be 'perhaps': it takes true or false");
  refused("compare tri.obj", "cameras = 0", "--cameras cannot be '0': it takes an integer from 1 to 100");
  refused("compare tri.obj", "samples = 3", "--samples cannot be '3': it takes an even number from 2 to 4096");
  refused("bench", "resolution = 0x0", "--resolution cannot be '0x0'");
  // Values that the command line overrides, or that are for another command, are not checked.
  write("wrong", "layers = 17\n[bench]\nruns = 0\n");
  good(render + " --config wrong --layers 1" + std::string(kSmall));
}

// Values that depend on others, or on the model, are checked after the command line has been read.
TEST_F(Config, ConfigurationValuesThatAreCheckedLaterNameTheLine) {
  const std::string render = "tri.obj -o x.png" + std::string(kSmall);
  refused("tri.obj -o x.png", "device = nowhere", "there is no device 'nowhere'");
  refused(render, "isa = mmx", "");
  refused(render, "passes = depht", "");
  refused(render, "passes = layer1.depth", "there is no pass 'layer1.depth' with --layers 1");
  refused(render, "passes = depth,emission", "--passes depth,emission needs a file that holds several passes");
  refused(render, "hdri-file = none.hdr", "'none.hdr' does not exist", 3);
  refused(render, "hdri-skybox = true", "--hdri-skybox needs an image");
  refused(render + " --no-background",
          "hdri-skybox = true\nhdri-file = sky:", "--hdri-skybox and --no-background both");
  refused(render + " --hdri-skybox --hdri-file sky:", "no-background = true", "--hdri-skybox and --no-background both");
  refused(render, "set = upsample.factor=4", "--set 'upsample.factor=4': upsample.factor follows from --ao-scale");
  refused(render, "camera-index = 9", "--camera-index cannot be '9'");
  refused(render, "scene-index = 9", "--scene-index cannot be '9'");
  refused(render, "half = true", "--half is for .exr files");
  refused(render, "ground = on", "--ground on requires a look");
  refused(render + " --ao reference", "ao-scale = half", "--ao-scale cannot be 'half'");
  refused(render, "svg = lines.txt", "");
  refused(render, "input-format = xyzw", "--input-format cannot be 'xyzw'");
  refused("compare tri.obj", "filter = nothing", "there is no filter 'nothing'");
  refused("compare tri.obj", "ao = nothing", "there is no occlusion technique 'nothing'");
  refused("compare tri.obj", "baseline = none.json", "", 3);
  refused("tune tri.obj", "ao = none", "--ao none has no settings");
  refused("bench tri.obj", "effect = nothing", "there is no effect 'nothing'");
  refused("figures", "paper = nothing", "there is no paper 'nothing'");
  // Errors about other values do not name the file.
  write("right", "resolution = 9x9\nlayers = 2\nscene-index = 0\n");
  bad(render + " --config right --camera-index 0", 2, {"umbrage: --camera-index cannot be '0'"});
  bad("missing.obj -o x.png --config right", 3, {"umbrage: 'missing.obj' does not exist"});
  write("right", "set = bitmask.slices=2\n");
  bad(render + " --config right --set upsample.factor=4", 2, {"umbrage: --set 'upsample.factor=4'"});
  write("right", "look = studio\n");
  bad("tri.obj -o x.png --config right --passes xyzzy", 2, {"umbrage: the look 'studio' writes no pass 'xyzzy'"});
}

}  // namespace
}  // namespace umbrage
