// The CPU device: captures with Embree and runs kernels in SIMD lanes, on tiles in parallel with oneTBB.
#pragma once
#include <memory>

#include "core/device.h"

namespace umbrage {

struct CpuSettings {
  int threads = 0;      ///< 0, or more than the process may use: all that it may use
  bool scalar = false;  ///< run kernels as plain C++ instead of lanes; the reference for tests
  bool tuned = true;    ///< run the tuned kernel of a dispatch if it has one
};

/// Creates a CPU device. Cannot fail.
std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings = {});

}  // namespace umbrage
