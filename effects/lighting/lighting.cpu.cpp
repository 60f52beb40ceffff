// Compiles lighting.kernel.h for the CPU.
#define UMBRAGE_KERNEL lighting
#define UMBRAGE_KERNEL_TEXT "effects/lighting/lighting.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS LightingConstants
#include "effects/lighting/lighting.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/lighting/lighting.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
