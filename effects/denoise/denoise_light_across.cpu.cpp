// Compiles denoise_light_across.kernel.h for the CPU.
#define UMBRAGE_KERNEL denoise_light_across
#define UMBRAGE_KERNEL_TEXT "effects/denoise/denoise_light_across.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS DenoiseConstants
#include "effects/denoise/denoise.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/denoise/denoise_light_across.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
