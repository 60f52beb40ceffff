#include "apps/cli/sequence.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <string_view>
#include <thread>

#include "apps/cli/frame_range.h"
#include "apps/cli/options.h"
#include "apps/cli/progress.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "core/version.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the time of the last change of a file; nullopt if there is none.
std::optional<fs::file_time_type> time_of(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error);
  return error ? std::nullopt : std::optional(time);
}

/// Returns the hash of the options that change a picture, as 16 hexadecimal digits: FNV-1a of their names and values,
/// and of the version.
std::string request_of(const CLI::App& command) {
  constexpr std::array<std::string_view, 10> kOthers = {"--output", "--frames", "--shard",   "--overwrite",
                                                        "--device", "--memory", "--threads", "--verbose",
                                                        "--json",   "--config"};
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](std::string_view text) {
    for (const char c : text) hash = (hash ^ (unsigned char)(c)) * 0x100000001b3u;
    hash = (hash ^ '\n') * 0x100000001b3u;
  };
  add(project_version());
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || contains(kOthers, option->get_name())) continue;
    add(option->get_name());
    for (const std::string& value : option->results()) add(value);
  }
  return fmt::format("{:016x}", hash);
}

/// Returns the file that records what drew the frames.
fs::path record_of(const FrameNames& names) {
  const fs::path start(names.before);
  std::string name = start.filename().string();
  while (!name.empty() && std::string_view("._-").find(name.back()) != std::string_view::npos) name.pop_back();
  return start.parent_path() / ((name.empty() ? "umbrage" : name) + ".frames");
}

/// Returns the name of a frame's file in the record: relative to the record's folder.
std::string recorded_name(const Sequence& sequence, const fs::path& file) {
  return file.lexically_relative(record_of(sequence.outputs.front()).parent_path()).generic_string();
}

/// Returns the record's line for a file of this request; empty if there is no such file.
std::string record_line(const Sequence& sequence, const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  return error ? "" : fmt::format("{} {} {}", sequence.request, size, recorded_name(sequence, file));
}

/// Adds the files of a frame to the record. Without it a later run makes the frame again.
void add_to_record(const Sequence& sequence, int frame) {
  std::string lines;
  for (const FrameNames& names : sequence.outputs) lines += record_line(sequence, names.of(frame)) + "\n";
  if (sequence.outputs.empty()) return;
  std::ofstream(record_of(sequence.outputs.front()), std::ios::app | std::ios::binary) << lines << std::flush;
}

/// The last line of the record for each file, by its name.
using FrameRecord = std::map<std::string, std::string>;

FrameRecord read_record(const FrameNames& names) {
  FrameRecord record;
  std::ifstream file(record_of(names), std::ios::binary);
  for (std::string line; std::getline(file, line);) {
    const auto name = line.find(' ', line.find(' ') + 1);  // after the hash and the size
    if (name != std::string::npos) record[line.substr(name + 1)] = line;
  }
  return record;
}

/// Returns whether the files of a frame are as the record says.
bool is_recorded(const Sequence& sequence, const FrameRecord& record, int frame) {
  return std::all_of(sequence.outputs.begin(), sequence.outputs.end(), [&](const FrameNames& names) {
    const fs::path file = names.of(frame);
    const auto found = record.find(recorded_name(sequence, file));
    return found != record.end() && found->second == record_line(sequence, file);
  });
}

/// Returns whether all outputs of a frame are there and no input is newer.
bool is_up_to_date(const SequenceFiles& files, int frame) {
  auto oldest = fs::file_time_type::max();
  for (const FrameNames& names : files.outputs) {
    const auto time = time_of(names.of(frame));
    if (!time) return false;
    oldest = std::min(oldest, *time);
  }
  const auto is_older = [&](const fs::path& file) {
    const auto time = time_of(file);
    return !time || *time <= oldest;
  };
  const auto are_older = [&](const FrameNames& names) {
    for (int read = std::max(frame - files.reach, 0); read <= frame + files.reach; ++read)
      if (!is_older(names.of(read))) return false;
    return true;
  };
  return std::all_of(files.shared.begin(), files.shared.end(), is_older) &&
         std::all_of(files.inputs.begin(), files.inputs.end(), are_older);
}

/// Checks that the outputs of a frame are none of its inputs. Errors: kUsage.
Result<void> check_inputs_remain(const SequenceFiles& files, int frame) {
  std::vector<fs::path> inputs = files.shared;
  for (const FrameNames& names : files.inputs) inputs.emplace_back(names.of(frame));
  for (const FrameNames& names : files.outputs)
    for (const fs::path& input : inputs)
      if (auto status = check_input_remains(input, names.of(frame)); !status) return status;
  return {};
}

/// Returns the error for frames without a file. Names the frames that exist, or else files of similar names.
Error no_file_error(const FrameNames& names, const std::vector<int>& frames) {
  const std::string pattern = names.pattern();
  FrameNames others;
  if (const auto existing = names.existing(&others); !existing.empty())
    return file_error("there is no file '{}' for a frame of {}: there are frames {}", pattern, frames_text(frames),
                      frames_text(existing));
  if (others.digits > 0)
    return file_error("there is no file '{}': the files there are '{}', frames {}", pattern, others.pattern(),
                      frames_text(others.existing()));
  const fs::path start(pattern);
  const fs::path folder = start.has_parent_path() ? start.parent_path() : fs::path(".");
  std::error_code error;
  std::vector<std::string> near;
  fs::directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == start.extension()) near.push_back(entry->path().filename().string());
  if (error) return file_error("there is no file '{}': the folder '{}' cannot be read", pattern, folder.string());
  if (near.empty())
    return file_error("there is no file '{}': the folder '{}' has no {} file", pattern, folder.string(),
                      start.extension().string());
  std::sort(near.begin(), near.end());
  std::vector<std::string> patterns = near;
  for (std::string& name : patterns)
    for (std::size_t at = name.find_last_of("0123456789"); at < name.size() && std::isdigit((unsigned char)(name[at]));
         --at)
      name[at] = '#';
  return file_error("there is no file '{}'{}: the folder has {}{}", pattern,
                    did_you_mean(nearest_name(start.filename().string(), patterns)), near.front(),
                    near.size() > 1 ? fmt::format(" to {}", near.back()) : "");
}

/// Returns a warning if there are files of the name beside these frames, by other digits, or if frames between them
/// have no file; empty if not. Every second frame, as an example, is whole.
std::string doubt_of(const FrameNames& names, const std::vector<int>& frames, const FrameNames& others) {
  if (frames.empty()) return "";
  if (others.digits > 0)
    return fmt::format("'{}' has the frames {}: files with other digits, '{}', are left out", names.pattern(),
                       frames_text(frames), others.pattern());
  int step = kMaxFrames;
  for (std::size_t k = 1; k < frames.size(); ++k) step = std::min(step, frames[k] - frames[k - 1]);
  std::vector<int> missing;
  for (long at = frames.front(); at < frames.back() && missing.size() < kMaxFrames; at += step)
    if (!std::binary_search(frames.begin(), frames.end(), int(at))) missing.push_back(int(at));
  return missing.empty() ? "" : fmt::format("'{}' has no file of the frames {}", names.pattern(), frames_text(missing));
}

/// State of the threads that make frames.
struct Progress {
  const Sequence& sequence;
  const SequenceWork& work;
  std::size_t total = sequence.own.size();
  std::size_t done = 0;
  std::vector<int> failed = {};
  std::vector<double> fractions = {};  // of the frame that each worker makes
  std::optional<Error> end = {};       // ends the sequence
  std::mutex mutex = {};               // guards the members above
  ProgressLine line = {};

  void show() {
    const double partial = std::accumulate(fractions.begin(), fractions.end(), 0.0);
    line.show(fmt::format("{}, {} of {} frames done", work.activity, done, total),
              std::min(1.0, (double(done) + partial) / double(total)));
  }

  /// Makes a frame and adds its outcome, except an error that `ends` the sequence. Returns the error.
  Result<void> make(int worker, int frame, bool writes, bool (*ends)(ErrorKind)) {
    const auto start = std::chrono::steady_clock::now();
    const auto monitor = [&](double fraction) {
      const std::lock_guard lock(mutex);
      fractions[std::size_t(worker)] = fraction;
      show();
      return !end;
    };
    auto made = guarded([&] { return fmt::format("frame {}; try a smaller --memory", frame); },
                        [&] {
                          return work.make({worker, frame, writes, monitor, [&] { line.wipe(); }});
                        });
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(mutex);
    if (made && writes) add_to_record(sequence, frame);
    fractions[std::size_t(worker)] = 0.0;
    if (!made && !end && (work.needs_all || ends(made.error().kind))) end = made.error();
    if (!writes || (!made && end)) return made;
    ++done;
    if (!made) failed.push_back(frame);
    if (!made || work.verbose) {
      line.wipe();
      const std::string text = made ? fmt::format("{:.2f} s", s) : with_option_names(made.error().message);
      // fmt::print would throw if standard error cannot be written.
      std::fputs(fmt::format("umbrage: frame {}: {}\n", frame, text).c_str(), stderr);
    }
    show();
    return made;
  }
};

bool is_interruption(ErrorKind kind) { return kind == ErrorKind::kInterrupted; }
bool is_not_about_frame(ErrorKind kind) { return is_interruption(kind) || kind == ErrorKind::kUsage; }

/// Makes the first frame that can be made. Returns it, or the last one; the frames before it have failed.
Result<int> make_first(const Sequence& sequence, Progress& progress) {
  for (const int frame : sequence.all) {
    const bool is_own = std::binary_search(sequence.own.begin(), sequence.own.end(), frame);
    const auto made = progress.make(0, frame, is_own, is_not_about_frame);
    if (made) return frame;
    if (progress.end) return *progress.end;
    if (!is_own && made.error().kind != ErrorKind::kFile) return made.error();
  }
  return sequence.all.back();
}

}  // namespace

bool has_inputs(const SequenceFiles& files, int frame) {
  std::error_code ignored;
  return std::all_of(files.inputs.begin(), files.inputs.end(),
                     [&](const FrameNames& names) { return fs::exists(names.of(frame), ignored); });
}

Result<void> check_input_remains(const fs::path& input, const std::string& output) {
  std::error_code ignored;
  if (!fs::equivalent(input, output, ignored)) return {};
  return field_error("--output", output, "{} '{}' is the input: name another file", output);
}

void add_sequence_options(CLI::App& command, SequenceOptions& options, bool has_frames) {
  const auto output = "Output";
  options.command = &command;
  if (has_frames) {
    CLI::Option* frames = command.add_option(
        "--frames", options.frames, "frames of a sequence: 1-240, 1-240x2 for every second one, or 1,3,5-9 [all]");
    frames->type_name("RANGE")->group(output);
    add_check(*frames, [](const std::string& text) -> Result<void> {
      const auto parsed = parse_frames(text);
      return parsed ? Result<void>() : parsed.error();
    });
  }
  command
      .add_option("--shard", options.shard,
                  "make one part of the frames: 2/6 is the second of six; slurm: that of this task of a Slurm array "
                  "[all frames]")
      ->type_name("I/N")
      ->group(output);
  command.add_flag("--overwrite", options.overwrite, "also make frames whose files are there and up to date")
      ->group(output);
}

Result<Sequence> plan_sequence(const SequenceOptions& options, const SequenceFiles& files, std::vector<int> range) {
  Shard shard;
  if (!options.shard.empty()) {
    const auto parsed = parse_shard(options.shard);
    if (!parsed) return parsed.error();
    shard = *parsed;
  }
  Sequence sequence;
  const bool is_whole = !range.empty() && options.frames.empty();
  for (const FrameNames& names : is_whole ? files.outputs : std::vector<FrameNames>()) {
    auto others = names.existing();
    others.erase(others.begin(), std::upper_bound(others.begin(), others.end(), range.back()));
    if (!others.empty())
      sequence.left_over += fmt::format("umbrage: '{}' has more frames, which are not of this run and remain: {}\n",
                                        names.pattern(), frames_text(others));
  }
  if (range.empty() && !options.frames.empty()) {
    auto parsed = parse_frames(options.frames);
    if (!parsed) return parsed.error();
    range = std::move(*parsed);
  } else if (range.empty()) {
    FrameNames others;
    range = files.inputs.front().existing(&others);
    sequence.doubt = doubt_of(files.inputs.front(), range, others);
  }
  for (const int frame : range)
    if (has_inputs(files, frame)) sequence.all.push_back(frame);
  if (sequence.all.empty()) {
    const auto lacking = std::find_if(files.inputs.begin(), files.inputs.end(), [&](const FrameNames& names) {
      std::error_code ignored;
      return std::none_of(range.begin(), range.end(), [&](int frame) { return fs::exists(names.of(frame), ignored); });
    });
    if (lacking != files.inputs.end()) return no_file_error(*lacking, range);
    return file_error("no frame of {} has all its files: '{}' and the others have different frames", frames_text(range),
                      files.inputs.front().pattern());
  }
  if (options.command && !files.outputs.empty()) {
    sequence.outputs = files.outputs;
    for (FrameNames& names : sequence.outputs) names.before = (fs::current_path() / names.before).string();
    sequence.request = request_of(*options.command);
  }
  const auto record = sequence.outputs.empty() ? FrameRecord() : read_record(sequence.outputs.front());
  for (const int frame : shard.of(range)) {
    if (auto status = check_inputs_remain(files, frame); !status) return status.error();
    if (!std::binary_search(sequence.all.begin(), sequence.all.end(), frame))
      sequence.missing.push_back(frame);
    else if (options.overwrite || !is_up_to_date(files, frame))
      sequence.own.push_back(frame);
    else if (is_recorded(sequence, record, frame))
      ++sequence.finished;
    else
      sequence.own.push_back(frame), ++sequence.replaced;
  }
  return sequence;
}

void print_kept(const Sequence& sequence) {
  std::fputs(sequence.left_over.c_str(), stderr);
  if (!sequence.doubt.empty()) print_warning(sequence.doubt);
  if (sequence.finished > 0)
    fmt::print(stderr, "umbrage: {} of {} frames are there already; --overwrite makes them again\n", sequence.finished,
               sequence.finished + sequence.own.size() + sequence.missing.size());
  if (sequence.replaced > 0)
    fmt::print(stderr, "umbrage: {} {} there, but cut off or drawn by other options, and made again\n",
               sequence.replaced, sequence.replaced == 1 ? "frame is" : "frames are");
}

Result<void> make_sequence(const Sequence& sequence, const SequenceWork& work) {
  print_kept(sequence);
  Progress progress{sequence, work};
  progress.fractions.resize(1);
  if (!sequence.own.empty()) {
    const auto first = make_first(sequence, progress);
    if (!first) return first.error();
    // Frames up to the first have been made, or have failed.
    const auto rest = std::upper_bound(sequence.own.begin(), sequence.own.end(), *first);
    const auto count = std::size_t(sequence.own.end() - rest);
    if (count > 0) {
      const auto workers = work.start_workers();
      if (!workers) return workers.error();
      const std::size_t threads = std::clamp(std::size_t(*workers), std::size_t(1), count);
      progress.fractions.resize(threads);
      std::atomic<std::size_t> next = 0;
      const auto run = [&](int worker) {
        for (std::size_t k = next++; k < count; k = next++) {
          {
            const std::lock_guard lock(progress.mutex);
            if (progress.end) return;
          }
          static_cast<void>(bool(progress.make(worker, rest[std::ptrdiff_t(k)], true, is_interruption)));
        }
      };
      std::vector<std::jthread> others;
      for (std::size_t worker = 1; worker < threads; ++worker) others.emplace_back(run, int(worker));
      run(0);
      others.clear();
    }
  }
  progress.line.wipe();
  if (progress.end) return *progress.end;
  if (!sequence.missing.empty())
    fmt::print(stderr, "umbrage: these frames have no input: {}\n", frames_text(sequence.missing));
  const std::size_t bad = progress.failed.size() + sequence.missing.size();
  if (bad == 0) return {};
  std::vector<int> frames = progress.failed;
  frames.insert(frames.end(), sequence.missing.begin(), sequence.missing.end());
  std::sort(frames.begin(), frames.end());
  return file_error("{} of {} frames have no picture: {}", bad,
                    sequence.finished + sequence.own.size() + sequence.missing.size(), frames_text(frames));
}

}  // namespace umbrage::cli
