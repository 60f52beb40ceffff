// Shades the frames of a sequence of G-buffers, whose occlusion and indirect light are joined with those of the frames
// around: see steady.h. Where a surface is in another frame is known by motion vectors, or else, in still scenes, by
// the cameras. Frames after a cut, and those that cannot be read or have another size, are not joined.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "renderer/flow.h"
#include "renderer/shade_file.h"
#include "renderer/steady.h"

namespace umbrage {

/// The files of a sequence.
struct ShadedFrames {
  std::vector<int> numbers;  ///< of all frames that have files, ascending
  std::vector<int> shaded;   ///< those to shade: shading them reports what cannot be read
  /// Opens the files of a frame. `first`: as for GBufferFile::open.
  std::function<Result<GBufferFile>(int number, const Conventions* first)> open;
  std::function<void(const std::string& sentence)> warn;
  int reach = 3;  ///< number of frames before and after a frame that it is joined with
};

/// Returns about how many bytes the frames of a window take, besides the picture that is shaded.
double window_memory(const GBufferFile& file, int reach);

/// Keeps the frames of one window, so frames in ascending order are read once. Several threads may call `shade`.
/// Frames whose planes and cameras are equal, one after another, are one frame to all others, and have one picture.
class SteadyShading {
 public:
  /// The device must outlive this object.
  SteadyShading(Device& device, ShadedFrames frames) : device_(device), frames_(std::move(frames)) {}

  /// Begins with the frame that determines radius, exposure and conventions: finds out from this frame and those after
  /// it what their motion vectors mean. Returns what all frames take, still without exposure. Errors: kFile; kUsage.
  Result<SequenceStart> begin(int number, const GBufferFile& file);

  /// Shades a frame, whose files are open, and passes its rows to `take`, which may run beside the shading of another
  /// frame. Else as shade_file.
  Result<SequenceStart> shade(int number, const GBufferFile& file, const Recipe& recipe,
                              const std::vector<std::string>& planes, const TakeRows& take, std::optional<float> stops,
                              StageTimes& times, const ProgressMonitor& monitor);

 private:
  struct Loaded {
    GBuffer gbuffer;  ///< without layers after its technique was drawn
    FlowFrame flow;
  };
  /// Flow between two neighbouring frames.
  struct Link {
    Flow after, before;  ///< from the first to the second, and back
    bool by_camera = false;
  };

  /// Flow from a frame to one that may be farther.
  struct Way {
    int frame = 0;
    bool by_camera = false;
    Flow flow;
  };

  // Frames are known by their place in frames_.numbers.
  Result<std::shared_ptr<Loaded>> read(int at);
  /// Returns a frame, or null if it cannot be joined, which is warned of.
  std::shared_ptr<Loaded> loaded(int at);
  bool are_equal(int at, int other);
  /// Return the first and the last of the frames that are equal to this one, without a gap.
  int first_of(int at);
  int last_of(int at);
  /// Returns the next frame that differs, before or after; -1 if there is none to be joined with.
  int beside(int at, bool after);
  /// Returns the flow between a frame and the one that follows it; null if they are not joined.
  const Link* link(int at);
  /// Returns the way to the frame `steps` frames after a frame, or before it if below 0; null if they are not joined.
  const Way* way(int at, int steps);
  Result<void> add_there(int at, int other, Frame& branch);
  SteadyFrames steady_frames();

  Device& device_;
  const ShadedFrames frames_;
  SequenceStart start_;
  int width_ = 0, height_ = 0;
  Recipe recipe_;  ///< completed
  std::optional<SteadySequence> steady_;
  std::map<int, std::shared_ptr<Loaded>> loaded_;
  std::map<int, std::uint64_t> prints_;  ///< hashes of planes and cameras
  std::map<int, std::optional<Link>> links_;
  std::map<std::pair<int, int>, Way> ways_;  ///< by frame and steps
  std::mutex mutex_;                         ///< guards the device and all members
};

}  // namespace umbrage
