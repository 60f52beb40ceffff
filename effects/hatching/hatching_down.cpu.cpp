// Compiles hatching_down.kernel.h for the CPU.
#define UMBRAGE_KERNEL hatching_down
#define UMBRAGE_KERNEL_TEXT "effects/hatching/hatching_down.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS HatchingConstants
#include "effects/hatching/hatching.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/hatching/hatching_down.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
