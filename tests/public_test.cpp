// The public interface, through its header alone.
#include "umbrage/umbrage.h"

#include <gtest/gtest.h>

namespace {

TEST(Public, DrawsAPicture) {
  umbrage::Picture picture;
  const umbrage::Outcome outcome =
      umbrage::render({.model = "scene:solids?detail=7000", .look = "unsharp", .width = 48, .height = 32}, picture);
  ASSERT_EQ(outcome.code, 0) << outcome.message;
  EXPECT_EQ(picture.width, 48);
  EXPECT_EQ(picture.height, 32);
  ASSERT_EQ(picture.rgba.size(), 48u * 32u * 4u);
  float least = 1.0f, most = 0.0f;
  for (const float v : picture.rgba) least = std::min(least, v), most = std::max(most, v);
  EXPECT_LT(least, 0.5f);
  EXPECT_GT(most, 0.9f);
}

TEST(Public, SaysWhatIsWrongAndLeavesThePicture) {
  umbrage::Picture picture{1, 1, {0.25f, 0.5f, 0.75f, 1.0f}};
  const auto outcome = [&](const umbrage::RenderRequest& request) { return umbrage::render(request, picture); };
  EXPECT_EQ(outcome({.model = "missing.obj"}).code, 3);
  EXPECT_NE(outcome({.model = "missing.obj"}).message.find("missing.obj"), std::string::npos);
  EXPECT_EQ(outcome({.model = "scene:solid"}).code, 2);
  EXPECT_EQ(outcome({.model = "scene:solids", .look = "aoo"}).code, 2);
  EXPECT_EQ(outcome({.model = "scene:solids", .settings = {"unsharp.kernel=-1"}}).code, 2);
  EXPECT_EQ(outcome({.model = "scene:solids", .width = 0}).code, 2);
  EXPECT_EQ(picture.rgba[1], 0.5f);
}

TEST(Public, HasAVersion) { EXPECT_EQ(std::string(umbrage::version()).find('.'), 1u); }

}  // namespace
