// Compiles normals.kernel.h for the CPU.
#define UMBRAGE_KERNEL normals
#define UMBRAGE_KERNEL_TEXT "effects/normals/normals.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS NormalsConstants
#include "effects/normals/normals.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/normals/normals.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
