// The planes of frames, on every device: the values of missing ones, and branches of a frame, which share planes: a
// frame must not be written while a branch of it lives.
#pragma once
#include <memory>
#include <optional>
#include <string_view>

#include "core/check.h"

namespace umbrage {

/// Returns the value that replaces a plane that a G-buffer lacks, or nullopt if the plane is required.
std::optional<float> neutral_value(std::string_view plane);

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
