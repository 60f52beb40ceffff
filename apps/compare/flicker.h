// Flicker: how much the frames of a sequence change on surfaces that both of two frames show, beside the change of
// ray-traced truth. `umbrage compare --sequence` draws the sequences (sequences.cpp) and measures them.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <glm/mat4x4.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "apps/compare/compare.h"
#include "core/device.h"

namespace umbrage {

inline constexpr int kFarFrames = 3;  ///< frames from a frame to the farther one with which it is compared

/// The surfaces that a frame shows, and where they are.
struct FrameSurfaces {
  GBuffer gbuffer;              ///< planes depth, normal.x .y .z, object_id, without a guard band
  int moving_object = -1;       ///< object id of the object that moves; below 0: all objects stand still
  glm::dmat4 object_pose{1.0};  ///< its rigid motion from where the scene has it, world space
};

/// The exact motion from one frame to another: where the surface of each pixel of `to` is in `from`, by the cameras of
/// both and the motion of the object.
class Warp {
 public:
  Warp(const FrameSurfaces& from, const FrameSurfaces& to);
  /// The classes of the pixels of `to`; kBackground also where the surface is not seen in `from`: a pixel there counts
  /// if it shows the same object, has a similar normal, and both points are near each other's plane.
  const ClassMap& seen() const { return seen_; }
  /// Returns a plane of `from` at the pixels of `to`, interpolated between the pixels that count; 0 where unseen.
  Plane warped(const Plane& plane) const;

 private:
  struct Taps {
    int x = 0, y = 0;                 // of the upper left one of four pixels of `from`
    float weights[4] = {0, 0, 0, 0};  // left, right, those below; their sum is 1, or 0 where unseen
  };
  ClassMap seen_;
  std::vector<Taps> taps_;
};

/// The warps between the frames of a sequence, from each to the next one, and to that kFarFrames later.
struct Warps {
  std::vector<Warp> next, far;
  explicit Warps(const std::vector<FrameSurfaces>& frames);
};

/// The planes of one quantity, for each frame.
using SequencePlanes = std::vector<Image>;

/// What is measured of a sequence. Changes are the root mean square, over all planes and the pixels that both frames
/// show, of a frame warped to another minus that one.
struct Flicker {
  long pixels = 0;                                        ///< pixels that count, of all pairs of neighbouring frames
  double next = 0.0;                                      ///< change to the next frame
  double far = std::numeric_limits<double>::quiet_NaN();  ///< change to the frame kFarFrames later; NaN: too few frames
  double truth_next = 0.0, truth_far = far;               ///< the same of the truth
  double truth_noise = 0.0;  ///< what the noise of the truth alone may make of truth_next: its standard error
  double own = 0.0;          ///< difference between the change to the next frame and that of the truth
  double error = 0.0;        ///< difference of the frames from the truth
  double open_rms = 0.0;     ///< `next` over PixelClass::kOpen
  double open_p99 = 0.0;     ///< 99th percentile of the absolute changes there
  double flip = 0.0, truth_flip = 0.0;  ///< mean of FLIP between the warped frame and the next one

  /// Returns `next` as a fraction of that of the truth; NaN if the truth's is noise, or rounding.
  double ratio() const {
    return truth_next > std::max(truth_noise, 1e-6) ? next / truth_next : std::numeric_limits<double>::quiet_NaN();
  }
};

/// The numbers of Flicker, by their names in scores.json.
inline constexpr std::pair<const char*, double Flicker::*> kFlickerFields[] = {{"flicker", &Flicker::next},
                                                                               {"flicker3", &Flicker::far},
                                                                               {"truth_flicker", &Flicker::truth_next},
                                                                               {"truth_flicker3", &Flicker::truth_far},
                                                                               {"own_flicker", &Flicker::own},
                                                                               {"rmse", &Flicker::error},
                                                                               {"rms_open", &Flicker::open_rms},
                                                                               {"p99", &Flicker::open_p99},
                                                                               {"flip", &Flicker::flip},
                                                                               {"truth_flip", &Flicker::truth_flip},
                                                                               {"truth_noise", &Flicker::truth_noise}};

/// Measures frames. `truth`: two independent halves, whose noise cancels: squares are products of one half's value and
/// the other's. `shown` converts values to those that FLIP takes. `map`, if not null, receives the change to the next
/// frame of each pixel, root mean square over planes and frames.
Flicker measure_flicker(const Warps& warps, const SequencePlanes& frames, const std::array<SequencePlanes, 2>& truth,
                        const std::vector<FrameSurfaces>& surfaces, const std::function<float(float)>& shown,
                        Plane* map);

/// Settings of `umbrage compare --sequence`. `techniques`: empty: the technique of each look. `cameras`, `runs`,
/// `light`, `budget` and `filter` do not apply.
struct SequenceSettings : CompareSettings {
  std::vector<std::string> looks = {"ao", "studio"};
  std::vector<std::string> motions;  ///< names of motion_names(); empty: all
  int frames = kFarFrames + 1;       ///< frames that are measured
  int reach = 3;                     ///< frames before and after a frame with which it is joined
};

/// One row of the report: a plane of a sequence, drawn by one technique in one way.
struct FlickerRow {
  std::string scene, motion, look, technique, quantity;
  int reach = 0;  ///< SteadyFrames::reach; 0: frames are drawn singly
  std::string device, view;
  int width = 0, height = 0;
  Flicker flicker;
  Image strip, truth_strip;  ///< the frames side by side, reduced; display values. Empty without pictures.
  Image map;                 ///< of measure_flicker, one plane
  std::string setting() const { return fmt::format("look={} steady={}", look, reach); }
};

struct SequenceComparison {
  Terms terms;
  std::vector<FlickerRow> rows;
  std::vector<std::string> warnings;
};

/// Returns the names of the motions: of the model, the camera, an object, the light.
std::vector<std::string_view> motion_names();

/// Checks names and numbers of the settings before any work. Errors: kUsage.
Result<void> check_sequences(const SequenceSettings& settings);

/// Returns the terms of a comparison. The settings must have passed check_sequences.
Terms terms_of(const SequenceSettings& settings);

/// Draws short sequences of each scene in each look, singly and joined, and their truth: the same look with the
/// technique `reference` and no filter. Errors: as umbrage::compare.
Result<SequenceComparison> compare_sequences(Device& device, const SequenceSettings& settings);

}  // namespace umbrage
