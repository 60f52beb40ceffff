// The Vulkan device: its results compared with the CPU device, its memory and submissions, and its errors.
#include "devices/vulkan/vulkan_device.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "devices/vulkan/commands.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/memory.h"
#include "devices/vulkan/pipelines.h"
#include "faulty_vulkan.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "run_effect.h"
#include "run_program.h"
#include "support.h"
#include "vulkan_capture.h"
#include "vulkan_recorder.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

using test::faulty;

/// Returns a device with the faults of faulty_vulkan.h, none of them active.
std::unique_ptr<Device> faulty_device() {
  if (!test::start_faulty()) return nullptr;
  return test::new_vulkan_device({.get = test::faulty_get});
}

std::string error_of(const Result<std::unique_ptr<Device>>& device) {
  EXPECT_FALSE(device);
  if (device) return {};
  EXPECT_EQ(device.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(device.error().message.find('\n'), std::string::npos);
  return device.error().message;
}

Result<RunState> run(Device& device, std::string_view effect, Frame& frame) {
  const Effect& e = *find_effect(effect);
  return device.run(e, initial_parameters(e.parameters, e.params_size), frame);
}

/// Returns a frame of the G-buffer, with its lighting computed.
Result<Frame> lit_frame(Device& device, const GBuffer& gbuffer) {
  auto frame = device.upload(gbuffer);
  if (!frame) return frame;
  if (const auto status = run(device, "lighting", *frame); !status) return status.error();
  return frame;
}

void expect_equal(const Image& a, const Image& b) {
  ASSERT_EQ(a.names, b.names);
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).max, 0.0) << a.names[p];
}

// ---- planes and results ----

TEST(Vulkan, StoresUploadedPlanes) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  for (const auto& [width, height] : {std::pair{1, 1}, {5, 3}, {16, 16}, {131, 77}}) {
    GBuffer gbuffer = test::hostile_gbuffer(width, height, 5);
    gbuffer.layers.push_back(test::bumpy_gbuffer(width, height, 6).layers[0]);
    gbuffer.info.more_layers.resize(1);
    gbuffer.info.guard = width > 20 ? 7 : 0;
    const auto on_gpu = gpu->upload(gbuffer), on_cpu = cpu->upload(gbuffer);
    ASSERT_TRUE(on_gpu && on_cpu);
    const auto a = gpu->download_all(*on_gpu), b = cpu->download_all(*on_cpu);
    ASSERT_TRUE(a && b);
    expect_equal(*a, *b);
    const auto some = gpu->download(*on_gpu, {"layer1.depth", "albedo.g"});
    ASSERT_TRUE(some);
    expect_equal(*some, *cpu->download(*on_cpu, {"layer1.depth", "albedo.g"}));
  }
}

TEST(Vulkan, AddReplacesPlanesOfTheSameName) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  auto frame = gpu->upload(test::bumpy_gbuffer(40, 30, 5));
  ASSERT_TRUE(frame);
  Image more(40, 30);
  more.add("ao") = Plane(40, 30, 0.25f);
  more.add("depth") = Plane(40, 30, 3.0f);
  ASSERT_TRUE(gpu->add(more, *frame));
  const auto image = gpu->download(*frame, {"ao", "depth"});
  ASSERT_TRUE(image);
  expect_equal(*image, more);
}

TEST(Vulkan, ReducesAndPlacesLikeTheCpu) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  for (const int factor : {1, 2, 3, 4})
    for (const auto& [width, height] : {std::pair{1, 1}, {131, 77}}) {
      GBuffer gbuffer = test::bumpy_gbuffer(width, height, 9);
      gbuffer.layers.push_back(test::bumpy_gbuffer(width, height, 10).layers[0]);
      gbuffer.info.more_layers.resize(1);
      const std::vector<std::string> names = {"depth", "normal.x", "nowhere"};
      std::array<Image, 2> small_images, full_images;
      int k = 0;
      for (Device* device : {gpu, static_cast<Device*>(cpu.get())}) {
        auto full = device->upload(gbuffer);
        ASSERT_TRUE(full);
        auto small = device->reduced(*full, factor, names);
        ASSERT_TRUE(small);
        EXPECT_EQ(small->info.width, reduced_side(width, factor));
        const auto placed = device->add_planes_of(*small, {"nowhere"}, *full);
        ASSERT_FALSE(placed);
        EXPECT_NE(placed.error().message.find("'nowhere'"), std::string::npos);
        ASSERT_TRUE(device->add_planes_of(*small, {"depth"}, *full));
        const std::string name = factor > 1 ? reduced_plane("depth") : other_plane("depth");
        ASSERT_TRUE(device->download(*full, {name})) << name;
        small_images[k] = *device->download_all(*small);
        std::vector<std::string> all = device->plane_names(*full);
        if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);  // it may be shared
        full_images[k++] = *device->download(*full, all);
      }
      expect_equal(small_images[0], small_images[1]);
      expect_equal(full_images[0], full_images[1]);
    }
}

TEST(Vulkan, MissingPlanesAreNeutralOrReported) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  GBuffer bare = test::empty_gbuffer(33, 20);
  bare.layers[0].add("depth") = Plane(33, 20, 5.0f);
  for (const char* name : {"normal.x", "normal.y", "normal.z"})
    bare.layers[0].add(name) = Plane(33, 20, name[7] == 'z' ? 1.0f : 0.0f);
  std::array<Image, 2> images;
  int k = 0;
  for (Device* device : {gpu, static_cast<Device*>(cpu.get())}) {
    auto frame = device->upload(bare);
    ASSERT_TRUE(frame);
    ASSERT_TRUE(run(*device, "lighting", *frame));
    ASSERT_TRUE(run(*device, "composite", *frame));
    images[k++] = *device->download_all(*frame);
    const auto missing = device->download(*frame, {"depth", "no_such"});
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kUsage);
    EXPECT_NE(missing.error().message.find("'no_such'"), std::string::npos);
    auto empty = device->upload(test::empty_gbuffer(8, 8));
    ASSERT_TRUE(empty);
    const auto status = run(*device, "lighting", *empty);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
  }
  EXPECT_EQ(images[0].names, images[1].names);
}

/// Expects that all looks give the same picture on the CPU and on a device that captures in a certain way, except at a
/// fraction of the pixels.
void expect_same_looks(VulkanCapture how, double fraction, double fraction_of_lines) {
  Device* const gpu = test::capturing_device(how);
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  auto scene = load_scene("scene:solids?detail=3000");
  ASSERT_TRUE(scene);
  for (const Look* look : scene_looks()) {
    Request settings;
    settings.width = 150;
    settings.height = 110;
    settings.look = std::string(look->name);
    settings.guard_band = 5.0f;
    if (look == scene_looks().front()) settings.occlusion_scale = "half";
    std::array<Image, 2> images;
    int k = 0;
    for (Device* device : {gpu, static_cast<Device*>(cpu.get())}) {
      StageTimes times;
      ASSERT_TRUE(device->prepare(*scene));
      const auto frame = draw(*device, *scene, settings, times);
      ASSERT_TRUE(frame) << frame.error().message;
      images[k++] = *device->download(*frame, {"color.r", "color.g", "color.b"});
    }
    for (std::size_t p = 0; p < 3; ++p) {
      const auto d = test::difference(images[0].planes[p], images[1].planes[p], 2.0 / 255.0);
      const bool has_lines = look->name == "cartoon" || look->name == "hatching" || look->name == "technical";
      EXPECT_LE(d.fraction_over, has_lines ? fraction_of_lines : fraction) << look->name << ", most " << d.max;
    }
  }
}

TEST(Vulkan, EveryLookGivesTheSamePicture) { expect_same_looks(VulkanCapture::kRays, 1e-3, 1e-3); }

TEST(Vulkan, EveryLookGivesNearlyTheSamePictureRasterised) {
  // Rasterised pixels on the border of a surface may show another one, and lines, which `cartoon`, `hatching` and
  // `technical` draw, follow them.
  expect_same_looks(VulkanCapture::kRaster, 1e-2, 5e-2);
}

// ---- submissions and memory ----

TEST(Vulkan, SubmitsOncePerFrame) {
  const auto gpu = faulty_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  auto frame = gpu->upload(test::bumpy_gbuffer(64, 48, 5));
  ASSERT_TRUE(frame);
  for (const char* effect : {"lighting", "hemisphere", "composite", "output"}) ASSERT_TRUE(run(*gpu, effect, *frame));
  EXPECT_EQ(faulty().faults.submits, 0);
  ASSERT_TRUE(gpu->download(*frame, {"color.r", "color.g", "color.b", "ao"}));
  EXPECT_EQ(faulty().faults.submits, 1);
  ASSERT_TRUE(gpu->finish());
  EXPECT_EQ(faulty().faults.submits, 1);
}

TEST(Vulkan, StripsOfLongDispatchesGiveTheSameBits) {
  // One device with time for one row of workgroups per submission, and one that never splits.
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto splitting = test::new_vulkan_device(
      {.capture = VulkanCapture::kRaster, .max_submission_ms = 1e-6, .first_groups = 1, .get = test::faulty_get});
  const auto whole = test::new_vulkan_device({.capture = VulkanCapture::kRaster, .max_submission_ms = 0.0});
  UMBRAGE_NEEDS_VULKAN(splitting && whole);
  const test::NoMessages no_messages;
  auto scene = load_scene("scene:solids?detail=2000");
  ASSERT_TRUE(scene);
  for (const char* look : {"studio", "bleeding", "unsharp"}) {
    Request settings;
    settings.width = 75;
    settings.height = 52;
    settings.look = look;
    std::array<Image, 2> images;
    int k = 0;
    const int before = faulty().faults.submits;
    for (Device* device : {splitting.get(), whole.get()}) {
      StageTimes times;
      ASSERT_TRUE(device->prepare(*scene));
      ASSERT_TRUE(device->finish());
      const auto frame = draw(*device, *scene, settings, times);
      ASSERT_TRUE(frame) << frame.error().message;
      images[k++] = *device->download_all(*frame);
    }
    expect_equal(images[0], images[1]);
    // The row ranges of a dispatch count as one in the reported times.
    const std::vector<DispatchTime> dispatches = *splitting->finish();
    EXPECT_EQ(dispatches.size(), whole->finish()->size()) << look;
    EXPECT_GE(faulty().faults.submits - before, 3 * int(dispatches.size())) << look;
  }
}

TEST(Vulkan, DoesNotSplitShortFrames) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu = test::new_vulkan_device({.max_submission_ms = 1e6, .first_groups = 16, .get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const GBuffer gbuffer = test::bumpy_gbuffer(64, 48, 5);
  for (int picture = 0; picture < 3; ++picture) {
    auto frame = gpu->upload(gbuffer);
    ASSERT_TRUE(frame);
    const int before = faulty().faults.submits;
    ASSERT_TRUE(run(*gpu, "lighting", *frame));
    ASSERT_TRUE(run(*gpu, "gaussian", *frame));
    ASSERT_TRUE(gpu->download(*frame, {"ao"}));
    // The times of the first picture's dispatches are unknown.
    if (picture == 0)
      EXPECT_GT(faulty().faults.submits - before, 3);
    else
      EXPECT_EQ(faulty().faults.submits - before, 1);
  }
}

TEST(Vulkan, ReportsTheTimeOfDispatches) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  ASSERT_TRUE(gpu->finish());
  auto frame = lit_frame(*gpu, test::bumpy_gbuffer(256, 256, 5));
  ASSERT_TRUE(frame);
  ASSERT_TRUE(run(*gpu, "gaussian", *frame));
  const std::vector<DispatchTime> times = *gpu->finish();
  ASSERT_GE(times.size(), 3u);
  for (const DispatchTime& time : times) {
    EXPECT_EQ(time.effect, &time == &times[0] ? "lighting" : "gaussian");
    EXPECT_FALSE(time.dispatch.empty());
    EXPECT_GT(time.ms, 0.0);
    EXPECT_LT(time.ms, 10000.0);
  }
  EXPECT_TRUE(gpu->finish()->empty());
}

TEST(Vulkan, MemoryDoesNotGrowFromFrameToFrame) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const GBuffer gbuffer = test::bumpy_gbuffer(64, 48, 5);
  VulkanMemory after_ten;
  for (int k = 0; k < 1000; ++k) {
    auto frame = lit_frame(*gpu, gbuffer);
    ASSERT_TRUE(frame);
    auto small = gpu->reduced(*frame, 2, {"depth", "normal.x", "normal.y", "normal.z"});
    ASSERT_TRUE(small);
    ASSERT_TRUE(run(*gpu, "sphere", *small));
    ASSERT_TRUE(gpu->add_planes_of(*small, {"ao"}, *frame));
    ASSERT_TRUE(gpu->download(*frame, {"direct.r", "reduced_ao"}));
    if (k == 9) after_ten = vulkan_memory(*gpu);
  }
  EXPECT_GT(after_ten.device_bytes, 0u);
  EXPECT_EQ(vulkan_memory(*gpu).device_bytes, after_ten.device_bytes);
  EXPECT_EQ(vulkan_memory(*gpu).host_bytes, after_ten.host_bytes);
}

TEST(Vulkan, ReleasesMemoryOfOtherSizes) {
  const auto gpu = faulty_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  // Each size takes at least 90 MiB; if all were kept, they would take over 900.
  for (int side = 1400; side < 1500; side += 10) {
    GBuffer gbuffer = test::empty_gbuffer(side, side);
    for (int k = 0; k < 12; ++k) gbuffer.layers[0].add(fmt::format("plane{}", k)) = Plane(side, side, float(k));
    const auto frame = gpu->upload(gbuffer);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_TRUE(gpu->finish());
  }
  EXPECT_LT(vulkan_memory(*gpu).device_bytes, std::uint64_t(512) << 20);
  EXPECT_LT(vulkan_memory(*gpu).host_bytes, std::uint64_t(512) << 20);
}

TEST(Vulkan, KeepsCompiledKernels) {
  std::string folder = (std::filesystem::temp_directory_path() / "umbrage-vulkan-XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const std::string inner = folder + "/new";
  const auto use = [&] {
    const auto gpu = test::new_vulkan_device({.pipeline_folder = inner});
    if (!gpu) return false;
    auto frame = gpu->upload(test::bumpy_gbuffer(16, 16, 5));
    EXPECT_TRUE(run(*gpu, "lighting", *frame));
    EXPECT_TRUE(gpu->download(*frame, {"direct.r"}));
    return true;
  };
  UMBRAGE_NEEDS_VULKAN(use());
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(inner)) files.push_back(entry.path());
  ASSERT_EQ(files.size(), 1u);  // and no temporary file is left
  ASSERT_FALSE(read_pipelines(files[0]).empty());
  // Truncated, changed, or foreign: ignored, and rewritten by the next device.
  const std::string bytes = test::text_of(files[0]);
  std::string changed = bytes;
  changed.back() = char(~changed.back());
  for (const std::string& broken :
       {bytes.substr(0, bytes.size() / 2), changed, std::string("nonsense"), std::string()}) {
    std::ofstream(files[0], std::ios::binary) << broken;
    EXPECT_TRUE(read_pipelines(files[0]).empty());
    EXPECT_TRUE(use());
    EXPECT_FALSE(read_pipelines(files[0]).empty());  // drivers do not always write the same number of bytes
  }
  std::filesystem::remove_all(folder);
}

TEST(Vulkan, ValidationReportsMistakes) {
  // Makes two mistakes, one of them in synchronization: tests that expect no messages would detect both.
  std::vector<std::string> messages;
  const auto instance = make_instance(nullptr, [&](std::string_view message) { messages.emplace_back(message); });
  UMBRAGE_NEEDS_VULKAN(instance);
  const auto [gpu, memory, commands] = test::open_recorder(*instance);
  ASSERT_TRUE(commands);
  const auto plane = memory->plane(1024);
  ASSERT_TRUE(plane);
  EXPECT_TRUE(messages.empty()) << messages.front();
  const auto buffer = commands->buffer();
  ASSERT_TRUE(buffer);
  gpu->vk.CmdFillBuffer(*buffer, (*plane)->buffer, (*plane)->offset, 1024, 1);
  gpu->vk.CmdFillBuffer(*buffer, (*plane)->buffer, (*plane)->offset, 1024, 2);  // without a barrier in between
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("SYNC-HAZARD-WRITE-AFTER-WRITE"), std::string::npos) << messages[0];
  commands->barrier();
  gpu->vk.CmdFillBuffer(*buffer, (*plane)->buffer, (*plane)->offset, 1024, 3);
  EXPECT_EQ(messages.size(), 1u);
  gpu->vk.CmdFillBuffer(*buffer, (*plane)->buffer, 1, 1024, 3);  // misaligned
  EXPECT_GT(messages.size(), 1u);
}

// ---- errors ----

TEST(Vulkan, ReportsMissingRequirements) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty() && vulkan_gpus());
  const auto none = load_vulkan("libno-such-vulkan.so");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kDevice);
  EXPECT_NE(none.error().message.find("libno-such-vulkan.so"), std::string::npos);

  const auto message = [](const VulkanSettings& settings) {
    return error_of(make_vulkan_device(settings, make_cpu_device()));
  };
  faulty().faults.loader_version = VK_API_VERSION_1_1;
  EXPECT_NE(message({.get = test::faulty_get}).find("1.2 is required"), std::string::npos);
  faulty().faults = {};
  faulty().faults.device_version = VK_API_VERSION_1_1;
  EXPECT_NE(message({.get = test::faulty_get}).find("lacks Vulkan 1.2 (its driver supports 1.1)"), std::string::npos);
  const auto listed = vulkan_gpus({.get = test::faulty_get});
  ASSERT_TRUE(listed);
  EXPECT_FALSE(listed->front().usable);
  EXPECT_NE(listed->front().summary.find("lacks Vulkan 1.2"), std::string::npos);
  faulty().faults = {};
  faulty().faults.has_addresses = false;
  EXPECT_NE(message({.get = test::faulty_get}).find("buffer device addresses"), std::string::npos);
  faulty().faults = {};
  faulty().faults.bound_buffers = 8;
  EXPECT_NE(message({.get = test::faulty_get}).find("it supports 8 per shader; 16 are required"), std::string::npos);
  faulty().faults = {};
  EXPECT_NE(message({.index = 99, .get = test::faulty_get}).find("'vulkan:99'"), std::string::npos);
}

TEST(Vulkan, ALostDeviceIsAnError) {
  for (const bool while_waiting : {false, true}) {
    const auto gpu = faulty_device();
    UMBRAGE_NEEDS_VULKAN(gpu);
    auto frame = gpu->upload(test::bumpy_gbuffer(32, 32, 5));
    ASSERT_TRUE(frame);
    (while_waiting ? faulty().faults.wait : faulty().faults.submit) = VK_ERROR_DEVICE_LOST;
    for (int k = 0; k < 3; ++k) {
      const auto status = run(*gpu, "lighting", *frame);
      const auto image = status ? gpu->download(*frame, {"direct.r"}) : status.error();
      ASSERT_FALSE(image);
      EXPECT_EQ(image.error().kind, ErrorKind::kDevice);
      EXPECT_NE(image.error().message.find("lost"), std::string::npos);
    }
  }
}

TEST(Vulkan, WorksAfterAFailedWait) {
  const auto gpu = faulty_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const GBuffer gbuffer = test::bumpy_gbuffer(32, 32, 5);
  for (int k = 0; k < 3; ++k) {
    auto frame = lit_frame(*gpu, gbuffer);
    ASSERT_TRUE(frame);
    faulty().faults.wait = k < 2 ? VK_ERROR_OUT_OF_HOST_MEMORY : VK_SUCCESS;
    const auto image = gpu->download(*frame, {"direct.r"});
    faulty().faults.wait = VK_SUCCESS;
    ASSERT_EQ(bool(image), k == 2);
    if (!image) {
      EXPECT_EQ(image.error().kind, ErrorKind::kDevice);
    }
  }
  // If the state of submitted work is unknown, the device gets no more work.
  faulty().faults.wait = faulty().faults.idle = VK_ERROR_OUT_OF_HOST_MEMORY;
  auto frame = gpu->upload(gbuffer);
  ASSERT_TRUE(frame);
  ASSERT_FALSE(gpu->finish());
  faulty().faults.wait = faulty().faults.idle = VK_SUCCESS;
  const int before = faulty().faults.submits;
  const auto again = gpu->download(*frame, {"depth"});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::kDevice);
  EXPECT_EQ(faulty().faults.submits, before);
}

TEST(Vulkan, TooLittleMemoryIsAnError) {
  const auto gpu = faulty_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const GBuffer large = test::bumpy_gbuffer(700, 700, 5), small = test::bumpy_gbuffer(70, 70, 5);
  for (const std::uint64_t left : {0u, 5u << 20, 30u << 20, 60u << 20}) {
    faulty().faults.memory_left = left;
    auto frame = gpu->upload(large);
    const auto status = frame ? run(*gpu, "hemisphere", *frame) : frame.error();
    const auto image = status ? gpu->download_all(*frame) : status.error();
    ASSERT_FALSE(image) << left;
    EXPECT_EQ(image.error().kind, ErrorKind::kDevice);
    EXPECT_NE(image.error().message.find("memory"), std::string::npos);
  }
  // It works again with the available memory.
  faulty().faults.memory_left = std::uint64_t(64) << 20;
  const auto frame = lit_frame(*gpu, small);
  ASSERT_TRUE(frame) << frame.error().message;
  ASSERT_TRUE(gpu->download(*frame, {"direct.r"}));
}

TEST(Vulkan, APictureLargerThanTheDeviceAllowsIsAnError) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  faulty().faults.max_allocation = 8 << 20;
  const auto gpu = test::new_vulkan_device({.get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  EXPECT_TRUE(gpu->upload(test::bumpy_gbuffer(1000, 1000, 5)));
  const auto frame = gpu->upload(test::bumpy_gbuffer(2000, 2000, 5));
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kDevice);
  EXPECT_NE(frame.error().message.find("too large for the Vulkan device"), std::string::npos);
}

using VulkanProgram = test::ProgramTest;

TEST_F(VulkanProgram, ExitsWithFourAndASentence) {
  const std::string line = "tri.obj -o out.png --resolution 64,64 --device ";
  bad(line + "vulkan", 4, {"Vulkan driver", "--device cpu"}, "VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere");
  bad(line + "vulkan:x", 2, {"'vulkan:x'", "vulkan:0"});
  bad(line + "vulkan", 2, {"UMBRAGE_VULKAN_CAPTURE", "'x'"}, "UMBRAGE_VULKAN_CAPTURE=x");
  bad(line + "vulkan:", 2, {"'vulkan:'", "vulkan:0"});
  bad(line + "vulkan:-1", 2, {"'vulkan:-1'", "vulkan:0"});
  good(line + "auto", "VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere");
  const std::string listed = good("list devices", "VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere").out;
  EXPECT_NE(listed.find("\nvulkan  not available: there is no Vulkan driver"), std::string::npos) << listed;
  UMBRAGE_NEEDS_VULKAN(vulkan_gpus());
  bad(line + "vulkan:99", 4, {"'vulkan:99'", "list devices"});
}

TEST_F(VulkanProgram, DrawsListsAndTimes) {
  const auto gpus = vulkan_gpus();
  UMBRAGE_NEEDS_VULKAN(gpus);
  const std::string listed = good("list devices").out;
  for (const VulkanGpu& gpu : *gpus) EXPECT_NE(listed.find(gpu.name + "  " + gpu.summary), std::string::npos) << listed;
  good("tri.obj -o cpu.pfm --resolution 96,64 --look ao --device cpu");
  good("tri.obj -o gpu.pfm --resolution 96,64 --look ao --device vulkan:0");
  const Image a = image("cpu.pfm"), b = image("gpu.pfm");
  ASSERT_EQ(a.names, b.names);
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    EXPECT_LE(test::difference(a.planes[p], b.planes[p], 2.0 / 255.0).fraction_over, 1e-3);

  const auto stages = nlohmann::json::parse(good("tri.obj -o x.png --resolution 96,64 --device vulkan --json").out);
  EXPECT_EQ(stages.back().at("stage"), "total");
  std::set<std::string> timed;
  for (const auto& record : stages)
    if (record.contains("gpu_ms")) {
      timed.insert(record.at("stage").get<std::string>());
      EXPECT_GE(record.at("gpu_ms").get<double>(), 0.0);
      EXPECT_FALSE(record.at("pass").get<std::string>().empty());
      EXPECT_FALSE(record.contains("ms"));
    }
  EXPECT_TRUE(timed.contains("output")) << stages.dump();
  const test::Outcome verbose = run("tri.obj -o x.png --resolution 96,64 --device vulkan --verbose");
  EXPECT_NE(verbose.err.find("on the GPU"), std::string::npos) << verbose.err;

  const auto bench = nlohmann::json::parse(
      good("bench tri.obj --effect gaussian --resolution 96,64 --runs 3 --json --device vulkan").out);
  for (const auto& record : bench) {
    EXPECT_EQ(record.at("device").get<std::string>().rfind("vulkan:", 0), 0u);
    EXPECT_GT(record.at("gpu_ms").get<double>(), 0.0);
    EXPECT_LE(record.at("gpu_ms").get<double>(), record.at("ms").get<double>() * 1.5 + 1.0);
  }
}

}  // namespace
}  // namespace umbrage
