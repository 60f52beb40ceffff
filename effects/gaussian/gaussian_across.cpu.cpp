// Compiles gaussian_across.kernel.h for the CPU.
#define UMBRAGE_KERNEL gaussian_across
#define UMBRAGE_KERNEL_TEXT "effects/gaussian/gaussian_across.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS GaussianConstants
#include "effects/gaussian/gaussian.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/gaussian/gaussian_across.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
