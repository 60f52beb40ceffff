// Importing and preparing a model stop soon after the monitor returns false, and report valid progress until then.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <thread>

#include "devices/cpu/cpu_device.h"
#include "devices/vulkan/hierarchy.h"
#include "rays/traced_scene.h"
#include "renderer/models.h"
#include "run_program.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "umbrage/umbrage.hpp"

namespace umbrage {
namespace {

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Returns a wavy square of side x side cells with two triangles each.
Mesh waves(int side) {
  Mesh mesh;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) {
      const float x = float(i) / float(side), z = float(j) / float(side);
      mesh.positions.emplace_back(x, 0.1f * std::sin(17.0f * x) * std::cos(23.0f * z), z);
    }
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const auto at = [&](int di, int dj) { return std::uint32_t((j + dj) * (side + 1) + i + di); };
      mesh.indices.insert(mesh.indices.end(), {at(0, 0), at(0, 1), at(1, 0), at(1, 0), at(0, 1), at(1, 1)});
    }
  return mesh;
}

/// A function that reports progress to a monitor and ends when the monitor returns false.
using Work = std::function<Result<void>(const ProgressMonitor& monitor)>;

/// Expects rising progress in [0, 1] that is reported on the calling thread, and that after the monitor returns false,
/// work stops within a tenth of its total time or within kMaxSeconds.
void expect_ends(const Work& work, const char* what) {
  SCOPED_TRACE(what);
  const auto thread = std::this_thread::get_id();
  std::vector<double> reported;
  const Clock::time_point begin = Clock::now();
  ASSERT_TRUE(work([&](double done) {
    EXPECT_EQ(std::this_thread::get_id(), thread);
    reported.push_back(done);
    return true;
  }));
  const double total = seconds_since(begin);
  ASSERT_FALSE(reported.empty());
  EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end()));
  EXPECT_GE(reported.front(), 0.0);
  EXPECT_LE(reported.back(), 1.0);
  double max = 0.0, max_reported = 0.0;
  for (const double fraction : {0.0, 0.3, 0.7}) {
    const Clock::time_point start = Clock::now();
    Clock::time_point ended;
    bool cancelled = false;
    const auto status = work([&](double at) {
      EXPECT_FALSE(cancelled) << "the monitor is called after it returned false";
      max_reported = std::max(max_reported, at);
      if (seconds_since(start) < fraction * total) return true;
      cancelled = true;
      ended = Clock::now();
      return false;
    });
    if (!cancelled) continue;  // the work finished first
    max = std::max(max, seconds_since(ended));
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::kInterrupted);
  }
  std::printf("%s: %.0f ms, ends within %.0f ms, %zu monitor calls\n", what, 1e3 * total, 1e3 * max, reported.size());
  constexpr double kMaxSeconds = 0.3;
  EXPECT_LT(max, std::max(kMaxSeconds, 0.1 * total));
}

class Cancel : public test::ProgramTest {
 protected:
  /// Writes a quarter of a million triangles to a file of this kind.
  fs::path file_of(const std::string& extension) {
    constexpr int kSide = 350;
    const Mesh mesh = waves(kSide);
    const fs::path file = folder_ / ("waves." + extension);
    std::string text;
    if (extension == "ply")
      text = fmt::format(
          "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
          "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
          mesh.positions.size(), mesh.indices.size() / 3);
    if (extension == "off") text = fmt::format("OFF\n{} {} 0\n", mesh.positions.size(), mesh.indices.size() / 3);
    const bool obj = extension == "obj";
    for (const glm::vec3& p : mesh.positions)
      fmt::format_to(std::back_inserter(text), "{}{} {} {}\n", obj ? "v " : "", p.x, p.y, p.z);
    for (std::size_t i = 0; i < mesh.indices.size() && extension != "xyz"; i += 3) {
      const unsigned first = obj ? 1 : 0;
      fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", obj ? "f" : "3", mesh.indices[i] + first,
                     mesh.indices[i + 1] + first, mesh.indices[i + 2] + first);
    }
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
};

void expect_no_children() {
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(Cancel, ReadingAFileEnds) {
  for (const char* extension : {"ply", "off", "xyz", "obj"}) {
    const fs::path file = file_of(extension);
    expect_ends(
        [&](const ProgressMonitor& monitor) {
          const auto scene = import_scene(file, {}, monitor);
          return scene ? Result<void>() : scene.error();
        },
        extension);
    expect_no_children();
    fs::remove(file);
  }
}

TEST_F(Cancel, SeveralModelsAreOneWork) {
  const std::string file = file_of("ply").string();
  expect_ends(
      [&](const ProgressMonitor& monitor) {
        const auto scene = load_scenes({file, "scene:solids?detail=2000", file}, {}, monitor);
        return scene ? Result<void>() : scene.error();
      },
      "three models");
}

TEST_F(Cancel, BuildingAHierarchyEnds) {
  Scene scene;
  constexpr int kSide = 500;
  scene.meshes.push_back(waves(kSide));
  ASSERT_EQ(finish_scene(scene), 0u);
  for (const int threads : {1, 2}) {
    const auto device = make_cpu_device({.threads = threads});
    expect_ends([&](const ProgressMonitor& monitor) { return device->prepare(scene, monitor); }, "prepare");
    expect_ends(
        [&](const ProgressMonitor& monitor) {
          const auto traced = build_traced_scene(scene, threads, monitor);
          return traced ? Result<void>() : traced.error();
        },
        "build_traced_scene");
  }
  expect_ends(
      [&](const ProgressMonitor& monitor) {
        const auto built = build_hierarchy(scene, scene.center(), 1.0f, monitor);
        return built ? Result<void>() : built.error();
      },
      "build_hierarchy");
  // Interrupted work leaves no trace.
  const auto device = make_cpu_device({});
  int calls = 0;
  EXPECT_FALSE(device->prepare(scene, [&](double) { return ++calls < 2; }));
  ASSERT_TRUE(device->prepare(scene));
  const Camera camera = frame_scene(scene, {}, 64, 48);
  EXPECT_TRUE(device->capture(camera, {.width = 64, .height = 48}));
}

TEST_F(Cancel, TheLibraryEndsWhileItOpensAModel) {
  for (const char* extension : {"ply", "obj"}) {
    const std::string file = file_of(extension).string();
    for (const int last : {2, 4, 6}) {
      int calls = 0;
      umb::FrameRenderer renderer;
      const auto outcome = renderer.open(
          {.model = file, .look = "ao", .width = 64, .height = 48, .device = "cpu", .progress = [&](double done) {
             EXPECT_EQ(done, 0.0);
             return ++calls < last;
           }});
      EXPECT_EQ(outcome.code, 130) << outcome.message;
      EXPECT_EQ(calls, last);
    }
    expect_no_children();
  }
}

}  // namespace
}  // namespace umbrage
