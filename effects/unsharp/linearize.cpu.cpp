// Compiles linearize.kernel.h for the CPU.
#define UMBRAGE_KERNEL linearize
#define UMBRAGE_KERNEL_TEXT "effects/unsharp/linearize.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS UnsharpConstants
#include "effects/unsharp/unsharp.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/unsharp/linearize.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
