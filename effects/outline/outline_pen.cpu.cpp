// Names the kernel text outline_pen.kernel.h for the CPU.
#define UMBRAGE_KERNEL outline_pen
#define UMBRAGE_KERNEL_TEXT "effects/outline/outline_pen.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutlineConstants
#define UMBRAGE_KERNEL_VIEW PackedView
#include "effects/outline/outline.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/outline/outline_pen.cpu.cpp"
#include "hwy/foreach_target.h"
#include "machine/cpu_kernel.h"
