// Compiles soften.kernel.h for the CPU.
#define UMBRAGE_KERNEL soften
#define UMBRAGE_KERNEL_TEXT "devices/shared/soften.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS SoftenConstants
#include "devices/shared/soften.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "devices/shared/soften.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
