// Compiles hemisphere_sent.kernel.h for the CPU.
#define UMBRAGE_KERNEL hemisphere_sent
#define UMBRAGE_KERNEL_TEXT "effects/hemisphere/hemisphere_sent.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS HemisphereConstants
#include "effects/hemisphere/hemisphere.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/hemisphere/hemisphere_sent.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
