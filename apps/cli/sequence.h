// Sequences: numbered frames that are made several at once. A frame that fails does not stop the others. A record
// beside the frames, NAME.frames, has a line for each file: a hash of the options that drew it, its size and its name.
// A frame whose files are as the record says is finished.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/cli/frame_names.h"
#include "core/progress.h"
#include "core/result.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// The options of a sequence, as texts.
struct SequenceOptions {
  std::string frames, shard;
  bool overwrite = false;
  const CLI::App* command = nullptr;  ///< whose options draw the frames; set by add_sequence_options
};

/// Checks that an output is not this input. Errors: kUsage.
Result<void> check_input_remains(const std::filesystem::path& input, const std::string& output);

/// Adds --shard and --overwrite to the group Output, and --frames if `has_frames`.
void add_sequence_options(CLI::App& command, SequenceOptions& options, bool has_frames);

/// The files of a sequence.
struct SequenceFiles {
  std::vector<FrameNames> inputs, outputs;    ///< files that each frame reads and writes
  std::vector<std::filesystem::path> shared;  ///< files that all frames read
  int reach = 0;                              ///< number of frames before and after a frame whose files it reads, too
};

/// Returns whether all inputs of a frame are there.
bool has_inputs(const SequenceFiles& files, int frame);

/// The frames to make, ascending.
struct Sequence {
  std::vector<FrameNames> outputs = {};
  std::string request = {};  ///< hash of the options that draw a frame
  std::vector<int> all;      ///< frames of the whole range whose inputs are there, of all shards
  std::vector<int> own;      ///< those of this process that are not finished
  std::vector<int> missing;  ///< frames of this process that have no input
  std::string doubt = {};    ///< warning of frames that `all` may lack; empty if there are none
  std::size_t finished = 0;  ///< number of frames of this process that were finished before
  std::size_t replaced = 0;  ///< of `own`, those whose files are there but cut off, or drawn by other options
  std::string left_over;     ///< sentence about files of frames after the last of a whole range; may be empty
};

/// Returns the frames of a sequence. `range`: all frames; empty: those of --frames, or else all files of the first
/// input. Frames whose outputs are there as these options draw them, and not older than their inputs, are finished,
/// unless --overwrite is given. Errors: kUsage, also if an output is an input; kFile if the range has no file.
Result<Sequence> plan_sequence(const SequenceOptions& options, const SequenceFiles& files, std::vector<int> range);

/// A frame to make.
struct FrameTask {
  int worker = 0;  ///< number of the calling thread
  int frame = 0;
  bool writes = true;  ///< false: the frame is only needed for those after it
  ProgressMonitor monitor = {};
  std::function<void()> wipe_progress = {};  ///< call it before anything is printed
};
using MakeFrame = std::function<Result<void>(const FrameTask& task)>;

struct SequenceWork {
  std::string activity;    ///< "shading", for the progress line
  bool verbose = false;    ///< prints a line for each frame
  bool needs_all = false;  ///< a frame that fails ends the sequence
  MakeFrame make;
  /// Called after the first frame; makes ready for several and returns their number.
  std::function<Result<int>()> start_workers = [] { return Result<int>(1); };
};

/// Prints a line each: if frames may be lacking, if some were finished before, if some are made again, and left_over.
void print_kept(const Sequence& sequence);

/// Makes the frames, after print_kept. The first frame of all shards
/// that can be made is made first, alone and on worker 0, so that the others can depend on it; it is written only if it
/// is one of `own`. A failure is reported by one line on standard error. Errors: kFile if frames failed or were
/// missing; kUsage of the first frame and kInterrupted of any, or any error if all are needed, end the sequence.
Result<void> make_sequence(const Sequence& sequence, const SequenceWork& work);

}  // namespace umbrage::cli
