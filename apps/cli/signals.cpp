#include "apps/cli/signals.h"

#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "apps/cli/progress.h"
#include "apps/cli/standard_input.h"
#include "io/image_file.h"

namespace umbrage::cli {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

pthread_t main_thread;
std::atomic<pid_t> child = 0;
static_assert(std::atomic<pid_t>::is_always_lock_free);

/// Handles a signal; calls async-signal-safe functions only. Other threads forward the signal to the main thread, which
/// writes the files.
void handle_signal(int signal) {
  if (!::pthread_equal(::pthread_self(), main_thread)) {
    ::pthread_kill(main_thread, signal);
    return;
  }
  wipe_progress();
  constexpr char kLine[] = "umbrage: interrupted\n";
  const bool reported = ::write(STDERR_FILENO, kLine, sizeof kLine - 1) > 0;
  static_cast<void>(reported);
  // Wait until the child has ended before its file is removed; otherwise it could create the file again.
  if (const pid_t pid = child; pid > 0) {
    ::kill(pid, SIGKILL);
    int status = 0;
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
  }
  abandon_writes();
  remove_standard_input_copy();
  constexpr int kExitBySignal = 128;
  std::_Exit(kExitBySignal + signal);
}

}  // namespace

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kSignals) sigaddset(&set, signal);
  return set;
}

void end_on_signals() {
  main_thread = ::pthread_self();
  for (const int signal : kSignals) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = handle_signal;
    action.sa_mask = ending_signals();
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
  ::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of file sizes (ulimit -f) fails with EFBIG instead
}

BlockSignals::BlockSignals() {
  const sigset_t ours = ending_signals();
  ::pthread_sigmask(SIG_BLOCK, &ours, &before_);
}

BlockSignals::~BlockSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

void set_child(pid_t process) { child = process; }

}  // namespace umbrage::cli
