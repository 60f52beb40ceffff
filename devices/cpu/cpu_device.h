// The CPU device: Embree captures, kernels run as SIMD lanes on oneTBB tiles.
#pragma once
#include <memory>

#include "core/device.h"

namespace umbrage {

struct CpuSettings {
  int threads = 0;      ///< 0: all that the process may use; larger numbers are reduced to that
  bool scalar = false;  ///< run kernels as plain C++ instead of lanes; the reference for tests
  bool tuned = true;    ///< run the tuned kernel of a pass if it has one
};

/// Creates a CPU device. Cannot fail.
std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings = {});

}  // namespace umbrage
