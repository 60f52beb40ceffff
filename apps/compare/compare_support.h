// Comparisons for the tests of `umbrage compare`.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <utility>

#include "apps/compare/compare.h"
#include "renderer/devices.h"

namespace umbrage::test {

/// Returns settings for one picture of scene:solids, timed once, without a filter.
inline CompareSettings solids_settings(int detail, std::pair<int, int> size, int samples) {
  CompareSettings settings;
  settings.models = {fmt::format("scene:solids?detail={}", detail)};
  settings.sizes = {size};
  settings.cameras = 1;
  settings.samples = samples;
  settings.runs = 1;
  settings.filter = kNoFilter;
  return settings;
}

inline Comparison compared(const CompareSettings& settings) {
  const auto device = make_device("cpu", 0);
  auto result = compare(**device, settings);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

}  // namespace umbrage::test
