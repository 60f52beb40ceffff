// Tests of invalid input to the program, and of its error messages.
#include <gtest/gtest.h>

#include "cli_support.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::kSmall;
using test::Words;

class CliRefusals : public test::ProgramTest {};

TEST_F(CliRefusals, RefusesFilesThatAreNotModels) {
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
  bad("nothere.obj -o out.png", 3, {"nothere.obj", "does not exist"});
  bad("no/where.obj -o out.png", 3, {"no/where.obj", "does not exist"});
  bad("folder.obj -o out.png", 3, {"folder.obj", "folder"});
  bad("notes.txt -o out.png", 3, {"notes.txt", ".obj", ".ply"});
  bad("lines.obj -o out.png", 3, {"lines.obj", "no triangles"});
  bad("range.obj -o out.png", 3, {"range.obj", "vertices that are missing"});
  bad("nan.obj -o out.png", 3, {"nan.obj", "not finite"});
  bad("line.obj -o out.png", 3, {"line.obj", "degenerate"});
  bad("tri.obj nothere.obj -o out.png", 3, {"nothere.obj"});
}

TEST_F(CliRefusals, RefusesModelsThatAreCutShort) {
  // Files whose headers promise 1000 triangles, but which end earlier.
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

TEST_F(CliRefusals, RefusesResolutions) {
  for (const char* text : {"0x0", "-5x5", "100000x100000", "16385x16384", "abc", "0", "64,", "64x", "x64", "64x64x64",
                           "1e2x64", "64.5x64", "99999999999x1"})
    bad_option(std::string("--resolution ") + text, {"--resolution", fmt::format("'{}'", text), "16384"});
}

TEST_F(CliRefusals, RefusesPlacesToWrite) {
  fs::create_directory(folder_ / "folder");
  write("file", "a file");
  const auto to = [&](const std::string& output, const Words& texts) { bad(Words{"tri.obj", "-o", output}, 3, texts); };
  to("nofolder/out.png", {"nofolder/out.png", "does not exist"});
  to("file/out.png", {"file/out.png", "not a folder"});
  to("folder", {"folder", "is a folder"});
  to("folder/", {"folder", "is a folder"});
  to("", {"empty"});
  bad("tri.obj -o out", 2, {"'out'", ".png", ".exr", ".pfm"});
  bad("tri.obj -o out.gif", 2, {"'out.gif'"});
  bad("tri.obj -o out.avi", 2, {"'.avi'", ".mp4, .webm or .gif"});
  bad("compare tri.obj -o page.png", 2, {"--output", "'page.png'", "a folder, for index.html"});
  bad("tri.obj -o out.pgn", 2, {"did you mean 'png'"});
  to("/proc/out.png", {"/proc/out.png", "cannot be written"});
  if (::geteuid() != 0) {  // root may write everywhere
    fs::create_directory(folder_ / "locked");
    fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    to("locked/out.png", {"locked", "ermission"});
  }
}

TEST_F(CliRefusals, RefusesValuesOutOfRange) {
  bad_option("--camera-position 1e19,0,0", {"--camera-position", "'1e19,0,0'", "1e+15"});
  bad_option("--camera-focal-point 0,1e30,0", {"--camera-focal-point", "1e+15"});
  bad_option("--ao-radius 0", {"--ao-radius", "'0'"});
  bad_option("--passes depth,depth", {"'depth'", "twice"});
  bad_option("--half", {"--half", ".exr"});
  bad("tri.obj -o out.exr --bits 16", 2, {"--bits", ".png"});
}

TEST_F(CliRefusals, PassColorKeepsItsChannels) {
  good("tri.obj -o out.png --passes color --background-color 1,0.5,0" + kSmall);
  const auto image = read_image(folder_ / "out.png");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_NEAR(image->plane("color.r").at(0, 0), 1.0f, 1e-3);
  EXPECT_NEAR(image->plane("color.g").at(0, 0), 0.5f, 3e-3);
  EXPECT_NEAR(image->plane("color.b").at(0, 0), 0.0f, 1e-3);
}

TEST_F(CliRefusals, RefusesNamesThatDoNotExist) {
  bad_option("--lok ao", {"'--lok'", "did you mean '--look'"});
  bad_option("--resolutoin=8x8", {"'--resolutoin'", "did you mean '--resolution'"});
  for (const auto& [name, own] : {std::pair("bg-color", "background-color"),
                                  {"camera-azimuth", "camera-azimuth-angle"},
                                  {"ambient-occlusion", "ao"},
                                  {"ssao", "ao"},
                                  {"no-ground", "ground"}})
    bad_option(fmt::format("--{} 3", name), {fmt::format("(did you mean '--{}'?)", own)});
  bad_option("--background-color transparent", {"'transparent'", "--no-background"});
  bad_option("--fooo", {"'--fooo'", "umbrage render --help"});
  bad_option("--xyzzy", {"'--xyzzy'", "umbrage render --help"});
  bad_option("-q", {"'-q'", "umbrage render --help"});
  bad_option("--look unshap", {"'unshap'", "did you mean 'unsharp'"});
  bad_option("--look xyzzy", {"'xyzzy'", "available: ", "ao", "unsharp"});
  bad_option("--ao unshrp", {"'unshrp'", "did you mean 'unsharp'"});
  bad_option("--ao xyzzy", {"'xyzzy'", "available: ", "unsharp", "none"});
  bad_option("--device cpuu", {"'cpuu'", "did you mean 'cpu'"});
  bad_option("--device xyzzy", {"'xyzzy'", "available: ", "cpu"});
  bad_option("--passes dept", {"'dept'", "did you mean 'depth'"});
  bad_option("--passes xyzzy", {"'xyzzy'", "available: ", "normal"});
  good("tri.obj -o half.exr --look bleeding --ao-scale half --passes ao,indirect" + kSmall);
  bad_option("--look bleeding --ao-scale half --passes denoise_ao", {"'bleeding'", "'denoise_ao'"});
  // Passes that only other looks have.
  bad_option("--look bleeding --passes outline", {"'bleeding'", "'outline'", "the look cartoon does"});
  bad_option("--look bleeding --passes zzz", {"'zzz'", "available: ", "indirect"});
  bad_option("--set unshar.kernel=4", {"'unshar'", "did you mean 'unsharp'"});
  bad_option("--set unsharp.kernal=4", {"'kernal'", "did you mean 'kernel'"});
  bad_option("--set composite.mode=multipl", {"'multipl'", "did you mean 'multiply'"});
  bad("scene:solid -o out.png", 2, {"'solid'", "did you mean 'solids'"});
  bad("scene:xyzzy -o out.png", 2, {"'xyzzy'", "available: ", "atrium"});
  bad("scene:solids?detail=3 -o out.png", 2, {"'3'", "1000"});
  bad("scene:solids?colour=red -o out.png", 2, {"'colour=red'", "detail"});
  bad("rendr tri.obj -o out.png", 2, {"'rendr'", "did you mean 'render'"});
  bad("list lokos", 2, {"'lokos'", "did you mean 'looks'"});
  bad("list xyzzy", 2, {"'xyzzy'", "effects"});
}

TEST_F(CliRefusals, RefusesOptionsWithNothingInThem) {
  for (const char* option : {"--ao-scale", "--layers", "--ao", "--look", "--ao-radius", "--camera-zoom-factor", "--up",
                             "--passes", "--set", "--resolution"}) {
    bad_option(option + std::string("="), {option, "needs a value"});
    bad(Words{"tri.obj", "-o", "out.png", option, ""}, 2, {option, "needs a value"});
  }
}

TEST_F(CliRefusals, RefusesValues) {
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
  bad_option("--threads 1.5", {"--threads", "'1.5'", "an integer"});
  bad_option("--threads 99999", {"--threads", "'99999'", "0 to 1024"});
  bad_option("--bits 7", {"--bits", "'7'", "8 or 16"});
  bad_option("--bits many", {"--bits", "'many'", "8 or 16"});
  bad_option("--turntable 1.5", {"--turntable", "'1.5'", "an integer from 1 to 100000"});
  for (const char* text : {"0", "-1", "nan", "inf", "long"})
    bad_option(fmt::format("--time {}", text), {"--time", fmt::format("'{}'", text), "a number from 0.001 to 604800"});
  bad_option("--time 1 --anti-aliasing 1", {"--anti-aliasing 1", "--time", "leave out one"});
  bad_option("--time 1 --passes depth", {"--time", "--passes are not averaged"});
  bad("tri.obj --time 1 -o lines.svg", 2, {"--time", "lines are not averaged"});
  bad_option("--time 1 --memory 70M --resolution 2000", {"--time", "2000 x 2000", "raise --memory"});
  bad_option("--frame-rate 0", {"--frame-rate", "'0'", "a number from 0.1 to 1000"});
  for (const char* text : {"much", "0", "-1G", "1GB", "G", "inf"})
    bad_option(fmt::format("--memory {}", text), {"--memory", fmt::format("'{}'", text), "such as 6G"});
  bad_option("--verbose=perhaps", {"--verbose", "'perhaps'"});
  bad_option("--passes all", {"--passes all", ".exr"});
  bad_option("--passes depth,normal", {"depth,normal", ".exr"});
  // Only after the model is read is it known that these passes do not exist. Even so, nothing is drawn.
  const std::string none = "there is no pass ";
  for (const char* extra : {"", " --turntable 2", " --memory 200M", " --anti-aliasing 4"}) {
    bad_option("--passes emission" + std::string(extra), {none + "'emission'", "leave it out of --passes"});
    bad_option("--passes shadow5" + std::string(extra), {none + "'shadow5'", "--passes takes shadow"});
  }
  for (const char* option : {"--camera-position", "--camera-focal-point"})
    for (const char* text : {"1,2", "1,2,3,4", "a,b,c", "nan,0,0", "inf,0,0", ",,", "1;2;3"})
      bad_option(fmt::format("{} {}", option, text), {option, fmt::format("'{}'", text), "three numbers"});
  for (const char* option : {"--camera-direction", "--camera-view-up", "--up"})
    for (const char* text : {"0,0,0", "W", "+W", "1,2", "nan,1,0"})
      bad_option(fmt::format("{} {}", option, text), {option, fmt::format("'{}'", text), "+Y"});
  for (const char* text : {"0", "180", "-30", "wide", "nan"})
    bad_option(fmt::format("--camera-view-angle {}", text), {"--camera-view-angle", fmt::format("'{}'", text), "179"});
  bad_option("--camera-position 1,2,3 --camera-focal-point 1,2,3",
             {"--camera-position", "'1,2,3'", "its own position"});
  bad_option("--camera-position 1,2,3 --camera-focal-point 0,0,0 --camera-direction 1,0,0",
             {"--camera-position", "--camera-focal-point and --camera-direction both"});
  bad_option("--background-color wite", {"did you mean 'white'?"});
  bad_option("--look= studio", {"--look needs a value after its '='"});
  bad("tri.obj --style -o out.png", 2, {"--style needs a value", "-o, is an option"});
  bad("tri.obj -o --look studio", 2, {"-o needs a value", "--look, is an option"});
  bad_option("--set toon.steps=2.5", {"toon.steps", "'2.5'", "an integer from"});
  bad("tri.obj -o out.bmp", 2, {"'out.bmp'", ".jpeg or .webp"});
  bad_option("--camera-zoom-factor 0", {"--camera-zoom-factor", "'0'"});
  bad_option("--camera-azimuth-angle x", {"--camera-azimuth-angle", "'x'"});
  bad_option("--camera-elevation-angle 1e9", {"--camera-elevation-angle", "'1e9'"});
  for (const char* text : {"2,0,0", "-0.1,0,0", "nocolor", "#12345", "#ggg", "1,1", "nan,0,0"})
    bad_option(fmt::format("--background-color {}", text),
               {"--background-color", fmt::format("'{}'", text), "three numbers from 0 to 1"});
}

TEST_F(CliRefusals, RefusesSectionsThatCutNothing) {
  for (const char* text : {"w=1", "x=1cm", "1,2,3", "0,0,0,1", "x=nan"})
    bad_option(fmt::format("--section {}", text), {"--section cannot be", fmt::format("'{}'", text), "it takes x=0.4"});
  bad_option("--section x=1000", {"--section 'x=1000' cuts nothing", "along x", "extends from"});
  bad_option("--section x>1000", {"leaves nothing"});
  bad_option("--section x=50% --section x=1000", {"'x=1000'"});
}

TEST_F(CliRefusals, RefusesMissingAndExtraArguments) {
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
  bad("list effects outlien", 2, {"'outlien'", "did you mean 'outline'"});
  bad("list passes cartoom", 2, {"'cartoom'", "did you mean 'cartoon'"});
  bad("list looks extra more", 2, {"'more'", "too many"});
}

}  // namespace
}  // namespace umbrage
