// Tests of turntables: numbered pictures and videos of a turning model.
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::text_of;

const std::string kSolids = "scene:solids?detail=2000 --device cpu --resolution 64x48 ";

class TurntableTest : public test::ProgramTest {
 protected:
  /// Writes a shell script named ffmpeg. Returns the assignment to PATH that makes the program find it.
  std::string fake_ffmpeg(const std::string& script) {
    const fs::path bin = root_ / "bin", program = bin / "ffmpeg";
    fs::create_directories(bin);
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    ::chmod(program.c_str(), 0755);
    return fmt::format("PATH={}:/usr/bin:/bin", test::quoted(bin.string()));
  }
  /// Writes an ffmpeg that stores its arguments in ffmpeg.txt and its input in its output file.
  std::string recording_ffmpeg() {
    return fake_ffmpeg(fmt::format("echo \"$@\" >{}\nfor last; do :; done\ncat >\"$last\"",
                                   test::quoted((root_ / "ffmpeg.txt").string())));
  }
  std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) names.insert(entry.path().filename().string());
    names.erase("tri.obj");
    return names;
  }
  /// Writes a cube, which looks the same after a quarter turn. `materials` is the content of cube.mtl.
  void write_cube(const std::string& materials) {
    write("cube.mtl", materials);
    write("cube.obj",
          "mtllib cube.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
          "usemtl side\nf 4 3 7 8\nf 3 2 6 7\nf 1 4 8 5\nusemtl back\nf 2 1 5 6\nusemtl top\nf 8 7 6 5\n");
  }
};

/// Returns the mean absolute difference of two pictures.
double difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) sum += std::abs(double(a.planes[p].at(x, y)) - double(b.planes[p].at(x, y)));
  return sum / (double(a.planes.size()) * a.width * a.height);
}

TEST_F(TurntableTest, WritesNumberedPictures) {
  good(kSolids + "--quality draft -o one.png");
  const Outcome outcome = good(kSolids + "--quality draft -o turn.png --turntable 3 --json");
  EXPECT_EQ(names(), (std::set<std::string>{"one.png", "turn_0000.png", "turn_0001.png", "turn_0002.png"}));
  EXPECT_EQ(text_of(folder_ / "turn_0000.png"), text_of(folder_ / "one.png"));
  const Image a = image("turn_0000.png"), b = image("turn_0001.png"), c = image("turn_0002.png");
  EXPECT_EQ(b.width, 64);
  EXPECT_EQ(b.height, 48);
  for (const auto& [first, second] : {std::pair(&a, &b), {&b, &c}, {&a, &c}})
    EXPECT_GT(difference(*first, *second), 0.01);
  // Each stage has one record, for all frames.
  const auto records = nlohmann::json::parse(outcome.out);
  std::set<std::string> stages;
  for (const auto& record : records) EXPECT_TRUE(stages.insert(record["stage"]).second) << record;
  EXPECT_TRUE(stages.count("load") && stages.count("write") && stages.count("total"));

  good(kSolids + "--look ao -o a%03d.png --turntable 2");
  good(kSolids + "--look ao -o b%%%d.png --turntable 1");
  good(kSolids + "--look ao -o plane.exr --passes depth,normal --turntable 2");
  for (const char* name : {"a000.png", "a001.png", "b%0.png", "plane_0000.exr", "plane_0001.exr"})
    EXPECT_TRUE(names().count(name)) << name;
  EXPECT_EQ(names().size(), 9u);
  EXPECT_TRUE(image("plane_0001.exr").find("normal.x"));
  // Without --turntable, % has no special meaning.
  good(kSolids + "--look ao -o c%03d.png");
  EXPECT_TRUE(names().count("c%03d.png"));
}

TEST_F(TurntableTest, TurnsTheCameraAboutTheModel) {
  // A camera at a given position turns in the same direction as with --camera-azimuth-angle.
  const std::string camera = kSolids + "--look ao --passes depth --camera-position 2,3,8 --camera-focal-point 0,1,0 ";
  good(camera + "-o turn.pfm --turntable 4");
  good(camera + "-o quarter.pfm --camera-azimuth-angle 90");
  const Image turned = image("turn_0001.pfm"), placed = image("quarter.pfm");
  int differ = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const float a = turned.planes[0].at(x, y), b = placed.planes[0].at(x, y);
      differ += std::isfinite(a) != std::isfinite(b) || (std::isfinite(a) && std::abs(a - b) > 1e-3f * b);
    }
  EXPECT_LE(differ, 6) << "silhouettes may fall on either side of a pixel's centre";
}

TEST_F(TurntableTest, LightStaysWithTheCamera) {
  // After a quarter turn a cube looks as before, unless the light has turned with it.
  write_cube("newmtl side\nKd 0.6 0.5 0.4\nnewmtl back\nKd 0.6 0.5 0.4\nnewmtl top\nKd 0.3 0.6 0.3\n");
  for (const std::string look : {"--look studio", "--look lit", "--look studio --hdri-file sky: --hdri-skybox"}) {
    good("cube.obj --device cpu --resolution 96x72 -o turn.png --turntable 4 --overwrite " + look);
    for (const char* name : {"turn_0001.png", "turn_0002.png", "turn_0003.png"})
      EXPECT_LT(difference(image("turn_0000.png"), image(name)), 0.004) << look << " " << name;
    // An eighth of a turn shows a difference.
    good("cube.obj --device cpu --resolution 96x72 -o eighth.png --turntable 8 --overwrite " + look);
    EXPECT_GT(difference(image("eighth_0000.png"), image("eighth_0001.png")), 0.012) << look;
  }
}

TEST_F(TurntableTest, AllViewsHaveOneExposure) {
  // One side of this cube is emissive. If views were metered one by one, those that show this side would be darker.
  write_cube("newmtl side\nKd 0.2 0.2 0.2\nnewmtl back\nKd 0.2 0.2 0.2\nKe 3 3 3\nnewmtl top\nKd 0.2 0.2 0.2\n");
  const std::string line =
      "cube.obj --device cpu --resolution 96x72 --ao none --camera-position 0,9,4 --camera-focal-point 0,1,0 ";
  good(line + "-o turn.png --turntable 2");
  good(line + "-o alone.png --camera-azimuth-angle 180");
  const auto top = [&](const std::string& name) { return image(name).plane("color.r").at(48, 30); };
  EXPECT_NEAR(top("turn_0001.png"), top("turn_0000.png"), 1.5f / 255.0f);
  EXPECT_NEAR(top("alone.png"), top("turn_0000.png"), 1.5f / 255.0f);
}

TEST_F(TurntableTest, MakesVideos) {
  const std::string path = recording_ffmpeg();
  good(kSolids + "--look ao -o one.png");
  good(kSolids + "--look ao -o turn.mp4 --turntable 3 --frame-rate 24", path);
  EXPECT_EQ(names(), (std::set<std::string>{"one.png", "turn.mp4"}));
  const std::string reported = text_of(root_ / "ffmpeg.txt");
  for (const char* part : {"-video_size 64x48", "-framerate 24", "-pixel_format rgb24", "-f mp4"})
    EXPECT_NE(reported.find(part), std::string::npos) << reported;
  const std::string bytes = text_of(folder_ / "turn.mp4");
  ASSERT_EQ(bytes.size(), 3u * 64 * 48 * 3);
  const Image one = image("one.png");
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(one.planes[std::size_t(c)].at(x, y) * 255.0f,
                    float(std::uint8_t(bytes[std::size_t((y * 64 + x) * 3 + c)])), 1e-3f);
  good(kSolids + "--look ao -o turn.webm --turntable 2 --no-background", path);
  EXPECT_EQ(text_of(folder_ / "turn.webm").size(), 2u * 64 * 48 * 4);
  good(kSolids + "--look ao -o depth.gif --turntable 2 --passes depth", path);
  EXPECT_EQ(text_of(folder_ / "depth.gif").size(), 2u * 64 * 48 * 3);
}

TEST_F(TurntableTest, AVideoIsWholeOrNotThere) {
  write("turn.mp4", "older");
  bad(kSolids + "--look ao -o turn.mp4 --turntable 3", 3, {"turn.mp4", "ffmpeg", "not on PATH"}, "PATH=/nowhere");
  for (const char* script : {"echo 'no such codec' >&2; exit 1", "cat >/dev/null; echo 'no such codec' >&2; exit 1",
                             "head -c 5000 >/dev/null; echo 'no such codec' >&2; exit 1"})
    bad(kSolids + "--look ao -o turn.mp4 --turntable 3", 3, {"turn.mp4", "ffmpeg failed", "no such codec"},
        fake_ffmpeg(script));
  EXPECT_EQ(text_of(folder_ / "turn.mp4"), "older");
}

TEST_F(TurntableTest, RefusesWhatCannotBe) {
  const std::string path = recording_ffmpeg();
  for (const char* frames : {"0", "100001", "-1", "2.5", "many"})
    bad(fmt::format("tri.obj -o out.png --turntable={}", frames), 2, {"--turntable", "1 to 100000"});
  bad("tri.obj -o out.mp4", 2, {"out.mp4", "--turntable"}, path);
  bad("tri.obj -o - --turntable 2", 2, {"--turntable", "-o -"});
  bad("tri.obj -o out.bmp --turntable 2", 2, {".jpeg or .webp"});
  for (const char* name : {"a%q.png", "a%4d.png", "a%d%d.png", "a%.png", "a%0999999999999d.png"})
    bad({"tri.obj", "-o", name, "--turntable", "2"}, 2, {name, "%04d"});
  for (const char* rate : {"0", "1001", "fast"})
    bad(fmt::format("tri.obj -o out.mp4 --turntable 2 --frame-rate {}", rate), 2, {"--frame-rate"}, path);
  bad("tri.obj -o out.mp4 --turntable 2 --resolution 63x48", 2, {"63,48", "even"}, path);
  bad("tri.obj -o out.mp4 --turntable 2 --no-background", 2, {"--no-background", ".webm"}, path);
  bad("tri.obj -o out.mp4 --turntable 2 --bits 16", 2, {"--bits"}, path);
  bad("tri.obj -o out.mp4 --turntable 2 --passes all", 2, {"--passes", ".exr"}, path);
  bad("tri.obj -o nothere/out.png --turntable 2", 3, {"nothere"});
  fs::create_directory(folder_ / "out_0001.png");
  bad("tri.obj -o out.png --turntable 2", 3, {"out_0001.png", "folder"});
}

}  // namespace
}  // namespace umbrage
