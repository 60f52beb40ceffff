// Tests of pictures that have one camera: turntables, videos, times of an animation, models with the same view.
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
  const Outcome outcome = good(kSolids + "--quality draft -o turn.png --turntable 3 --steady 0 --json");
  EXPECT_EQ(names(),
            (std::set<std::string>{"one.png", "turn.frames", "turn_0000.png", "turn_0001.png", "turn_0002.png"}));
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
  EXPECT_EQ(names().size(), 13u) << "pictures and four records of frames";
  EXPECT_TRUE(image("plane_0001.exr").find("normal.x"));
  // Without --turntable, % has no special meaning.
  EXPECT_NE(run(kSolids + "--look ao -o c%03d.png").err.find("'c%03d.png'"), std::string::npos);
  EXPECT_TRUE(names().count("c%03d.png"));
  EXPECT_NE(run(kSolids + "--look ao -o a%03d.png --turntable 1").err.find("'a###.png' has more frames"),
            std::string::npos);
  EXPECT_TRUE(names().count("a001.png"));
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
  good(kSolids + "--look ao -o turn.mp4 --turntable 3 --steady 0 --frame-rate 24", path);
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

TEST_F(TurntableTest, ShadesVideos) {
  const std::string path = recording_ffmpeg();
  good(kSolids + "--passes depth,normal,albedo -o shot.####.exr --turntable 3");
  good("shade shot.####.exr -o one.####.png --device cpu");
  good("shade shot.####.exr -o shot.mp4 --device cpu --frame-rate 12", path);
  const std::string reported = text_of(root_ / "ffmpeg.txt"), bytes = text_of(folder_ / "shot.mp4");
  for (const char* part : {"-video_size 64x48", "-framerate 12", "-f mp4"})
    EXPECT_NE(reported.find(part), std::string::npos) << reported;
  ASSERT_EQ(bytes.size(), 3u * 64 * 48 * 3);
  for (int frame = 0; frame < 3; ++frame) {
    const Image one = image(fmt::format("one.{:04}.png", frame));
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(one.planes[std::size_t(c)].at(x, y) * 255.0f,
                      float(std::uint8_t(bytes[std::size_t(((frame * 48 + y) * 64 + x) * 3 + c)])), 1e-3f);
  }
  good("shade shot.####.exr -o half.gif --device cpu --reduction 2 --frames 0-1", path);
  EXPECT_EQ(text_of(folder_ / "half.gif").size(), 2u * 32 * 24 * 3);
  write("shot.mp4", "older");
  good(
      "scene:solids?detail=2000 --device cpu --resolution 80x60 --passes depth,normal,albedo -o wide.####.exr "
      "--turntable 2");
  fs::rename(folder_ / "wide.0001.exr", folder_ / "other.0001.exr");
  fs::copy(folder_ / "shot.0000.exr", folder_ / "other.0000.exr");
  bad("shade other.####.exr -o other.mp4 --device cpu --steady 0", 3, {"other.mp4", "80 x 60", "64 x 48"}, path);
  bad("shade shot.0000.exr -o shot.mp4", 2, {"shot.mp4", "####"}, path);
  bad("shade shot.####.exr -o shot.mp4 --shard 1/2", 2, {"--shard"}, path);
  bad("shade shot.####.exr -o shot.mp4 --overwrite", 2, {"--overwrite"}, path);
  bad("shade shot.####.exr -o shot.mp4 --merge", 2, {"--merge"}, path);
  bad("shade shot.####.exr -o shot.mp4 --frames 0-4", 3, {"no input: 3-4"}, path);
  bad("shade shot.####.exr -o shot.mp4", 3, {"ffmpeg", "not on PATH"}, "PATH=/nowhere");
  fs::resize_file(folder_ / "shot.0001.exr", 3000);
  bad("shade shot.####.exr -o shot.mp4 --device cpu", 3, {"shot.0001.exr"}, path);
  EXPECT_EQ(text_of(folder_ / "shot.mp4"), "older");
}

/// Writes a box of this size in x, on the ground.
std::string box_obj(float width) {
  return fmt::format(
      "v 0 0 0\nv {0} 0 0\nv {0} 0 1\nv 0 0 1\nv 0 1 0\nv {0} 1 0\nv {0} 1 1\nv 0 1 1\n"
      "f 4 3 7 8\nf 3 2 6 7\nf 1 4 8 5\nf 2 1 5 6\nf 8 7 6 5\nf 1 2 3 4\n",
      width);
}

/// Returns a model of which one box stays and another rises by 5 in 2 seconds and turns half around.
std::string rising_gltf(bool moves) {
  auto json = nlohmann::json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"name":"stays"},{"mesh":1,"name":"rises","translation":[2,0,0]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.3,0.3,0.3,1],"metallicFactor":0}},
{"pbrMetallicRoughness":{"baseColorFactor":[0.9,0.9,0.9,1],"metallicFactor":0},"emissiveFactor":[1,1,1]}],
"buffers":[{"uri":"rise.bin","byteLength":196}],
"bufferViews":[{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":36},
{"buffer":0,"byteOffset":132,"byteLength":8},{"buffer":0,"byteOffset":140,"byteLength":24},
{"buffer":0,"byteOffset":164,"byteLength":32}],
"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR"},
{"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"},
{"bufferView":4,"componentType":5126,"count":2,"type":"VEC4"}],
"animations":[{"samplers":[{"input":2,"output":3},{"input":2,"output":4}],
"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},
{"sampler":1,"target":{"node":1,"path":"rotation"}}]}]})");
  if (!moves) json.erase("animations");
  return json.dump();
}

std::string rising_bin() {
  std::string bytes;
  const auto add = [&](std::initializer_list<float> numbers) {
    for (const float number : numbers) bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  for (const float y : {0.0f, 1.0f}) add({-0.5f, y, -0.5f, 0.5f, y, -0.5f, 0.5f, y, 0.5f, -0.5f, y, 0.5f});
  for (const char index :
       {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6, 3, 2, 6, 3, 6, 7, 2, 1, 5, 2, 5, 6, 1, 0, 4, 1, 4, 5, 0, 3, 7, 0, 7, 4})
    bytes.push_back(index);
  add({0.0f, 2.0f});
  add({2.0f, 0.0f, 0.0f, 2.0f, 5.0f, 0.0f});
  add({0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 1.0f, 0.0f, 0.0f});
  return bytes;
}

/// Returns the number of pixels that show a surface, and of those among them that differ, where both pictures show the
/// object `id`; and whether a surface is at the border.
struct Seen {
  int both = 0, different = 0;
  bool at_border = false;
};
Seen seen(const Image& a, const Image& b, const Image& color_a, const Image& color_b, float id) {
  Seen seen;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const float d = a.plane("depth").at(x, y);
      seen.at_border |= std::isfinite(d) && (x == 0 || y == 0 || x == a.width - 1 || y == a.height - 1);
      if (a.plane("object_id").at(x, y) != id || b.plane("object_id").at(x, y) != id) continue;
      ++seen.both;
      seen.different += d != b.plane("depth").at(x, y) ||
                        std::abs(color_a.plane("color.g").at(x, y) - color_b.plane("color.g").at(x, y)) > 1.5f / 255.0f;
    }
  return seen;
}

// The camera, the ground and the exposure are those of the whole animation: what does not move looks the same at all
// times, and what moves stays in the picture.
TEST_F(TurntableTest, AMovingModelHasOneViewAndExposure) {
  write("rise.bin", rising_bin());
  write("rise.gltf", rising_gltf(true));
  write("still.gltf", rising_gltf(false));
  const std::string small = " --device cpu --resolution 96x96 --ao none --shadow-strength 0 ";
  for (const char* time : {"0", "0.9", "2"})
    for (const char* output : {"png", "exr --passes depth,object_id"})
      good(fmt::format("rise.gltf{0}--animation-time {1} -o t{1}.{2}", small, time, output));
  const Image first = image("t0.exr"), first_color = image("t0.png");
  for (const std::string time : {"0", "0.9", "2"}) {
    const Image other = image("t" + time + ".exr"), color = image("t" + time + ".png");
    const Seen stays = seen(other, first, color, first_color, 0.0f);
    EXPECT_GT(stays.both, 100) << time;
    EXPECT_LT(stays.different, stays.both / 10) << time << ": the edges that what moves hides may differ";
    EXPECT_FALSE(stays.at_border) << time;
    EXPECT_GT(seen(other, other, color, color, 1.0f).both, 100) << time;
  }
  // Without a time, the animation changes nothing.
  good("rise.gltf" + small + "-o rise.png");
  good("still.gltf" + small + "-o still.png");
  EXPECT_EQ(text_of(folder_ / "rise.png"), text_of(folder_ / "still.png"));
}

TEST_F(TurntableTest, AnAnimationIsASequence) {
  write("rise.bin", rising_bin());
  write("rise.gltf", rising_gltf(true));
  write("still.gltf", rising_gltf(false));
  const std::string small = " --device cpu --resolution 64x64 ";
  good("rise.gltf" + small + "--animate --frame-rate 1.5 -o all.png");
  EXPECT_TRUE(fs::exists(folder_ / "all_0003.png"));  // 2 s
  EXPECT_FALSE(fs::exists(folder_ / "all_0004.png"));
  good("rise.gltf" + small + "--animate --frame-rate 1.5 -o some.png --frames 2");
  EXPECT_EQ(text_of(folder_ / "all_0002.png"), text_of(folder_ / "some_0002.png"));
  good("rise.gltf" + small + "--animate --frame-rate 1.5 -o single.png --steady 0 --frames 3");
  good("rise.gltf" + small + "--animation-time 2 -o end.png");
  EXPECT_EQ(text_of(folder_ / "single_0003.png"), text_of(folder_ / "end.png"));
  EXPECT_GT(difference(image("all_0000.png"), image("all_0003.png")), 0.005);
  bad("still.gltf --animate -o all.png", 2, {"--animate", "'still.gltf' has none"});
  bad("rise.gltf --animate -o all.png --frames 9-120", 2, {"--frames 9-120", "0 to 60"});
  bad("rise.gltf --animate --same-view -o '{stem}.png'", 2, {"--animate", "--same-view"});
  bad("rise.gltf --animate --animation-time 1 -o all.png", 2, {"--animate", "--animation-time"});
  bad("rise.gltf --steady 3 -o one.png", 2, {"--steady 3", "--turntable"});
  bad("rise.gltf --animate -o -", 2, {"--animate", "-o -"});
  bad("rise.gltf --animate --turntable 3 -o all.png", 2, {"--animate", "--turntable"});
}

TEST_F(TurntableTest, ACameraPathIsASequence) {
  // The camera stands still for the last second.
  write("path.csv",
        "time,position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z\n"
        "0,8,3,8,0,1,0\n1,0,4,10,0,1,0\n1.5,-8,2,6,0,1,0\n2.5,-8,2,6,0,1,0\n");
  const std::string line = kSolids + "--camera-path path.csv --frame-rate 4 ";
  good(line + "-o whole.png");
  EXPECT_TRUE(fs::exists(folder_ / "whole_0010.png"));
  EXPECT_FALSE(fs::exists(folder_ / "whole_0011.png"));
  good(line + "-o part.png --shard 2/3");
  for (int frame = 4; frame < 8; ++frame)
    EXPECT_EQ(text_of(folder_ / fmt::format("part_{:04}.png", frame)),
              text_of(folder_ / fmt::format("whole_{:04}.png", frame)));
  EXPECT_NE(text_of(folder_ / "whole_0000.png"), text_of(folder_ / "whole_0001.png"));
  good(kSolids + "--camera-path path.csv --steady 0 -o one.png --frames 0 --frame-rate 4");
  good(kSolids + "--camera-position 8,3,8 --camera-focal-point 0,1,0 -o single.png");
  EXPECT_EQ(difference(image("one_0000.png"), image("single.png")), 0.0);
  write("back.csv",
        "time,position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z\n"
        "1,8,3,8,0,1,0\n0,0,4,10,0,1,0\n");
  bad(kSolids + "--camera-path back.csv -o x.png", 3, {"'back.csv', key camera 2", "not after"});
  bad(kSolids + "--camera-path path.csv --turntable 2 -o x.png", 2, {"--turntable", "--camera-path"});
}

TEST_F(TurntableTest, FramesOfAStandingCameraAreEqual) {
  write("path.csv",
        "time,position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z\n"
        "0,8,3,8,0,1,0\n1,8,3,8,0,1,0\n");
  good(kSolids + "--camera-path path.csv --frame-rate 2 -o p.png");
  for (const char* name : {"p_0001.png", "p_0002.png"})
    EXPECT_EQ(text_of(folder_ / name), text_of(folder_ / "p_0000.png"));
}

TEST_F(TurntableTest, HatchingDependsOnTwoKeyFrames) {
  // The camera stands still for the last second.
  write("path.csv",
        "time,position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z\n"
        "0,8,3,8,0,1,0\n2,4,3,9,0,1,0\n3,4,3,9,0,1,0\n");
  const std::string line = kSolids + "--look hatching --frame-rate 8 ";
  good(line + "--camera-path path.csv -o whole.png");
  good(line + "--camera-path path.csv -o part.png --shard 2/3");
  good(line + "--camera-path path.csv -o one.png --frames 7");
  for (int frame = 9; frame < 17; ++frame)
    EXPECT_EQ(text_of(folder_ / fmt::format("part_{:04}.png", frame)),
              text_of(folder_ / fmt::format("whole_{:04}.png", frame)));
  EXPECT_EQ(text_of(folder_ / "one_0007.png"), text_of(folder_ / "whole_0007.png"));
  for (int frame = 17; frame < 25; ++frame)
    EXPECT_EQ(text_of(folder_ / fmt::format("whole_{:04}.png", frame)), text_of(folder_ / "whole_0016.png"));
  good(line + "--camera-path path.csv -o new.png --frames 7 --steady 0");
  EXPECT_NE(text_of(folder_ / "new_0007.png"), text_of(folder_ / "whole_0007.png"));
  // Occlusion that is joined does not change this.
  good(line + "--ao traced --turntable 200 -o turn.png --frames 0-3");
  good(line + "--ao traced --turntable 200 -o third.png --frames 3");
  EXPECT_EQ(text_of(folder_ / "third_0003.png"), text_of(folder_ / "turn_0003.png"));
}

TEST_F(TurntableTest, ModelsWithTheSameViewAreDrawnAlone) {
  write("a.obj", box_obj(1.0f));
  write("b.obj", box_obj(4.0f));
  write("c.obj", box_obj(1.0f));
  fs::create_directory(folder_ / "out");
  const std::string small = " --device cpu --resolution 64x64 ";
  good("a.obj b.obj c.obj" + small + "--same-view -o out/{stem}.png");
  good("a.obj b.obj" + small + "--same-view -o out/{stem}.exr --passes depth,object_id");
  EXPECT_EQ(names(),
            (std::set<std::string>{"a.obj", "b.obj", "c.obj", "out", "a.png", "b.png", "c.png", "a.exr", "b.exr"}));
  EXPECT_EQ(text_of(folder_ / "out/a.png"), text_of(folder_ / "out/c.png"));
  // The left side, which both boxes have, is seen from one camera.
  const Image a = image("out/a.exr"), b = image("out/b.exr");
  int both = 0, same = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      if (std::isfinite(a.plane("depth").at(x, y))) {
        ++both;
        same += std::abs(a.plane("depth").at(x, y) - b.plane("depth").at(x, y)) < 1e-4f;
      }
  EXPECT_GT(both, 60);
  EXPECT_GT(same, both / 2) << "the front and the top are the same in both";
  good("a.obj" + small + "-o alone.exr --passes depth");
  EXPECT_NE(text_of(folder_ / "alone.exr"), text_of(folder_ / "out/a.exr"));
}

TEST_F(TurntableTest, ATurnOfModelsWithTheSameViewFits) {
  write("a.obj",
        "v 0 0 0\nv .1 0 0\nv .1 0 -9\nv 0 0 -9\nv 0 1 0\nv .1 1 0\nv .1 1 -9\nv 0 1 -9\nf 1 2 6 5\nf 2 3 7 6\n");
  write("b.obj", box_obj(1.0f));
  good("a.obj b.obj --device cpu --resolution 64x64 --look ao --turntable 4 --same-view --passes depth -o {stem}.pfm");
  for (const char* name : {"a_0000.pfm", "a_0001.pfm", "a_0002.pfm", "a_0003.pfm"}) {
    const Image depth = image(name);
    for (int k = 0; k < 64; ++k)
      EXPECT_FALSE(std::isfinite(depth.planes[0].at(0, k)) || std::isfinite(depth.planes[0].at(63, k))) << name;
  }
}

TEST_F(TurntableTest, RefusesNamesForModelsWithTheSameView) {
  write("a.obj", box_obj(1.0f));
  write("a.b.obj", box_obj(1.0f));
  fs::create_directory(folder_ / "more");
  fs::copy(folder_ / "a.obj", folder_ / "more/a.obj");
  const std::set<std::string> before = names();
  bad("a.obj a.b.obj --same-view -o out.png", 2, {"out.png", "{stem}"});
  bad("a.obj more/a.obj --same-view -o {stem}.png", 2, {"more/a.obj", "'a.png'"});
  bad("a.obj nothere.obj --same-view -o {stem}.png", 3, {"nothere.obj", "does not exist"});
  bad("a.obj - --same-view -o {stem}.png", 2, {"--same-view", "standard input"});
  bad("a.obj -o {stem}.png", 2, {"{stem}", "--same-view"});
  bad("a.obj --same-view -o {stem}.svg --svg x.svg", 2, {"--svg", "{stem}"});
  bad("a.obj --same-view -o nothere/{stem}.png", 3, {"nothere"});
  EXPECT_EQ(names(), before);
}

TEST_F(TurntableTest, WarnsOfUnrelatedModels) {
  write("a.obj", box_obj(1.0f));
  write("b.obj", box_obj(1.5f));
  write("large.obj", box_obj(500.0f));
  write("far.obj", "v 40 0 0\nv 41 0 0\nv 40 1 0\nf 1 2 3\n");
  const std::string small = " --device cpu --resolution 16x16 --ao none -o out.png";
  const auto count = [&](const std::string& models) {
    const std::string text = run(models + small).err;
    int found = 0;
    for (auto at = text.find("--same-view"); at != std::string::npos; at = text.find("--same-view", at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("a.obj b.obj"), 0);
  EXPECT_EQ(count("a.obj large.obj"), 1);
  EXPECT_EQ(count("a.obj far.obj large.obj"), 1);
  const auto warns = [&](const std::string& models, const std::string& text) {
    EXPECT_NE(run(models + small).err.find(text), std::string::npos) << models;
    const std::string err = run(models + " --device cpu --resolution 16x16 --ao none --same-view -o {stem}.png").err;
    EXPECT_NE(err.find(text), std::string::npos) << err;
    EXPECT_EQ(err.find("far apart"), std::string::npos) << err;
  };
  write("mm.obj", "v 0 0 0\nv 1000 1000 1000\nv 0 1000 0\nf 1 2 3\n");
  warns("a.obj far.obj", "'far.obj' is 24.8 times farther from 'a.obj' than they are large");
  warns("mm.obj a.obj", "'mm.obj' is 1000 times as large as 'a.obj': it is probably in mm, the other in m");
  warns("a.obj large.obj", " times as large as 'a.obj'; their units may differ");
  write("z.stl",
        "solid z\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 1\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid z\n");
  warns("z.stl a.obj", "'a.obj' has +Y up, 'z.stl' +Z, and neither is turned (--up gives the axis of both)");
  EXPECT_EQ(run("z.stl a.obj --up=+Z" + small).err.find("+Y"), std::string::npos);
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
