#include "apps/cli/frame_range.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>

namespace umbrage::cli {
namespace {

/// Removes an integer from the start of `text` and returns it, or nullopt if there is none.
std::optional<int> take_integer(std::string_view& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(std::size_t(end - text.begin()));
  return value;
}

/// Removes `mark` from the start of `text`; returns whether it was there.
bool take(char mark, std::string_view& text) {
  if (text.empty() || text.front() != mark) return false;
  text.remove_prefix(1);
  return true;
}

constexpr int kMaxFrameNumber = 999999999;  // nine digits

/// A range of frame numbers, first and last included.
struct FrameSpan {
  int first = 0, last = 0, step = 1;
};

/// Parses one entry of a list of frames.
std::optional<FrameSpan> parse_span(std::string_view text) {
  FrameSpan span;
  const auto first = take_integer(text);
  if (!first) return std::nullopt;
  span.first = span.last = *first;
  if (take('-', text)) {
    const auto last = take_integer(text);
    if (!last) return std::nullopt;
    span.last = *last;
    if (take('x', text)) {
      const auto step = take_integer(text);
      if (!step || *step < 1) return std::nullopt;
      span.step = *step;
    }
  }
  const bool in_range = span.first >= -kMaxFrameNumber && span.last <= kMaxFrameNumber;
  return text.empty() && in_range && span.first <= span.last ? std::optional(span) : std::nullopt;
}

/// Returns an integer from the environment, or nullopt.
std::optional<int> environment_integer(const char* name) {
  const char* text = std::getenv(name);
  if (!text) return std::nullopt;
  std::string_view rest = text;
  const auto value = take_integer(rest);
  return rest.empty() ? value : std::nullopt;
}

Result<Shard> slurm_shard() {
  const auto id = environment_integer("SLURM_ARRAY_TASK_ID"), first = environment_integer("SLURM_ARRAY_TASK_MIN"),
             last = environment_integer("SLURM_ARRAY_TASK_MAX");
  const int step = environment_integer("SLURM_ARRAY_TASK_STEP").value_or(1);
  if (!id || !first || !last || step < 1 || *id < *first || *id > *last)
    return field_error("--shard", "slurm",
                       "{} slurm needs SLURM_ARRAY_TASK_ID, SLURM_ARRAY_TASK_MIN and SLURM_ARRAY_TASK_MAX, which Slurm "
                       "sets for tasks of an array: submit with --array, or give --shard I/N, such as 2/6");
  const int count = (*last - *first) / step + 1;
  const int tasks = environment_integer("SLURM_ARRAY_TASK_COUNT").value_or(count);
  if (tasks != count)
    return field_error("--shard", "slurm",
                       "{} slurm needs an array without gaps, and {} to {} has {} tasks: submit the whole array again, "
                       "since finished frames are skipped, or give --shard I/N",
                       *first, *last, tasks);
  return Shard{(*id - *first) / step, count};
}

}  // namespace

Result<std::vector<int>> parse_frames(std::string_view text) {
  std::vector<int> frames;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const auto span = parse_span(text.substr(start, comma - start));
    if (!span)
      return field_error("--frames", text,
                         "{} cannot be '{}': it takes frames and ranges, such as 1-240, 1-240x2 or 1,3,5-9");
    if ((long(span->last) - span->first) / span->step + long(frames.size()) >= kMaxFrames)
      return field_error("--frames", text, "{} cannot be '{}': it takes at most {} frames", kMaxFrames);
    for (long frame = span->first; frame <= span->last; frame += span->step) frames.push_back(int(frame));
    start = comma + 1;
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::string frames_text(std::span<const int> frames) {
  constexpr int kMaxShown = 20;  // frames and ranges
  std::string text;
  int shown = 0;
  for (std::size_t k = 0; k < frames.size();) {
    if (++shown > kMaxShown) return text + fmt::format(" and {} more", frames.size() - k);
    std::size_t end = k + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", frames[k]);
    if (end > k + 1) text += fmt::format("-{}", frames[end - 1]);
    k = end;
  }
  return text;
}

std::vector<int> Shard::of(std::span<const int> frames) const {
  const auto begin_of = [&](int part) { return frames.begin() + (long(frames.size()) * part + count - 1) / count; };
  return {begin_of(index), begin_of(index + 1)};
}

Result<Shard> parse_shard(const std::string& text) {
  if (text == "slurm") return slurm_shard();
  std::string_view rest = text;
  const auto index = take_integer(rest);
  const bool has_slash = take('/', rest);
  const auto count = take_integer(rest);
  if (!index || !has_slash || !count || !rest.empty() || *index < 1 || *count < *index || *count > kMaxFrames)
    return field_error("--shard", text, "{} cannot be '{}': it takes I/N, from 1/N to N/N, such as 2/6, or slurm");
  return Shard{*index - 1, *count};
}

}  // namespace umbrage::cli
