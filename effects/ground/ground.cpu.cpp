// Compiles ground.kernel.h for the CPU.
#define UMBRAGE_KERNEL ground
#define UMBRAGE_KERNEL_TEXT "effects/ground/ground.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS GroundConstants
#include "effects/ground/ground.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/ground/ground.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
