// The names of a frame's planes, without reading any of them back: the same on every device, those that download has.
#include "core/device.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

std::vector<std::string> names_on(Device& device) {
  GBuffer g = test::empty_gbuffer(24, 16);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "lit.r", "lit.g", "lit.b"})
    g.layers[0].add(name);
  auto frame = device.upload(g);
  EXPECT_TRUE(frame);
  EXPECT_EQ(device.plane_names(*frame), device.download_all(*frame)->names);
  // It makes colour, and asks for lines and a sky that nobody made.
  const Effect& output = *find_effect("output");
  const ParameterBytes params = initial_parameters(output.parameters, output.params_size);
  EXPECT_TRUE(device.run(output, params, *frame));
  std::vector<std::string> names = device.plane_names(*frame);
  EXPECT_EQ(names, device.download_all(*frame)->names);
  return names;
}

TEST(PlaneNames, AreThoseThatDownloadHas) {
  const auto cpu = make_cpu_device();
  const std::vector<std::string> names = names_on(*cpu);
  for (const char* name : {"depth", "color.r", "color.a", "outline", "sky.b"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  EXPECT_EQ(names_on(*gpu), names);
}

}  // namespace
}  // namespace umbrage
