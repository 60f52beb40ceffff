#include "devices/cpu/cpu_planes.h"

#include <algorithm>
#include <set>

#include "core/check.h"
#include "devices/shared/neutral.h"
#include "kernel/kernel_frame.h"

namespace umbrage {
namespace {

/// Returns the number of picture rows that the margin of a strip lacks, if these rows of a plane are valid.
int missing_margin(const CpuPlanes& planes, const Rows& valid, int reduced) {
  const int above = valid.begin - planes.strip->rows.begin, below = planes.strip->rows.end - valid.end;
  return std::max({0, above * reduced, below * reduced});
}

}  // namespace

const Plane* find_made(const CpuPlanes& planes, std::string_view name) {
  const Plane* own = planes.image.find(name);
  return own || !planes.kept ? own : find_made(*planes.kept, name);
}

Plane& writable(CpuPlanes& planes, const std::string& name) {
  if (Plane* own = planes.image.find(name)) return *own;
  // A pass may write only a part of the plane; the remainder keeps its previous or neutral values.
  const Plane* before = find_plane(planes, name);
  Plane& own = planes.image.add(name);
  if (before) own = *before;
  return own;
}

const Plane* find_plane(const CpuPlanes& planes, std::string_view name) {
  if (const Plane* made = find_made(planes, name)) return made;
  const bool neutral = std::find(planes.neutral.begin(), planes.neutral.end(), name) != planes.neutral.end();
  if (neutral) return &planes.constants.at(*neutral_value(name));
  return planes.kept ? find_plane(*planes.kept, name) : nullptr;
}

std::vector<std::string> names_of(const CpuPlanes& planes) {
  std::vector<const CpuPlanes*> line;  // from the frame that is no branch on
  for (const CpuPlanes* each = &planes; each; each = each->kept.get()) line.insert(line.begin(), each);
  std::vector<std::string> names;
  std::set<std::string_view> listed;
  for (const CpuPlanes* each : line)
    for (const std::string& name : each->image.names)
      if (listed.insert(name).second) names.push_back(name);
  for (const CpuPlanes* each : line)
    for (const std::string& name : each->neutral)
      if (listed.insert(name).second) names.push_back(name);
  return names;
}

const Plane* find_whole(const CpuPlanes& planes, const PictureInfo& info, std::string_view name, int version) {
  const auto& all = planes.strip->wholes->planes;
  const auto found = all.find({info.reduced, std::string(name), version});
  return found != all.end() && found->second.complete ? &found->second.plane : nullptr;
}

const Held* find_held(const CpuPlanes& planes, std::string_view name) {
  const auto found = planes.held.find(name);
  return found != planes.held.end() ? &found->second : nullptr;
}

Rows shrunk(const Rows& rows, int margin, int height) {
  return {rows.begin > 0 ? rows.begin + margin : 0, rows.end < height ? rows.end - margin : height};
}

Rows divided(const Rows& rows, int factor) {
  return {reduced_side(rows.begin, factor), reduced_side(rows.end, factor)};
}

StripRun prepare_strip(const DispatchRun& run, CpuPlanes& planes, tbb::task_arena& arena) {
  const PictureInfo& info = run.info;
  StripRun of{.rows = planes.rows};
  const int version = ++planes.dispatches;
  bool all = run.pixels == PixelSet::kAll;
  for (const std::string_view output : run.dispatch.outputs)
    all = all && (!run.is_there(output) || find_whole(planes, info, run.plane(output), version));
  if (all) {
    for (const std::string_view output : run.dispatch.outputs)
      if (run.is_there(output)) planes.held[run.plane(output)] = {planes.rows, version, 0, false};
    of.done = true;
    return of;
  }
  const int reach = run.dispatch.reach ? run.dispatch.reach(run.constants.data(), run.round) : 0;
  std::vector<std::string> wanted;
  const auto& far = run.dispatch.unbounded_inputs;
  for (const std::string_view input : run.dispatch.inputs) {
    const std::string name = run.plane(input);
    const Held* held = find_held(planes, name);
    if (!held) continue;
    if (!run.dispatch.reach || std::find(far.begin(), far.end(), input) != far.end()) {
      of.far.push_back(name);
      if (!find_whole(planes, info, name, held->version)) wanted.push_back(name);
    } else if (held->made) {
      const Rows valid = shrunk(held->valid, reach, info.height);
      of.rows = {std::max(of.rows.begin, valid.begin), std::min(of.rows.end, valid.end)};
    }
  }
  // All pixels that are not missing keep their values.
  if (run.pixels == PixelSet::kMissing)
    if (const Held* ao = find_held(planes, run.plane("ao")))
      of.rows = {std::max(of.rows.begin, ao->valid.begin), std::min(of.rows.end, ao->valid.end)};
  if (!wanted.empty()) {
    const Rows& own = planes.strip->rows;
    of.progression.finished = false;
    for (const std::string& name : wanted) {
      of.progression.missing_rows = missing_margin(planes, find_held(planes, name)->valid, info.reduced);
      if (of.progression.missing_rows > 0) return of;
    }
    for (const std::string& name : wanted) {
      const Held& held = *find_held(planes, name);
      Plane& whole = planes.strip->wholes->planes[{info.reduced, name, held.version}].plane;
      if (!whole.data()) whole = Plane(info.width, info.height);
      const Plane& from = planes.image.plane(name);
      for_rows(arena, own.count(),
               [&](int y) { std::copy_n(from.row(own.begin + y - held.first), info.width, whole.row(own.begin + y)); });
    }
    return of;
  }
  if (run.dispatch.host) return of;
  for (const std::string_view output : run.dispatch.outputs) {
    if (!run.is_there(output)) continue;
    const std::string name = run.plane(output);
    // A pass may write only a part of an existing plane.
    if (const Held* held = find_held(planes, name); held && !held->made) {
      const Plane& from = *find_whole(planes, info, name, held->version);
      Plane& to = planes.image.add(name);
      for_rows(arena, to.height, [&](int y) { std::copy_n(from.row(planes.rows.begin + y), info.width, to.row(y)); });
    }
    planes.held[name] = {of.rows, version, planes.rows.begin};
  }
  return of;
}

float* row_zero_of(const DispatchRun& run, const CpuPlanes& planes, const StripRun& strip, const std::string& name) {
  const Held* held = find_held(planes, name);
  const bool far = std::find(strip.far.begin(), strip.far.end(), name) != strip.far.end();
  const bool whole = held && (far || !held->made);
  const Plane* plane = whole ? find_whole(planes, run.info, name, held->version) : find_plane(planes, name);
  return row_zero(const_cast<float*>(plane->data()), plane->stride, whole ? 0 : held ? held->first : planes.rows.begin);
}

int missing_strip_rows(const Frame& frame, const std::vector<std::string>& names) {
  const CpuPlanes& planes = cpu_planes(frame);
  int missing = 0;
  for (const std::string& name : names)
    if (const Held* held = find_held(planes, name); held && held->made)
      missing = std::max(missing, missing_margin(planes, held->valid, frame.info.reduced));
  return missing;
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
    const Held* held = find_held(planes, name);
    int first = planes.rows.begin;
    if (held && !held->made) {
      plane = find_whole(planes, frame.info, name, held->version);
      first = 0;
    } else if (held) {
      if (!held->valid.contains(own)) fail_check(fmt::format("rows of '{}' are missing in a strip", name));
      first = held->first;
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
