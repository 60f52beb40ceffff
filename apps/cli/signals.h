// What happens when somebody ends the program: nothing half done stays behind.
#pragma once
#include <sys/types.h>
#include <csignal>

namespace umbrage::cli {

/// Ends the program on SIGINT, SIGTERM and SIGHUP, unless who started it wants these ignored: removes temporary files,
/// ends child processes, says one line, exits with 128 and the signal's number. For the main thread, before any other.
void end_on_signals();

/// Holds those signals back for as long as it lives. For the main thread.
class SignalsHeld {
 public:
  SignalsHeld();
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

/// The child process that a signal is to end, too; 0: none. Set it while signals are held.
void set_child(pid_t child);

}  // namespace umbrage::cli
