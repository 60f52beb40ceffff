// Names the kernel text outline_drop.kernel.h for the CPU.
#define UMBRAGE_KERNEL outline_drop
#define UMBRAGE_KERNEL_TEXT "effects/outline/outline_drop.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS OutlineConstants
#define UMBRAGE_KERNEL_VIEW PackedView
#include "effects/outline/outline.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/outline/outline_drop.cpu.cpp"
#include "hwy/foreach_target.h"
#include "machine/cpu_kernel.h"
