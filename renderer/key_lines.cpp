#include "renderer/key_lines.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/trigonometric.hpp>

#include "core/lists.h"

namespace umbrage {
namespace {

constexpr int kMaxFrames = 16;  // from key frame to key frame
// Of the camera between them: lines of other views are too dense or too sparse. The way is a fraction of the distance
// to the focal point.
constexpr float kMaxTurnDeg = 12.0f, kMaxWay = 0.2f;
constexpr std::size_t kKept = 4;  // entries that are kept, since threads may ask for frames out of order

/// Returns the key frames of a sequence: evenly spaced, by frames or by the motion of the camera.
std::vector<int> key_frames(const std::function<Plan(int)>& plan, int count, bool is_closed) {
  const int end = is_closed ? count : count - 1;
  std::vector<float> way = {0.0f};  // to each frame
  Camera before = plan(0).camera;
  float part = 0.0f;  // of the way between key frames
  for (int frame = 1; frame <= end; ++frame) {
    if (frame == 1 || !is_closed) {  // a closed sequence turns evenly
      const Plan at = plan(frame % count);
      const glm::vec3 turned(glm::row(at.camera.view_from_world, 2) - glm::row(before.view_from_world, 2));
      const float turn_deg = 2.0f * glm::degrees(std::asin(std::min(0.5f * glm::length(turned), 1.0f)));
      part = std::max(1.0f / float(kMaxFrames), turn_deg / kMaxTurnDeg);
      if (const auto& focal = at.recipe.framing.focal_point; focal && !is_closed) {
        const double distance = glm::length(*focal - at.origin - glm::dvec3(at.camera.eye()));
        const double moved = glm::length(at.camera.eye() - before.eye());
        if (distance > 0.0) part = std::max(part, float(moved / distance) / kMaxWay);
      }
      before = at.camera;
    }
    way.push_back(way.back() + part);
  }
  const float step = way.back() / std::max(std::ceil(way.back() - 1e-3f), 1.0f);
  std::vector<int> keys = {0};
  for (int frame = 1; frame <= end; ++frame)
    if (frame == end || way[std::size_t(frame)] > (float(keys.size()) - 1e-3f) * step) keys.push_back(frame);
  return keys;
}

/// Removes entries far from `key` so that kKept remain.
void shorten(std::map<int, SurfaceLines>& entries, int key) {
  while (entries.size() > kKept) {
    const auto last = std::prev(entries.end());
    entries.erase(key - entries.begin()->first > last->first - key ? entries.begin() : last);
  }
}

}  // namespace

KeyLines::KeyLines(Device& device, std::function<Plan(int frame)> plan, int count, bool is_closed)
    : device_(device), plan_(std::move(plan)), count_(count) {
  const Recipe recipe = plan_(0).recipe;
  const auto steps = steps_of(look_run(recipe));
  lines_ = stroke_parameters_or_none(recipe);
  std::erase_if(lines_, [&](const EffectStep& each) {
    return !tracing_dispatch(*each.effect).keys.key || !contains(steps, each.effect);
  });
  if (lines_.empty() || count == 1) return;
  field_ = *lines_[0].effect;
  std::erase_if(field_.dispatches, [](const Dispatch& dispatch) { return dispatch.trace != nullptr; });
  keys_ = key_frames(plan_, count, is_closed);
}

Result<SurfaceLines> KeyLines::lines_of_key(int frame, StageTimes& times, const ProgressMonitor& monitor) {
  if (const auto found = drawn_.find(frame); found != drawn_.end()) return found->second;
  Plan plan = plan_(frame % count_);
  const Camera camera = begin_picture(plan, {});
  plan.capture.shadows = plan.capture.extra_views = plan.capture.occluders = 0;
  plan.capture.layers = 1;
  plan.capture.back_sides = false;
  plan.capture.planes = {"object_id"};
  auto captured = device_.capture(camera, plan.capture, monitor);
  if (!captured) return captured.error();
  if (auto run = device_.run(field_, lines_[0].params, *captured, {}, monitor); !run) return run.error();
  std::vector<std::string> names;
  const auto available = device_.plane_names(*captured);
  for (const std::string_view name : edge_planes(lines_, 1))
    if (contains(available, name)) names.emplace_back(name);
  const auto planes = device_.download_with_guard(*captured, names);
  if (!planes) return planes.error();
  SurfaceLines& lines = drawn_[frame];
  run_tracing(lines_[0], captured->info, *planes, device_.threads(),
              [&](const Dispatch& dispatch, const HostFrame& host) { lines = dispatch.keys.key(host); });
  times.done("key lines");
  return lines;
}

Result<void> KeyLines::complete(int frame, Plan& plan, StageTimes& times, const ProgressMonitor& monitor) {
  if (keys_.size() < 2) return {};
  const auto after = std::upper_bound(keys_.begin(), keys_.end() - 1, frame);
  const int first = *(after - 1), second = *after;
  if (!joined_.contains(first)) {
    const auto before = lines_of_key(first, times, monitor);
    if (!before) return before.error();
    const auto next = lines_of_key(second, times, monitor);
    if (!next) return next.error();
    tbb::task_arena arena(device_.threads());
    joined_[first] = arena.execute([&] { return tracing_dispatch(*lines_[0].effect).keys.join(*before, *next); });
    times.done("key lines");
    shorten(drawn_, first);
    shorten(joined_, first);
  }
  const float after_first = float(frame - first) / float(second - first);
  plan.lines_between = std::make_shared<const LinesBetween>(LinesBetween{joined_[first], after_first});
  return {};
}

}  // namespace umbrage
