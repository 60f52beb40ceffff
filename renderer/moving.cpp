#include "renderer/moving.h"

#include <tbb/task_arena.h>

#include <cstdint>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <map>

#include "core/rows.h"
#include "reference/trace.h"

namespace umbrage {

namespace {

using Positions = std::vector<std::vector<glm::vec3>>;  // of the vertices of each mesh

/// A point of a mesh: of the triangle or the disc that a pixel shows.
struct MeshPoint {
  unsigned mesh = 0, triangle = 0;
  float u = 0.0f, v = 0.0f;  // weights of the second and third vertex
  bool is_known = false;
};

/// Returns a point of a mesh with these positions of the vertices; for a disc its centre.
glm::vec3 position_of(const MeshPoint& point, const Mesh& mesh, const std::vector<glm::vec3>& positions) {
  if (mesh.points) return positions[point.triangle];
  const std::uint32_t* i = mesh.indices.data() + std::size_t(point.triangle) * 3;
  return positions[i[0]] * (1.0f - point.u - point.v) + positions[i[1]] * point.u + positions[i[2]] * point.v;
}

/// A frame that was drawn up to its technique.
struct Kept {
  std::shared_ptr<const Scene> scene;  ///< until the frame is drawn
  Plan plan;
  PictureInfo info;
  std::vector<MeshPoint> points;  ///< of its pixels, row by row
  Positions positions;
  Plane depth;
  std::vector<std::uint8_t> covered;  ///< of its pixels: see MovingScene::find_covered; empty: not found yet

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(info.width) + std::size_t(x); }
  const MeshPoint& point(int x, int y) const { return points[index(x, y)]; }
};

/// Where the surface points of a frame are in another one: see effects/steady.
class Placement {
 public:
  Placement(const Kept& here, const Kept& there)
      : here_(here),
        there_(there),
        orthographic_(there.info.camera.projection == Projection::kOrthographic),
        turn_(glm::dmat4(there.info.camera.view_from_world) *
              glm::inverse(glm::dmat4(here.info.camera.view_from_world))) {}

  /// Returns column, row and depth in the other frame of the point that pixel (x, y) shows. A depth of 0: not known, or
  /// not in front of the camera.
  glm::vec3 of(int x, int y) const {
    const PictureInfo &here = here_.info, &there = there_.info;
    const MeshPoint& point = here_.point(x, y);
    if (there.camera.projection != here.camera.projection || point.mesh >= there_.positions.size())
      return glm::vec3(0.0f);
    const Mesh& mesh = here_.scene->meshes[point.mesh];
    const std::vector<glm::vec3>& moved = there_.positions[point.mesh];
    if (mesh.positions.size() != moved.size()) return glm::vec3(0.0f);
    const glm::vec3 change = position_of(point, mesh, moved) - position_of(point, mesh, mesh.positions);
    const float depth = here_.depth.at(x, y), spread = orthographic_ ? 1.0f : depth;
    const glm::vec4 seen((here.camera.left + (float(x) + 0.5f) * here.pixel_width()) * spread,
                         (here.camera.top - (float(y) + 0.5f) * here.pixel_height()) * spread, -depth, 1.0f);
    const glm::vec4 p = turn_ * seen + there.camera.view_from_world * glm::vec4(change, 0.0f);
    const float away = orthographic_ ? 1.0f : -p.z;
    if (!(away > 0.0f)) return glm::vec3(0.0f);
    return {(p.x / away - there.camera.left) / there.pixel_width() - 0.5f,
            (there.camera.top - p.y / away) / there.pixel_height() - 0.5f, -p.z};
  }

 private:
  const Kept &here_, &there_;
  const bool orthographic_;
  const glm::mat4 turn_;
};

class MovingScene {
 public:
  MovingScene(Device& device, int reach, std::function<Result<MovingFrame>(int)> frame)
      : device_(device), reach_(reach), frame_(std::move(frame)) {}

  Result<Frame> draw_technique(int frame, StageTimes& times, const ProgressMonitor& monitor) {
    auto moved = frame_(frame);
    if (!moved) return moved.error();
    Kept& kept = kept_[frame] = {std::move(moved->scene), std::move(moved->plan), {}, {}, {}, {}, {}};
    for (const Mesh& mesh : kept.scene->meshes) kept.positions.push_back(mesh.positions);
    if (auto ready = prepare(kept, monitor); !ready) return ready.error();
    times.done("prepare");
    auto drawn = umbrage::draw_technique(device_, *kept.scene, kept.plan, times, monitor);
    if (!drawn) return drawn;
    kept.info = drawn->info;
    auto depth = device_.download_with_guard(*drawn, {"depth"});
    if (!depth) return depth.error();
    kept.depth = std::move(depth->planes[0]);
    if (auto found = find_points(kept, monitor); !found) return found.error();
    times.done("motion");
    return drawn;
  }

  Result<Drawn> draw_rest(int frame, const Frame& technique, StageTimes& times, const ProgressMonitor& monitor,
                          std::optional<float> stops, const Continuation& more) {
    Kept& kept = kept_.at(frame);
    if (auto ready = prepare(kept, monitor); !ready) return ready.error();
    auto drawn = draw_after_technique(device_, *kept.scene, kept.plan, technique, times, monitor, stops, more);
    // Frames before it are not drawn any more; others read no more of them than where their vertices are.
    for (auto& [each, earlier] : kept_)
      if (each <= frame) earlier.scene.reset();
    return drawn;
  }

  Result<void> add_there(int frame, int other, Frame& branch) {
    Kept& here = kept_.at(frame);
    if (here.covered.empty()) find_covered(frame);
    Image image(here.info.width, here.info.height);
    for (const char* name : {"there.x", "there.y", "there.z"}) image.add(name) = Plane(image.width, image.height, 0.0f);
    const Placement placement(here, kept_.at(other));
    for_pixels(here, [&](int x, int y, std::size_t pixel) {
      if (here.covered[pixel] != 0) return;
      const glm::vec3 place = placement.of(x, y);
      for (int k = 0; k < 3; ++k) image.planes[std::size_t(k)].at(x, y) = place[k];
    });
    return device_.add(std::move(image), branch);
  }

  void release(int frame) { kept_.erase(frame); }

 private:
  /// Calls work(x, y, index) for the pixels of a frame whose points are known, in parallel.
  template <class Work>
  void for_pixels(const Kept& kept, const Work& work) const {
    tbb::task_arena arena(device_.threads());
    arena.execute([&] {
      for_rows(0, kept.info.height, [&](int y) {
        for (int x = 0; x < kept.info.width; ++x)
          if (kept.point(x, y).is_known) work(x, y, kept.index(x, y));
      });
    });
  }

  /// Finds the pixels whose surface points another mesh covers in a frame of the window: occlusion is another there,
  /// and changes fast.
  void find_covered(int frame) {
    constexpr float kInFront = 0.99f;
    Kept& here = kept_.at(frame);
    here.covered.assign(here.points.size(), 0);
    for (auto at = kept_.lower_bound(frame - reach_); at != kept_.end() && at->first <= frame + reach_; ++at) {
      const Kept& there = at->second;
      const Placement placement(here, there);
      for_pixels(here, [&](int x, int y, std::size_t pixel) {
        const glm::vec3 place = placement.of(x, y);
        if (!(place.z > 0.0f && place.x >= 0.0f && place.y >= 0.0f && place.x < float(there.info.width - 1) &&
              place.y < float(there.info.height - 1)))
          return;
        const int column = int(place.x + 0.5f), row = int(place.y + 0.5f);
        if (there.depth.at(column, row) < kInFront * place.z &&
            there.point(column, row).mesh != here.points[pixel].mesh)
          here.covered[pixel] = 1;
      });
    }
  }

  /// Prepares the device for a frame.
  Result<void> prepare(const Kept& kept, const ProgressMonitor& monitor) {
    if (prepared_ == kept.scene) return {};
    device_.release_scene();
    prepared_ = nullptr;
    if (auto ready = device_.prepare(*kept.scene, monitor); !ready) return ready;
    prepared_ = kept.scene;
    return {};
  }

  /// Finds what the pixels show.
  Result<void> find_points(Kept& kept, const ProgressMonitor& monitor) const {
    const auto traced = build_traced_scene(*kept.scene, device_.threads(), monitor);
    if (!traced) return traced.error();
    kept.points.resize(std::size_t(kept.info.width) * std::size_t(kept.info.height));
    return trace_surfaces(**traced, kept.info, {.threads = device_.threads()},
                          [&](int x, int y, const Surface& surface) {
                            kept.points[kept.index(x, y)] = {unsigned(surface.mesh - kept.scene->meshes.data()),
                                                             surface.triangle, surface.u, surface.v, true};
                          });
  }

  Device& device_;
  const int reach_;
  const std::function<Result<MovingFrame>(int)> frame_;
  std::map<int, Kept> kept_;
  std::shared_ptr<const Scene> prepared_;
};

}  // namespace

SteadyFrames frames_of_moving_scene(Device& device, Recipe recipe, int reach,
                                    std::function<Result<MovingFrame>(int frame)> frame) {
  const auto scene = std::make_shared<MovingScene>(device, reach, std::move(frame));
  SteadyFrames frames;
  frames.reach = reach;
  frames.recipe = std::move(recipe);
  frames.draw_technique = std::bind_front(&MovingScene::draw_technique, scene);
  frames.draw_rest = std::bind_front(&MovingScene::draw_rest, scene);
  frames.add_there = std::bind_front(&MovingScene::add_there, scene);
  frames.release = std::bind_front(&MovingScene::release, scene);
  return frames;
}

}  // namespace umbrage
