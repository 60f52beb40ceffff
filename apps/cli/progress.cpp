#include "apps/cli/progress.h"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>

namespace umbrage::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kShowDelay = 1s;          // delay before the line appears
constexpr auto kUpdateInterval = 200ms;  // interval between two updates of the line
// Min fraction of the work that must be done before the time left is estimated.
constexpr double kMinFractionForEstimate = 0.01;
constexpr std::size_t kDefaultWidth = 80;

// For the signal handler: whether the line is on the terminal, and whether it may no longer be drawn.
std::atomic<bool> on_screen = false, disabled = false;
static_assert(std::atomic<bool>::is_always_lock_free);

std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : kDefaultWidth;
}

}  // namespace

std::string duration_text(double seconds) {
  const long whole = std::lround(std::max(seconds, 0.0));
  const long minutes = whole / 60 % 60, hours = whole / 3600;
  return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                   : fmt::format("{}:{:02}", minutes, whole % 60);
}

ProgressLine::ProgressLine() : on_terminal_(::isatty(STDERR_FILENO) != 0) {
  if (!on_terminal_) return;
  // Block all signals in the new thread, so that other threads handle them.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  ticker_ = std::thread([this] { tick(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

ProgressLine::~ProgressLine() {
  wipe();
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (ticker_.joinable()) ticker_.join();
}

void ProgressLine::tick() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kUpdateInterval, [this] { return stop_; }))
    if (visible_ && Clock::now() - start_time_ >= kShowDelay) draw();
}

void ProgressLine::draw() {
  // Leave the last column free, since some terminals move to the next line when it is written.
  const std::string line = text(Clock::now(), terminal_width() - 1);
  if (disabled) return;
  on_screen = true;
  fmt::print(stderr, "\r{:<{}}", line, std::max(width_, line.size()));
  std::fflush(stderr);
  width_ = std::max(width_, line.size());
}

std::string ProgressLine::text(Clock::time_point now, std::size_t room) const {
  std::string numbers;
  if (fraction_) {
    numbers = fmt::format(": {:.0f} %", std::floor(100.0 * *fraction_));
    const double done_since_first = *fraction_ - first_fraction_;
    const double elapsed = std::chrono::duration<double>(last_report_time_ - first_report_time_).count();
    const double since = std::chrono::duration<double>(now - last_report_time_).count();
    if (done_since_first >= kMinFractionForEstimate && elapsed > 0.0)
      numbers += fmt::format(", {} left", duration_text(elapsed * (1.0 - *fraction_) / done_since_first - since));
  } else {
    numbers = fmt::format(" ({})", duration_text(std::chrono::duration<double>(now - start_time_).count()));
  }
  if (numbers.size() >= room) return numbers.substr(0, room);
  constexpr std::string_view kCut = "..";
  std::string what = activity_;
  if (const std::size_t left = room - numbers.size(); what.size() > left)
    what = left > kCut.size() ? what.substr(0, left - kCut.size()).append(kCut) : "";
  return what + numbers;
}

void ProgressLine::show(std::string what, std::optional<double> fraction) {
  if (!on_terminal_) return;
  const std::lock_guard lock(mutex_);
  if (fraction && !fraction_) {
    first_fraction_ = *fraction;
    first_report_time_ = Clock::now();
  }
  activity_ = std::move(what);
  fraction_ = fraction;
  last_report_time_ = Clock::now();
  visible_ = true;
}

void ProgressLine::wipe() {
  if (!on_terminal_) return;
  const std::lock_guard lock(mutex_);
  visible_ = false;
  if (width_ > 0 && !disabled) {
    fmt::print(stderr, "\r{:{}}\r", "", width_);
    std::fflush(stderr);
  }
  width_ = 0;
  on_screen = false;
}

void wipe_progress() {
  disabled = true;
  constexpr char kClearLine[] = "\r\033[K";
  if (on_screen && ::write(STDERR_FILENO, kClearLine, sizeof kClearLine - 1) < 0) on_screen = false;
}

}  // namespace umbrage::cli
