// Compiles composite_parts.kernel.h for the CPU.
#define UMBRAGE_KERNEL composite_parts
#define UMBRAGE_KERNEL_TEXT "effects/composite/composite_parts.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS CompositeConstants
#include "effects/composite/composite.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/composite/composite_parts.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
