#include "apps/view/outbox.h"

#include <gtest/gtest.h>

#include <vector>

namespace umbrage::view {
namespace {

using namespace std::chrono_literals;

/// A wire that lets through one message after the other, as a test wishes.
struct TestWire {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> sent;
  bool open = false, ended = false, finished = false, writing = false;

  Outbox::Wire wire() {
    return {[this](Outbox::Kind kind, std::string_view bytes) {
              std::unique_lock lock(mutex);
              writing = true;
              changed.notify_all();
              changed.wait(lock, [this] { return open || ended; });
              if (open) sent.push_back(kind == Outbox::Kind::kClose ? "close" : std::string(bytes));
              return open;
            },
            [this](bool all_sent) {
              const std::lock_guard lock(mutex);
              ended = true;
              finished = all_sent;
              changed.notify_all();
            }};
  }
  void wait_for_write() {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, 10s, [this] { return writing; });
  }
  void let_through() {
    const std::lock_guard lock(mutex);
    open = true;
    changed.notify_all();
  }
};

TEST(ViewOutbox, KeepsTextsAndTheNewestFrameOfEachView) {
  TestWire wire;
  Outbox outbox(wire.wire());
  outbox.add_text("first");
  wire.wait_for_write();
  outbox.add_frame(0, "frame 1");
  outbox.add_frame(1, "frame 2");
  outbox.add_text("second");
  outbox.add_frame(0, "frame 3");
  wire.let_through();
  for (int i = 0; i < 500; ++i) {
    std::this_thread::sleep_for(10ms);
    const std::lock_guard lock(wire.mutex);
    if (wire.sent.size() == 4) break;
  }
  outbox.finish();
  outbox.add_text("too late");
  EXPECT_TRUE(outbox.wait_until_ended(10s));
  EXPECT_EQ(wire.sent, (std::vector<std::string>{"first", "frame 2", "second", "frame 3", "close"}));
  EXPECT_TRUE(wire.finished);
}

TEST(ViewOutbox, EndsWhenTooManyTextsWait) {
  TestWire wire;
  Outbox outbox(wire.wire());
  const std::string text(kMaxWaitingTextBytes / 4, 'x');
  for (int i = 0; i < 4; ++i) outbox.add_text(text);
  EXPECT_FALSE(outbox.wait_until_ended(0ms));
  outbox.add_text("x");
  EXPECT_TRUE(outbox.wait_until_ended(10s));
  EXPECT_FALSE(wire.finished);
}

}  // namespace
}  // namespace umbrage::view
