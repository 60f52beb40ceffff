// One line of progress on a terminal: what is done, how much of it, the time that is left.
#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace umbrage::cli {

/// The line, on standard error. It appears a second after it was made, and is wiped at the end; where standard error is
/// no terminal there is nothing. Where the terminal is narrow, what is done is cut short.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  /// What is done now and, where it is known, the share of the whole work that is done, 0 to 1. From any thread.
  void show(std::string what, std::optional<double> share = std::nullopt);
  /// Clears the line, before anything else is printed. It comes back with the next show.
  void wipe();

 private:
  using Clock = std::chrono::steady_clock;
  void tick();
  void draw();
  std::string text(Clock::time_point now, std::size_t room) const;

  bool on_terminal_;
  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  bool ends_ = false, wanted_ = false;
  std::string what_;
  std::optional<double> share_;
  double first_share_ = 0.0;  // when somebody told one for the first time
  Clock::time_point made_ = Clock::now(), first_told_, told_;
  std::size_t width_ = 0;  // of what is on the terminal
  std::thread ticker_;
};

/// "1:05", "2:00:00".
std::string duration_text(double seconds);

/// Wipes the line for good. For signal handlers.
void drop_progress();

}  // namespace umbrage::cli
