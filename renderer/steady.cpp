#include "renderer/steady.h"

#include <algorithm>
#include <cstdlib>

#include "core/lists.h"
#include "effects/effects.h"
#include "effects/steady/steady.h"

namespace umbrage {

namespace {

constexpr int kSpare = 2;  // frames that are kept beyond a window, since threads may ask for frames out of order

/// Returns the planes of a frame that others read.
std::vector<std::string> joined_planes(const Device& device, const Frame& frame) {
  const std::vector<std::string> available = device.plane_names(frame);
  std::vector<std::string> names = {"depth", "normal.x", "normal.y", "normal.z", "ao"};
  for (const char* name : {"traced_confidence", "indirect.r", "indirect.g", "indirect.b"})
    if (contains(available, name)) names.emplace_back(name);
  return names;
}

}  // namespace

SteadySequence::SteadySequence(Device& device, const Scene& scene, SteadyFrames frames)
    : device_(device),
      scene_(scene),
      frames_(std::move(frames)),
      recipe_(frames_.plan(frames_.begin).recipe),
      technique_(filtered_technique(recipe_)),
      after_(technique_ ? std::min(frames_.reach, 1) : frames_.reach),
      before_(frames_.reach - after_) {}

std::vector<int> SteadySequence::neighbours(int frame, int reach) const {
  const int count = frames_.end - frames_.begin;
  std::vector<int> found;
  for (int distance = 1; distance <= reach; ++distance)
    for (int other : {frame - distance, frame + distance}) {
      if (frames_.is_closed) other = frames_.begin + ((other - frames_.begin) % count + count) % count;
      const bool inside = other >= frames_.begin && other < frames_.end;
      if (inside && other != frame && !contains(found, other)) found.push_back(other);
    }
  return found;
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
    for (const std::string& name : joined_planes(device_, drawn.frame)) std::erase(others, name);
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

Result<Frame> SteadySequence::joined(const Frame& own, const std::vector<const Frame*>& others, bool by_samples) {
  const Effect& steady = effect_with<SteadyParams>();
  ParameterBytes bytes = params_of(recipe_.settings, steady.name);
  auto& params = as<SteadyParams>(bytes);
  Frame joined = device_.branch(own);
  if (!contains(device_.plane_names(own), "ao")) return joined;  // the picture shows no occlusion
  const std::vector<std::string> names = joined_planes(device_, own);
  params.light = contains(names, "indirect.r");
  params.weight = by_samples ? kSteadyRays : kSteadyEqual;
  params.begin = 1;
  for (const Frame* other : others) {
    if (auto added = device_.add_planes_of(*other, names, joined); !added) return added.error();
    joined.info.other_camera = other->info.camera;
    if (auto state = device_.run(steady, bytes, joined); !state) return state.error();
    params.begin = 0;
  }
  return joined;
}

Result<void> SteadySequence::filter(int frame) {
  Neighbour& own = drawn_.at(frame);
  if (own.filtered) return {};
  std::vector<const Frame*> others;
  for (const int other : neighbours(frame, before_)) others.push_back(&drawn_.at(other).frame);
  auto made = joined(own.frame, others, true);
  if (!made) return made.error();
  if (technique_ && contains(device_.plane_names(*made), "ao")) {
    const int frames = int(others.size()) + 1;
    const ParameterBytes params = params_of_filter(*technique_, frames, params_of(recipe_.settings, technique_->name));
    if (auto state = device_.run(*technique_, params, *made); !state) return state.error();
  }
  own.filtered = std::move(*made);
  return {};
}

Result<Drawn> SteadySequence::draw(int frame, StageTimes& times, const ProgressMonitor& monitor,
                                   std::optional<float> stops, const Continuation& more) {
  const ScopedPlanePool pool(device_.pool());
  // Half of the progress for the frames of the window, of which mostly one is lacking.
  const auto part = [&](double begin) {
    return [&, begin](double fraction) { return !monitor || monitor(begin + 0.5 * fraction); };
  };
  release_frames(frame);
  std::erase_if(drawn_, [&](const auto& entry) { return entry.first == frame && entry.second.is_finished; });
  std::vector<int> window = neighbours(frame, frames_.reach);
  window.push_back(frame);
  if (auto drawn = draw_lacking(std::move(window), times, part(0.0)); !drawn) return drawn.error();
  if (auto done = filter(frame); !done) return done.error();
  std::vector<const Frame*> others;
  for (const int other : neighbours(frame, after_)) {
    if (auto done = filter(other); !done) return done.error();
    others.push_back(&*drawn_.at(other).filtered);
  }
  Neighbour& own = drawn_.at(frame);
  auto start = joined(*own.filtered, others, false);
  if (!start) return start.error();
  times.done(effect_with<SteadyParams>().name);
  auto drawn = draw_after_technique(device_, scene_, frames_.plan(frame), *start, times, part(0.5), stops, more);
  own.is_finished = true;
  return drawn;
}

}  // namespace umbrage
