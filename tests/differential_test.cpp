// Compares the scalar kernels of every effect with its kernels on every SIMD target, with any number of threads, with
// its tuned kernels, and with its kernels on a Vulkan device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "faulty_vulkan.h"
#include "kernel/frame_constants.h"
#include "kernel/isa.h"
#include "renderer/models.h"
#include "renderer/recipe.h"
#include "run_effect.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

struct Size {
  int width, height;
};
constexpr Size kSizes[] = {{1, 1}, {3, 2}, {191, 347}};

/// The input of a test run. runs() returns every size with each of `variants` variants.
struct Run {
  Size size;
  unsigned variant;
};
std::vector<Run> runs(unsigned variants) {
  std::vector<Run> all;
  for (const Size size : kSizes)
    for (unsigned variant = 0; variant < variants; ++variant) all.push_back({size, variant});
  return all;
}

constexpr double kMaxFlips = 1e-4;  // fraction of the pixels, for kernels that count or threshold

/// Returns random parameters of an effect within the ranges of its table; variant 0: its defaults.
ParameterBytes variant_of(const Effect& effect, unsigned variant) {
  ParameterBytes bytes = initial_parameters(effect.parameters, effect.params_size);
  if (variant == 0) return bytes;
  for (std::size_t k = 0; k < effect.parameters.size(); ++k) {
    const Parameter& row = effect.parameters[k];
    const unsigned r = test::hash(variant * 101u + unsigned(k));
    std::string text;
    // Windows are small, since plain scalar kernels are slow; numbers are close to usual settings.
    constexpr double kMaxWindow = 21.0, kMaxNumber = 8.0;
    switch (row.type) {
      case ParameterType::kChoice:
        text = row.choices[r % row.choices.size()];
        break;
      case ParameterType::kBool:
        text = r % 2 ? "on" : "off";
        break;
      case ParameterType::kLength:
        text = fmt::format("{}", 1 + r % int(std::min(kMaxWindow, row.max)));
        break;
      case ParameterType::kInt:
        text = fmt::format("{}", row.min + r % int(std::min(row.max - row.min, 8.0) + 1));
        break;
      default: {
        const double max = std::min(row.max, row.min + kMaxNumber);
        text = fmt::format("{}", r % 4 == 0 ? row.initial : row.min + (max - row.min) * (r % 1000) / 999.0);
      }
    }
    EXPECT_TRUE(set_parameter(effect.name, row, text, bytes)) << row.name << " = " << text;
  }
  return bytes;
}

/// Runs the effect on a G-buffer and returns all planes that it writes.
Image outputs(const Effect& effect, const ParameterBytes& params, const GBuffer& gbuffer, Device& device) {
  const Image none(gbuffer.info.inner_width(), gbuffer.info.inner_height());
  auto frame = device.upload(gbuffer);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  if (!frame) return none;
  const auto status = device.run(effect, params, *frame);
  EXPECT_TRUE(status) << (status ? "" : status.error().message);
  const auto names = test::written_planes(effect, params);
  if (names.empty()) return none;
  auto image = device.download(*frame, names);
  EXPECT_TRUE(image) << (image ? "" : image.error().message);
  return image ? *image : none;
}
Image outputs(const Effect& effect, const ParameterBytes& params, const GBuffer& gbuffer, const CpuSettings& settings) {
  return outputs(effect, params, gbuffer, *make_cpu_device(settings));
}

/// Adds the inputs of an effect that other effects write, that is, inputs of a dispatch that no earlier dispatch
/// writes.
void add_inputs_of_other_effects(const Effect& effect, GBuffer& gbuffer) {
  for (std::size_t reader = 0; reader < effect.dispatches.size(); ++reader)
    for (std::string_view input : effect.dispatches[reader].inputs) {
      bool written_here = false;
      for (std::size_t k = 0; k < reader; ++k)
        for (std::string_view output : effect.dispatches[k].outputs) written_here |= output == input;
      if (written_here || gbuffer.layers[0].find(input)) continue;
      Plane& plane = gbuffer.layers[0].add(input);
      for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x)
          plane.at(x, y) = float(test::hash(x + 4099u * y + unsigned(input.size())) >> 8) * 0x1.4p-24f;
    }
}

/// Returns the input of an effect, with an orthographic camera for odd variants.
GBuffer bumpy_input(const Effect& effect, Size size, unsigned variant) {
  GBuffer gbuffer = test::bumpy_gbuffer(size.width, size.height, 7 + variant);
  if (variant % 2) gbuffer.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 1.5f);
  add_inputs_of_other_effects(effect, gbuffer);
  return gbuffer;
}

/// Returns the number of pixels of a plane that are not finite, except infinite depth of the background.
long undefined_pixels(const Image& image, std::size_t p) {
  long count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float v = image.planes[p].at(x, y);
      const bool no_surface = image.names[p] == "depth" && v == std::numeric_limits<float>::infinity();
      count += !std::isfinite(v) && !no_surface;
    }
  return count;
}

class Differential : public testing::TestWithParam<const Effect*> {
 protected:
  void TearDown() override { choose_isa(""); }
};

TEST_P(Differential, LanesAgreeWithScalarOnEveryTarget) {
  const Effect& effect = *GetParam();
  for (const auto& [size, variant] : runs(6)) {
    const GBuffer gbuffer = bumpy_input(effect, size, variant);
    const ParameterBytes params = variant_of(effect, variant);
    const Image oracle = outputs(effect, params, gbuffer, {.scalar = true});
    for (const std::string_view target : test::lane_isas()) {
      ASSERT_TRUE(choose_isa(target));
      const Image lanes = outputs(effect, params, gbuffer, {.tuned = false});
      for (std::size_t p = 0; p < oracle.planes.size(); ++p) {
        const double scale = test::scale_of(oracle.planes[p]);
        const auto d = test::difference(oracle.planes[p], lanes.planes[p], 1e-4 * scale);
        const std::string what = fmt::format("{} {} {} variant {} at {}x{}", effect.name, oracle.names[p], target,
                                             variant, size.width, size.height);
        if (effect.quantum > 0.0) {
          EXPECT_LE(d.fraction_over, kMaxFlips) << what;
          EXPECT_LE(d.max, 2.0 * effect.quantum * scale) << what;
        } else {
          EXPECT_LE(d.max, 1e-4 * scale) << what;
          EXPECT_LE(d.mean, 1e-6 * scale) << what;
        }
      }
    }
  }
}

TEST_P(Differential, TunedKernelsAreBitwiseIdentical) {
  const Effect& effect = *GetParam();
  if (std::none_of(effect.dispatches.begin(), effect.dispatches.end(),
                   [](const Dispatch& dispatch) { return dispatch.tuned != nullptr; }))
    return;
  for (const auto& [size, variant] : runs(12)) {
    GBuffer gbuffer = test::bumpy_gbuffer(size.width, size.height, 70 + variant);
    add_inputs_of_other_effects(effect, gbuffer);
    const ParameterBytes params = variant_of(effect, variant);
    for (const std::string_view target : test::lane_isas()) {
      ASSERT_TRUE(choose_isa(target));
      const Image plain = outputs(effect, params, gbuffer, {.tuned = false});
      const Image tuned = outputs(effect, params, gbuffer, {.tuned = true});
      for (std::size_t p = 0; p < plain.planes.size(); ++p)
        EXPECT_EQ(test::difference(plain.planes[p], tuned.planes[p], 0.0).max, 0.0)
            << effect.name << ' ' << plain.names[p] << ' ' << target << " variant " << variant << " at " << size.width
            << 'x' << size.height;
    }
  }
}

TEST_P(Differential, ThreadsAndRunsDoNotMatter) {
  const Effect& effect = *GetParam();
  GBuffer gbuffer = test::bumpy_gbuffer(191, 347, 3);
  add_inputs_of_other_effects(effect, gbuffer);
  const ParameterBytes params = variant_of(effect, 0);
  const Image one = outputs(effect, params, gbuffer, {.threads = 1});
  for (int threads : {1, 2, 5}) {
    const Image many = outputs(effect, params, gbuffer, {.threads = threads});
    for (std::size_t p = 0; p < one.planes.size(); ++p)
      EXPECT_EQ(test::difference(one.planes[p], many.planes[p], 0.0).max, 0.0) << effect.name << ' ' << threads;
  }
}

TEST_P(Differential, HostileInputGivesDefinedOutput) {
  const Effect& effect = *GetParam();
  for (const auto& [size, variant] : runs(4)) {
    GBuffer gbuffer = test::hostile_gbuffer(size.width, size.height, 11 + variant);
    add_inputs_of_other_effects(effect, gbuffer);
    for (const bool scalar : {true, false}) {
      const Image image = outputs(effect, variant_of(effect, variant), gbuffer, {.scalar = scalar});
      for (std::size_t p = 0; p < image.planes.size(); ++p) {
        EXPECT_EQ(undefined_pixels(image, p), 0)
            << effect.name << ' ' << image.names[p] << (scalar ? " scalar" : " lanes") << " variant " << variant;
      }
    }
  }
}

// A GPU rounds some functions differently: all but a thousandth of the pixels are within a visible difference, or
// within one quantum.
TEST_P(Differential, VulkanAgreesWithScalar) {
  constexpr double kVisible = 2.0 / 255.0, kMaxOver = 1e-3;
  const Effect& effect = *GetParam();
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  for (const auto& [size, variant] : runs(6)) {
    const GBuffer gbuffer = bumpy_input(effect, size, variant);
    const ParameterBytes params = variant_of(effect, variant);
    const Image oracle = outputs(effect, params, gbuffer, {.scalar = true});
    const Image image = outputs(effect, params, gbuffer, *device);
    ASSERT_EQ(image.names, oracle.names);
    for (std::size_t p = 0; p < oracle.planes.size(); ++p) {
      const double bound = std::max(kVisible, effect.quantum) * test::scale_of(oracle.planes[p]);
      const auto d = test::difference(oracle.planes[p], image.planes[p], bound);
      EXPECT_LE(d.fraction_over, kMaxOver) << effect.name << ' ' << oracle.names[p] << " variant " << variant << " at "
                                           << size.width << 'x' << size.height << ", most " << d.max;
    }
  }
}

TEST_P(Differential, VulkanRunsAreBitwiseIdenticalAndDefined) {
  const Effect& effect = *GetParam();
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  for (const auto& [size, variant] : runs(4)) {
    GBuffer gbuffer = test::hostile_gbuffer(size.width, size.height, 11 + variant);
    add_inputs_of_other_effects(effect, gbuffer);
    const Image once = outputs(effect, variant_of(effect, variant), gbuffer, *device);
    const Image again = outputs(effect, variant_of(effect, variant), gbuffer, *device);
    for (std::size_t p = 0; p < once.planes.size(); ++p) {
      EXPECT_EQ(undefined_pixels(once, p), 0) << effect.name << ' ' << once.names[p] << " variant " << variant;
      EXPECT_EQ(test::difference(once.planes[p], again.planes[p], 0.0).max, 0.0) << effect.name << once.names[p];
    }
  }
}

bool has_gpu_variants(const Effect& effect) {
  return std::any_of(effect.dispatches.begin(), effect.dispatches.end(),
                     [](const Dispatch& dispatch) { return !dispatch.gpu_variants.empty(); });
}

TEST_P(Differential, GpuVariantsAreBitwiseIdentical) {
  const Effect& effect = *GetParam();
  if (!has_gpu_variants(effect)) return;
  Device* const tuned = test::vulkan_device();
  const auto plain = test::new_vulkan_device({.tuned = false});
  UMBRAGE_NEEDS_VULKAN(tuned && plain);
  const test::NoMessages no_messages;
  std::vector<ParameterBytes> all;
  for (unsigned variant = 0; variant < 12; ++variant) all.push_back(variant_of(effect, variant));
  for (const std::string_view text : effect.variants) {
    EffectSettings settings;
    const std::string name(effect.name);
    settings[name] = variant_of(effect, 0);
    ASSERT_TRUE(apply_variant(settings, effect, text)) << text;
    all.push_back(settings[name]);
  }
  for (const Size size : {Size{1, 1}, Size{3, 2}, Size{67, 41}})
    for (std::size_t k = 0; k < all.size(); ++k)
      for (const bool hostile : {false, true}) {
        GBuffer gbuffer = hostile ? test::hostile_gbuffer(size.width, size.height, 11 + unsigned(k))
                                  : test::bumpy_gbuffer(size.width, size.height, 70 + unsigned(k));
        add_inputs_of_other_effects(effect, gbuffer);
        const Image a = outputs(effect, all[k], gbuffer, *plain), b = outputs(effect, all[k], gbuffer, *tuned);
        ASSERT_EQ(a.names, b.names);
        for (std::size_t p = 0; p < a.planes.size(); ++p)
          EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).max, 0.0)
              << effect.name << ' ' << a.names[p] << " setting " << k << " at " << size.width << 'x' << size.height;
      }
}

// Planes that a device cannot bind are read by their addresses.
TEST_P(Differential, PlanesTooLargeToBindAreBitwiseIdentical) {
  const Effect& effect = *GetParam();
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  test::faulty().faults.max_bound_bytes = 4096;
  const auto unbound = test::new_vulkan_device({.get = test::faulty_get});
  Device* const bound = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(unbound && bound);
  const test::NoMessages no_messages;
  GBuffer gbuffer = test::bumpy_gbuffer(67, 41, 3);
  add_inputs_of_other_effects(effect, gbuffer);
  for (const unsigned variant : {0u, 1u, 2u}) {
    const ParameterBytes params = variant_of(effect, variant);
    const Image a = outputs(effect, params, gbuffer, *bound), b = outputs(effect, params, gbuffer, *unbound);
    ASSERT_EQ(a.names, b.names);
    for (std::size_t p = 0; p < a.planes.size(); ++p)
      EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).max, 0.0)
          << effect.name << ' ' << a.names[p] << " variant " << variant;
  }
}

// In high pictures, lines are detected with strides of several pixels, and light is smoothed over many.
class HighPictures : public testing::TestWithParam<Size> {};

/// Compares an effect on all SIMD targets, and `plane` on the Vulkan device, with the scalar kernel. Returns the scalar
/// planes.
Image compare_with_scalar(const char* name, const char* plane, const Size& size, Device& vulkan) {
  const Effect& effect = *find_effect(name);
  GBuffer gbuffer = test::bumpy_gbuffer(size.width, size.height, 7);
  add_inputs_of_other_effects(effect, gbuffer);
  const ParameterBytes params = variant_of(effect, 0);
  Image oracle = outputs(effect, params, gbuffer, {.scalar = true});
  for (const std::string_view target : test::lane_isas()) {
    EXPECT_TRUE(choose_isa(target));
    const Image image = outputs(effect, params, gbuffer, {});
    for (std::size_t p = 0; p < oracle.planes.size(); ++p) {
      const auto d = test::difference(oracle.planes[p], image.planes[p], 1e-4 * test::scale_of(oracle.planes[p]));
      EXPECT_LE(d.fraction_over, kMaxFlips) << oracle.names[p] << ' ' << target << " at " << size.height;
    }
  }
  choose_isa("");
  const Image image = outputs(effect, params, gbuffer, vulkan);
  const auto d = test::difference(oracle.plane(plane), image.plane(plane), 2.0 / 255.0);
  EXPECT_LE(d.fraction_over, 1e-3) << "at " << size.height;
  return oracle;
}

TEST_P(HighPictures, LinesAgreeWithScalar) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  const Image oracle = compare_with_scalar("outline", "outline", GetParam(), *device);
  double drawn = 0.0;
  for (int y = 0; y < oracle.height; ++y)
    for (int x = 0; x < oracle.width; ++x) drawn += oracle.plane("outline").at(x, y);
  EXPECT_GT(drawn, 100.0);
}

TEST_P(HighPictures, StripsAgreeWithScalar) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  compare_with_scalar("toon", "lit.g", GetParam(), *device);
}

INSTANTIATE_TEST_SUITE_P(Strides, HighPictures, testing::Values(Size{37, 1300}, Size{33, 2200}, Size{35, 2900}),
                         [](const auto& info) { return std::to_string(info.param.height); });

bool is_missing(int x, int y) { return test::hash(unsigned(x) + 4099u * unsigned(y)) % 7 == 0 || (x > 90 && y == 17); }

// Missing pixels get bitwise the occlusion of a run for all pixels. Other pixels, and light, are unchanged.
TEST_P(Differential, MissingPixelsAreAsInARunForAll) {
  const Effect& effect = *GetParam();
  for (const bool bleeding : {false, true}) {
    if (bleeding && !find_parameter(effect, "bleeding")) continue;
    const ParameterBytes params =
        test::parameters_of(effect, bleeding ? test::Settings{{"bleeding", "1"}} : test::Settings{});
    if (!runs_for_missing(effect, params)) continue;
    for (const Size size : kSizes) {
      GBuffer gbuffer = test::bumpy_gbuffer(size.width, size.height, 5);
      add_inputs_of_other_effects(effect, gbuffer);
      const auto check = [&](Device& device, const std::string& what) {
        SCOPED_TRACE(fmt::format("{}, bleeding {}, at {}x{}", what, bleeding, size.width, size.height));
        auto frame = *device.upload(gbuffer);
        ASSERT_TRUE(device.run(effect, params, frame));
        const Plane all = device.download(frame, {"ao"})->planes[0];
        Image start(size.width, size.height);
        for (const char* name : {"ao", "indirect.r"}) start.add(name) = Plane(size.width, size.height, 0.25f);
        for (int y = 0; y < size.height; ++y)
          for (int x = 0; x < size.width; ++x)
            if (is_missing(x, y)) start.plane("ao").at(x, y) = kMissing;
        ASSERT_TRUE(device.add(start, frame));
        ASSERT_TRUE(device.run(effect, params, frame, {.pixels = PixelSet::kMissing}));
        const Image result = *device.download(frame, {"ao", "indirect.r"});
        long wrong = 0;
        for (int y = 0; y < size.height; ++y)
          for (int x = 0; x < size.width; ++x) {
            wrong += result.planes[0].at(x, y) != (is_missing(x, y) ? all.at(x, y) : 0.25f);
            wrong += result.planes[1].at(x, y) != 0.25f;
          }
        EXPECT_EQ(wrong, 0);
      };
      check(*make_cpu_device({.scalar = true}), "scalar");
      for (const std::string_view target : test::lane_isas()) {
        ASSERT_TRUE(choose_isa(target));
        check(*make_cpu_device({}), std::string(target));
      }
      if (Device* const device = test::vulkan_device()) {
        const test::NoMessages no_messages;
        check(*device, "vulkan");
      }
    }
  }
}

/// Returns the effects that need no scene besides the planes of a picture.
std::vector<const Effect*> effects_of_planes() {
  std::vector<const Effect*> all(effects().begin(), effects().end());
  std::erase_if(all, [](const Effect* effect) { return needs_scene(*effect); });
  return all;
}

INSTANTIATE_TEST_SUITE_P(Effects, Differential, testing::ValuesIn(effects_of_planes()),
                         [](const auto& info) { return std::string(info.param->name); });

}  // namespace
}  // namespace umbrage
