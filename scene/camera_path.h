// Camera paths: key cameras in a file, and the smooth curve through them.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "core/result.h"
#include "scene/framing.h"

namespace umbrage {

/// A curve through key cameras, which passes each at its time.
class CameraPath {
 public:
  /// Reads a .csv file, whose first line names the columns, or a .json file, an array of objects. Names: time
  /// (seconds), position, focal_point, up, view_angle (degrees); in CSV position_x, _y, _z and so on. Only positions
  /// and focal points are required. Without times, the camera moves at an even pace, a second from key to key on
  /// average. Errors: kFile.
  static Result<CameraPath> read(const std::filesystem::path& file);

  /// Returns the time of the last key, in seconds after the first.
  double duration_s() const { return times_.back() - times_.front(); }
  /// Sets position, focal point, and what else the keys have, of the camera at a time after the first key. Before and
  /// after the keys, the camera stands still.
  void set_camera(double time_s, Framing& framing) const;

 private:
  static constexpr std::size_t kValues = 10;  // position, focal point, up, view angle
  using Key = std::array<double, kValues>;

  void set_even_times();
  /// Returns how fast a value changes at a key, per second.
  double speed(std::size_t key, std::size_t value) const;

  std::vector<double> times_;
  std::vector<Key> keys_;
  bool has_up_ = false, has_angle_ = false;
};

}  // namespace umbrage
