// Tests camera paths: the curve passes its keys at their times, and bad files are refused by name.
#include "scene/camera_path.h"

#include <gtest/gtest.h>

#include "file_folder.h"

namespace umbrage {
namespace {

struct CameraPathTest : test::FileFolder {
  Result<CameraPath> read(const std::string& text, const std::string& name = "path.csv") {
    write(name, text);
    return CameraPath::read(folder / name);
  }
};

const std::string kHeader =
    "time,position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z,view_angle\n";

TEST_F(CameraPathTest, PassesItsKeysAtTheirTimes) {
  const auto path = read(kHeader + "2,0,0,5,0,0,0,30\n3,1,2,5,0,0,0,40\n# a comment\n5,4,0,5,0,1,0,50\n");
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_DOUBLE_EQ(path->duration_s(), 3.0);
  for (const auto& [time, x, y, angle] : {std::tuple(-1.0, 0.0, 0.0, 30.0),
                                          {0.0, 0.0, 0.0, 30.0},
                                          {1.0, 1.0, 2.0, 40.0},
                                          {3.0, 4.0, 0.0, 50.0},
                                          {9.0, 4.0, 0.0, 50.0}}) {
    Framing framing;
    path->set_camera(time, framing);
    EXPECT_NEAR(framing.position->x, x, 1e-12) << time;
    EXPECT_NEAR(framing.position->y, y, 1e-12) << time;
    EXPECT_NEAR(*framing.view_angle_deg, angle, 1e-5) << time;
    EXPECT_FALSE(framing.view_up);
  }
}

TEST_F(CameraPathTest, AStraightPathIsEven) {
  const auto path = read(
      "position_x,position_y,position_z,focal_point_x,focal_point_y,focal_point_z\n"
      "0,0,5,0,0,0\n1,0,5,1,0,0\n2,0,5,2,0,0\n3,0,5,3,0,0\n");
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_DOUBLE_EQ(path->duration_s(), 3.0);
  for (double time = 0.0; time < 3.0; time += 0.1) {
    Framing framing;
    path->set_camera(time, framing);
    EXPECT_NEAR(framing.position->x, time, 1e-9);
    EXPECT_NEAR(framing.focal_point->x, time, 1e-9);
  }
}

TEST_F(CameraPathTest, ReadsJson) {
  const auto path = read(R"([{"position": [0, 0, 5], "focal_point": [0, 0, 0], "up": [0, 0, 1]},
                             {"position": [0, 4, 5], "focal_point": [0, 0, 0], "up": [0, 1, 1]}])",
                         "path.json");
  ASSERT_TRUE(path) << path.error().message;
  Framing framing;
  path->set_camera(path->duration_s() / 2.0, framing);
  EXPECT_NEAR(framing.position->y, 2.0, 1e-9);
  EXPECT_NEAR(framing.view_up->y, 0.5, 1e-6);
  const auto marked = read("\xef\xbb\xbf" + kHeader + "0,0,0,5,0,0,0,30\r\n1,1,0,5,0,0,0,30\r\n");
  EXPECT_TRUE(marked) << marked.error().message;
}

TEST_F(CameraPathTest, RefusesBadFilesByName) {
  for (const auto& [text, said] :
       {std::pair<std::string, std::string>(kHeader + "0,0,0,5,0,0,0,30\n", "fewer than two"),
        {kHeader + "1,0,0,5,0,0,0,30\n1,1,0,5,0,0,0,30\n", "key camera 2: its time, 1, is not after"},
        {kHeader + "0,0,0,5,0,0,0,30\n1,1,x,5,0,0,0,30\n", "line 3: position_y must be a number, not 'x'"},
        {kHeader + "0,0,0,5,0,0,0\n", "7 values for 8 columns"},
        {kHeader + "0,0,0,5,0,0,5,30\n1,0,0,5,0,0,0,30\n", "position and focal point are equal"},
        {"positionx,a\n1,2\n3,4\n", "no column"},
        {"position_x,position_y\n1,2\n3,4\n", "'position_z' is missing"},
        {"[{\"position\": [1, 2]}]", "key camera 1: 'position' must be a number or three"},
        {"[1]", "key camera 1 is no object"},
        {"[", "no valid JSON"},
        {"time;position_x\n0;1\n", "commas"},
        {"position_x,position_x\n", "twice"},
        {kHeader + "0,0,0,5,0,0,0,180\n1,1,0,5,0,0,0,30\n", "view_angle must be from 0.1 to 179, not 180"},
        {"{}", "must be an array"}}) {
    const auto path = read(text);
    ASSERT_FALSE(path) << text;
    EXPECT_NE(path.error().message.find(said), std::string::npos) << path.error().message;
    EXPECT_EQ(path.error().kind, ErrorKind::kFile);
  }
}

}  // namespace
}  // namespace umbrage
