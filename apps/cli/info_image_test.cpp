// umbrage info of image files.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli_support.h"

namespace umbrage::test {
namespace {

struct ImageInfo : ProgramTest {
  Outcome info(const std::string& words) { return run("info " + words); }

  /// A slope with normals and a beauty.
  void write_render(const std::string& name) const {
    Image image(32, 24);
    for (const char* plane : {"color.r", "color.g", "color.b", "normal.x", "normal.y", "normal.z", "depth"})
      image.add(plane) = Plane(32, 24, 0.0f);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x) {
        image.plane("depth").at(x, y) = 4.0f + 0.1f * float(y);
        image.plane("normal.z").at(x, y) = 1.0f;
        image.plane("color.r").at(x, y) = 0.5f;
      }
    ASSERT_TRUE(write_image(folder_ / name, image));
  }
};

TEST_F(ImageInfo, LayersFactsAndContactSheet) {
  write_render("render.exr");
  const Outcome text = info("render.exr --fov 40");
  ASSERT_EQ(text.code, 0) << text.err;
  for (const char* line : {"layer: depth (Z)", "layer: normal (XYZ)", "layer: RGB", "depth: depth (Z), planar",
                           "camera: 40 deg high, by option", "beauty: RGB"})
    EXPECT_NE(text.out.find(line), std::string::npos) << line << "\n" << text.out;
  const Outcome json = info("render.exr --json --contact-sheet sheet.png");
  ASSERT_EQ(json.code, 0) << json.err;
  int layers = 0, cells = 0;
  for (const auto& record : nlohmann::json::parse(json.out)) {
    layers += record["what"] == "layer";
    if (record["what"] != "contact_sheet") continue;
    ++cells;
    EXPECT_GE(record["row"].get<int>(), 1);
  }
  EXPECT_EQ(layers, 3);
  EXPECT_EQ(cells, 3);
  const auto sheet = read_image(folder_ / "sheet.png");
  ASSERT_TRUE(sheet);
  EXPECT_GT(sheet->width, 2 * 32);
}

TEST_F(ImageInfo, TheFirstFrameOfASequence) {
  write_render("shot.0003.exr");
  write_render("shot.0004.exr");
  const Outcome text = info("shot.####.exr");
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* line : {"frame: 3 of 3-4", "depth: depth (Z), planar"})
    EXPECT_NE(text.out.find(line), std::string::npos) << line << "\n" << text.out;
  EXPECT_EQ(info("none.####.exr").code, 3);
}

TEST_F(ImageInfo, PixelsThatCannotBeRead) {
  write_render("cut.exr");
  std::filesystem::resize_file(folder_ / "cut.exr", std::filesystem::file_size(folder_ / "cut.exr") - 100);
  const Outcome cut = info("cut.exr");
  EXPECT_EQ(cut.code, 3) << cut.out;
  EXPECT_NE(cut.err.find("cut.exr"), std::string::npos) << cut.err;
}

TEST_F(ImageInfo, FilesWithoutDepthAndOtherFiles) {
  Image color(8, 8);
  for (const char* plane : {"color.r", "color.g", "color.b"}) color.add(plane) = Plane(8, 8, 0.2f);
  color.planes[1].at(2, 2) = 0.9f;
  for (int x = 0; x < 8; ++x) color.planes[0].at(x, 3) = 0.9f;
  ASSERT_TRUE(write_image(folder_ / "photo.png", color));
  const Outcome photo = info("photo.png");
  EXPECT_EQ(photo.code, 0);
  EXPECT_NE(photo.out.find("warning"), std::string::npos) << photo.out;
  write("broken.exr", "nothing of the kind");
  EXPECT_EQ(info("broken.exr").code, 3);
  EXPECT_EQ(info("").code, 2);
  EXPECT_EQ(info("scene:solids --contact-sheet sheet.png").code, 2);
}

}  // namespace
}  // namespace umbrage::test
