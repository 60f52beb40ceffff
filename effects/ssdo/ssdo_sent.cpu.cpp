// Compiles ssdo_sent.kernel.h for the CPU.
#define UMBRAGE_KERNEL ssdo_sent
#define UMBRAGE_KERNEL_TEXT "effects/ssdo/ssdo_sent.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS SsdoConstants
#include "effects/ssdo/ssdo.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/ssdo/ssdo_sent.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
