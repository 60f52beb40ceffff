// Compiles output_parts.kernel.h for the CPU.
#define UMBRAGE_KERNEL output_parts
#define UMBRAGE_KERNEL_TEXT "effects/output/output_parts.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutputConstants
#include "effects/output/output.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/output/output_parts.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
