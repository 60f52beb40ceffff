// A progress line on a terminal: the activity, the percentage done and the time left.
#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace umbrage::cli {

/// The progress line, on standard error. It appears one second after construction; the destructor wipes it. If standard
/// error is not a terminal, nothing is printed. The activity is shortened to the width of the terminal.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  /// Sets the activity and, if known, the fraction of the whole work that is done, 0 to 1. May be called from any
  /// thread.
  void show(std::string what, std::optional<double> fraction = std::nullopt);
  /// Clears the line, before other output is printed. The next `show` brings it back.
  void wipe();

 private:
  using Clock = std::chrono::steady_clock;
  void tick();
  void draw();
  std::string text(Clock::time_point now, std::size_t room) const;

  bool on_terminal_;
  std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  bool stop_ = false, visible_ = false;
  std::string activity_;
  std::optional<double> fraction_;
  double first_fraction_ = 0.0;  // the first reported fraction
  Clock::time_point start_time_ = Clock::now(), first_report_time_, last_report_time_;
  std::size_t width_ = 0;  // width of the text on the terminal
  std::thread ticker_;
};

/// Formats a duration in seconds: "1:05", "2:00:00".
std::string duration_text(double seconds);

/// Wipes the line; nothing is drawn afterwards. Async-signal-safe.
void wipe_progress();

}  // namespace umbrage::cli
