#include "renderer/steady_shading.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "core/lists.h"
#include "core/rows.h"
#include "gbuffers/conventions.h"

namespace umbrage {
namespace {

/// Returns a hash of what a picture depends on.
std::uint64_t print_of(const GBuffer& gbuffer) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](float v) { hash = std::rotl((hash ^ std::bit_cast<std::uint32_t>(v)) * 0x100000001b3u, 23); };
  const Camera& camera = gbuffer.info.camera;
  for (const float v : {camera.left, camera.right, camera.bottom, camera.top}) add(v);
  for (int k = 0; k < 16; ++k) add(camera.view_from_world[k / 4][k % 4]);
  for (const Plane& plane : gbuffer.layers[0].planes)
    for (int y = 0; y < plane.height; ++y) std::for_each_n(plane.row(y), plane.width, add);
  return hash;
}

}  // namespace

double window_memory(const GBufferFile& file, int reach) {
  constexpr double kOfTechnique = 12.0, kOfFlow = 12.0;
  const double window = 2.0 * reach + 3.0, planes = double(file.plane_names().size()) + kOfTechnique + kOfFlow;
  return window * planes * sizeof(float) * double(file.info().width) * double(file.info().height);
}

Result<SequenceStart> SteadyShading::begin(int number, const GBufferFile& file) {
  constexpr int kMaxPairs = 8;  // of frames, of which the first may show no motion
  start_ = start_of(file.info(), 0.0f);
  start_.stops.reset();
  auto conventions = std::make_shared<Conventions>(file.conventions());
  start_.conventions = conventions;
  width_ = file.info().width, height_ = file.info().height;
  std::vector<MotionMeanings>& pairs = conventions->motion;
  std::vector<bool> fit(pairs.size(), false);
  const auto is_open = [&] {
    return std::any_of(pairs.begin(), pairs.end(), [](const MotionMeanings& all) { return all.size() > 1; });
  };
  if (!is_open()) return start_;
  const auto first = std::lower_bound(frames_.numbers.begin(), frames_.numbers.end(), number);
  std::optional<std::pair<Image, Image>> here;  // planes and stored motion
  bool compared = false;
  for (auto at = first; at != frames_.numbers.end() && at - first <= kMaxPairs && is_open(); ++at) {
    const auto next = frames_.open(*at, conventions.get());
    if (!next || next->info().width != width_ || next->info().height != height_) break;
    auto planes = next->rows({0, height_}), stored = next->stored_motion();
    if (!planes || !stored || stored->planes.size() != 2 * pairs.size()) break;
    std::pair now(std::move(*planes), std::move(*stored));
    if (here && *at == *std::prev(at) + 1) {
      const auto fits = narrow_meanings({here->first, here->second}, {now.first, now.second}, pairs);
      for (std::size_t k = 0; k < fits.size(); ++k) fit[k] = fit[k] || fits[k];
      compared = true;
    }
    here = std::move(now);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    MotionMeanings& meanings = pairs[k];
    if (compared && !fit[k] && meanings.size() > 1) {
      meanings.clear();
      frames_.warn(
          "the motion vectors lead to no like surfaces in the frames beside, and are not used: `motion_kind` sets "
          "their meaning");
    }
    if (meanings.size() <= 1) continue;
    frames_.warn(fmt::format("the motion vectors may be {} or {}: the first is taken; `motion_kind` sets another",
                             meanings[0].meaning, meanings[1].meaning));
    meanings.resize(1);
  }
  return start_;
}

Result<std::shared_ptr<SteadyShading::Loaded>> SteadyShading::read(int at) {
  const auto file = frames_.open(frames_.numbers[std::size_t(at)], start_.conventions.get());
  if (!file) return file.error();
  auto planes = file->rows({0, height_});
  auto stored = file->stored_motion();
  if (!planes || !stored) return planes ? stored.error() : planes.error();
  auto loaded = std::make_shared<Loaded>();
  loaded->gbuffer.info = started(file->info(), start_);
  loaded->flow.depth = planes->plane("depth");
  if (file->conventions().has_place) loaded->flow.camera = file->info().camera;
  loaded->flow.motion = motion_planes(*stored, file->conventions().motion);
  loaded->gbuffer.layers.push_back(std::move(*planes));
  prints_[at] = print_of(loaded->gbuffer);
  return loaded;
}

std::shared_ptr<SteadyShading::Loaded> SteadyShading::loaded(int at) {
  if (at < 0 || at >= int(frames_.numbers.size())) return nullptr;
  if (const auto known = loaded_.find(at); known != loaded_.end()) return known->second;
  auto made = read(at);
  const int number = frames_.numbers[std::size_t(at)];
  std::string why;
  if (!made && !contains(frames_.shaded, number)) why = made.error().message;
  if (made && ((*made)->flow.depth.width != width_ || (*made)->flow.depth.height != height_)) {
    why = fmt::format("it has {} x {} pixels, and the first frame {} x {}", (*made)->flow.depth.width,
                      (*made)->flow.depth.height, width_, height_);
    made = file_error("{}", why);
  }
  if (!why.empty()) frames_.warn(fmt::format("frame {} is not joined with others: {}", number, why));
  return loaded_[at] = made ? *made : nullptr;
}

bool SteadyShading::are_equal(int at, int other) {
  for (const int each : {at, other})
    if (!prints_.contains(each) && !loaded(each)) return false;
  return prints_.at(at) == prints_.at(other);
}

int SteadyShading::first_of(int at) {
  while (at > 0 && are_equal(at - 1, at)) loaded_.erase(at--);  // only the first one is used
  return at;
}

int SteadyShading::last_of(int at) {
  while (at + 1 < int(frames_.numbers.size()) && are_equal(at, at + 1)) loaded_.erase(++at);
  return at;
}

const SteadyShading::Link* SteadyShading::link(int at) {
  const auto known = links_.find(at);
  if (known != links_.end()) return known->second ? &*known->second : nullptr;
  std::optional<Link>& made = links_[at];
  const auto here = loaded(at), next = loaded(at + 1);
  if (!here || !next) return nullptr;
  const int number = frames_.numbers[std::size_t(at)], gap = frames_.numbers[std::size_t(at) + 1] - number;
  auto after = gap == 1 ? flow_between(here->flow, next->flow, true) : std::nullopt;
  auto before = after ? flow_between(next->flow, here->flow, false) : camera_flow(next->flow, here->flow);
  const bool by_camera = !after;
  if (by_camera && gap <= frames_.reach) after = camera_flow(here->flow, next->flow);
  if (!after) {
    if (gap == 1)
      frames_.warn(
          "the frames have neither motion vectors nor the place of the camera, by which surfaces are found in the "
          "frames beside: they are not joined");
    return nullptr;
  }
  if (is_cut(*after, here->flow.depth, next->flow.depth)) {
    frames_.warn(fmt::format("after frame {} another scene begins: frames are not joined across this cut", number));
    return nullptr;
  }
  made = Link{std::move(*after), std::move(*before), by_camera};
  return &*made;
}

int SteadyShading::beside(int at, bool after) {
  const int last = after ? last_of(at) : first_of(at) - 1;  // the frame before the change
  if (last < 0 || !link(last)) return -1;
  return after ? last + 1 : first_of(last);
}

const SteadyShading::Way* SteadyShading::way(int at, int steps) {
  if (const auto known = ways_.find({at, steps}); known != ways_.end()) return &known->second;
  const bool after = steps > 0;
  const Way* begin = std::abs(steps) > 1 ? way(at, after ? steps - 1 : steps + 1) : nullptr;
  if (!begin && std::abs(steps) > 1) return nullptr;
  const int here = begin ? begin->frame : at, next = beside(here, after);
  if (next < 0) return nullptr;
  const Link& last = *link(after ? last_of(here) : here - 1);
  const Flow& step = after ? last.after : last.before;
  Way made{next, last.by_camera && (!begin || begin->by_camera), step};
  const auto own = loaded(at), between = loaded(here), there = loaded(next);
  if (!own || !between || !there) return nullptr;  // files may have changed
  if (made.by_camera)
    made.flow = *camera_flow(own->flow, there->flow);
  else if (begin)
    made.flow = composed(begin->flow, step, between->flow.depth);
  return &ways_.emplace(std::pair(at, steps), std::move(made)).first->second;
}

Result<void> SteadyShading::add_there(int at, int other, Frame& branch) {
  const int step = other > at ? 1 : -1;
  int steps = step;
  while (way(at, steps)->frame != other) steps += step;
  const Way& there = *way(at, steps);
  // Occlusion changes where something passes. So a surface that is covered in a frame of the window is joined with
  // none, but one that is outside the picture there is.
  std::vector<std::pair<int, const Way*>> ends;
  for (const int side : {-1, 1}) {
    int last = side * frames_.reach;
    while (last != 0 && !way(at, last)) last -= side;
    if (last != 0 && !there.by_camera) ends.emplace_back(last, way(at, last));
  }
  Image planes(width_, height_);
  planes.add("there.x") = there.flow.x;
  planes.add("there.y") = there.flow.y;
  planes.add("there.z") = there.flow.z;
  const Plane &x = planes.planes[0], &y = planes.planes[1];
  Plane& z = planes.planes[2];
  for_rows(0, height_, [&](int row) {
    for (int column = 0; column < width_; ++column) {
      bool covered = std::isnan(z.at(column, row));
      for (const auto& [last, end] : ends) {
        const float way = float(last) / float(steps), end_x = float(column) + way * (x.at(column, row) - float(column)),
                    end_y = float(row) + way * (y.at(column, row) - float(row));
        const bool inside = end_x > 0.0f && end_y > 0.0f && end_x < float(width_ - 1) && end_y < float(height_ - 1);
        covered = covered || (inside && std::isnan(end->flow.z.at(column, row)));
      }
      if (covered) z.at(column, row) = 0.0f;  // not there
    }
  });
  return device_.add(std::move(planes), branch);
}

SteadyFrames SteadyShading::steady_frames() {
  return {.recipe = recipe_,
          .draw_technique = [this](int at, StageTimes& times, const ProgressMonitor& monitor) -> Result<Frame> {
            auto frame = loaded(at);
            if (!frame || frame->gbuffer.layers.empty()) {
              auto again = read(at);
              if (!again) return again.error();
              frame = *again;
            }
            times.done("read");
            GBuffer gbuffer = std::move(frame->gbuffer);
            frame->gbuffer.layers.clear();
            gbuffer.info = info_of(gbuffer);
            auto recipe = complete_shading(recipe_, gbuffer.info);
            if (!recipe) return recipe.error();
            advance_noise(*recipe, frames_.numbers[std::size_t(at)]);  // noise moves, so that it averages out
            return shade_technique(device_, std::move(gbuffer), *recipe, times, monitor);
          },
          .draw_rest =
              [this](int, const Frame& technique, StageTimes& times, const ProgressMonitor& monitor,
                     std::optional<float> stops, const Continuation&) {
                return shade_after_technique(device_, technique, recipe_, times, monitor, stops);
              },
          .add_there = [this](int at, int other, Frame& branch) { return add_there(at, other, branch); },
          .neighbours =
              [this](int at, int reach) {
                std::vector<int> found;
                int before = at, after = at;
                for (int distance = 1; distance <= reach; ++distance) {
                  if (before >= 0 && (before = beside(before, false)) >= 0) found.push_back(before);
                  if (after >= 0 && (after = beside(after, true)) >= 0) found.push_back(after);
                }
                return found;
              },
          .reach = frames_.reach,
          .count = int(frames_.numbers.size())};
}

Result<SequenceStart> SteadyShading::shade(int number, const GBufferFile& file, const Recipe& recipe,
                                           const std::vector<std::string>& planes, const TakeRows& take,
                                           std::optional<float> stops, StageTimes& times,
                                           const ProgressMonitor& monitor) {
  std::unique_lock lock(mutex_);
  times.last = std::chrono::steady_clock::now();
  const auto place = std::lower_bound(frames_.numbers.begin(), frames_.numbers.end(), number);
  const int own = int(place - frames_.numbers.begin());
  if (!loaded(own)) {
    SequenceStart start = start_;
    start.stops = stops;
    return shade_file(device_, file, recipe, planes, take, start, times, monitor);
  }
  if (!steady_) {
    PictureInfo info = loaded(own)->gbuffer.info;
    auto completed = complete_shading(recipe, info);
    if (!completed) return completed.error();
    recipe_ = std::move(*completed);
    steady_.emplace(device_, steady_frames());
  }
  const int at = first_of(own), kept = 2 * frames_.reach + 3;
  auto drawn = steady_->draw(at, times, monitor, stops, {});
  if (!drawn) return drawn.error();
  const auto picture = device_.download(drawn->frame, planes);
  if (!picture) return picture.error();
  std::erase_if(loaded_, [&](const auto& entry) { return std::abs(entry.first - own) > kept; });
  ways_.clear();
  std::erase_if(links_, [&](const auto& entry) { return std::abs(entry.first - own) > kept; });
  const PictureInfo info = drawn->frame.info;
  const SequenceStart used{start_.scene_radius, drawn->stops.value_or(0.0f), start_.depth_min, start_.depth_max,
                           start_.conventions};
  drawn = Drawn{};
  lock.unlock();
  if (auto taken = reduced_rows(recipe.reduction, recipe, take)(info, *picture, 0); !taken) return taken.error();
  return used;
}

}  // namespace umbrage
