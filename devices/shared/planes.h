// Branches of a frame, on every device, which share planes: a frame must not be written while a branch of it lives.
#pragma once
#include <memory>

#include "core/check.h"
#include "effects/effects.h"

namespace umbrage {

/// Tracks whether a frame has branches. The storage of each frame contains one; that of a branch is created by branch()
/// of the original's.
class Branches {
 public:
  Branches() = default;
  Branches branch() const { return Branches(own_); }
  bool any() const { return own_.use_count() > 1; }
  /// Throws InternalError if branches share the planes that are to be written.
  void check_none() const {
    if (any()) fail_check("a frame is written while a branch of it lives");
  }

 private:
  struct Link {
    std::shared_ptr<const Link> parent;  // shared by all branches of a frame
  };
  explicit Branches(std::shared_ptr<const Link> parent) : own_(std::make_shared<const Link>(Link{std::move(parent)})) {}
  std::shared_ptr<const Link> own_ = std::make_shared<const Link>();
};

}  // namespace umbrage
