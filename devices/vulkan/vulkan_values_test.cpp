// Values as colours: both devices show the same.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "support.h"
#include "vulkan_capture.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

class VulkanValues : public testing::TestWithParam<VulkanCapture> {};

INSTANTIATE_TEST_SUITE_P(Modes, VulkanValues, testing::ValuesIn(test::kGpuCaptures),
                         [](const auto& info) { return std::string(test::name_of(info.param)); });

TEST_P(VulkanValues, ValuesHaveTheSameColours) {
  Device* const gpu = test::capturing_device(GetParam());
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  for (const int bands : {0, 7}) {
    Request request;
    request.width = 150;
    request.height = 110;
    request.anti_aliasing = 1;
    request.color_by = "p";
    request.color_range = {-0.6f, 0.9f};  // some are outside
    if (bands > 0) request.color_bands = bands;
    std::vector<Image> images;
    for (Device* device : {gpu, cpu.get()}) {
      auto scene = load_scene("scene:solids?detail=3000");
      for (Mesh& mesh : scene->meshes) {
        Field& field = mesh.fields.emplace_back(Field{.name = "p", .values = {}});
        for (const glm::vec3& p : mesh.positions) field.values.push_back(std::sin(2.0f * p.x) + 0.2f * p.y);
      }
      ASSERT_TRUE(complete_scene(*scene, *make_recipe(request)));
      ASSERT_TRUE(device->prepare(*scene));
      StageTimes times;
      const auto frame = draw(*device, *scene, request, times);
      ASSERT_TRUE(frame) << frame.error().message;
      images.push_back(*device->download(*frame, {"color.r", "color.g", "color.b"}));
    }
    for (std::size_t p = 0; p < 3; ++p)
      EXPECT_LE(test::difference(images[0].planes[p], images[1].planes[p], 2.0 / 255.0).fraction_over, 2e-3) << bands;
    EXPECT_GT(test::difference(images[0].planes[0], images[0].planes[2], 0.2).fraction_over, 0.05)
        << "they are colours";
  }
}

}  // namespace
}  // namespace umbrage
