// Compiles ssdo_occlusion.kernel.h for the CPU.
#define UMBRAGE_KERNEL ssdo_occlusion
#define UMBRAGE_KERNEL_TEXT "effects/ssdo/ssdo_occlusion.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS SsdoConstants
#include "effects/ssdo/ssdo.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/ssdo/ssdo_occlusion.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
