// Device::plane_names returns the names of a download of all planes on every device, but reads no plane back. Released
// planes are gone on every device.
#include <algorithm>

#include "core/check.h"
#include "core/device.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

std::vector<std::string> names_after_output(Device& device) {
  GBuffer g = test::empty_gbuffer(24, 16);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "lit.r", "lit.g", "lit.b"})
    g.layers[0].add(name);
  auto frame = device.upload(g);
  EXPECT_TRUE(frame);
  EXPECT_EQ(device.plane_names(*frame), device.download_all(*frame)->names);
  // The effect `output` writes colour, and reads planes of lines and of the sky that do not exist.
  const Effect& output = *find_effect("output");
  const ParameterBytes params = initial_parameters(output.parameters, output.params_size);
  EXPECT_TRUE(device.run(output, params, *frame));
  std::vector<std::string> names = device.plane_names(*frame);
  EXPECT_EQ(names, device.download_all(*frame)->names);
  return names;
}

/// Returns the names of all planes, after checking that download has the same.
std::vector<std::string> checked_names(Device& device, const Frame& frame) {
  std::vector<std::string> names = device.plane_names(frame);
  const auto image = device.download_all(frame);
  EXPECT_TRUE(image) << image.error().message;
  if (image) {
    EXPECT_EQ(names, image->names);
  }
  return names;
}

Result<RunState> run(Device& device, const char* name, Frame& frame) {
  const Effect& effect = *find_effect(name);
  return device.run(effect, initial_parameters(effect.parameters, effect.params_size), frame);
}

/// Returns the names of a frame, of a branch, and of a branch of that. Each starts with those of the frame that it
/// branches from, constant planes included.
std::vector<std::vector<std::string>> names_of_branches(Device& device) {
  auto frame = device.upload(test::bumpy_gbuffer(24, 16, 5));
  EXPECT_TRUE(frame);
  EXPECT_TRUE(run(device, "lighting", *frame));  // reads shadows
  std::vector<std::vector<std::string>> all = {checked_names(device, *frame)};
  Frame branch = device.branch(*frame);
  EXPECT_EQ(checked_names(device, branch), all.back());
  Image made(24, 16);
  made.add("added") = Plane(24, 16, 3.0f);
  made.add("shadow1") = Plane(24, 16, 0.25f);  // so far a constant plane
  EXPECT_TRUE(device.add(made, branch));
  EXPECT_TRUE(run(device, "sphere", branch));
  all.push_back(checked_names(device, branch));
  Frame second_branch = device.branch(branch);
  EXPECT_EQ(checked_names(device, second_branch), all.back());
  EXPECT_TRUE(run(device, "gaussian", second_branch));
  EXPECT_TRUE(run(device, "composite", second_branch));
  all.push_back(checked_names(device, second_branch));
  EXPECT_EQ(device.download(second_branch, {"added"})->plane("added").at(5, 5), 3.0f);
  EXPECT_EQ(device.download(second_branch, {"shadow1"})->plane("shadow1").at(5, 5), 0.25f);
  EXPECT_EQ(device.download(*frame, {"shadow1"})->plane("shadow1").at(5, 5), 1.0f);
  // Shared planes are not written, even after the branch between them is gone.
  EXPECT_THROW(static_cast<void>(run(device, "lighting", branch)), InternalError);
  EXPECT_THROW(static_cast<void>(device.add(made, *frame)), InternalError);
  branch = {};
  EXPECT_THROW(static_cast<void>(run(device, "lighting", *frame)), InternalError);
  EXPECT_EQ(checked_names(device, second_branch), all.back());
  second_branch = {};
  EXPECT_TRUE(run(device, "lighting", *frame));
  EXPECT_EQ(checked_names(device, *frame), all.front());
  return all;
}

TEST(PlaneNames, OfBranchesDoNotDependOnTheDevice) {
  const auto cpu = make_cpu_device();
  const auto names = names_of_branches(*cpu);
  for (const char* name : {"depth", "direct.r", "added", "shadow1", "shadow2", "ao", "lit.r"})
    EXPECT_EQ(std::count(names.back().begin(), names.back().end(), name), 1) << name;
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  EXPECT_EQ(names_of_branches(*gpu), names);
}

TEST(PlaneNames, EqualThoseOfADownload) {
  const auto cpu = make_cpu_device();
  const std::vector<std::string> names = names_after_output(*cpu);
  for (const char* name : {"depth", "color.r", "color.a", "outline", "sky.b"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  EXPECT_EQ(names_after_output(*gpu), names);
}

void release_planes(Device& device) {
  auto frame = device.upload(test::bumpy_gbuffer(24, 16, 5));
  ASSERT_TRUE(frame);
  ASSERT_TRUE(run(device, "lighting", *frame));
  const auto has = [&](const Frame& of, const char* name) {
    const auto names = checked_names(device, of);
    return std::count(names.begin(), names.end(), name) == 1;
  };
  const float lit = device.download(*frame, {"direct.r"})->planes[0].at(5, 5);
  {
    Frame branch = device.branch(*frame);
    device.release(*frame, {"direct.r"});
    EXPECT_TRUE(has(*frame, "direct.r")) << "a branch shares it";
    device.release(branch, {"direct.r"});
    ASSERT_TRUE(run(device, "composite", branch));
    device.release(branch, {"lit.r", "no such plane"});
    EXPECT_FALSE(has(branch, "lit.r"));
    EXPECT_TRUE(has(branch, "lit.g"));
  }
  EXPECT_EQ(device.download(*frame, {"direct.r"})->planes[0].at(5, 5), lit) << "a branch does not own it";
  device.release(*frame, {"direct.r"});
  EXPECT_FALSE(has(*frame, "direct.r"));
  EXPECT_FALSE(device.download(*frame, {"direct.r"}));
  ASSERT_TRUE(run(device, "lighting", *frame));
  EXPECT_EQ(device.download(*frame, {"direct.r"})->planes[0].at(5, 5), lit) << "written again";
}

TEST(ReleasedPlanes, AreGoneUntilTheyAreWrittenAgain) {
  const auto cpu = make_cpu_device();
  release_planes(*cpu);
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  release_planes(*gpu);
}

TEST(ReleasedPlanes, AreNotReadAsNeutralOnes) {
  const auto cpu = make_cpu_device();
  auto frame = cpu->upload(test::bumpy_gbuffer(24, 16, 5));
  ASSERT_TRUE(run(*cpu, "lighting", *frame));
  cpu->release(*frame, {"direct.r"});
  EXPECT_THROW(static_cast<void>(run(*cpu, "composite", *frame)), InternalError);
}

// The dispatches of `denoise` read normals one after the other, in several rounds: released before the last, they would
// be read when they are gone.
TEST(ReleasedPlanes, LastUntilTheEndOfTheirUseInARun) {
  const auto cpu = make_cpu_device();
  const auto shaded = [&](bool released) {
    auto frame = cpu->upload(test::bumpy_gbuffer(24, 16, 5));
    EXPECT_TRUE(frame);
    EXPECT_TRUE(run(*cpu, "bitmask", *frame));
    const Effect& denoise = *find_effect("denoise");
    EffectRun settings;
    if (released) settings.last_used = {"normal.x", "no such plane"};
    EXPECT_TRUE(cpu->run(denoise, initial_parameters(denoise.parameters, denoise.params_size), *frame, settings));
    return *frame;
  };
  const Frame kept = shaded(false), released = shaded(true);
  EXPECT_TRUE(cpu->download(kept, {"normal.x"}));
  EXPECT_FALSE(cpu->download(released, {"normal.x"}));
  EXPECT_TRUE(cpu->download(released, {"normal.y"}));
  const Image a = *cpu->download(kept, {"ao"}), b = *cpu->download(released, {"ao"});
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) ASSERT_EQ(a.planes[0].at(x, y), b.planes[0].at(x, y)) << x << ", " << y;
}

TEST(Views, ReferToThePlanesOfTheFrame) {
  const auto cpu = make_cpu_device();
  GBuffer gbuffer = test::bumpy_gbuffer(24, 16, 5);
  const float* const depth = gbuffer.layers[0].plane("depth").data();
  const auto frame = cpu->upload(std::move(gbuffer));
  const auto image = cpu->view(*frame, {"normal.x", "depth"});
  ASSERT_TRUE(image);
  EXPECT_EQ(image->names, (std::vector<std::string>{"normal.x", "depth"}));
  EXPECT_EQ(image->plane("depth").data(), depth);
  EXPECT_FALSE(cpu->view(*frame, {"no such plane"}));
}

}  // namespace
}  // namespace umbrage
