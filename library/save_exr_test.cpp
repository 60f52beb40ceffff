// Tests that .exr files of the library are those of the program: scene-linear, premultiplied, with the camera.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "io/image_file.h"
#include "run_program.h"
#include "umbrage/umbrage.hpp"

namespace umbrage {
namespace {

const std::string kSolids = "scene:solids?detail=2000";

class SaveExr : public test::ProgramTest {};

TEST_F(SaveExr, IsThatOfTheProgram) {
  for (const bool transparent : {false, true}) {
    SCOPED_TRACE(transparent);
    umb::Picture picture;
    const auto outcome = umb::render({.model = kSolids,
                                      .width = 40,
                                      .height = 30,
                                      .device = "cpu",
                                      .transparent = transparent,
                                      .passes = {"beauty", "depth", "normal", "ao"}},
                                     picture);
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    ASSERT_TRUE(picture.view);
    const auto saved = umb::save(picture, (folder_ / "library.exr").string());
    EXPECT_EQ(saved.code, 0) << saved.message;
    EXPECT_TRUE(saved.warnings.empty());
    const std::string program = fmt::format(
        "'{}' render {} --device cpu --resolution 40x30 --passes "
        "color,depth,normal,ao {} -o '{}'",
        test::kProgram, kSolids, transparent ? "--no-background" : "", (folder_ / "program.exr").string());
    ASSERT_EQ(std::system(program.c_str()), 0);
    const auto ours = read_image(folder_ / "library.exr"), theirs = read_image(folder_ / "program.exr");
    ASSERT_TRUE(ours && theirs);
    EXPECT_EQ(std::set<std::string>(ours->names.begin(), ours->names.end()),
              std::set<std::string>(theirs->names.begin(), theirs->names.end()));
    for (const std::string& name : ours->names)
      for (int y = 0; y < ours->height; ++y)
        for (int x = 0; x < ours->width; ++x) {
          const float a = ours->plane(name).at(x, y), b = theirs->plane(name).at(x, y);
          ASSERT_TRUE(a == b || std::abs(a - b) <= 1e-6f) << name << ' ' << a << ' ' << b;
        }
    const auto camera = read_camera(folder_ / "library.exr"), expected = read_camera(folder_ / "program.exr");
    ASSERT_TRUE(camera && *camera && expected && *expected);
    EXPECT_EQ((*camera)->view_from_world, (*expected)->view_from_world);
    EXPECT_EQ((*camera)->right, (*expected)->right);
  }
}

TEST_F(SaveExr, OfDisplayValuesIsLinearAndPremultiplied) {
  umb::Picture picture;
  picture.width = picture.height = 1;
  picture.rgba = {0.5f, 1.0f, 0.0f, 0.25f};
  const auto saved = umb::save(picture, (folder_ / "a.exr").string());
  EXPECT_EQ(saved.code, 0);
  ASSERT_EQ(saved.warnings.size(), 1u);
  EXPECT_NE(saved.warnings[0].find("\"beauty\""), std::string::npos) << saved.warnings[0];
  const auto read = read_image(folder_ / "a.exr");
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->plane("color.r").at(0, 0), 0.25 * std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_EQ(read->plane("color.g").at(0, 0), 0.25f);
  EXPECT_EQ(read->plane("color.a").at(0, 0), 0.25f);
}

}  // namespace
}  // namespace umbrage
