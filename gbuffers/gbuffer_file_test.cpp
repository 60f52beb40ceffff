// GBufferFile with files on disk.
#include "gbuffers/gbuffer_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "file_folder.h"
#include "io/image_file.h"

namespace umbrage {
namespace {

struct GBufferFiles : test::FileFolder {
  Camera camera = perspective_camera({4, -6, 3}, {0, 0, 1}, {0, 0, 1}, 35.0f, 1.5f);

  /// A bump at depth 5 before a plane at depth 9, with a hole.
  Image planes(int width = 48, int height = 32) const {
    Image image(width, height);
    for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "color.r",
                             "color.g", "color.b", "color.a", "object_id", "specular"})
      image.add(name) = Plane(width, height, 0.25f);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const float dx = (float(x) - 24.0f) / 10.0f, dy = (float(y) - 16.0f) / 10.0f, square = dx * dx + dy * dy;
        const bool ball = square < 1.0f, hole = y < 4;
        const float nz = ball ? std::sqrt(1.0f - square) : 1.0f;
        image.plane("depth").at(x, y) = hole ? std::numeric_limits<float>::infinity() : ball ? 6.0f - nz : 9.0f;
        image.plane("normal.x").at(x, y) = ball && !hole ? dx : 0.0f;
        image.plane("normal.y").at(x, y) = ball && !hole ? -dy : 0.0f;
        image.plane("normal.z").at(x, y) = hole ? 0.0f : nz;
        image.plane("object_id").at(x, y) = hole ? -1.0f : ball ? 7.0f : 3.0f;
        image.plane("color.a").at(x, y) = hole ? 0.0f : 0.5f;
      }
    return image;
  }

  std::string write_planes(const std::string& name, const Image& image) const {
    WriteSettings settings;
    settings.camera = &camera;
    EXPECT_TRUE(write_image(folder / name, image, settings));
    return (folder / name).string();
  }

  Result<GBufferFile> open(const GBufferSettings& settings, double memory = 1e9) const {
    return GBufferFile::open(settings, memory, folder.string());
  }
};

std::string all_facts(const GBufferFile& file) {
  std::string text;
  for (const auto& list : {file.facts().lines, file.facts().warnings})
    for (const std::string& line : list) text += line + "\n";
  return text;
}

TEST_F(GBufferFiles, OwnFilesComeBackUnchanged) {
  const Image written = planes();
  GBufferSettings settings;
  settings.file = write_planes("own.exr", written);
  const auto file = open(settings);
  ASSERT_TRUE(file) << file.error().message;
  const auto rows = file->rows({0, 32});
  ASSERT_TRUE(rows);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "albedo.g", "specular"}) {
    ASSERT_TRUE(rows->find(name)) << name << "\n" << all_facts(*file);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x) {
        const float a = rows->plane(name).at(x, y), b = written.plane(name).at(x, y);
        ASSERT_TRUE(a == b || std::abs(a - b) < 1e-6f) << name << " " << x << " " << y << "\n" << all_facts(*file);
      }
  }
  // The colour is multiplied by alpha in the file.
  EXPECT_FLOAT_EQ(rows->plane("beauty.r").at(3, 20), 0.5f);
  EXPECT_FLOAT_EQ(rows->plane("beauty.a").at(3, 20), 0.5f);
  EXPECT_EQ(rows->plane("object_id").at(3, 1), -1.0f);
  EXPECT_NE(rows->plane("object_id").at(24, 16), rows->plane("object_id").at(2, 20));
  EXPECT_EQ(file->info().depth_min, 5.0f);
  EXPECT_EQ(file->info().depth_max, 9.0f);
  EXPECT_NEAR(file->info().camera.top, camera.top, 1e-6);
  EXPECT_NEAR(glm::vec3(file->info().camera.eye()).x, 4.0f, 1e-5);
  EXPECT_EQ(file->merge_base(), settings.file);
  EXPECT_EQ(file->plane_names(), rows->names);
}

TEST_F(GBufferFiles, RowsOfLargePicturesAreTheSame) {
  GBufferSettings settings;
  settings.file = write_planes("own.exr", planes());
  const auto whole = open(settings), parts = open(settings, 1000.0);
  ASSERT_TRUE(whole && parts);
  EXPECT_TRUE(whole->is_in_memory());
  EXPECT_FALSE(parts->is_in_memory());
  const auto a = whole->rows({0, 32}), b = parts->rows({9, 20});
  ASSERT_TRUE(a && b);
  for (std::size_t k = 0; k < a->planes.size(); ++k)
    for (int y = 9; y < 20; ++y)
      for (int x = 0; x < 48; ++x) ASSERT_EQ(a->planes[k].at(x, y), b->planes[k].at(x, y - 9)) << a->names[k];
}

TEST_F(GBufferFiles, SeparateFilesAndTheirSizes) {
  Image depth(48, 32), normal(48, 32), small(24, 32), color(48, 32);
  const Image all = planes();
  depth.add("depth") = all.plane("depth");
  for (const char* name : {"normal.x", "normal.y", "normal.z"}) normal.add(name) = all.plane(name);
  small.add("depth") = Plane(24, 32, 4.0f);
  for (const char* name : {"color.r", "color.g", "color.b"}) color.add(name) = Plane(48, 32, 0.5f);
  GBufferSettings settings;
  settings.depth_file = write_planes("d.exr", depth);
  settings.normal_file = write_planes("n.exr", normal);
  settings.beauty_file = (folder / "beauty.png").string();
  ASSERT_TRUE(write_image(settings.beauty_file, color));
  const auto file = open(settings);
  ASSERT_TRUE(file) << file.error().message;
  const auto rows = file->rows({0, 32});
  ASSERT_TRUE(rows);
  EXPECT_FLOAT_EQ(rows->plane("depth").at(24, 16), 5.0f);
  // 0.5 on the display is linear light of 0.21.
  EXPECT_NEAR(rows->plane("beauty.r").at(24, 16), 0.214f, 0.004f);
  EXPECT_TRUE(file->is_display_referred());
  EXPECT_EQ(file->merge_base(), "");
  settings.normal_file = write_planes("small.exr", small);
  settings.depth_file = write_planes("d.exr", depth);
  settings.normal_file.clear();
  settings.id_file = write_planes("small.exr", small);
  const auto wrong = open(settings);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, ErrorKind::kUsage);
  EXPECT_NE(wrong.error().message.find("24 x 32"), std::string::npos) << wrong.error().message;
  EXPECT_NE(wrong.error().message.find("48 x 32"), std::string::npos) << wrong.error().message;
}

TEST_F(GBufferFiles, MissingDepthListsTheLayers) {
  Image image(8, 8);
  for (const char* name : {"color.r", "color.g", "color.b", "normal.x", "normal.y", "normal.z"})
    image.add(name) = Plane(8, 8, 0.5f);
  GBufferSettings settings;
  settings.file = write_planes("none.exr", image);
  const auto file = open(settings);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, ErrorKind::kFile);
  EXPECT_NE(file.error().message.find("normal (XYZ)"), std::string::npos) << file.error().message;
  EXPECT_NE(file.error().message.find("RGB"), std::string::npos) << file.error().message;
  const auto facts = describe_gbuffer(settings);
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->layers.size(), 2u);
  EXPECT_EQ(facts->warnings.size(), 1u);
}

TEST_F(GBufferFiles, UnreadablePixelsAreReadOnce) {
  Image image(512, 512);
  unsigned noise = 1;
  Plane& grey = image.add("grey") = Plane(512, 512);
  for (int k = 0; k < 512 * 512; ++k)
    grey.at(k % 512, k / 512) = float((noise = noise * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
  GBufferSettings settings;
  settings.depth_file = (folder / "cut.png").string();
  ASSERT_TRUE(write_image(settings.depth_file, image, {.bits = 16}));
  const auto size = std::filesystem::file_size(settings.depth_file) - 1000;
  std::filesystem::resize_file(settings.depth_file, size);
  const auto read_bytes = [] {
    std::uintmax_t count = 0;
    std::string word;
    std::ifstream("/proc/self/io") >> word >> count;
    return count;
  };
  const auto before = read_bytes();
  EXPECT_FALSE(describe_gbuffer(settings));
  const auto bytes = read_bytes() - before;
  EXPECT_GT(bytes, size / 2);
  EXPECT_LT(bytes, size + size / 2);
}

TEST_F(GBufferFiles, TinyPicturesAndNothingButNan) {
  for (const int side : {1, 2, 3}) {
    Image image(side, side);
    image.add("depth") = Plane(side, side, 4.0f);
    for (const char* name : {"normal.x", "normal.y", "normal.z"})
      image.add(name) = Plane(side, side, std::numeric_limits<float>::quiet_NaN());
    GBufferSettings settings;
    settings.file = write_planes("tiny.exr", image);
    const auto file = open(settings);
    ASSERT_TRUE(file) << file.error().message;
    const auto rows = file->rows({0, side});
    ASSERT_TRUE(rows);
    EXPECT_EQ(rows->plane("depth").at(side - 1, side - 1), 4.0f);
    EXPECT_FALSE(rows->find("normal.x")) << "they are rebuilt from depth";
    EXPECT_NE(all_facts(*file).find("normal"), std::string::npos) << all_facts(*file);
  }
}

TEST_F(GBufferFiles, DepthBelowZeroIsCounted) {
  Image image(48, 32);
  Plane& depth = image.add("depth") = planes().plane("depth");
  GBufferSettings settings;
  settings.file = write_planes("some.exr", image);
  EXPECT_EQ(all_facts(*open(settings)).find("below 0"), std::string::npos);
  for (int x = 0; x < 3; ++x) depth.at(8 * x, 20) = -1.0f - float(x);
  settings.file = write_planes("some.exr", image);
  const auto some = open(settings), in_parts = open(settings, 1000.0);
  ASSERT_TRUE(some && in_parts);
  for (const auto* file : {&*some, &*in_parts})
    EXPECT_NE(all_facts(*file).find("below 0 at 3 pixels (0.2 %)"), std::string::npos) << all_facts(*file);
  for (int x = 0; x < 3; ++x) depth.at(8 * x, 20) = -1.0f;
  settings.file = write_planes("named.exr", image);
  settings.depth_background = -1.0f;
  EXPECT_EQ(all_facts(*open(settings)).find("below 0"), std::string::npos) << "an option says that it means no surface";
  depth = Plane(48, 32, std::numeric_limits<float>::quiet_NaN());
  settings = {.file = write_planes("empty.exr", image)};
  EXPECT_NE(all_facts(*open(settings)).find("shows no surface"), std::string::npos) << all_facts(*open(settings));
}

TEST_F(GBufferFiles, UnusableFilesAndOptions) {
  GBufferSettings settings;
  EXPECT_EQ(open(settings).error().kind, ErrorKind::kUsage);
  settings.file = write("text.exr", "no picture").string();
  EXPECT_EQ(open(settings).error().kind, ErrorKind::kFile);
  settings.file = (folder / "missing.exr").string();
  EXPECT_EQ(open(settings).error().kind, ErrorKind::kFile);
  settings.file = write_planes("own.exr", planes());
  settings.depth_packing = "rgb24";
  EXPECT_EQ(open(settings).error().kind, ErrorKind::kUsage);
  settings.depth_packing = "none";
  settings.depth_file = settings.file + ":nothing";
  EXPECT_EQ(open(settings).error().kind, ErrorKind::kUsage);
}

}  // namespace
}  // namespace umbrage
