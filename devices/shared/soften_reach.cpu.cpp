// Compiles soften_reach.kernel.h for the CPU.
#define UMBRAGE_KERNEL soften_reach
#define UMBRAGE_KERNEL_TEXT "devices/shared/soften_reach.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS SoftenConstants
#include "devices/shared/soften.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "devices/shared/soften_reach.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
