// Signal handling: an interrupted program leaves no temporary or partial files.
#pragma once
#include <sys/types.h>
#include <csignal>

namespace umbrage::cli {

/// Ignores SIGXFSZ, and installs handlers for SIGINT, SIGTERM and SIGHUP, except those that the parent process ignores.
/// A handler removes temporary files, ends the child process, prints one line and exits with 128 + the signal's number.
/// Call it on the main thread before other threads start.
void end_on_signals();

/// Returns the signals of end_on_signals.
sigset_t ending_signals();

/// Blocks the signals of end_on_signals during its lifetime. For the main thread only.
class BlockSignals {
 public:
  BlockSignals();
  ~BlockSignals();
  BlockSignals(const BlockSignals&) = delete;

 private:
  sigset_t before_;
};

/// Sets the child process that the handlers end; 0: none. Call it while these signals are blocked.
void set_child(pid_t child);

}  // namespace umbrage::cli
