// Compiles output.kernel.h for the CPU.
#define UMBRAGE_KERNEL output
#define UMBRAGE_KERNEL_TEXT "effects/output/output.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutputConstants
#include "effects/output/output.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/output/output.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
