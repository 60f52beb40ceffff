// Compiles hatching_tone.kernel.h for the CPU.
#define UMBRAGE_KERNEL hatching_tone
#define UMBRAGE_KERNEL_TEXT "effects/hatching/hatching_tone.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS HatchingConstants
#include "effects/hatching/hatching.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/hatching/hatching_tone.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
