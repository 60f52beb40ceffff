// Motion vectors: recognised by names, by the frames beside, or by option.
#include "gbuffers/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test_scene.h"

namespace umbrage {
namespace {

using namespace test;

/// A file with depth, and motion channels of these names, which hold these constants.
Understood with_motion(const std::vector<std::pair<std::string, double>>& channels,
                       const GBufferSettings& settings = {}, double max_integer = 0.0) {
  TestFile file(scene());
  file.add("ViewLayer.Depth.Z", 1e10f, [](const Hit& hit) { return hit.depth; });
  file.max_integer = max_integer;
  for (const auto& [name, value] : channels)
    file.add(name, float(value), [value = value](const Hit&) { return value; });
  return understand(file, settings);
}

TEST(Motion, ThatOfBlenderIsKnownByItsName) {
  const auto got = with_motion({{"ViewLayer.Vector.W", 4.0},
                                {"ViewLayer.Vector.X", 1.0},
                                {"ViewLayer.Vector.Y", 2.0},
                                {"ViewLayer.Vector.Z", 3.0}});
  ASSERT_EQ(got.conventions.motion.size(), 2u) << got.text();
  ASSERT_EQ(got.conventions.motion[0].size(), 1u);
  ASSERT_EQ(got.conventions.motion[1].size(), 1u);
  Image stored(1, 1);
  for (const float v : {1.0f, 2.0f, 3.0f, 4.0f}) stored.add(std::to_string(v)) = Plane(1, 1, v);
  const Image motion = motion_planes(stored, got.conventions.motion);
  // Cycles stores previous - this, and this - next, in pixels with y upwards.
  EXPECT_EQ(motion.plane("before.x").at(0, 0), 1.0f);
  EXPECT_EQ(motion.plane("before.y").at(0, 0), -2.0f);
  EXPECT_EQ(motion.plane("after.x").at(0, 0), -3.0f);
  EXPECT_EQ(motion.plane("after.y").at(0, 0), 4.0f);
  EXPECT_NE(got.text().find("motion: ViewLayer.Vector, px to the previous frame, y up, and px from the next frame"),
            std::string::npos)
      << got.text();
}

TEST(Motion, NamesWithADirectionAreFound) {
  const auto nuke = with_motion({{"forward.u", 1.0}, {"forward.v", 0.0}, {"backward.u", -1.0}, {"backward.v", 0.0}});
  ASSERT_EQ(nuke.conventions.motion.size(), 2u) << nuke.text();
  EXPECT_EQ(nuke.conventions.motion[0][0].meaning, "px to the previous frame, y up");
  EXPECT_EQ(nuke.conventions.motion[1][0].meaning, "px to the next frame, y up");
  for (const std::string layer :
       {"motion", "MV", "velocity", "MotionVectors", "FinalImageMovieRenderQueue_MotionVectors"}) {
    const auto open = with_motion({{layer + ".R", 0.1}, {layer + ".G", 0.0}});
    ASSERT_EQ(open.conventions.motion.size(), 1u) << layer;
    EXPECT_GT(open.conventions.motion[0].size(), 1u) << "its name does not say what it means";
    EXPECT_NE(open.text().find("its meaning is decided by the frames beside"), std::string::npos) << open.text();
  }
  const MotionMeanings of_next = with_motion({{"motion_next.X", 0.1}, {"motion_next.Y", 0.0}}).conventions.motion.at(0);
  for (const MotionConvention& meaning : of_next) EXPECT_TRUE(meaning.is_next);
  for (const std::string layer : {"Vector", "emotion", "flower"})
    EXPECT_TRUE(with_motion({{layer + ".X", 0.1}, {layer + ".Y", 0.0}}).conventions.motion.empty()) << layer;
}

TEST(Motion, OptionsDecide) {
  GBufferSettings settings;
  settings.motion_kind = {"uv", "next", "down", "from"};
  const auto got = with_motion({{"MV.X", 0.1}, {"MV.Y", 0.0}}, settings);
  ASSERT_EQ(got.conventions.motion.at(0).size(), 1u);
  EXPECT_EQ(got.conventions.motion[0][0].scale, glm::dvec2(-240.0, -160.0));
  EXPECT_TRUE(got.conventions.motion[0][0].is_next);
  settings.motion_kind = {"down"};
  const auto blender = with_motion({{"Vector.X", 1}, {"Vector.Y", 2}, {"Vector.Z", 3}, {"Vector.W", 4}}, settings);
  EXPECT_EQ(blender.conventions.motion.at(1).at(0).meaning, "px from the next frame, y down");
}

/// A wavy surface, whose pixels move by this motion from frame to frame.
Image moved_waves(glm::dvec2 by) {
  Image image(96, 64);
  Plane& depth = image.add("depth") = Plane(96, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const double u = x - by.x, v = y - by.y;
      depth.at(x, y) = float(5.0 + std::sin(0.31 * u + 0.12 * v) + 0.8 * std::cos(0.23 * v - 0.05 * u));
    }
  return image;
}

TEST(Motion, FramesBesideDecideWhatNamesLeaveOpen) {
  const glm::dvec2 motion(3.0, -2.0);
  const Image here = moved_waves({0.0, 0.0}), next = moved_waves(motion);
  const auto open = with_motion({{"MV.X", 0.01}, {"MV.Y", 0.0}}).conventions.motion.at(0);
  ASSERT_EQ(open.size(), 24u);
  for (const MotionConvention& of_scene : open) {
    MotionMeanings meanings = open;
    MotionConvention truth;
    for (MotionConvention& each : meanings) {
      // The scales of this picture.
      each.scale *=
          glm::dvec2(each.meaning[0] == 'p' ? 1.0 : 96.0 / 240.0, each.meaning[0] == 'p' ? 1.0 : 64.0 / 160.0);
      if (each.meaning == of_scene.meaning) truth = each;
    }
    Image stored(96, 64);
    for (const int axis : {0, 1})
      stored.add(std::to_string(axis)) =
          Plane(96, 64, float((truth.is_next ? 1.0 : -1.0) * motion[axis] / truth.scale[axis]));
    std::vector<MotionMeanings> pairs = {meanings};
    EXPECT_TRUE(narrow_meanings({here, stored}, {next, stored}, pairs)[0]);
    EXPECT_EQ(pairs[0][0].meaning.substr(0, 2), truth.meaning.substr(0, 2));
    for (const MotionConvention& left : pairs[0]) {
      // A motion that is the same everywhere and in time leads to the previous and to the next frame alike.
      const glm::dvec2 way = (left.is_next ? 1.0 : -1.0) * left.scale,
                       right = (truth.is_next ? 1.0 : -1.0) * truth.scale;
      EXPECT_NEAR(way.x, right.x, 1e-9) << left.meaning << " for " << truth.meaning;
      EXPECT_NEAR(way.y, right.y, 1e-9);
    }
  }
  // A still picture leaves all open, and one that no vectors explain leaves them, too, and says so.
  Image still(96, 64);
  still.add("0") = still.add("1") = Plane(96, 64, 0.0f);
  std::vector<MotionMeanings> pairs = {open};
  EXPECT_TRUE(narrow_meanings({here, still}, {here, still}, pairs)[0]);
  EXPECT_EQ(pairs[0].size(), open.size());
  const Image cut = moved_waves({40.0, 17.0});
  Image moving(96, 64);
  moving.add("0") = moving.add("1") = Plane(96, 64, 3.0f);
  EXPECT_FALSE(narrow_meanings({here, moving}, {cut, moving}, pairs)[0]);
  EXPECT_EQ(pairs[0].size(), open.size());
}

TEST(Motion, ValuesAroundOneHalfAreFractions) {
  const auto got = with_motion({{"MV.R", 0.52}, {"MV.G", 0.49}}).conventions.motion.at(0);
  for (const MotionConvention& meaning : got) {
    EXPECT_EQ(meaning.zero, 0.5);
    EXPECT_NE(meaning.meaning.substr(0, 2), "px");
  }
  const MotionMeanings wide = with_motion({{"MV.R", 12.0}, {"MV.G", 0.0}}).conventions.motion.at(0);
  for (const MotionConvention& meaning : wide)
    EXPECT_EQ(meaning.meaning.substr(0, 2), "px") << "no motion is wider than the picture";
}

}  // namespace
}  // namespace umbrage
