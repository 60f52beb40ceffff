// Compiles hbao.kernel.h for the CPU.
#define UMBRAGE_KERNEL hbao
#define UMBRAGE_KERNEL_TEXT "effects/hbao/hbao.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS HbaoConstants
#include "effects/hbao/hbao.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/hbao/hbao.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
