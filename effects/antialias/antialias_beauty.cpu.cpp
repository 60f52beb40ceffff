// Compiles antialias_beauty.kernel.h for the CPU.
#define UMBRAGE_KERNEL antialias_beauty
#define UMBRAGE_KERNEL_TEXT "effects/antialias/antialias_beauty.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS AntialiasConstants
#include "effects/antialias/antialias.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/antialias/antialias_beauty.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
