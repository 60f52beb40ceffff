// Compiles lighting_open.kernel.h for the CPU.
#define UMBRAGE_KERNEL lighting_open
#define UMBRAGE_KERNEL_TEXT "effects/lighting/lighting_open.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS LightingConstants
#include "effects/lighting/lighting.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/lighting/lighting_open.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
