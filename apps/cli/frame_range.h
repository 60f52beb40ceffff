// Which frames of a sequence are made: the range of --frames, and the part of it that --shard selects.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace umbrage::cli {

/// Parses "12", "1-240", "1-240x2" (every second frame) and lists of these, "1,3,5-9". Returns the frames in ascending
/// order, each once; at most kMaxFrames. Errors: kUsage.
Result<std::vector<int>> parse_frames(std::string_view text);
inline constexpr int kMaxFrames = 1000000;

/// Returns ascending frames as text, shortened if it is long: "1-3, 7, 9-12".
std::string frames_text(std::span<const int> frames);

/// One of `count` parts of a sequence, which several processes make. A part is a run of frames, since each is drawn
/// with its neighbours.
struct Shard {
  int index = 0, count = 1;  ///< index: from 0

  std::vector<int> of(std::span<const int> frames) const;
};

/// Parses "2/6": the second of six parts; or "slurm": the part of this task of a Slurm array, from SLURM_ARRAY_TASK_ID,
/// SLURM_ARRAY_TASK_MIN, SLURM_ARRAY_TASK_MAX and SLURM_ARRAY_TASK_STEP. Errors: kUsage, also outside a Slurm array and
/// for an array with gaps, whose tasks cannot know which of them they are.
Result<Shard> parse_shard(const std::string& text);

}  // namespace umbrage::cli
