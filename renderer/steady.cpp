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

Result<Drawn> SteadySequence::draw(int frame, StageTimes& times, const ProgressMonitor& monitor,
                                   std::optional<float> stops, const Continuation& more) {
  const ScopedPlanePool pool(device_.pool());
  const std::vector<int> others = neighbours(frame);
  const int count = frames_.end - frames_.begin;
  std::erase_if(drawn_, [&](const auto& entry) {
    const int distance = std::abs(entry.first - frame);
    return (frames_.is_closed ? std::min(distance, count - distance) : distance) > frames_.reach + kSpare;
  });
  std::vector<int> needed = others;
  needed.push_back(frame);
  double done = 0.0;
  const auto lacking = std::count_if(needed.begin(), needed.end(), [&](int each) { return !drawn_.contains(each); });
  for (const int each : needed) {
    if (drawn_.contains(each)) continue;
    const auto part = [&](double fraction) { return !monitor || monitor((done + fraction) / (double(lacking) + 1.0)); };
    auto made = draw_technique(device_, scene_, frames_.plan(each), times, part);
    if (!made) return made.error();
    drawn_.emplace(each, std::move(*made));
    ++done;
  }
  const Frame& own = drawn_.at(frame);
  Frame joined = device_.branch(own);
  const Effect& steady = effect_with<SteadyParams>();
  const Plan plan = frames_.plan(frame);
  ParameterBytes bytes = params_of(plan.recipe.settings, steady.name);
  auto& params = as<SteadyParams>(bytes);
  const std::vector<std::string> planes = device_.plane_names(own);
  params.light = contains(planes, "indirect.r");
  std::vector<std::string> read = {"depth", "normal.x", "normal.y", "normal.z", "ao"};
  if (params.light) read.insert(read.end(), {"indirect.r", "indirect.g", "indirect.b"});
  params.begin = 1;
  if (contains(planes, "ao"))
    for (const int other : others) {
      const Frame& from = drawn_.at(other);
      if (auto added = device_.add_planes_of(from, read, joined); !added) return added.error();
      joined.info.other_camera = from.info.camera;
      if (auto state = device_.run(steady, bytes, joined); !state) return state.error();
      params.begin = 0;
    }
  times.done("steady");
  const auto rest = [&](double fraction) {
    return !monitor || monitor((double(lacking) + fraction) / (double(lacking) + 1.0));
  };
  return draw_after_technique(device_, scene_, plan, joined, times, rest, stops, more);
}

}  // namespace umbrage
