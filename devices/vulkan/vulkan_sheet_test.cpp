// The picture and the table of docs/vulkan.md: every look of every built-in scene on both devices, with captures on the
// GPU by rays and by rasterisation. Takes minutes on lavapipe, so it only runs on request:
// umbrage_tests --gtest_also_run_disabled_tests --gtest_filter='*VulkanSheet.*'
// Writes vulkan-errors-rays.png and .md, the same for raster, and vulkan-looks.png to the folder UMBRAGE_SHEET_FOLDER,
// or the current folder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "generators/builtin.h"
#include "io/image_file.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "vulkan_capture.h"

namespace umbrage {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr int kPictureDownsampling = 4;  // downsampling factor of pictures in the sheet
constexpr int kErrorDownsampling = 2;    // downsampling factor of differences, which keeps the max
constexpr double kGain = 16.0;           // amplification of differences
constexpr double kVisible = 2.0 / 255.0;

constexpr const char* kChannels[] = {"color.r", "color.g", "color.b"};

Image picture(Device& device, const std::string& scene_name, const Request& settings) {
  auto scene = load_scene(scene_name);
  EXPECT_TRUE(scene);
  EXPECT_TRUE(complete_scene(*scene, *make_recipe(settings)));
  EXPECT_TRUE(device.prepare(*scene));
  StageTimes times;
  const auto frame = draw(device, *scene, settings, times);
  EXPECT_TRUE(frame) << frame.error().message;
  return *device.download(*frame, {"color.r", "color.g", "color.b"});
}

struct Sheet {
  int columns, rows, width, height;
  Image image;
  Sheet(int across, int down, int cell_width, int cell_height)
      : columns(across),
        rows(down),
        width(cell_width),
        height(cell_height),
        image(across * cell_width, down * cell_height) {
    for (const char* channel : kChannels) image.add(channel);
  }
};

/// Fills a cell. `color_at` computes each value from `step` x `step` pixels of a plane.
template <class ColorAt>
void fill_cell(Sheet& sheet, int column, int row, int step, const ColorAt& color_at) {
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < kHeight / step; ++y)
      for (int x = 0; x < kWidth / step; ++x)
        sheet.image.planes[std::size_t(c)].at(column * sheet.width + x, row * sheet.height + y) =
            float(color_at(c, x * step, y * step));
}

class VulkanSheet : public testing::TestWithParam<VulkanCapture> {};

INSTANTIATE_TEST_SUITE_P(Ways, VulkanSheet, testing::ValuesIn(test::kGpuCaptures),
                         [](const auto& info) { return std::string(test::name_of(info.param)); });

TEST_P(VulkanSheet, DISABLED_LooksOfAllScenes) {
  auto created = make_vulkan_device({.capture = GetParam()}, make_cpu_device());
  ASSERT_TRUE(created);
  Device& gpu = **created;
  const auto cpu = make_cpu_device();
  const char* chosen_folder = std::getenv("UMBRAGE_SHEET_FOLDER");
  const std::filesystem::path folder = chosen_folder ? chosen_folder : ".";
  const auto scenes = builtin_scenes();
  Sheet pictures(int(scenes.size()), int(scene_looks().size()), kWidth / kPictureDownsampling,
                 kHeight / kPictureDownsampling);
  Sheet errors(int(scenes.size()), int(scene_looks().size()), kWidth / kErrorDownsampling,
               kHeight / kErrorDownsampling);
  std::string table =
      "| look | scene | most, in 1/255 | mean, in 1/255 | pixels over 2/255, of 10 000 |\n| --- | --- | --- | --- | "
      "--- |\n";
  long over_all = 0;
  int row = 0;
  for (const Look* look : scene_looks()) {
    int column = 0;
    for (const auto& scene : scenes) {
      Request settings;
      settings.width = kWidth;
      settings.height = kHeight;
      settings.look = std::string(look->name);
      const std::string name = fmt::format("scene:{}?detail=20000", scene.name);
      const Image a = picture(*cpu, name, settings), b = picture(gpu, name, settings);
      double max = 0.0, sum = 0.0;
      long over = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          double worst = 0.0;
          for (std::size_t c = 0; c < 3; ++c)
            worst = std::max(worst, std::fabs(double(a.planes[c].at(x, y)) - double(b.planes[c].at(x, y))));
          max = std::max(max, worst);
          sum += worst;
          over += worst > kVisible;
        }
      over_all += over;
      table += fmt::format("| {} | {} | {:.1f} | {:.4f} | {:.2f} |\n", look->name, scene.name, max * 255.0,
                           sum * 255.0 / (kWidth * kHeight), 1e4 * double(over) / (kWidth * kHeight));
      fmt::print("{} {}: most {:.1f}/255, {} over\n", look->name, scene.name, max * 255.0, over);
      std::fflush(stdout);
      fill_cell(pictures, column, row, kPictureDownsampling, [&](int c, int x, int y) {
        double all = 0.0;
        for (int j = 0; j < kPictureDownsampling; ++j)
          for (int i = 0; i < kPictureDownsampling; ++i) all += double(a.planes[std::size_t(c)].at(x + i, y + j));
        return all / (kPictureDownsampling * kPictureDownsampling);
      });
      fill_cell(errors, column, row, kErrorDownsampling, [&](int c, int x, int y) {
        double worst = 0.0;
        for (int j = 0; j < kErrorDownsampling; ++j)
          for (int i = 0; i < kErrorDownsampling; ++i)
            worst = std::max(worst, std::fabs(double(a.planes[std::size_t(c)].at(x + i, y + j)) -
                                              double(b.planes[std::size_t(c)].at(x + i, y + j))));
        return kGain * worst;
      });
      ++column;
    }
    ++row;
  }
  fmt::print("{} pixels over 2/255, of {}\n", over_all,
             long(kWidth) * kHeight * long(scenes.size() * scene_looks().size()));
  EXPECT_TRUE(write_image(folder / "vulkan-looks.png", pictures.image, {.small = true}));
  const std::string name = std::string("vulkan-errors-") + test::name_of(GetParam());
  EXPECT_TRUE(write_image(folder / (name + ".png"), errors.image, {.small = true}));
  EXPECT_TRUE(write_text(folder / (name + ".md"), table));
}

}  // namespace
}  // namespace umbrage
