// Compiles traced_joints.kernel.h for the CPU.
#define UMBRAGE_KERNEL traced_joints
#define UMBRAGE_KERNEL_TEXT "effects/traced/traced_joints.kernel.h"
#define UMBRAGE_KERNEL_CONSTANTS TracedConstants
#include "effects/traced/traced.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "effects/traced/traced_joints.cpu.cpp"
#include "hwy/foreach_target.h"
#include "kernel/cpu_kernel.h"
