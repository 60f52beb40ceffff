// Compiles upsample_light.kernel.h for the CPU.
#define UMBRAGE_KERNEL upsample_light
#define UMBRAGE_KERNEL_TEXT "effects/upsample/upsample_light.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS UpsampleConstants
#include "effects/upsample/upsample.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/upsample/upsample_light.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
