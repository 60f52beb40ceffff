#include "devices/cpu/cpu_planes.h"

#include <algorithm>

#include "core/check.h"
#include "core/lists.h"
#include "kernel/kernel_frame.h"

namespace umbrage {
namespace {

/// Throws InternalError if `rows` of a plane in a strip are not among its valid ones: the margin is too small then.
void check_rows(const StripRows& strip_rows, const Rows& rows, std::string_view name) {
  if (strip_rows.stored && !strip_rows.valid.contains(rows))
    fail_check(fmt::format("rows {} to {} of '{}' are missing in a strip, which has {} to {}", rows.begin, rows.end,
                           name, strip_rows.valid.begin, strip_rows.valid.end));
}

/// Returns the name that a plane of `first`, the other frame, has there, or an empty one.
std::string_view name_in_first(const CpuPlanes& planes, std::string_view name) {
  const std::string start = other_plane("");
  return planes.first && name.starts_with(start) ? name.substr(start.size()) : std::string_view();
}

}  // namespace

const Plane* find_stored(const CpuPlanes& planes, std::string_view name) {
  if (const std::string_view in_first = name_in_first(planes, name); !in_first.empty())
    return find_plane(*planes.first, in_first);
  const Plane* own = planes.image.find(name);
  return own || !planes.parent ? own : find_stored(*planes.parent, name);
}

Plane& writable(CpuPlanes& planes, const std::string& name) {
  if (Plane* own = planes.image.find(name)) return *own;
  planes.released.erase(name);
  // A dispatch may write only a part of the plane; the remainder keeps its previous or neutral values.
  const Plane* previous = find_plane(planes, name);
  Plane& own = planes.image.add(name);
  if (previous) own = *previous;
  return own;
}

const Plane* find_plane(const CpuPlanes& planes, std::string_view name) {
  if (const Plane* stored = find_stored(planes, name)) return stored;
  const bool neutral = contains(planes.neutral, name);
  if (neutral) return planes.constants.at(*neutral_value(name)).get();
  return planes.parent ? find_plane(*planes.parent, name) : nullptr;
}

std::vector<std::string> names_of(const CpuPlanes& planes) {
  // From the frame that is not a branch to `planes`.
  std::vector<const CpuPlanes*> lineage;
  for (const CpuPlanes* each = &planes; each; each = each->parent.get()) lineage.insert(lineage.begin(), each);
  std::vector<std::string> names;
  std::set<std::string_view> listed;
  for (const CpuPlanes* each : lineage)
    for (const std::string& name : each->image.names)
      if (listed.insert(name).second) names.push_back(name);
  for (const CpuPlanes* each : lineage)
    for (const std::string& name : each->neutral)
      if (listed.insert(name).second) names.push_back(name);
  return names;
}

const Plane* find_whole(const CpuPlanes& planes, const PictureInfo& info, std::string_view name, int version) {
  const auto& all = planes.strip->wholes->planes;
  const auto found = all.find({info.reduced, std::string(name), version});
  return found != all.end() && found->second.complete ? &found->second.plane : nullptr;
}

void begin_strip(const Strip& strip, int height, CpuPlanes& planes) {
  planes.strip = strip;
  planes.rows = rows_with_margin(strip, height);
  for (const std::string& name : planes.image.names)
    planes.strip_rows[name] = {.valid = planes.rows, .first = planes.rows.begin};
}

const StripRows* find_strip_rows(const CpuPlanes& planes, std::string_view name) {
  if (const std::string_view in_first = name_in_first(planes, name); !in_first.empty())
    return find_strip_rows(*planes.first, in_first);
  const auto found = planes.strip_rows.find(name);
  return found != planes.strip_rows.end() ? &found->second : nullptr;
}

Rows shrunk(const Rows& rows, int margin, int height) {
  return {rows.begin > 0 ? rows.begin + margin : 0, rows.end < height ? rows.end - margin : height};
}

Rows reduced_rows(const Rows& rows, int factor) {
  return {reduced_side(rows.begin, factor), reduced_side(rows.end, factor)};
}

StripRun prepare_strip(const DispatchRun& run, CpuPlanes& planes, tbb::task_arena& arena) {
  const PictureInfo& info = run.info;
  StripRun result{.rows = planes.rows};
  const int version = ++planes.dispatches;
  bool all = run.pixels != PixelSet::kMissing;
  for (const std::string_view output : run.dispatch.outputs)
    all = all && (!run.has_layer_of(output) || find_whole(planes, info, run.plane(output), version));
  if (all) {
    for (const std::string_view output : run.dispatch.outputs)
      if (run.has_layer_of(output)) planes.strip_rows[run.plane(output)] = {planes.rows, version, 0, false};
    result.done = true;
    return result;
  }
  const int reach = run.dispatch.reach ? run.dispatch.reach(run.constants.data(), run.round) : 0;
  std::vector<std::string> incomplete;
  const auto& unbounded = run.dispatch.unbounded_inputs;
  for (const std::string_view input : run.dispatch.inputs) {
    const std::string name = run.plane(input);
    const StripRows* strip_rows = find_strip_rows(planes, name);
    if (!strip_rows) continue;
    if (!run.dispatch.reach || contains(unbounded, input)) {
      result.unbounded.push_back(name);
      if (!find_whole(planes, info, name, strip_rows->version)) incomplete.push_back(name);
    } else if (strip_rows->stored) {
      // A further sample has marked pixels only: dispatches read neighbouring ones in the first sample alone.
      const bool at_pixel = planes.first && name_in_first(planes, name).empty();
      const Rows valid = shrunk(strip_rows->valid, at_pixel ? 0 : reach, info.height);
      result.rows = {std::max(result.rows.begin, valid.begin), std::min(result.rows.end, valid.end)};
    }
  }
  // Pixels that are not missing keep their values, so `ao` must be valid too.
  if (run.pixels == PixelSet::kMissing)
    if (const StripRows* ao = find_strip_rows(planes, run.plane("ao")))
      result.rows = {std::max(result.rows.begin, ao->valid.begin), std::min(result.rows.end, ao->valid.end)};
  if (!incomplete.empty()) {
    const Rows& own = planes.strip->rows;
    result.state.finished = false;
    for (const std::string& name : incomplete) {
      const StripRows& strip_rows = *find_strip_rows(planes, name);
      check_rows(strip_rows, own, name);
      Plane& whole = planes.strip->wholes->planes[{info.reduced, name, strip_rows.version}].plane;
      if (!whole.data()) whole = Plane(info.width, info.height);
      const Plane& from = planes.image.plane(name);
      for_rows(arena, own.count(), [&](int y) {
        std::copy_n(from.row(own.begin + y - strip_rows.first), info.width, whole.row(own.begin + y));
      });
    }
    return result;
  }
  if (run.dispatch.host) return result;
  for (const std::string_view output : run.dispatch.outputs) {
    if (!run.has_layer_of(output)) continue;
    const std::string name = run.plane(output);
    // A dispatch may write only a part of an existing plane; the remainder keeps its values.
    if (const StripRows* strip_rows = find_strip_rows(planes, name); strip_rows && !strip_rows->stored) {
      const Plane& from = *find_whole(planes, info, name, strip_rows->version);
      Plane& to = planes.image.add(name);
      for_rows(arena, to.height, [&](int y) { std::copy_n(from.row(planes.rows.begin + y), info.width, to.row(y)); });
    }
    planes.strip_rows[name] = {result.rows, version, planes.rows.begin};
  }
  return result;
}

float* row_zero_of(const DispatchRun& run, const CpuPlanes& planes, const StripRun& strip, const std::string& name) {
  const StripRows* strip_rows = find_strip_rows(planes, name);
  const bool unbounded = contains(strip.unbounded, name);
  const bool whole = strip_rows && (unbounded || !strip_rows->stored);
  const Plane* plane = whole ? find_whole(planes, run.info, name, strip_rows->version) : find_plane(planes, name);
  // The first sample may be drawn whole, and its further samples in strips.
  const bool of_whole_first = !name_in_first(planes, name).empty() && !planes.first->strip;
  return row_zero(const_cast<float*>(plane->data()), plane->stride,
                  whole || of_whole_first ? 0
                  : strip_rows            ? strip_rows->first
                                          : planes.rows.begin);
}

void release_planes(const std::vector<std::string>& names, CpuPlanes& planes) {
  if (planes.branches.any()) return;  // they share the planes
  for (const std::string& name : names) {
    const auto found = std::find(planes.image.names.begin(), planes.image.names.end(), name);
    if (found == planes.image.names.end()) continue;
    planes.image.planes.erase(planes.image.planes.begin() + (found - planes.image.names.begin()));
    planes.image.names.erase(found);
    planes.placed.erase(name);
    planes.strip_rows.erase(name);
    planes.released.insert(name);
  }
  // Neutral planes are made again when they are read again.
  std::erase_if(planes.neutral, [&](const std::string& name) { return contains(names, name); });
  std::erase_if(planes.constants, [&](const auto& constant) {
    return std::none_of(planes.neutral.begin(), planes.neutral.end(),
                        [&](const std::string& name) { return neutral_value(name) == constant.first; });
  });
}

void release_ended(const DispatchRun& run, const std::vector<std::string>& last_used, CpuPlanes& planes) {
  std::vector<std::string> ended;
  for (const std::string& name : last_used)
    if (uses(run.dispatch, name) &&
        std::none_of(run.later.begin(), run.later.end(), [&](const Dispatch* each) { return uses(*each, name); }))
      ended.push_back(name);
  release_planes(ended, planes);
}

Result<Image> download_strip(const Frame& frame, const std::vector<std::string>& names) {
  const CpuPlanes& planes = cpu_planes(frame);
  const int guard = frame.info.guard;
  const Rows& own = planes.strip->rows;
  const Rows rows{std::clamp(own.begin, guard, frame.info.height - guard),
                  std::clamp(own.end, guard, frame.info.height - guard)};
  Image out(frame.info.inner_width(), rows.count());
  for (const std::string& name : names) {
    const Plane* plane = find_plane(planes, name);
    const StripRows* strip_rows = find_strip_rows(planes, name);
    int first = planes.rows.begin;
    if (strip_rows && !strip_rows->stored) {
      plane = find_whole(planes, frame.info, name, strip_rows->version);
      first = 0;
    } else if (strip_rows) {
      check_rows(*strip_rows, own, name);
      first = strip_rows->first;
    }
    if (!plane) return usage_error("the picture has no plane '{}'", name);
    Plane& to = out.add(name);
    for (int y = 0; y < rows.count(); ++y)
      if (rows.begin + y - first < plane->height)
        std::copy_n(plane->row(rows.begin + y - first) + guard, out.width, to.row(y));
  }
  return out;
}

}  // namespace umbrage
