// The Vulkan devices that tests run on, with validation layers.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "devices/vulkan/vulkan_device.h"
#include "memory_order.h"

namespace umbrage::test {

/// Returns the messages of the validation layers so far, from all devices of the functions below.
inline std::vector<std::string>& validation_messages() {
  static std::vector<std::string> all;
  return all;
}

inline ValidationMessage note_message() {
  return [](std::string_view message) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    validation_messages().emplace_back(message);
  };
}

/// Returns whether tests may be skipped because there is no Vulkan device: not if CI is set in the environment.
inline bool may_lack_vulkan() { return !std::getenv("CI"); }

/// Returns a new device with validation and checked_get(). Returns null if there is none, which is a failure if CI is
/// set.
inline std::unique_ptr<Device> new_vulkan_device(VulkanSettings settings = {}) {
  settings.on_message = note_message();
  if (!settings.get) settings.get = checked_get;
  auto device = make_vulkan_device(settings, make_cpu_device());
  if (device) return std::move(*device);
  if (!may_lack_vulkan()) ADD_FAILURE() << device.error().message;
  return nullptr;
}

/// Returns `device`. The test fails if it is null and CI is set.
inline Device* expect_in_ci(Device* device) {
  EXPECT_TRUE(device || may_lack_vulkan()) << "no Vulkan device here";
  return device;
}

/// Returns one device for all tests that only use it; null if there is none, which is a failure if CI is set. It is
/// never destroyed, since the driver's own statics may be destroyed before it.
inline Device* vulkan_device() {
  static Device* const device = new_vulkan_device().release();
  return expect_in_ci(device);
}

/// Fails for each validation message during its lifetime.
struct NoMessages {
  std::size_t before = validation_messages().size();
  ~NoMessages() {
    for (std::size_t k = before; k < validation_messages().size(); ++k) ADD_FAILURE() << validation_messages()[k];
  }
};

}  // namespace umbrage::test

/// Skips a test if `device`, a Vulkan device or what one needs, is null or false. If CI is set, the test fails instead.
#define UMBRAGE_NEEDS_VULKAN(device)                                          \
  do {                                                                        \
    if (device) break;                                                        \
    if (!umbrage::test::may_lack_vulkan()) FAIL() << "no Vulkan device here"; \
    GTEST_SKIP() << "no Vulkan device here";                                  \
  } while (false)
