#include "apps/view/outbox.h"

#include <algorithm>

namespace umbrage::view {

Outbox::Outbox(Wire wire) : wire_(std::move(wire)), sender_([this] { send(); }) {}

Outbox::~Outbox() {
  {
    std::unique_lock lock(mutex_);
    end(lock, false);
  }
  sender_.join();
}

void Outbox::end(std::unique_lock<std::mutex>& lock, bool finished) {
  if (std::exchange(ended_, true)) return;
  items_.clear();
  lock.unlock();
  wire_.end(finished);
  lock.lock();
  changed_.notify_all();
}

void Outbox::add_text(std::string text) {
  std::unique_lock lock(mutex_);
  if (finishing_ || ended_) return;
  text_bytes_ += text.size();
  if (text_bytes_ > kMaxWaitingTextBytes) return end(lock, false);
  items_.push_back({Kind::kText, 0, std::move(text)});
  changed_.notify_all();
}

void Outbox::replace(Kind kind, int view, std::string bytes) {
  const std::lock_guard lock(mutex_);
  if (finishing_ || ended_) return;
  std::erase_if(items_, [&](const Item& item) { return item.kind == kind && item.view == view; });
  items_.push_back({kind, view, std::move(bytes)});
  changed_.notify_all();
}

void Outbox::finish(std::string bytes) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(finishing_, true) || ended_) return;
  std::erase_if(items_, [](const Item& item) { return item.kind == Kind::kFrame; });
  items_.push_back({Kind::kClose, 0, std::move(bytes)});
  changed_.notify_all();
}

bool Outbox::wait_until_ended(std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, limit, [this] { return ended_; });
}

void Outbox::send() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ended_ || !items_.empty(); });
    if (ended_) return;
    const Item item = std::move(items_.front());
    items_.pop_front();
    lock.unlock();
    const bool sent = wire_.write(item.kind, item.bytes);
    lock.lock();
    if (item.kind == Kind::kText) text_bytes_ -= item.bytes.size();
    if (!sent || item.kind == Kind::kClose) return end(lock, sent);
  }
}

}  // namespace umbrage::view
