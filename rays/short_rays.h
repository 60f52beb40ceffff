// Short rays: many incoherent rays from neighbouring points, each tested for any occluder within a distance. Made in
// arrays and traced eight at a time, which is faster than RayPacket for short rays in all directions.
#pragma once
#include <array>
#include <glm/vec3.hpp>

#include "rays/traced_scene.h"

namespace umbrage {

/// Rays in unit space. Their origins and directions must be within kRayLimit.
class ShortRays {
 public:
  static constexpr int kCapacity = 256;

  int size() const { return size_; }
  bool full() const { return size_ == kCapacity; }
  void clear() { size_ = 0; }

  /// Adds a ray. `id`: for the caller; not above 2^31 - 1.
  void add(glm::vec3 origin, glm::vec3 direction, int id) {
    const std::size_t k = std::size_t(size_++);
    for (int axis = 0; axis < 3; ++axis) {
      origins_[std::size_t(axis)][k] = origin[axis];
      directions_[std::size_t(axis)][k] = direction[axis];
    }
    ids_[k] = id;
  }

  /// Finds for each ray whether anything is closer than `length`.
  void find_blocked(const TracedScene& traced, float length);
  /// Finds the distance of the nearest hit of each ray closer than `length`.
  void find_distances(const TracedScene& traced, float length);

  int id(int k) const { return ids_[std::size_t(k)]; }
  glm::vec3 origin(int k) const { return vector(origins_, k); }
  glm::vec3 direction(int k) const { return vector(directions_, k); }
  /// Valid after find_blocked.
  bool blocked(int k) const { return distances_[std::size_t(k)] < 0.0f; }
  /// Valid after find_distances: `length` if nothing was hit.
  float distance(int k) const { return distances_[std::size_t(k)]; }

 private:
  static constexpr int kWidth = 8;
  using Vectors = std::array<std::array<float, kCapacity>, 3>;

  static glm::vec3 vector(const Vectors& vectors, int k) {
    const auto n = std::size_t(k);
    return {vectors[0][n], vectors[1][n], vectors[2][n]};
  }
  template <class Rays>
  void load(int first, float length, Rays& rays, std::array<int, kWidth>& valid) const;

  int size_ = 0;
  Vectors origins_{}, directions_{};
  std::array<float, kCapacity> distances_{};
  std::array<int, kCapacity> ids_{};
};

}  // namespace umbrage
