// Tests of umbrage shade --steady: frames of another renderer are joined along motion vectors or by cameras, and
// nothing is joined that is not the same surface.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::text_of;

constexpr int kWidth = 96, kHeight = 64, kFrames = 8, kSpeed = 3;
constexpr float kNear = 3.6f, kWall = 4.0f, kTop = 0.5f;

/// A square that moves by kSpeed pixels a frame before a still wall with grooves, seen by a perspective camera.
struct Shot {
  bool has_camera = false;
  int pan = 0;    ///< motion of the camera, in pixels of the wall
  int moves = 1;  ///< 0: the square stands still
  std::string motion = "before after";
  int cut = 1000;  ///< first frame of another scene
};

bool is_square(int x, int y, int frame, const Shot& shot) {
  const int left = 12 + shot.moves * kSpeed * frame;
  return x >= left && x < left + 24 && y >= 20 && y < 44;
}

class SteadyShade : public test::ProgramTest {
 protected:
  /// Writes a frame: depth, normals and motion vectors as Nuke names them.
  void write_frame(int frame, const Shot& shot, const std::string& name = "shot") {
    Image image(kWidth, kHeight);
    for (const char* plane : {"depth", "normal.x", "normal.y", "normal.z"})
      image.add(plane) = Plane(kWidth, kHeight, 0.0f);
    for (const char* way : {"before", "after"})
      if (shot.motion.find(way) != std::string::npos)
        for (const char* axis : {".x", ".y"})
          image.add((way == std::string("after") ? "forward" : "backward") + std::string(axis)) =
              Plane(kWidth, kHeight, 0.0f);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool square = is_square(x, y, frame, shot);
        // Grooves of the wall, which stand still in the world.
        const int column = x + shot.pan * frame;
        const bool groove = (column % 24 + 24) % 24 < 4;
        float& depth = image.plane("depth").at(x, y);
        depth = frame >= shot.cut ? 9.0f : square ? kNear : groove ? kWall + 0.4f : kWall;
        image.plane("normal.z").at(x, y) = 1.0f;
        const float way = square ? float(shot.moves * kSpeed) : -float(shot.pan);
        if (Plane* after = image.find("forward.x")) after->at(x, y) = way;
        if (Plane* before = image.find("backward.x")) before->at(x, y) = -way;
      }
    Camera camera;
    camera.top = kTop, camera.bottom = -kTop;
    camera.right = kTop * kWidth / kHeight, camera.left = -camera.right;
    const float pixel = 2.0f * camera.right / kWidth * kWall;
    camera.view_from_world = glm::translate(glm::mat4(1.0f), {-pixel * float(shot.pan * frame), 0.0f, 0.0f});
    WriteSettings settings;
    if (shot.has_camera) settings.camera = &camera;
    ASSERT_TRUE(write_image(folder_ / fmt::format("{}.{:04}.exr", name, frame), image, settings));
  }
  void write_shot(const Shot& shot) {
    for (int frame = 0; frame < kFrames; ++frame) write_frame(frame, shot);
  }
  Outcome shade(const std::string& name, const std::string& more) {
    const Outcome outcome = run(fmt::format(
        "shade shot.####.exr -o {}.####.exr --device cpu --passes ao --look ao --fov 53.13 --scene-radius 3 {}", name,
        more));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome;
  }
  Plane ao(const std::string& name, int frame) { return image(fmt::format("{}.{:04}.exr", name, frame)).plane("ao"); }
  std::string bytes(const std::string& name, int frame) const {
    return text_of(folder_ / fmt::format("{}.{:04}.exr", name, frame));
  }
  /// Shades a frame with the noise of many samples, and returns their mean.
  Plane reference(int frame) {
    constexpr int kSamples = 24;
    Plane mean(kWidth, kHeight, 0.0f);
    for (int k = 0; k < kSamples; ++k) {
      shade("ref", fmt::format("--steady 0 --overwrite --frames {} --set bitmask.sample_index={}", frame, 11 * k));
      const Plane one = ao("ref", frame);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) mean.at(x, y) += one.at(x, y) / float(kSamples);
    }
    return mean;
  }
};

/// Returns the root mean square of the differences, where `counts`.
double difference(const Plane& a, const Plane& b, const std::function<bool(int, int)>& counts, int shift = 0) {
  double sum = 0.0, count = 0.0;
  for (int y = 4; y < kHeight - 4; ++y)
    for (int x = 8; x < kWidth - 8; ++x)
      if (counts(x, y)) sum += std::pow(double(a.at(x, y)) - b.at(x + shift, y), 2.0), ++count;
  EXPECT_GT(count, 50.0);
  return std::sqrt(sum / count);
}

TEST_F(SteadyShade, AWallBehindAMovingSquareHasLessNoiseAndNoTrail) {
  const Shot shot;
  write_shot(shot);
  shade("steady", "--frames 0-7");
  shade("single", "--steady 0 --frames 0-7");
  const Plane right = reference(4), steady = ao("steady", 4), single = ao("single", 4);
  const auto all = [](int, int) { return true; };
  const auto trail = [&](int x, int y) {  // behind the square in this frame, covered by it in one of the frames before
    return !is_square(x, y, 4, shot) &&
           (is_square(x, y, 3, shot) || is_square(x, y, 2, shot) || is_square(x, y, 1, shot));
  };
  EXPECT_LT(difference(steady, right, all), 0.8 * difference(single, right, all));
  EXPECT_LE(difference(steady, right, trail), 1.1 * difference(single, right, trail));
  EXPECT_GT(difference(steady, single, all), 1e-4) << "frames are joined";
}

TEST_F(SteadyShade, APanFlickersLess) {
  for (const bool has_vectors : {true, false}) {
    SCOPED_TRACE(has_vectors);
    write_shot({.has_camera = !has_vectors, .pan = 1, .moves = 0, .motion = has_vectors ? "before" : "", .cut = 1000});
    // The square is no still part of the world: it moves with the camera.
    const auto wall = [](int x, int y) { return (y < 12 || y > 52) && x > 12; };
    shade("steady", "--overwrite");
    shade("single", "--overwrite --steady 0");
    const double now = difference(ao("steady", 4), ao("steady", 3), wall, 1),
                 before = difference(ao("single", 4), ao("single", 3), wall, 1);
    EXPECT_LT(now, 0.5 * before) << now << ", before " << before;
  }
}

TEST_F(SteadyShade, AFrameIsTheSameAloneInARunAndInAShard) {
  write_shot({});
  shade("run", "--frames 1-7");
  shade("run2", "--frames 1-7 --threads 1");
  for (const int shard : {1, 2, 3}) shade("shard", fmt::format("--frames 1-7 --shard {}/3", shard));
  for (int frame = 1; frame < 8; ++frame) {
    EXPECT_EQ(bytes("run", frame), bytes("shard", frame)) << frame;
    EXPECT_EQ(bytes("run", frame), bytes("run2", frame)) << frame;
  }
  shade("alone", "--frames 1,5");
  EXPECT_EQ(bytes("alone", 5), bytes("run", 5));
  // A frame beside that is newer makes a frame old.
  EXPECT_NE(shade("run", "--frames 1-7").err.find("7 of 7 frames are there already"), std::string::npos);
  write_frame(7, {});
  EXPECT_NE(shade("run", "--frames 1-7").err.find("3 of 7 frames are there already"), std::string::npos);
}

TEST_F(SteadyShade, StillFramesAreEqual) {
  write_shot({.has_camera = true, .pan = 0, .moves = 0, .motion = "", .cut = 1000});
  shade("still", "");
  for (int frame = 1; frame < kFrames; ++frame) EXPECT_EQ(bytes("still", frame), bytes("still", 0)) << frame;
}

TEST_F(SteadyShade, WhatIsNotKnownIsNotJoined) {
  const auto equals_single = [&](int frame) { return ao("steady", frame).at(40, 5) == ao("single", frame).at(40, 5); };
  // No vectors and no cameras.
  write_shot({.motion = ""});
  EXPECT_NE(shade("steady", "--steady 3").err.find("neither motion vectors nor the place of the camera"),
            std::string::npos);
  shade("single", "--steady 0");
  for (int frame = 0; frame < kFrames; ++frame) EXPECT_EQ(bytes("steady", frame), bytes("single", frame));
  // NaN in place of vectors.
  write_shot({});
  Image nan(kWidth, kHeight);
  for (const char* axis : {"motion.x", "motion.y"})
    nan.add(axis) = Plane(kWidth, kHeight, std::numeric_limits<float>::quiet_NaN());
  ASSERT_TRUE(write_image(folder_ / "nan.exr", nan));
  shade("steady", "--overwrite --motion nan.exr --motion-kind px,previous --set bitmask.sample_index=0 --frames 0");
  shade("single", "--overwrite --steady 0 --frames 0");
  EXPECT_TRUE(equals_single(0));
}

TEST_F(SteadyShade, CutsMissingFramesAndOtherSizesEndAWindow) {
  write_shot({.cut = 4});
  const Outcome cut = shade("cut", "--frames 0-7");
  EXPECT_NE(cut.err.find("after frame 3 another scene begins"), std::string::npos) << cut.err;
  const std::string before = bytes("cut", 3);
  for (int frame = 4; frame < kFrames; ++frame) fs::remove(folder_ / fmt::format("shot.{:04}.exr", frame));
  EXPECT_EQ(shade("cut", "--frames 0-3 --overwrite").err.find("another scene"), std::string::npos);
  EXPECT_EQ(bytes("cut", 3), before) << "frames after a cut do not matter";
  write_shot({});
  fs::remove(folder_ / "shot.0004.exr");
  shade("gap", "--frames 0-3");
  EXPECT_EQ(bytes("gap", 3), bytes("cut", 3)) << "nor do those after a gap, without cameras";
  // A frame of another size is shaded by itself.
  Image small(32, 24);
  for (const char* plane : {"depth", "normal.z"}) small.add(plane) = Plane(32, 24, 1.0f);
  ASSERT_TRUE(write_image(folder_ / "shot.0004.exr", small));
  const Outcome sizes = shade("size", "--frames 0-7");
  EXPECT_NE(sizes.err.find("frame 4 is not joined with others: it has 32 x 24 pixels, and the first frame 96 x 64"),
            std::string::npos)
      << sizes.err;
  EXPECT_EQ(bytes("size", 3), bytes("cut", 3));
  EXPECT_EQ(image("size.0004.exr").width, 32);
}

TEST_F(SteadyShade, BadInputIsOneSentence) {
  write_shot({});
  ASSERT_TRUE(write_image(folder_ / "small.exr", [] {
    Image image(32, 24);
    image.add("motion.x") = image.add("motion.y") = Plane(32, 24, 0.0f);
    return image;
  }()));
  const auto refused = [&](const std::string& words, int code, const std::string& sentence) {
    const Outcome outcome = run("shade " + words + " -o bad.png --device cpu");
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(sentence), std::string::npos) << outcome.err;
  };
  refused("shot.0000.exr --motion small.exr", 2, "files of one G-buffer have the same size");
  refused("shot.0000.exr --motion shot.0000.exr:depth", 2, "has no layer with two channels");
  refused("shot.0000.exr --motion-kind px,sideways", 2, "--motion-kind cannot be 'sideways'");
  refused("shot.0000.exr --steady 2", 2, "--steady 2 is for a sequence");
  EXPECT_NE(good("info shot.0001.exr").out.find("motion: backward, forward, px to the previous frame, y up"),
            std::string::npos);
}

}  // namespace
}  // namespace umbrage
