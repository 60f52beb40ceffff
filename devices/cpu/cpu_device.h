// The CPU as a device: Embree captures, kernels run as SIMD lanes over oneTBB tiles.
#pragma once
#include <memory>

#include "core/device.h"

namespace umbrage {

struct CpuSettings {
  int threads = 0;      ///< 0: as many as the process may run at once; never more than that
  bool scalar = false;  ///< run kernels as plain C++ instead of lanes; the oracle of tests
  bool tuned = true;    ///< run a pass's tuned kernel where it has one
};

/// Always there.
std::unique_ptr<Device> make_cpu_device(const CpuSettings& settings = {});

}  // namespace umbrage
