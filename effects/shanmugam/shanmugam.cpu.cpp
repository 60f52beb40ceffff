// Compiles shanmugam.kernel.h for the CPU.
#define UMBRAGE_KERNEL shanmugam
#define UMBRAGE_KERNEL_TEXT "effects/shanmugam/shanmugam.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS ShanmugamConstants
#include "effects/shanmugam/shanmugam.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/shanmugam/shanmugam.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
