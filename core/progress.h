// ProgressMonitor: who asked for long work hears how far it is, and may end it.
#pragma once
#include <functional>

#include "core/result.h"

namespace umbrage {

/// Told now and then, by the thread that asked for the work and by no other, the share of it that is done, from 0 to 1.
/// Returns whether to go on: after false the work ends with `interrupted`. Null: nobody listens.
using ProgressMonitor = std::function<bool(double done)>;

inline Error interrupted() { return {ErrorKind::kInterrupted, "interrupted"}; }

}  // namespace umbrage
