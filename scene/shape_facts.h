// Facts of a scene's shape that take a pass over all its triangles: each is found once, not once per picture.
#pragma once
#include <glm/vec3.hpp>
#include <mutex>
#include <optional>
#include <vector>

namespace umbrage {

/// A fact that depends on an up direction. Keeps that of the last one.
template <class Fact>
class KeptFact {
 public:
  /// Returns the fact for `up`, from find() if it is not known. Several threads may call this: one of them finds it.
  template <class Find>
  Fact of(const glm::vec3& up, const Find& find) {
    const std::lock_guard lock(mutex_);
    if (!fact_ || up_ != up) fact_ = find(), up_ = up, ++found_;
    return *fact_;
  }
  /// Returns how often the fact was found.
  int found() const { return found_; }

 private:
  std::mutex mutex_;
  std::optional<Fact> fact_;
  glm::vec3 up_{0.0f};
  int found_ = 0;
};

struct ShapeFacts {
  KeptFact<glm::vec3> front;            ///< of scene/front.h
  KeptFact<std::vector<float>> relief;  ///< of scene/ground.h
};

}  // namespace umbrage
