// What waits to be sent to one page, and the thread that sends it, so that a slow page delays no other.
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

namespace umbrage::view {

/// The max bytes of texts that wait for a page. A page that falls so far behind is closed.
inline constexpr std::size_t kMaxWaitingTextBytes = std::size_t(8) << 20;

class Outbox {
 public:
  enum class Kind { kText, kFrame, kPing, kPong, kClose };
  /// The way to the page; called by the outbox's own thread. `write` may block; it returns false if the page is lost.
  /// `end` ends the connection, once: `finished` after all was sent, otherwise because the page is lost or too slow. If
  /// it is too slow, another thread calls `end` while `write` blocks, which must then return.
  struct Wire {
    std::function<bool(Kind, std::string_view)> write;
    std::function<void(bool finished)> end;
  };

  explicit Outbox(Wire wire);
  /// Ends the connection if it has not ended.
  ~Outbox();
  Outbox(const Outbox&) = delete;

  // These never block. After the end they do nothing.

  /// Texts are sent in order and not dropped.
  void add_text(std::string text);
  /// A frame replaces an unsent one of the same view; it comes after all that waits.
  void add_frame(int view, std::string bytes) { replace(Kind::kFrame, view, std::move(bytes)); }
  /// A ping or a pong replaces an unsent one.
  void add_control(Kind kind, std::string bytes) { replace(kind, 0, std::move(bytes)); }
  /// Drops waiting frames, sends the waiting texts and a close message of these bytes, and ends the connection.
  void finish(std::string bytes = {});

  /// Waits until the connection has ended. Returns false after `limit`.
  bool wait_until_ended(std::chrono::milliseconds limit);

 private:
  struct Item {
    Kind kind;
    int view;
    std::string bytes;
  };
  void send();
  void replace(Kind kind, int view, std::string bytes);
  void end(std::unique_lock<std::mutex>& lock, bool finished);

  Wire wire_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::size_t text_bytes_ = 0;
  bool finishing_ = false, ended_ = false;
  std::thread sender_;  // last, so that it starts when all else exists
};

}  // namespace umbrage::view
