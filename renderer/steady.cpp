#include "renderer/steady.h"

#include <algorithm>
#include <cstdlib>

#include "core/lists.h"
#include "effects/effects.h"
#include "effects/steady/steady.h"

namespace umbrage {

namespace {

constexpr int kSpare = 2;  // frames that are kept beyond a window, since threads may ask for frames out of order

}  // namespace

SteadySequence::SteadySequence(Device& device, const Scene& scene, SteadyFrames frames)
    : device_(device), scene_(scene), frames_(std::move(frames)) {}

std::vector<int> SteadySequence::neighbours(int frame) const {
  const int count = frames_.end - frames_.begin;
  std::vector<int> found;
  for (int distance = 1; distance <= frames_.reach; ++distance)
    for (int other : {frame - distance, frame + distance}) {
      if (frames_.is_closed) other = frames_.begin + ((other - frames_.begin) % count + count) % count;
      const bool inside = other >= frames_.begin && other < frames_.end;
      if (inside && other != frame && !contains(found, other)) found.push_back(other);
    }
  return found;
}

std::vector<std::string> SteadySequence::joined_planes(const Frame& frame) const {
  std::vector<std::string> names = {"depth", "normal.x", "normal.y", "normal.z", "ao"};
  if (contains(device_.plane_names(frame), "indirect.r"))
    names.insert(names.end(), {"indirect.r", "indirect.g", "indirect.b"});
  return names;
}

void SteadySequence::release_frames(int frame) {
  const int count = frames_.end - frames_.begin;
  std::erase_if(drawn_, [&](const auto& entry) {
    const int distance = std::abs(entry.first - frame);
    return (frames_.is_closed ? std::min(distance, count - distance) : distance) > frames_.reach + kSpare;
  });
  for (auto& [each, drawn] : drawn_) {
    if (!drawn.is_finished) continue;
    std::vector<std::string> others = device_.plane_names(drawn.frame);
    for (const std::string& name : joined_planes(drawn.frame)) std::erase(others, name);
    device_.release(drawn.frame, others);
  }
}

Result<void> SteadySequence::draw_lacking(std::vector<int> frames, StageTimes& times, const ProgressMonitor& monitor) {
  std::erase_if(frames, [&](int each) { return drawn_.contains(each); });
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto part = [&](double fraction) {
      return !monitor || monitor((double(k) + fraction) / double(frames.size()));
    };
    auto made = draw_technique(device_, scene_, frames_.plan(frames[k]), times, part);
    if (!made) return made.error();
    drawn_.emplace(frames[k], Neighbour{std::move(*made)});
  }
  return {};
}

Result<Frame> SteadySequence::joined(int frame, const std::vector<int>& others, const Plan& plan) {
  const Effect& steady = effect_with<SteadyParams>();
  ParameterBytes bytes = params_of(plan.recipe.settings, steady.name);
  auto& params = as<SteadyParams>(bytes);
  const Frame& own = drawn_.at(frame).frame;
  Frame joined = device_.branch(own);
  if (!contains(device_.plane_names(own), "ao")) return joined;  // the picture shows no occlusion
  const std::vector<std::string> names = joined_planes(own);
  params.light = contains(names, "indirect.r");
  params.begin = 1;
  for (const int other : others) {
    const Frame& from = drawn_.at(other).frame;
    if (auto added = device_.add_planes_of(from, names, joined); !added) return added.error();
    joined.info.other_camera = from.info.camera;
    if (auto state = device_.run(steady, bytes, joined); !state) return state.error();
    params.begin = 0;
  }
  return joined;
}

Result<Drawn> SteadySequence::draw(int frame, StageTimes& times, const ProgressMonitor& monitor,
                                   std::optional<float> stops, const Continuation& more) {
  const ScopedPlanePool pool(device_.pool());
  const std::vector<int> others = neighbours(frame);
  const Plan plan = frames_.plan(frame);
  // Half of the progress for the frames of the window, of which mostly one is lacking.
  const auto part = [&](double begin) {
    return [&, begin](double fraction) { return !monitor || monitor(begin + 0.5 * fraction); };
  };
  release_frames(frame);
  std::erase_if(drawn_, [&](const auto& entry) { return entry.first == frame && entry.second.is_finished; });
  std::vector<int> window = others;
  window.push_back(frame);
  if (auto drawn = draw_lacking(window, times, part(0.0)); !drawn) return drawn.error();
  auto start = joined(frame, others, plan);
  if (!start) return start.error();
  times.done("steady");
  auto drawn = draw_after_technique(device_, scene_, plan, *start, times, part(0.5), stops, more);
  drawn_.at(frame).is_finished = true;
  return drawn;
}

}  // namespace umbrage
