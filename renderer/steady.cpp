#include "renderer/steady.h"

#include <algorithm>

#include "core/lists.h"
#include "effects/effects.h"
#include "effects/steady/steady.h"
#include "rays/shadow_lights.h"

namespace umbrage {

namespace {

constexpr int kSpare = 2;  // frames that are kept beyond a window, since threads may ask for frames out of order

/// The planes that `steady` joins.
constexpr std::array<std::string_view, 4> kPlaces = {"ao", "indirect.r", "indirect.g", "indirect.b"};

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

/// Returns the planes of the soft shadows of a frame.
std::vector<std::string> soft_shadows(const Device& device, const Frame& frame) {
  const std::vector<std::string> available = device.plane_names(frame);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < std::min(frame.info.lights.size(), std::size_t(kMaxShadows)); ++k)
    if (const Light& light = frame.info.lights[k]; casts_visible_shadow(light) && light_size(light) > 0.0f)
      if (contains(available, shadow_plane(int(k)))) names.push_back(shadow_plane(int(k)));
  return names;
}

/// Returns whether the lights with soft shadows of two frames are in one place of the world, but for a small part of
/// their size.
bool share_lights(const PictureInfo& a, const PictureInfo& b) {
  constexpr float kFraction = 0.25f;
  if (a.lights.size() != b.lights.size()) return false;
  // From one view space to the other; in double precision, since scenes may be far from the origin.
  const glm::mat4 turn(glm::dmat4(b.camera.view_from_world) * glm::inverse(glm::dmat4(a.camera.view_from_world)));
  for (std::size_t k = 0; k < a.lights.size(); ++k) {
    const Light &here = a.lights[k], &there = b.lights[k];
    if (here.kind != there.kind) return false;
    if (!casts_visible_shadow(here) || light_size(here) == 0.0f) continue;
    const bool is_point = here.kind == LightKind::kPoint;
    const glm::vec3 moved = is_point ? glm::vec3(turn * glm::vec4(here.position, 1.0f)) - there.position
                                     : glm::mat3(turn) * here.direction - there.direction;
    if (!(glm::length(moved) <= kFraction * light_size(here))) return false;
  }
  return true;
}

/// Returns a frame in which these planes, at most four, take the places of those that `steady` joins.
Result<Frame> in_place_of_joined(Device& device, const Frame& frame, const std::vector<std::string>& names) {
  GBuffer gbuffer{frame.info, {}};
  gbuffer.info.more_layers.clear();
  Frame whole = frame;
  whole.info.guard = 0;
  std::vector<std::string> read = {"depth", "normal.x", "normal.y", "normal.z"}, places = read;
  for (std::size_t k = 0; k < kPlaces.size(); ++k) {
    read.push_back(names[std::min(k, names.size() - 1)]);
    places.emplace_back(kPlaces[k]);
  }
  auto planes = device.view(whole, read);
  if (!planes) return planes.error();
  planes->names = places;
  gbuffer.layers.push_back(std::move(*planes));
  return device.upload(std::move(gbuffer));
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

bool can_be_steady(const Recipe& recipe) {
  const Effect* technique = find_effect(recipe.occlusion);
  return technique && !technique->noise.empty() && (technique->filters_itself || recipe.frames == 1);
}

SteadyFrames frames_of_still_scene(Device& device, const Scene& scene, std::function<Plan(int frame)> plan) {
  return {
      .recipe = plan(0).recipe,
      .draw_technique =
          [&device, &scene, plan](int frame, StageTimes& times, const ProgressMonitor& monitor) {
            return umbrage::draw_technique(device, scene, plan(frame), times, monitor);
          },
      .draw_rest =
          [&device, &scene, plan](int frame, const Frame& technique, StageTimes& times, const ProgressMonitor& monitor,
                                  std::optional<float> stops, const Continuation& more) {
            return draw_after_technique(device, scene, plan(frame), technique, times, monitor, stops, more);
          }};
}

SteadySequence::SteadySequence(Device& device, SteadyFrames frames)
    : device_(device),
      frames_(std::move(frames)),
      technique_(filtered_technique(frames_.recipe)),
      after_(technique_ && !frames_.add_there ? std::min(frames_.reach, 1) : frames_.reach),
      before_(frames_.reach - after_) {}

int SteadySequence::frames_after(int frame, int other) const {
  const int distance = other - frame;
  return frames_.is_closed ? (distance % frames_.count + frames_.count) % frames_.count : distance;
}

std::vector<int> SteadySequence::neighbours(int frame, int reach) const {
  if (frames_.neighbours) return frames_.neighbours(frame, reach);
  std::vector<int> found;
  for (int distance = 1; distance <= reach; ++distance)
    for (const int beside : {frame - distance, frame + distance}) {
      if (frames_.only_past && beside > frame) continue;
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
  std::erase_if(drawn_, [&](const auto& entry) {
    const bool is_outside = !is_ahead(entry.first, frame) && !is_ahead(frame, entry.first);
    if (is_outside && frames_.release) frames_.release(entry.first);
    return is_outside;
  });
}

Result<void> SteadySequence::finish(Neighbour& drawn) {
  if (drawn.is_finished) return {};
  for (Frame* frame : {drawn.filtered ? &*drawn.filtered : nullptr, &drawn.frame}) {
    if (!frame) continue;
    std::vector<std::string> names = joined_planes(device_, *frame);
    if (frame == &drawn.frame && !frames_.add_there)
      for (std::string& shadow : soft_shadows(device_, *frame)) names.push_back(std::move(shadow));
    auto planes = device_.download_with_guard(*frame, names);
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
    auto made = frames_.draw_technique(frames[k], times, part);
    if (!made) return made.error();
    Neighbour& drawn = drawn_.emplace(frames[k], Neighbour{std::move(*made)}).first->second;
    if (!is_ahead(frames[k], frame) && !contains(near, frames[k]))
      if (auto done = finish(drawn); !done) return done;
  }
  return {};
}

Result<Frame> SteadySequence::joined(int frame, const Frame& own, const Others& others, bool by_samples,
                                     const ProgressMonitor& monitor) {
  const Effect& steady = effect_with<SteadyParams>();
  ParameterBytes bytes = params_of(frames_.recipe.settings, steady.name);
  auto& params = as<SteadyParams>(bytes);
  Frame joined = device_.branch(own);
  if (!contains(device_.plane_names(own), "ao")) return joined;  // the picture shows no occlusion
  const std::vector<std::string> names = joined_planes(device_, own);
  params.light = contains(names, "indirect.r");
  params.weight = by_samples ? kSteadyRays : kSteadyEqual;
  params.motion = frames_.add_there ? kMotionOfPlanes : kMotionOfCamera;
  params.begin = 1;
  for (const auto& [index, other] : others) {
    if (frames_.add_there)
      if (auto added = frames_.add_there(frame, index, joined); !added) return added.error();
    if (auto added = device_.add_planes_of(*other, names, joined); !added) return added.error();
    joined.info.other_camera = other->info.camera;
    if (auto state = device_.run(steady, bytes, joined, {}, monitor); !state) return state.error();
    params.begin = 0;
  }
  device_.release(joined, temporary_planes());
  return joined;
}

Result<void> SteadySequence::join_shadows(int frame, Frame& branch, const ProgressMonitor& monitor) {
  if (frames_.recipe.capture.shadow_rays == 0) return {};  // they have no noise
  if (frames_.add_there) return {};  // shadows move otherwise than the surfaces on which they fall
  const std::vector<std::string> shadows = soft_shadows(device_, branch);
  Others sharing;
  for (const int other : neighbours(frame, frames_.reach))
    if (const Frame& drawn = drawn_.at(other).frame; share_lights(branch.info, drawn.info))
      sharing.emplace_back(other, &drawn);
  if (sharing.empty()) return {};
  for (std::size_t first = 0; first < shadows.size(); first += kPlaces.size()) {
    const std::size_t last = std::min(first + kPlaces.size(), shadows.size());
    const std::vector<std::string> names(shadows.begin() + long(first), shadows.begin() + long(last));
    const auto own = in_place_of_joined(device_, branch, names);
    if (!own) return own.error();
    std::vector<Frame> frames;
    for (const auto& [index, other] : sharing) {
      auto renamed = in_place_of_joined(device_, *other, names);
      if (!renamed) return renamed.error();
      frames.push_back(std::move(*renamed));
    }
    Others others;
    for (std::size_t k = 0; k < frames.size(); ++k) others.emplace_back(sharing[k].first, &frames[k]);
    const auto made = joined(frame, *own, others, false, monitor);
    if (!made) return made.error();
    const std::vector<std::string> places(kPlaces.begin(), kPlaces.begin() + long(names.size()));
    auto planes = device_.download_with_guard(*made, places);
    if (!planes) return planes.error();
    planes->names = names;
    if (auto added = device_.add(std::move(*planes), branch); !added) return added;
  }
  return {};
}

Result<void> SteadySequence::filter(int frame, const ProgressMonitor& monitor) {
  Neighbour& own = drawn_.at(frame);
  if (own.filtered) return {};
  Others others;
  for (const int other : neighbours(frame, before_)) others.emplace_back(other, &drawn_.at(other).frame);
  auto made = joined(frame, own.frame, others, technique_ != nullptr, monitor);
  if (!made) return made.error();
  if (technique_ && contains(device_.plane_names(*made), "ao")) {
    const int frames = int(others.size()) + 1;
    const ParameterBytes params =
        params_of_filter(*technique_, frames, params_of(frames_.recipe.settings, technique_->name));
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
  Others others;
  for (const int other : near) {
    if (auto done = filter(other, still); !done) return done.error();
    others.emplace_back(other, &*drawn_.at(other).filtered);
  }
  Neighbour& own = drawn_.at(frame);
  auto start = joined(frame, *own.filtered, others, false, still);
  if (!start) return start.error();
  if (auto done = join_shadows(frame, *start, still); !done) return done.error();
  times.done(effect_with<SteadyParams>().name);
  auto drawn = frames_.draw_rest(frame, *start, times, part(0.5), stops, more);
  for (auto& [each, other] : drawn_)
    if (each == frame || !is_ahead(each, frame))
      if (auto done = finish(other); !done) return done.error();
  return drawn;
}

}  // namespace umbrage
