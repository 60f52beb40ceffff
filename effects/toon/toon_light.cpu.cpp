// Compiles toon_light.kernel.h for the CPU.
#define UMBRAGE_KERNEL toon_light
#define UMBRAGE_KERNEL_TEXT "effects/toon/toon_light.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS ToonConstants
#include "effects/toon/toon.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/toon/toon_light.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
