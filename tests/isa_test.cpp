// Runs the program as users do under each instruction set of this machine. It must succeed and draw the same picture as
// plain C++.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/lists.h"
#include "draw_picture.h"
#include "kernel/isa.h"
#include "looks/looks.h"
#include "renderer/models.h"
#include "run_program.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr const char* kScenes[] = {"scene:solids?detail=3000", "scene:room?detail=3000", "scene:terrain?detail=3000"};
const std::string kSize = " --resolution 96x64 --threads 2";
// Kernels that count differ by single counts in few pixels; filters and light spread these to their neighbours. No
// pixel differs visibly, and nearly all are within the bound of smooth kernels.
constexpr double kVisible = 2.0 / 255.0, kSmooth = 1e-4, kMaxFractionOver = 0.02, kMaxMean = 2e-5;

void expect_close(const Image& picture, const Image& oracle) {
  ASSERT_EQ(picture.names, oracle.names);
  for (std::size_t p = 0; p < oracle.planes.size(); ++p) {
    const double scale = test::scale_of(oracle.planes[p]);
    const auto d = test::difference(oracle.planes[p], picture.planes[p], kSmooth * scale);
    EXPECT_LE(d.max, kVisible * scale) << oracle.names[p];
    EXPECT_LE(d.fraction_over, kMaxFractionOver) << oracle.names[p];
    EXPECT_LE(d.mean, kMaxMean * scale) << oracle.names[p];
  }
}

class Isa : public test::ProgramTest {
 protected:
  void succeed(const std::string& words, std::string_view isa) {
    const auto outcome = run(words, fmt::format("UMBRAGE_ISA={}", isa));
    ASSERT_EQ(outcome.code, 0) << isa << ": " << words << ": " << outcome.err;
  }

  /// Expects the same picture from these arguments under all instruction sets.
  void expect_same(const std::string& words) {
    succeed(words + " -o scalar.exr", "scalar");
    const Image oracle = image("scalar.exr");
    for (const std::string_view isa : test::isas()) {
      if (isa == "scalar") continue;
      SCOPED_TRACE(fmt::format("{}: {}", isa, words));
      succeed(words + " -o other.exr", isa);
      expect_close(image("other.exr"), oracle);
    }
  }
};

/// In this process, since the built-in scenes take longer to make than their pictures.
class IsaScenes : public testing::TestWithParam<const char*> {
 protected:
  void TearDown() override { choose_isa(""); }
};

TEST_P(IsaScenes, EveryLookDrawsTheSamePicture) {
  const auto scene = load_scene(GetParam());
  ASSERT_TRUE(scene) << scene.error().message;
  const auto picture_of = [&](const Look& look, std::string_view isa) {
    EXPECT_TRUE(choose_isa(isa));
    Request request;
    request.look = look.name;
    request.width = 96;
    request.height = 64;
    return test::drawn_picture(*scene, request, {"color.r", "color.g", "color.b", "color.a"}).image;
  };
  const auto isas = test::isas();
  for (const Look* look : scene_looks()) {
    const Image oracle = picture_of(*look, "scalar");
    for (const std::string_view isa : isas) {
      SCOPED_TRACE(fmt::format("{}: {}", isa, look->name));
      if (isa != "scalar") expect_close(picture_of(*look, isa), oracle);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, IsaScenes, testing::ValuesIn(kScenes));

TEST_F(Isa, PassesAreTheSame) {
  for (const char* scene : kScenes)
    expect_same(fmt::format("{} --passes depth,normal,ao --device cpu{}", scene, kSize));
}

TEST_F(Isa, TheReferenceAndItsLightAreTheSame) {
  for (const char* scene : kScenes)
    expect_same(fmt::format("{} --look lit --ao reference --set reference.light=bounce --device cpu{}", scene, kSize));
}

TEST_F(Isa, LightOfImagesIsTheSame) { expect_same("scene:solids?detail=3000 --hdri-file sky: --device cpu" + kSize); }

// Embree builds the hierarchies of the Vulkan device and draws some of its captures.
TEST_F(Isa, VulkanDrawsTheSame) {
  UMBRAGE_NEEDS_VULKAN(test::vulkan_device());
  expect_same("scene:solids?detail=3000 --device vulkan" + kSize);
}

TEST_F(Isa, ComparisonsScoreTheSame) {
  const std::string words =
      "compare scene:solids?detail=3000 --ao bitmask,unsharp --light --samples 16 --device cpu -o ";
  const auto scores = [&](std::string_view isa) {
    succeed(words + std::string(isa) + kSize, isa);
    return nlohmann::json::parse(test::text_of(folder_ / isa / "scores.json"));
  };
  const auto oracle = scores("scalar");
  ASSERT_FALSE(oracle.empty());
  ASSERT_TRUE(oracle[0].contains("rmse"));
  for (const std::string_view isa : test::isas()) {
    if (isa == "scalar") continue;
    const auto found = scores(isa);
    ASSERT_EQ(found.size(), oracle.size());
    for (std::size_t k = 0; k < oracle.size(); ++k)
      for (const char* number : {"rmse", "bias", "ssim"}) {
        if (!oracle[k].contains(number)) continue;
        EXPECT_NEAR(found[k][number].get<double>(), oracle[k][number].get<double>(), 1e-3)
            << isa << ' ' << oracle[k].dump();
      }
  }
}

TEST_F(Isa, BenchmarksRun) {
  for (const std::string_view isa : test::isas())
    succeed("bench scene:solids?detail=3000 --runs 1 --json --device cpu" + kSize, isa);
}

TEST_F(Isa, IsReported) {
  for (const std::string_view isa : test::isas()) {
    const std::string text = fmt::format("kernels {}, rays {},", isa, isa == "scalar" ? "sse2" : isa);
    const std::string set = fmt::format("UMBRAGE_ISA={}", isa);
    EXPECT_NE(good("list devices", set).out.find(text), std::string::npos) << isa;
    EXPECT_NE(run("tri.obj -o a.png --device cpu --verbose" + kSize, set).err.find(text), std::string::npos) << isa;
  }
}

TEST_F(Isa, OptionWinsOverTheEnvironment) {
  const auto outcome = run("tri.obj -o a.png --isa scalar --device cpu --verbose" + kSize, "UMBRAGE_ISA=nonsense");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("kernels scalar"), std::string::npos) << outcome.err;
}

TEST_F(Isa, IsTakenFromAConfigurationButNotWithoutAValue) {
  write("bounded", "isa = scalar\n");
  const auto outcome = run("tri.obj -o a.png --config bounded --device cpu --verbose" + kSize, "UMBRAGE_ISA=");
  EXPECT_NE(outcome.err.find("kernels scalar"), std::string::npos) << outcome.err;
  write("empty", "look = ao\nisa =\n");
  bad("tri.obj -o b.png --config empty", 2, {"'empty', line 2", "isa needs a value"});
}

TEST_F(Isa, InvalidSetsAreRefused) {
  bad_option("--isa avx3", {"--isa", "'avx3'", "scalar"});
  bad("list devices", 2, {"UMBRAGE_ISA", "'mmx'", "scalar"}, "UMBRAGE_ISA=mmx");
  bad("tri.obj -o a.png", 2, {"UMBRAGE_ISA", "'mmx'", "scalar"}, "UMBRAGE_ISA=mmx");
  for (const std::string_view known : known_isas())  // includes at least one unusable set: of x86 or of ARM
    if (!contains(usable_isas(), known))
      bad(fmt::format("tri.obj -o a.png --isa {}", known), 4, {fmt::format("'{}' on this CPU", known), "scalar"});
}

}  // namespace
}  // namespace umbrage
