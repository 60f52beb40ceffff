// Steady sequences: the occlusion, indirect light and soft shadows of a frame are joined with those of the frames
// before and after it, along surfaces (effects/steady). A frame depends on the frames of its window alone, so any frame
// can be drawn by itself, with the same bytes. Shadows are joined with the frames in which the lights are in the same
// place.
//
// If the technique has a filter, most frames are joined before it, by their numbers of samples, and the nearest ones
// once more after it: this has less error than joining after the filter, and less flicker than joining before it. Where
// the scene moves, all frames are joined after the filter, since single samples do not tell whether occlusion changed.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "renderer/draw.h"

namespace umbrage {

/// The frames of a sequence, and how each is drawn by itself.
struct SteadyFrames {
  Recipe recipe;  ///< of all frames
  /// Draws a frame as umbrage::draw_technique.
  std::function<Result<Frame>(int frame, StageTimes& times, const ProgressMonitor& monitor)> draw_technique;
  /// Draws the rest from a branch of that frame, as umbrage::draw_after_technique.
  std::function<Result<Drawn>(int frame, const Frame& technique, StageTimes& times, const ProgressMonitor& monitor,
                              std::optional<float> stops, const Continuation& more)>
      draw_rest;
  /// Adds the planes `there` of effects/steady to a branch of a frame: where its surface points are in frame `other`.
  /// Empty: the cameras of both tell it, since nothing else moves.
  std::function<Result<void>(int frame, int other, Frame& branch)> add_there = {};
  std::function<void(int frame)> release = {};  ///< called when a drawn frame is not needed any more
  int reach = 3;                                ///< number of frames before and after a frame that it is joined with
  int count = 1;                                ///< number of frames, from 0
  bool is_closed = false;                       ///< the last frame is followed by the first one
  bool only_past = false;                       ///< frames are not joined with later ones
};

/// Returns whether frames of a recipe can be joined: its technique has noise, which is not averaged with the samples of
/// a picture.
bool can_be_steady(const Recipe& recipe);

/// Returns the frames of a still scene. `plan` returns the plan of a frame, of which all have one recipe. Device and
/// scene must outlive the functions.
SteadyFrames frames_of_still_scene(Device& device, const Scene& scene, std::function<Plan(int frame)> plan);

/// Returns about how many bytes the frames of a window take, besides the picture that is drawn.
double steady_memory(const Plan& plan, int reach);

/// Draws the frames of a sequence. Keeps the frames of one window, so frames in ascending order are drawn once.
class SteadySequence {
 public:
  /// The device must outlive this object.
  SteadySequence(Device& device, SteadyFrames frames);

  /// Draws a frame; else as umbrage::draw.
  Result<Drawn> draw(int frame, StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops,
                     const Continuation& more);

 private:
  struct Neighbour {
    Frame frame;                         ///< of draw_technique
    std::optional<Frame> filtered = {};  ///< a branch: joined, and filtered
    bool is_finished = false;            ///< both have only the planes that others read
  };
  using Others = std::vector<std::pair<int, const Frame*>>;

  /// Returns how many frames `other` comes after `frame`: in a closed sequence 0 to count - 1, else also below 0.
  int frames_after(int frame, int other) const;
  /// Returns the frames at most `reach` frames before and after a frame, without itself, from the nearest on.
  std::vector<int> neighbours(int frame, int reach) const;
  /// Releases frames that are outside the window of `frame`.
  void release_frames(int frame);
  /// Releases the planes that no other frame reads of a frame that is drawn, or will not be.
  Result<void> finish(Neighbour& drawn);
  /// Returns whether `other` is `frame` or comes next: it is probably drawn after it.
  bool is_ahead(int other, int frame) const;
  /// Draws the technique of the frames of a window that are not there.
  Result<void> draw_lacking(int frame, StageTimes& times, const ProgressMonitor& monitor);
  /// Filters a frame's technique, joined with the frames around it, if that is not done.
  Result<void> filter(int frame, const ProgressMonitor& monitor);
  /// Returns a branch of a frame, joined with others. `by_samples`: weights are numbers of samples, otherwise equal.
  Result<Frame> joined(int frame, const Frame& own, const Others& others, bool by_samples,
                       const ProgressMonitor& monitor);
  /// Replaces the shadows of a branch of a frame by those joined with the frames of its window.
  Result<void> join_shadows(int frame, Frame& branch, const ProgressMonitor& monitor);

  Device& device_;
  const SteadyFrames frames_;
  const Effect* const technique_;  ///< filtered_technique
  const int after_, before_;       ///< reach of the join after the filter, and of the one before it
  std::map<int, Neighbour> drawn_;
};

}  // namespace umbrage
