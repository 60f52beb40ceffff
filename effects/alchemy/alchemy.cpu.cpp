// Compiles alchemy.kernel.h for the CPU.
#define UMBRAGE_KERNEL alchemy
#define UMBRAGE_KERNEL_TEXT "effects/alchemy/alchemy.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS AlchemyConstants
#include "effects/alchemy/alchemy.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/alchemy/alchemy.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
