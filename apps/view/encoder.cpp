#include "apps/view/encoder.h"

#include "core/guarded.h"
#include "io/image_file.h"
#include "renderer/times.h"

namespace umbrage::view {

Result<Encoded> encode(const Image& picture, bool exact) {
  const bool is_png = exact || picture.find("color.a");
  auto bytes = is_png ? encode_png("the picture", picture) : encode_fast_jpeg("the picture", picture, kMovingQuality);
  if (!bytes) return bytes.error();
  return Encoded{std::move(*bytes), is_png ? "image/png" : "image/jpeg"};
}

Encoder::Encoder() : thread_([this] { run(); }) {}

Encoder::~Encoder() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Encoder::add(EncodeJob job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !next_; });
  next_ = std::move(job);
  changed_.notify_all();
}

void Encoder::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return next_ || stopping_; });
    if (stopping_) return;
    EncodeJob job = std::move(*next_);
    next_.reset();
    changed_.notify_all();
    lock.unlock();
    if (!job.is_wanted || job.is_wanted()) {
      StageTimes times;
      const auto purpose = [] { return std::string("the picture"); };
      auto encoded = guarded(purpose, [&] { return encode(job.picture, job.exact); });
      times.done("encode");
      const auto sent = guarded(purpose, [&] { return job.done(std::move(encoded), times.total()), Result<void>(); });
      static_cast<void>(sent);  // a frame is lost for lack of memory
    }
    job = {};
    lock.lock();
  }
}

}  // namespace umbrage::view
