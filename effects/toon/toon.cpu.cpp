// Compiles toon.kernel.h for the CPU.
#define UMBRAGE_KERNEL toon
#define UMBRAGE_KERNEL_TEXT "effects/toon/toon.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS ToonConstants
#include "effects/toon/toon.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/toon/toon.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
