// Compiles bitmask_bent.kernel.h for the CPU.
#define UMBRAGE_KERNEL bitmask_bent
#define UMBRAGE_KERNEL_TEXT "effects/bitmask/bitmask_bent.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS BitmaskConstants
#include "effects/bitmask/bitmask.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/bitmask/bitmask_bent.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
