#include "renderer/steady.h"

#include <algorithm>

#include "core/lists.h"
#include "effects/effects.h"
#include "effects/steady/steady.h"

namespace umbrage {

namespace {

constexpr int kSpare = 2;  // frames that are kept beyond a window, since threads may ask for frames out of order

/// Returns the planes of other frames that `steady` reads, by their names there.
std::vector<std::string> planes_of_others() {
  const std::string start = other_plane("");
  std::vector<std::string> names;
  for (const Dispatch& dispatch : effect_with<SteadyParams>().dispatches)
    for (const std::string_view input : dispatch.inputs)
      if (input.starts_with(start) && !contains(names, input.substr(start.size())))
        names.emplace_back(input.substr(start.size()));
  return names;
}

/// Returns those of them that a frame has.
std::vector<std::string> joined_planes(const Device& device, const Frame& frame) {
  const std::vector<std::string> available = device.plane_names(frame);
  std::vector<std::string> names = planes_of_others();
  std::erase_if(names, [&](const std::string& name) { return !contains(available, name); });
  return names;
}

/// Returns the planes that only the joins of one frame read: those of other frames, and what `steady` writes besides.
std::vector<std::string> temporary_planes() {
  const std::vector<std::string> read = planes_of_others();
  std::vector<std::string> names;
  for (const std::string& name : read) names.push_back(other_plane(name));
  for (const Dispatch& dispatch : effect_with<SteadyParams>().dispatches)
    for (const std::string_view output : dispatch.outputs)
      if (!contains(read, output) && !contains(names, output)) names.emplace_back(output);
  return names;
}

}  // namespace

double steady_memory(const Plan& plan, int reach) {
  constexpr double kOfTechnique = 12.0;  // planes that it and its filter write
  const double light = 2.0 * double(planes_of_others().size()), full = double(plan.given.names.size()) + kOfTechnique;
  const double planes = (reach + 2.0) * full + (reach + double(kSpare)) * light;
  return planes * double(sizeof(float)) * double(plan.info.width) * double(plan.info.height);
}

SteadySequence::SteadySequence(Device& device, const Scene& scene, SteadyFrames frames)
    : device_(device),
      scene_(scene),
      frames_(std::move(frames)),
      recipe_(frames_.plan(0).recipe),
      technique_(filtered_technique(recipe_)),
      after_(technique_ ? std::min(frames_.reach, 1) : frames_.reach),
      before_(frames_.reach - after_) {}

int SteadySequence::frames_after(int frame, int other) const {
  const int distance = other - frame;
  return frames_.is_closed ? (distance % frames_.count + frames_.count) % frames_.count : distance;
}

std::vector<int> SteadySequence::neighbours(int frame, int reach) const {
  std::vector<int> found;
  for (int distance = 1; distance <= reach; ++distance)
    for (const int beside : {frame - distance, frame + distance}) {
      const int other = frames_after(0, beside);
      const bool inside = other >= 0 && other < frames_.count;
      if (inside && other != frame && !contains(found, other)) found.push_back(other);
    }
  return found;
}

bool SteadySequence::is_ahead(int other, int frame) const {
  const int after = frames_after(frame, other);
  return after >= 0 && after <= frames_.reach + kSpare;
}

void SteadySequence::release_frames(int frame) {
  std::erase_if(drawn_,
                [&](const auto& entry) { return !is_ahead(entry.first, frame) && !is_ahead(frame, entry.first); });
}

Result<void> SteadySequence::finish(Neighbour& drawn) {
  if (drawn.is_finished) return {};
  for (Frame* frame : {drawn.filtered ? &*drawn.filtered : nullptr, &drawn.frame}) {
    if (!frame) continue;
    auto planes = device_.download_with_guard(*frame, joined_planes(device_, *frame));
    if (!planes) return planes.error();
    GBuffer gbuffer{frame->info, {}};
    gbuffer.info.more_layers.clear();
    gbuffer.layers.push_back(std::move(*planes));
    auto copy = device_.upload(std::move(gbuffer));
    if (!copy) return copy.error();
    *frame = std::move(*copy);
  }
  drawn.is_finished = true;
  return {};
}

Result<void> SteadySequence::draw_lacking(int frame, StageTimes& times, const ProgressMonitor& monitor) {
  std::vector<int> frames = neighbours(frame, frames_.reach);
  frames.push_back(frame);
  const std::vector<int> near = neighbours(frame, after_);
  std::erase_if(frames, [&](int each) { return drawn_.contains(each); });
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto part = [&](double fraction) {
      return !monitor || monitor((double(k) + fraction) / double(frames.size()));
    };
    auto made = draw_technique(device_, scene_, frames_.plan(frames[k]), times, part);
    if (!made) return made.error();
    Neighbour& drawn = drawn_.emplace(frames[k], Neighbour{std::move(*made)}).first->second;
    if (!is_ahead(frames[k], frame) && !contains(near, frames[k]))
      if (auto done = finish(drawn); !done) return done;
  }
  return {};
}

Result<Frame> SteadySequence::joined(const Frame& own, const std::vector<const Frame*>& others, bool by_samples,
                                     const ProgressMonitor& monitor) {
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
    if (auto state = device_.run(steady, bytes, joined, {}, monitor); !state) return state.error();
    params.begin = 0;
  }
  device_.release(joined, temporary_planes());
  return joined;
}

Result<void> SteadySequence::filter(int frame, const ProgressMonitor& monitor) {
  Neighbour& own = drawn_.at(frame);
  if (own.filtered) return {};
  std::vector<const Frame*> others;
  for (const int other : neighbours(frame, before_)) others.push_back(&drawn_.at(other).frame);
  auto made = joined(own.frame, others, technique_ != nullptr, monitor);
  if (!made) return made.error();
  if (technique_ && contains(device_.plane_names(*made), "ao")) {
    const int frames = int(others.size()) + 1;
    const ParameterBytes params = params_of_filter(*technique_, frames, params_of(recipe_.settings, technique_->name));
    if (auto state = device_.run(*technique_, params, *made, {}, monitor); !state) return state.error();
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
  // Frames that come out of order may have too few planes.
  const std::vector<int> near = neighbours(frame, after_);
  std::erase_if(drawn_, [&](const auto& entry) {
    const auto& [each, drawn] = entry;
    return drawn.is_finished && (each == frame || (contains(near, each) && !drawn.filtered));
  });
  if (auto drawn = draw_lacking(frame, times, part(0.0)); !drawn) return drawn.error();
  const auto still = [&](double) { return !monitor || monitor(0.5); };
  if (auto done = filter(frame, still); !done) return done.error();
  std::vector<const Frame*> others;
  for (const int other : near) {
    if (auto done = filter(other, still); !done) return done.error();
    others.push_back(&*drawn_.at(other).filtered);
  }
  Neighbour& own = drawn_.at(frame);
  auto start = joined(*own.filtered, others, false, still);
  if (!start) return start.error();
  times.done(effect_with<SteadyParams>().name);
  Plan plan = frames_.plan(frame);
  if (frames_.complete)
    if (auto done = frames_.complete(frame, plan, times, still); !done) return done.error();
  auto drawn = draw_after_technique(device_, scene_, plan, *start, times, part(0.5), stops, more);
  for (auto& [each, other] : drawn_)
    if (each == frame || !is_ahead(each, frame))
      if (auto done = finish(other); !done) return done.error();
  return drawn;
}

}  // namespace umbrage
