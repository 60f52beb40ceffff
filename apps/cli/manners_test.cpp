// Tests of the program in its environment: standard input and output, info, completion, warnings.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::Words;

class Manners : public test::ProgramTest {
 protected:
  /// Runs a shell command in the folder; $UMBRAGE is the program.
  Outcome shell(const std::string& line) {
    const fs::path out = root_ / "out", err = root_ / "err";
    const std::string command = fmt::format("cd {} && export UMBRAGE={} XDG_CONFIG_HOME={} TMPDIR={} && ({}) >{} 2>{}",
                                            test::quoted(folder_.string()), test::quoted(test::kProgram),
                                            test::quoted((root_ / "config").string()), test::quoted(root_.string()),
                                            line, test::quoted(out.string()), test::quoted(err.string()));
    const int status = std::system(("bash -c " + test::quoted(command)).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, test::text_of(out), test::text_of(err)};
  }
  nlohmann::json info(const std::string& line) { return nlohmann::json::parse(good("info --json " + line).out); }

  static constexpr const char* kSmall = " --resolution 32x24 --look ao --device cpu";
};

nlohmann::json record_of(const nlohmann::json& records, const std::string& what) {
  for (const auto& record : records)
    if (record["what"] == what) return record;
  return nlohmann::json();
}

TEST_F(Manners, LimitsOfTheSystemAreNamed) {
  const std::string draw = std::string("$UMBRAGE tri.obj -o tri.png") + kSmall;
  const auto refused = [&](const std::string& line, int code, const std::string& text) {
    const Outcome outcome = shell(line);
    EXPECT_EQ(outcome.code, code) << line;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << line << ": " << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(files().size(), 1u) << line;
  };
  refused("ulimit -f 1; $UMBRAGE tri.obj -o tri.exr" + std::string(kSmall), 3, "File too large");
  refused("ulimit -s 64; " + draw, 4, "the limit of the stack is 64 KiB");
  refused("TMPDIR=/missing; " + draw + " - <tri.obj", 3, "temporary files, '/missing'");
  refused("TMPDIR=/missing; timeout 5 $UMBRAGE view tri.obj --no-open", 3, "temporary files, '/missing'");
  // A reader in another process needs more files than may be open.
  write("empty.gltf", "{}");
  const Outcome few = shell("ulimit -n 6; $UMBRAGE info empty.gltf");
  EXPECT_EQ(few.code, 3);
  EXPECT_NE(few.err.find("Too many open files"), std::string::npos) << few.err;
}

TEST_F(Manners, NamesAreCleanedInMessages) {
  const Outcome outcome = shell("$UMBRAGE info $'a\\e[2J\\n\\xff.obj'");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("'a [2J \xef\xbf\xbd.obj'"), std::string::npos) << outcome.err;
}

TEST_F(Manners, ReadsAModelFromStandardInput) {
  good("tri.obj -o file.png" + std::string(kSmall));
  for (const char* more : {"", " --input-format obj"}) {
    const Outcome piped = shell(fmt::format("$UMBRAGE - -o piped.png{}{} <tri.obj", kSmall, more));
    EXPECT_EQ(piped.code, 0) << piped.err;
    EXPECT_EQ(piped.err, "");
    EXPECT_EQ(test::text_of(folder_ / "piped.png"), test::text_of(folder_ / "file.png"));
    fs::remove(folder_ / "piped.png");
  }
  for (const auto& entry : fs::directory_iterator(root_))
    EXPECT_FALSE(entry.path().filename().string().starts_with("umbrage-")) << "a temporary file is left";
  const auto refused = [&](const std::string& line, int code, const std::string& text) {
    const Outcome outcome = shell(line);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "x.png"));
  };
  refused("$UMBRAGE - -o x.png </dev/null", 3, "standard input is empty");
  refused("echo hello | $UMBRAGE - -o x.png", 3, "--input-format");
  refused("echo hello | $UMBRAGE - -o x.png --input-format ply", 3, "standard input cannot be read as PLY");
  refused("echo hello | $UMBRAGE - -o x.png --input-format pyl", 2, "did you mean 'ply'");
  refused("$UMBRAGE - - -o x.png <tri.obj", 2, "once");
  refused("$UMBRAGE tri.obj -o x.png --input-format obj", 2, "--input-format");
}

TEST_F(Manners, DetectsFormatsByContent) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::pair<std::string, std::string> models[] = {
      {"PLY", ply + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + corners + "3 0 1 2\n"},
      {"OBJ", "# made by hand\n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"OFF", "OFF\n3 1 0\n" + corners + "3 0 1 2\n"},
      {"STL",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
       "a\n"},
      {"XYZ", "# a scan\n" + corners}};
  for (const auto& [format, content] : models) {
    write("model", content);
    const Outcome outcome = shell("$UMBRAGE info - <model");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out.rfind("stdin", 0), 0u) << outcome.out;
    EXPECT_NE(outcome.out.find(": " + format + ", "), std::string::npos) << outcome.out;
  }
  // These are only the beginnings of files, so the error message shows which reader was chosen.
  const std::pair<std::string, std::string> beginnings[] = {
      {"GLB", std::string("glTF\2\0\0\0", 8)},
      {"GLTF", "{ \"asset\": {} }"},
      {"DAE", "<?xml version=\"1.0\"?><COLLADA>"},
      {"FBX", "Kaydara FBX Binary  "},
      {"STL", std::string(80, 's') + std::string("\1\0\0\0", 4) + std::string(50, '\xff')}};
  for (const auto& [format, content] : beginnings) {
    write("model", content);
    const Outcome outcome = shell("$UMBRAGE info - <model");
    EXPECT_EQ(outcome.code, 3) << format << outcome.out;
    EXPECT_TRUE(outcome.err.find(format) != std::string::npos ||
                outcome.err.find("umbrage: standard input ") != std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.err.find("unknown format"), std::string::npos) << format << ": " << outcome.err;
  }
}

TEST_F(Manners, WritesAPictureToStandardOutput) {
  good("tri.obj -o file.png" + std::string(kSmall));
  EXPECT_EQ(good("tri.obj -o -" + std::string(kSmall)).out, test::text_of(folder_ / "file.png"));
  good("tri.obj -o depth.png --passes depth --bits 16" + std::string(kSmall));
  EXPECT_EQ(good("tri.obj -o - --passes depth --bits 16" + std::string(kSmall)).out,
            test::text_of(folder_ / "depth.png"));
  bad("tri.obj -o - --json", 2, {"--json"});
  bad("tri.obj -o - --half", 2, {"--half", ".exr"});
  EXPECT_FALSE(fs::exists(folder_ / "-"));
}

TEST_F(Manners, InfoDescribesAModel) {
  write("a.mtl", "newmtl red\nKd 0.5 0 0\nnewmtl wood\nmap_Kd wood.tga\nnewmtl gone\nmap_Kd gone.png\n");
  std::string tga(18, '\0');
  tga[2] = 2, tga[12] = 2, tga[14] = 1, tga[16] = 24;
  write("wood.tga", tga + "abcdef");
  write("a.obj",
        "mtllib a.mtl\nv 0 0 0\nv 4 0 0\nv 0 2 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n"
        "usemtl wood\nf 1/1 2/2 4/3\nusemtl gone\nf 1/1 3/2 4/3\n");
  const nlohmann::json records = info("a.obj");
  const auto model = record_of(records, "model");
  EXPECT_EQ(model["name"], "a.obj");
  EXPECT_EQ(model["format"], "OBJ");
  EXPECT_EQ(model["triangles"], 3);
  EXPECT_EQ(model["points"], 0);
  EXPECT_EQ(model["meshes"], 3);
  EXPECT_EQ(model["max_x"], 4.0);
  EXPECT_EQ(model["max_y"], 2.0);
  EXPECT_EQ(model["up"], "+Y");
  EXPECT_EQ(record_of(records, "texture")["width"], 2);
  bool found = false;
  for (const auto& record : records)
    if (record["what"] == "material" && record["name"] == "wood")
      found = record["texture"].get<std::string>().ends_with("wood.tga");
  EXPECT_TRUE(found);
  EXPECT_NE(record_of(records, "warning")["text"].get<std::string>().find("gone.png"), std::string::npos);

  const std::string text = good("info a.obj").out;
  for (const char* part : {"a.obj: OBJ, 3 triangles in 3 meshes", "0, 0, 0 to 4, 2, 1", "wood.tga, 2 x 1", "gone.png"})
    EXPECT_NE(text.find(part), std::string::npos) << text;

  write("p.xyz", "0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n");
  EXPECT_EQ(record_of(info("p.xyz"), "model")["points"], 3);
  EXPECT_EQ(record_of(info("p.xyz"), "mesh")["shape"], "discs");
  EXPECT_EQ(record_of(info("p.xyz --point-sprites sphere"), "mesh")["shape"], "spheres");
  EXPECT_EQ(record_of(info("p.xyz"), "mesh")["colors"], true);
  EXPECT_EQ(record_of(info("tri.obj --up=+Z"), "model")["up"], "+Z");
  EXPECT_EQ(record_of(info("scene:pink"), "model")["format"], "built-in");
  EXPECT_GT(record_of(info("scene:pink"), "model")["cameras"], 0);
  bad("info nothere.obj", 3, {"nothere.obj"});
  const Outcome two = run("info nothere.obj a.obj");
  EXPECT_EQ(two.code, 3);
  EXPECT_NE(two.out.find("a.obj: OBJ, 3 triangles"), std::string::npos) << two.out;
}

TEST_F(Manners, CamerasAreChosenByIndex) {
  // The cameras equal those of --camera-position and related options.
  write("a.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
"nodes":[{"mesh":0},{"name":"front","camera":0,"translation":[0.25,0.25,4]},{"camera":1,"translation":[0.25,0.25,4]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.5235987756,"znear":0.1}},
{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0.1,"zfar":9}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  const auto records = info("a.gltf");
  EXPECT_EQ(record_of(records, "model")["cameras"], 2);
  EXPECT_EQ(record_of(records, "camera")["name"], "front");
  EXPECT_EQ(record_of(records, "model")["units"], "m");
  const std::string more = " --resolution 40x30 --look ao --device cpu --passes depth ";
  good("a.gltf --camera-index 0 -o a.pfm" + more);
  good("a.gltf -o b.pfm --camera-position 0.25,0.25,4 --camera-direction 0,0,-1 --camera-view-angle 30" + more);
  const Image a = image("a.pfm"), b = image("b.pfm");
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) ASSERT_EQ(std::isfinite(a.planes[0].at(x, y)), std::isfinite(b.planes[0].at(x, y)));
  EXPECT_NEAR(a.planes[0].at(20, 15), 4.0f, 1e-4f);
  good("a.gltf --camera-index 1 -o c.pfm" + more);
  // The view is two units high: 15 pixels per unit.
  const Image c = image("c.pfm");
  int covered = 0;
  for (int y = 0; y < 30; ++y) covered += std::isfinite(c.planes[0].at(20, y));
  EXPECT_NEAR(covered, 11, 1) << "at x = 0.25 + 1/30 the triangle is 0.717 high";
  good("scene:pink --camera-index 0 -o d.pfm" + more);
  bad("a.gltf -o x.png --camera-index 2", 2, {"--camera-index", "cameras 0 to 1"});
  bad("tri.obj -o x.png --camera-index 0", 2, {"--camera-index", "no cameras"});
  bad("a.gltf -o x.png --camera-index front", 2, {"--camera-index"});
  bad("a.gltf -o x.png --camera-index 0 --camera-position 1,2,3", 2, {"--camera-index", "--camera-position"});
}

/// Returns a glTF file with three scenes: a triangle at x = 0 to 1 (node 0), the same at x = 10 (node 1), and both. The
/// default scene is the second.
std::string three_scenes() {
  return R"({"asset":{"version":"2.0"},"scene":1,"scenes":[{"name":"left","nodes":[0]},{"name":"right","nodes":[1]},
{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"mesh":0,"translation":[10,0,0],"children":[2]},{"camera":0,"translation":[0,0,4]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

/// Converts the file of three_scenes to a .glb file, with the triangle in the second chunk.
std::string as_glb(std::string json) {
  const std::size_t uri = json.find(",\"uri\""), end = json.find("\"}]", uri + 8);
  json.erase(uri, end + 1 - uri);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t head[] = {2, std::uint32_t(12 + 8 + json.size() + 8 + sizeof corners), std::uint32_t(json.size()),
                                0x4e4f534au};
  const std::uint32_t chunk[] = {sizeof corners, 0x004e4942u};
  const auto bytes = [](const auto& list) { return std::string(reinterpret_cast<const char*>(list), sizeof list); };
  return "glTF" + bytes(head) + json + bytes(chunk) + bytes(corners);
}

TEST_F(Manners, ScenesAreChosenByIndex) {
  write("a.gltf", three_scenes());
  write("a.glb", as_glb(three_scenes()));
  for (const std::string file : {"a.gltf", "a.glb"}) {
    SCOPED_TRACE(file);
    const auto own = info(file);
    const auto bounds = [](const nlohmann::json& records) {
      const auto model = record_of(records, "model");
      return std::pair(model["min_x"].get<float>(), model["max_x"].get<float>());
    };
    EXPECT_EQ(bounds(own), std::pair(10.0f, 11.0f)) << "the scene that the file names";
    EXPECT_NE(record_of(own, "warning")["text"].get<std::string>().find("3 scenes"), std::string::npos);
    std::vector<std::string> names;
    int drawn = -1;
    for (const auto& record : own) {
      if (record["what"] != "scene") continue;
      names.push_back(record["name"]);
      if (record["drawn"]) drawn = record["index"];
    }
    EXPECT_EQ(names, (std::vector<std::string>{"left", "right", ""}));
    EXPECT_EQ(drawn, 1);
    const auto left = info(file + " --scene-index 0"), right = info(file + " --scene-index 1"),
               both = info(file + " --scene-index 2");
    EXPECT_EQ(bounds(left), std::pair(0.0f, 1.0f));
    EXPECT_EQ(bounds(right), std::pair(10.0f, 11.0f));
    EXPECT_EQ(bounds(both), std::pair(0.0f, 11.0f));
    EXPECT_EQ(record_of(both, "model")["triangles"], 2);
    EXPECT_TRUE(record_of(left, "warning").is_null());
    // A camera belongs to the scenes that contain its node.
    EXPECT_EQ(record_of(left, "model")["cameras"], 0);
    EXPECT_EQ(record_of(right, "camera")["eye_x"], 10.0f);
    EXPECT_NE(good("info " + file + " --scene-index 0").out.find("--scene-index 0 (left): this one"),
              std::string::npos);
    good(file + " --scene-index 2 -o a.png" + kSmall);
    bad(file + " -o x.png --scene-index 3", 2, {"--scene-index cannot be '3'", file, "3 scenes, 0 to 2"});
  }
  good("tri.obj --scene-index 0 -o b.png" + std::string(kSmall));
  bad("tri.obj -o x.png --scene-index 1", 2, {"--scene-index", "'tri.obj' has one scene, 0"});
  bad("scene:pink -o x.png --scene-index 1", 2, {"--scene-index", "'scene:pink' has one scene, 0"});
  bad("a.gltf -o x.png --scene-index -1", 2, {"--scene-index"});
  bad("a.gltf -o x.png --scene-index left", 2, {"--scene-index"});
}

TEST_F(Manners, CompareAndTuneTakeACameraAndStandardInput) {
  write("a.gltf", three_scenes());
  const std::string few = " --samples 2 --runs 1 --device cpu --resolution 40x30 ";
  good("compare a.gltf -o r --ao unsharp --scene-index 1 --camera-index 0" + few);
  const auto scores = nlohmann::json::parse(test::text_of(folder_ / "r/scores.json"));
  ASSERT_FALSE(scores.empty());
  for (const auto& score : scores)
    EXPECT_TRUE(score["view"].get<std::string>().find(" 4, 0.00 0.00 -1.00, ") != std::string::npos &&
                score["view"].get<std::string>().starts_with("perspective 10 "))
        << score["view"];
  good("tune a.gltf --trials 2 --scene-index 1 --camera-index 0" + few);
  for (const std::string command : {"compare", "tune"}) {
    bad(command + " a.gltf --camera-index 1" + few, 2, {"--camera-index", "one camera, 0"});
    bad(command + " a.gltf --camera-index 0 --camera-position 1,2,3" + few, 2, {"--camera-index", "--camera-position"});
    bad(command + " tri.obj --input-format obj" + few, 2, {"--input-format"});
    bad(command + " - -" + few, 2, {"once"});
  }
  const Outcome compared = shell("$UMBRAGE compare - tri.obj -o s --ao unsharp <a.gltf" + few);
  EXPECT_EQ(compared.code, 0) << compared.err;
  std::set<std::string> scenes;
  for (const auto& score : nlohmann::json::parse(test::text_of(folder_ / "s/scores.json")))
    scenes.insert(score["scene"]);
  EXPECT_EQ(scenes, (std::set<std::string>{"-", "tri.obj"}));
  EXPECT_EQ(shell("$UMBRAGE tune - --trials 2 --input-format gltf <a.gltf" + few).code, 0);
}

// File names in messages are not rewritten to option names.
TEST_F(Manners, FileNamesLikeOptionsAreNotReplaced) {
  bad(Words{"`width`.obj", "-o", "x.png"}, 3, {"'`width`.obj'", "does not exist"});
  bad(Words{"a `look` b.obj", "-o", "x.png"}, 3, {"'a `look` b.obj'", "does not exist"});
  write("`look`.ply", "ply\n");
  bad(Words{"`look`.ply", "-o", "x.png"}, 3, {"'`look`.ply' "});
  bad(Words{"tri.obj", "-o", "x.png", "--camera-index", "0", "--look", "`ao`"}, 2, {"no look '`ao`'"});
  fs::copy_file(folder_ / "tri.obj", folder_ / "`up`.obj");
  bad(Words{"`up`.obj", "-o", "x.png", "--camera-index", "0"}, 2, {"--camera-index cannot be '0': '`up`.obj' has"});
  write("`up`", "layers = 17\n");
  bad(Words{"tri.obj", "-o", "x.png", "--config", "`up`"}, 2, {"'`up`', line 1: --layers cannot be '17'"});
}

TEST_F(Manners, UnwritableOutputIsAFileError) {
  for (const char* words : {"list effects", "manual", "--help", "--version", "render --help"}) {
    const int status = std::system((std::string(test::kProgram) + " " + words + " > /dev/full 2> /dev/null").c_str());
    ASSERT_TRUE(WIFEXITED(status)) << words;
    EXPECT_EQ(WEXITSTATUS(status), 3) << words;
  }
}

TEST_F(Manners, ShellsCompleteEveryOption) {
  const std::string help = good("render --help").out;
  const std::string bash = good("completion bash").out, zsh = good("completion zsh").out,
                    fish = good("completion fish").out, man = good("manual").out;
  int options = 0;
  for (const std::string& word : test::words_of(help)) {
    if (!word.starts_with("--") || word.size() < 4) continue;
    const std::string name = word.substr(0, word.find_first_of(",;:.=)", 2));
    ++options;
    EXPECT_NE(bash.find(name), std::string::npos) << name;
    EXPECT_NE(zsh.find(name), std::string::npos) << name;
    EXPECT_NE(fish.find(" -l " + name.substr(2) + " "), std::string::npos) << name;
  }
  EXPECT_GT(options, 30);
  for (const char* part :
       {".SH UMBRAGE RENDER", "\\fB\\-\\-camera\\-azimuth\\-angle\\fR", "bitmask.radius", "UMBRAGE_DEVICE"})
    EXPECT_NE(man.find(part), std::string::npos) << part;

  write("umbrage.bash", bash);
  const auto completed = [&](const std::string& words) {
    const Outcome outcome =
        shell(fmt::format("source ./umbrage.bash; COMP_WORDS=({}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _umbrage; "
                          "echo \" ${{COMPREPLY[*]}} \"",
                          words));
    EXPECT_EQ(outcome.err, "") << words;
    return outcome.out;
  };
  const auto offers = [&](const std::string& words, const std::string& word) {
    const std::string offered = completed(words);
    EXPECT_NE(offered.find(" " + word + " "), std::string::npos) << words << ": " << offered;
  };
  offers("umbrage ren", "render");
  offers("umbrage tri", "tri.obj");
  offers("umbrage tri.obj --lo", "--look");
  offers("umbrage tri.obj --look stu", "studio");
  offers("umbrage tri.obj --look = car", "cartoon");
  offers("umbrage compare tri.obj --filter de", "denoise");
  offers("umbrage tri.obj --set bitmask.rad", "bitmask.radius=");
  offers("umbrage scene : at", "atrium");
  offers("umbrage list lo", "looks");
  offers("umbrage completion z", "zsh");
  EXPECT_EQ(completed("umbrage tri.obj --look nothing"), "  \n");
  bad("completion tcsh", 2, {"tcsh", "bash"});

  // Shells and groff check the syntax if they are installed.
  write("_umbrage", zsh);
  write("umbrage.fish", fish);
  write("umbrage.1", man);
  EXPECT_EQ(shell("bash -n umbrage.bash").code, 0);
  EXPECT_EQ(shell("! command -v zsh >/dev/null || zsh -n _umbrage").code, 0);
  EXPECT_EQ(shell("! command -v fish >/dev/null || fish --no-execute umbrage.fish").code, 0);
  EXPECT_EQ(shell("! command -v groff >/dev/null || test -z \"$(groff -man -ww -Tutf8 -z umbrage.1 2>&1)\"").code, 0);
}

TEST_F(Manners, WarnsOfAMemoryLimitThatCannotBeMet) {
  const Outcome outcome = run("tri.obj -o x.png --look cartoon --resolution 64 --device cpu --memory 1M");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_TRUE(outcome.err.starts_with("umbrage: warning: 64 x 64 pixels take about 0.06")) << outcome.err;
  EXPECT_NE(outcome.err.find("more than --memory 1M"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST_F(Manners, WarnsOfSettingsThatDoNothing) {
  const auto warned = [&](const std::string& line, const std::string& text) {
    const Outcome outcome = run("tri.obj -o x.png --resolution 32x24 --device cpu " + line);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (text.empty())
      EXPECT_EQ(outcome.err, "") << line;
    else
      EXPECT_NE(outcome.err.find("warning: " + text), std::string::npos) << outcome.err;
  };
  warned("--set outline.width=3", "--set outline.width=3 does nothing: the look studio has no outline");
  warned("--set hbao.radius=5%",
         "--set hbao.radius=5% does nothing: the occlusion of this picture is traced; try --ao hbao");
  warned("--ao none --ao-radius 5%", "--ao-radius 5% does nothing: this picture has no occlusion");
  warned("--point-size 1%", "--point-size does nothing: 'tri.obj' has no points");
  warned("--look cartoon --set toon.bands=3", "--set toon.bands=3: the parameter is now toon.steps");
  warned("--look cartoon --set toon.steps=3", "");
  warned("--set lighting.open=off --set bitmask.slices=2 --set output.shoulder=0.5", "");
  warned("--look ao --ao hbao --set hbao.radius=5%", "");
  warned("--look ao --ao-radius 0.001%",
         "occlusion changes 0 % of the model's pixels: its radius is 0.001 % of the bounding-sphere radius; try "
         "--ao-radius 5%");
  warned("--look ao --ao-radius 25%", "");
}

}  // namespace
}  // namespace umbrage
