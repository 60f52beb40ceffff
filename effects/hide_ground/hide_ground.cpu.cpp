// Compiles hide_ground.kernel.h for the CPU.
#define UMBRAGE_KERNEL hide_ground
#define UMBRAGE_KERNEL_TEXT "effects/hide_ground/hide_ground.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS HideGroundConstants
#include "effects/hide_ground/hide_ground.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/hide_ground/hide_ground.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
