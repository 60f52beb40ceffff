// Compiles relight.kernel.h for the CPU.
#define UMBRAGE_KERNEL relight
#define UMBRAGE_KERNEL_TEXT "effects/relight/relight.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS RelightConstants
#include "effects/relight/relight.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/relight/relight.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
