// Compiles gooch.kernel.h for the CPU.
#define UMBRAGE_KERNEL gooch
#define UMBRAGE_KERNEL_TEXT "effects/gooch/gooch.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS GoochConstants
#include "effects/gooch/gooch.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/gooch/gooch.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
