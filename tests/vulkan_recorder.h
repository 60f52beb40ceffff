// Commands of a device of their own, for tests that record what the Vulkan device does not.
#pragma once
#include <gtest/gtest.h>

#include <memory>

#include "devices/vulkan/commands.h"
#include "devices/vulkan/gpu.h"
#include "devices/vulkan/instance.h"
#include "devices/vulkan/memory.h"

namespace umbrage::test {

struct Recorder {
  GpuPtr gpu;
  std::shared_ptr<Memory> memory;
  std::unique_ptr<Commands> commands;
};

/// Opens the first device. The test fails, and `commands` is null, if that is not possible.
inline Recorder open_recorder(const InstancePtr& instance) {
  Recorder recorder;
  const auto gpus = physical_gpus(*instance);
  EXPECT_TRUE(gpus);
  if (!gpus) return recorder;
  const auto gpu = open_gpu(instance, gpus->front());
  EXPECT_TRUE(gpu);
  if (!gpu) return recorder;
  recorder.gpu = *gpu;
  recorder.memory = std::make_shared<Memory>(*gpu);
  auto commands = Commands::make(*gpu, recorder.memory);
  EXPECT_TRUE(commands);
  if (commands) recorder.commands = std::move(*commands);
  return recorder;
}

}  // namespace umbrage::test
