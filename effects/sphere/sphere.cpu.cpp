// Compiles sphere.kernel.h for the CPU.
#define UMBRAGE_KERNEL sphere
#define UMBRAGE_KERNEL_TEXT "effects/sphere/sphere.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS SphereConstants
#include "effects/sphere/sphere.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/sphere/sphere.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
