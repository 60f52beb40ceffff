#include "renderer/moving.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <map>

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

/// Where the surface points of a picture are in another one of the moved scene: see effects/steady.
class Placement {
 public:
  Placement(const PictureInfo& here, const PictureInfo& there)
      : here_(here),
        there_(there),
        orthographic_(there.camera.projection == Projection::kOrthographic),
        turn_(glm::dmat4(there.camera.view_from_world) * glm::inverse(glm::dmat4(here.camera.view_from_world))) {}

  /// Returns column, row and depth in the other picture of the point that pixel (x, y) shows at this depth, and that
  /// moves by `change` in world space. A depth of 0: not in front of the camera.
  glm::vec3 of(int x, int y, float depth, glm::vec3 change) const {
    const float spread = orthographic_ ? 1.0f : depth;
    const glm::vec4 seen((here_.camera.left + (float(x) + 0.5f) * here_.pixel_width()) * spread,
                         (here_.camera.top - (float(y) + 0.5f) * here_.pixel_height()) * spread, -depth, 1.0f);
    const glm::vec4 p = turn_ * seen + there_.camera.view_from_world * glm::vec4(change, 0.0f);
    const float away = orthographic_ ? 1.0f : -p.z;
    if (!(away > 0.0f)) return glm::vec3(0.0f);
    return {(p.x / away - there_.camera.left) / there_.pixel_width() - 0.5f,
            (there_.camera.top - p.y / away) / there_.pixel_height() - 0.5f, -p.z};
  }

 private:
  const PictureInfo &here_, &there_;
  const bool orthographic_;
  const glm::mat4 turn_;
};

/// A frame that was drawn up to its technique.
struct Kept {
  std::shared_ptr<const Scene> scene;  ///< until the frame is drawn
  Plan plan;
  PictureInfo info;
  std::vector<MeshPoint> points;  ///< of its pixels, row by row
  Positions positions;
  Plane depth;

  const MeshPoint& point(int x, int y) const {
    return points[std::size_t(y) * std::size_t(info.width) + std::size_t(x)];
  }
};

class MovingScene {
 public:
  MovingScene(Device& device, int reach, std::function<Result<MovingFrame>(int)> frame)
      : device_(device), reach_(reach), frame_(std::move(frame)) {}

  Result<Frame> draw_technique(int frame, StageTimes& times, const ProgressMonitor& monitor) {
    auto moved = frame_(frame);
    if (!moved) return moved.error();
    Kept& kept = kept_[frame] = {std::move(moved->scene), std::move(moved->plan), {}, {}, {}, {}};
    for (const Mesh& mesh : kept.scene->meshes) kept.positions.push_back(mesh.positions);
    if (auto ready = prepare(kept, monitor); !ready) return ready.error();
    times.done("prepare");
    auto drawn = umbrage::draw_technique(device_, *kept.scene, kept.plan, times, monitor);
    if (!drawn) return drawn;
    kept.info = drawn->info;
    Frame whole = *drawn;
    whole.info.guard = 0;
    auto depth = device_.download(whole, {"depth"});
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

  Result<void> add_there(int frame, int other, Frame& branch) const {
    const Kept& here = kept_.at(frame);
    Image image(here.info.width, here.info.height);
    for (const char* name : {"there.x", "there.y", "there.z"}) image.add(name) = Plane(image.width, image.height, 0.0f);
    tbb::task_arena arena(device_.threads());
    arena.execute([&] {
      tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
          if (!here.point(x, y).is_known || is_covered(frame, x, y)) continue;
          const glm::vec3 place = place_in(here, kept_.at(other), x, y);
          for (int k = 0; k < 3; ++k) image.planes[std::size_t(k)].at(x, y) = place[k];
        }
      });
    });
    return device_.add(std::move(image), branch);
  }

  void release(int frame) { kept_.erase(frame); }

 private:
  /// Returns where a frame shows the surface point of a pixel of another one: as Placement::of.
  static glm::vec3 place_in(const Kept& here, const Kept& there, int x, int y) {
    const MeshPoint& point = here.point(x, y);
    if (there.info.camera.projection != here.info.camera.projection || point.mesh >= there.positions.size())
      return glm::vec3(0.0f);
    const Mesh& mesh = here.scene->meshes[point.mesh];
    const std::vector<glm::vec3>& moved = there.positions[point.mesh];
    if (mesh.positions.size() != moved.size()) return glm::vec3(0.0f);
    const glm::vec3 change = position_of(point, mesh, moved) - position_of(point, mesh, mesh.positions);
    return Placement(here.info, there.info).of(x, y, here.depth.at(x, y), change);
  }

  /// Returns whether another mesh covers the surface point of a pixel in a frame of the window: occlusion is another
  /// there, and changes fast.
  bool is_covered(int frame, int x, int y) const {
    constexpr float kInFront = 0.99f;
    const Kept& here = kept_.at(frame);
    for (auto at = kept_.lower_bound(frame - reach_); at != kept_.end() && at->first <= frame + reach_; ++at) {
      const Kept& there = at->second;
      const glm::vec3 place = place_in(here, there, x, y);
      if (!(place.z > 0.0f && place.x >= 0.0f && place.y >= 0.0f && place.x < float(there.info.width - 1) &&
            place.y < float(there.info.height - 1)))
        continue;
      const int column = int(place.x + 0.5f), row = int(place.y + 0.5f);
      if (there.depth.at(column, row) < kInFront * place.z && there.point(column, row).mesh != here.point(x, y).mesh)
        return true;
    }
    return false;
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
    return trace_surfaces(
        **traced, kept.info, {.threads = device_.threads()}, [&](int x, int y, const Surface& surface) {
          kept.points[std::size_t(y) * std::size_t(kept.info.width) + std::size_t(x)] = {
              unsigned(surface.mesh - kept.scene->meshes.data()), surface.triangle, surface.u, surface.v, true};
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
