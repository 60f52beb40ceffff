// Compiles box_indirect_across.kernel.h for the CPU.
#define UMBRAGE_KERNEL box_indirect_across
#define UMBRAGE_KERNEL_TEXT "effects/box/box_indirect_across.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS BoxConstants
#include "effects/box/box.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/box/box_indirect_across.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
