// Compiles outline_color.kernel.h for the CPU.
#define UMBRAGE_KERNEL outline_color
#define UMBRAGE_KERNEL_TEXT "effects/outline/outline_color.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutlineConstants
#include "effects/outline/outline.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/outline/outline_color.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
