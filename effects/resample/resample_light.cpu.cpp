// Compiles resample_light.kernel.h for the CPU.
#define UMBRAGE_KERNEL resample_light
#define UMBRAGE_KERNEL_TEXT "effects/resample/resample_light.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS ResampleConstants
#include "effects/resample/resample.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/resample/resample_light.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
