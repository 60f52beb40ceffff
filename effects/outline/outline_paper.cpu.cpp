// Compiles outline_paper.kernel.h for the CPU.
#define UMBRAGE_KERNEL outline_paper
#define UMBRAGE_KERNEL_TEXT "effects/outline/outline_paper.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutlineConstants
#include "effects/outline/outline.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/outline/outline_paper.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
