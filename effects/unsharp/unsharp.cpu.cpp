// Compiles unsharp.kernel.h for the CPU.
#define UMBRAGE_KERNEL unsharp
#define UMBRAGE_KERNEL_TEXT "effects/unsharp/unsharp.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS UnsharpConstants
#include "effects/unsharp/unsharp.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/unsharp/unsharp.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
