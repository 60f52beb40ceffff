// The boundary between the library and its host: every failure inside becomes an Outcome.
#include "core/guarded.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <new>
#include <vector>

#include "kernel/kernel_frame.h"
#include "run_program.h"
#include "umbrage/umbrage.hpp"
#include "vulkan_support.h"
using namespace umb;  // the public interface; its names used here are not in umbrage

namespace umbrage {
namespace {

struct Fault {
  const char* name;
  void (*inject)();
  int code;
  const char* text;
};

const Fault kFaults[] = {
    {"Check", [] { check_equal(2, 3, "injected"); }, 1, "internal error: injected: 2 != 3"},
    {"Exception", [] { throw std::out_of_range("injected"); }, 1, "internal error: injected"},
    {"Memory", [] { throw std::bad_alloc(); }, 4, "not enough memory for a picture of "},
};

class Guarded : public testing::TestWithParam<Fault> {
 protected:
  void TearDown() override { injected_fault = nullptr; }

  /// Makes the call with the fault, which must be reported, and then without it.
  void expect_reported(const std::function<Outcome(Picture&)>& call) {
    Picture picture{1, 1, {0.25f, 0.5f, 0.75f, 1.0f}, {}};
    injected_fault = GetParam().inject;
    const Outcome failed = call(picture);
    injected_fault = nullptr;
    EXPECT_EQ(failed.code, GetParam().code) << failed.message;
    EXPECT_NE(failed.message.find(GetParam().text), std::string::npos) << failed.message;
    EXPECT_EQ(failed.message.find('\n'), std::string::npos) << failed.message;
    EXPECT_EQ(picture.rgba.size(), 4u);
    const Outcome again = call(picture);
    EXPECT_EQ(again.code, 0) << again.message;
    EXPECT_EQ(picture.rgba.size(), 64u * 48u * 4u);
  }
};

RenderRequest solids(const char* device) {
  return {.model = "scene:solids?detail=3000", .look = "ao", .width = 64, .height = 48, .threads = 2, .device = device};
}

TEST_P(Guarded, Render) {
  expect_reported([](Picture& picture) { return render(solids("cpu"), picture); });
}

TEST_P(Guarded, VulkanRender) {
  UMBRAGE_NEEDS_VULKAN(test::vulkan_device());
  expect_reported([](Picture& picture) { return render(solids("vulkan"), picture); });
}

TEST_P(Guarded, Frames) {
  FrameRenderer renderer;
  ASSERT_EQ(renderer.open(solids("cpu")).code, 0);
  expect_reported([&](Picture& picture) { return renderer.draw({}, picture); });
}

// Work recorded before the fault must not break later pictures.
TEST_P(Guarded, VulkanFrames) {
  UMBRAGE_NEEDS_VULKAN(test::vulkan_device());
  FrameRenderer renderer;
  ASSERT_EQ(renderer.open(solids("vulkan")).code, 0);
  expect_reported([&](Picture& picture) { return renderer.draw({}, picture); });
}

TEST_P(Guarded, Shade) {
  const std::vector<float> depth(64 * 48, 2.0f);
  ShadeRequest request;
  request.width = 64;
  request.height = 48;
  request.arrays = {{.name = "depth", .values = depth.data()}};
  request.look = "ao";
  request.device = "cpu";
  expect_reported([&](Picture& picture) { return shade(request, picture); });
}

INSTANTIATE_TEST_SUITE_P(Faults, Guarded, testing::ValuesIn(kFaults), [](const auto& info) { return info.param.name; });

TEST(KernelFrame, RefusesPlanesThatTheDispatchDoesNotList) { EXPECT_THROW(KernelFrame{}.plane("x"), std::logic_error); }

// Runs the program with several memory limits, since the memory that it has when it starts to draw is unknown.
class ShortMemory : public test::ProgramTest {};

TEST_F(ShortMemory, IsCodeFourAndWritesNothing) {
  const std::string words =
      " scene:solids?detail=3000 --look ao --resolution 6000x6000 --memory 64G --device cpu --threads 2 -o big.png";
  for (const int megabytes : {150, 300, 500, 800, 1200}) {
    const test::fs::path err = root_ / "err";
    const std::string line =
        fmt::format("cd {} && ulimit -v {} && {}{} >/dev/null 2>{}", test::quoted(folder_.string()), megabytes * 1024,
                    test::quoted(test::kProgram), words, test::quoted(err.string()));
    const int status = std::system(line.c_str());
    ASSERT_TRUE(WIFEXITED(status)) << megabytes;
    const std::string reported = test::text_of(err);
    ASSERT_EQ(WEXITSTATUS(status), 4) << megabytes << ": " << reported;
    EXPECT_NE(reported.find("not enough memory for"), std::string::npos) << reported;
    EXPECT_EQ(std::count(reported.begin(), reported.end(), '\n'), 1) << reported;
    EXPECT_FALSE(test::fs::exists(folder_ / "big.png"));
  }
}

}  // namespace
}  // namespace umbrage
