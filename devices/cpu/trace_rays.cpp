#include "devices/cpu/trace_rays.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "core/guarded.h"
#include "core/hash.h"
#include "core/light.h"
#include "rays/camera_rays.h"
#include "rays/hit_light.h"
#include "rays/short_rays.h"

namespace umbrage {
namespace {

constexpr int kBandRows = 4;     // rows that one task traces
constexpr int kBlockWidth = 64;  // pixels whose rays are collected: neighbours, whose rays visit the same nodes
constexpr int kBlockPixels = kBandRows * kBlockWidth;
constexpr int kRun = 8;  // pixels of a row whose rays are added one after the other

/// The planes of a task by name; outputs that the dispatch does not have are null.
struct RayPlanes {
  explicit RayPlanes(const KernelFrame& frame)
      : depth(frame.plane("depth")),
        offset{frame.plane("ray_offset.x"), frame.plane("ray_offset.y"), frame.plane("ray_offset.z")},
        ao(frame.plane("ao")),
        confidence(frame.plane("traced_confidence")) {
    const auto find = [&](std::string_view name) -> float* {
      for (const KernelPlane& plane : frame.planes)
        if (plane.name == name) return plane.data;
      return nullptr;
    };
    bent = {find("bent.x"), find("bent.y"), find("bent.z")};
    indirect = {find("indirect.r"), find("indirect.g"), find("indirect.b")};
  }

  const float* depth;
  std::array<const float*, 3> offset;
  float *ao, *confidence;
  std::array<float*, 3> bent, indirect;
};

/// Traces the rays of a block of pixels.
class RayBlock {
 public:
  /// `lighting` is null if the dispatch gathers no reflected light.
  RayBlock(const RayTask& task, const CameraRays& rays, const RayPlanes& planes, const HitLighting* lighting)
      : task_(task),
        rays_(rays),
        planes_(planes),
        lighting_(lighting),
        to_world_(rays.world_from_view),
        stride_(std::size_t(task.frame.frame.stride)),
        kernel_planes_(task.frame.planes.begin(), task.frame.planes.end()) {
    for (auto& plane : made_) plane.resize(std::size_t(kBandRows) * stride_);
  }

  void trace(int x0, int y0) {
    x0_ = x0;
    y0_ = y0;
    x1_ = std::min(x0 + kBlockWidth, task_.info.width);
    y1_ = std::min(y0 + kBandRows, task_.rows.end);
    open_ = {};
    count_ = {};
    bent_ = {};
    light_ = {};
    KernelFrame frame = task_.frame;
    static constexpr std::string_view kNames[] = {"ray.x", "ray.y", "ray.z"};
    kernel_planes_.resize(task_.frame.planes.size());
    for (std::size_t axis = 0; axis < 3; ++axis)
      kernel_planes_.push_back({kNames[axis], row_zero(made_[axis].data(), frame.frame.stride, y0)});
    frame.planes = kernel_planes_;
    for (int ray = 0; ray < task_.settings.max_rays; ++ray) {
      frame.frame.round = ray_ = ray;
      task_.kernel(frame, {x0, y0, x1_, y1_});
      if (!add_rays()) break;  // pixels have their rays at the first indices
    }
    flush();
    store();
  }

 private:
  std::size_t index_of(int pixel) const {
    return std::size_t(y0_ + pixel / kBlockWidth) * stride_ + std::size_t(x0_ + pixel % kBlockWidth);
  }
  bool contains(int pixel) const { return x0_ + pixel % kBlockWidth < x1_ && y0_ + pixel / kBlockWidth < y1_; }

  /// Adds the rays of one index, those of kRun x 2 pixels at a time. Returns whether there was any.
  bool add_rays() {
    bool any = false;
    for (int y = y0_; y < y1_; y += 2)
      for (int x = x0_; x < x1_; x += kRun) {
        any |= add_run(x, y);
        if (y + 1 < y1_) any |= add_run(x, y + 1);
      }
    return any;
  }

  bool add_run(int x, int y) {
    const std::size_t first = std::size_t(y - y0_) * stride_ + std::size_t(x);
    const int end = std::min(kRun, x1_ - x);
    bool any = false;
    for (int k = 0; k < end; ++k) {
      const std::size_t at = first + std::size_t(k);
      if (made_[0][at] == 0.0f && made_[1][at] == 0.0f && made_[2][at] == 0.0f) continue;
      add_ray(x + k, y, at);
      any = true;
    }
    return any;
  }

  /// `at`: index of the pixel in made_.
  void add_ray(int x, int y, std::size_t at) {
    const std::size_t pixel = at + std::size_t(y0_) * stride_;
    const glm::vec3 offset(planes_.offset[0][pixel], planes_.offset[1][pixel], planes_.offset[2][pixel]);
    const float px = float(x) + 0.5f, py = float(y) + 0.5f;
    const glm::vec3 start = rays_.origin_at(px, py) + rays_.direction_at(px, py) * planes_.depth[pixel] +
                            to_world_ * (offset * task_.traced.scale);
    const glm::vec3 ray(made_[0][at], made_[1][at], made_[2][at]), direction = to_world_ * ray;
    const int in_block = (y - y0_) * kBlockWidth + x - x0_;
    if (!(glm::dot(ray, offset) > 0.0f)) {  // below the triangle: blocked, and without reflected light
      count_[std::size_t(in_block)] += 1.0f;
      add_hidden_sky(in_block, ray, 1.0f);
      return;
    }
    if (!within_ray_limit(start) || !within_ray_limit(direction)) return;
    if (list_.full()) flush();
    list_.add(start, direction, ray_ * kBlockPixels + in_block);
  }

  void flush() {
    if (lighting_)
      gather_light();
    else
      test_occlusion();
    list_.clear();
  }

  /// Adds the result of a ray of the list to its pixel. `blocked`: 1 for an occluder without falloff.
  void add(int k, float blocked) {
    const auto pixel = std::size_t(list_.id(k) % kBlockPixels);
    open_[pixel] += 1.0f - blocked;
    count_[pixel] += 1.0f;
    if (planes_.bent[0]) bent_[pixel] += list_.direction(k) * (1.0f - blocked);
    add_hidden_sky(int(pixel), list_.direction(k) * to_world_, blocked);
  }

  /// Adds what a blocked ray changes in the ambient light of a pixel: see RaySettings::directional. `direction`: in
  /// view space.
  void add_hidden_sky(int pixel, glm::vec3 direction, float blocked) {
    const RaySettings& settings = task_.settings;
    if (settings.directional == 0.0f || !(blocked > 0.0f)) return;
    const std::size_t at = index_of(pixel);
    const glm::vec3 offset(planes_.offset[0][at], planes_.offset[1][at], planes_.offset[2][at]);
    const float size = std::max({std::abs(offset.x), std::abs(offset.y), std::abs(offset.z)});
    if (!(size > 0.0f)) return;
    // Divided by its size first, since the square of a short vector underflows.
    const glm::vec3 whole = sky_radiance(settings.sky, glm::normalize(offset / size), 2.0f / 3.0f, 0.25f);
    light_[std::size_t(pixel)] += (whole - sky_radiance(settings.sky, direction)) * (blocked * settings.directional);
  }

  /// Returns the weight of an occluder at the distance t, if there is one within `length`.
  float blocked_at(float t, float length) const {
    return t < length ? falloff_weight(task_.settings.falloff, t / length) : 0.0f;
  }

  void test_occlusion() {
    const float length = task_.settings.radius * task_.traced.scale;
    const bool distances = task_.settings.falloff != Falloff::kNone;
    if (distances)
      list_.find_distances(task_.traced, length);
    else
      list_.find_blocked(task_.traced, length);
    for (int k = 0; k < list_.size(); ++k)
      add(k, distances ? blocked_at(list_.distance(k), length) : float(list_.blocked(k)));
  }

  /// Does the same as test_occlusion, and adds the light of the surfaces that the rays hit.
  void gather_light() {
    const float length = task_.settings.radius * task_.traced.scale;
    for (int first = 0; first < list_.size(); first += kPacket) {
      const int n = std::min(kPacket, list_.size() - first);
      RayPacket packet;
      std::array<std::uint32_t, kPacket> seeds{};
      for (int k = 0; k < n; ++k) {
        packet.set(k, list_.origin(first + k), list_.direction(first + k), 0.0f, length);
        const int pixel = list_.id(first + k) % kBlockPixels, ray = list_.id(first + k) / kBlockPixels;
        const auto x = std::uint32_t(x0_ + pixel % kBlockWidth), y = std::uint32_t(y0_ + pixel / kBlockWidth);
        seeds[std::size_t(k)] = hash(hash(hash(x, task_.settings.seed), y), std::uint32_t(ray));
      }
      packet.find_hits(task_.traced, Coherence::kIncoherent);
      const PacketLight light = light_of_hits(task_.traced, *lighting_, packet, seeds);
      for (int k = 0; k < n; ++k) {
        const float blocked = packet.hit(k) ? blocked_at(packet.hit_distance(k), length) : 0.0f;
        add(first + k, blocked);
        light_[std::size_t(list_.id(first + k) % kBlockPixels)] +=
            light[std::size_t(k)] * (blocked * task_.settings.light);
      }
    }
  }

  void store() {
    for (int pixel = 0; pixel < kBlockPixels; ++pixel) {
      if (!contains(pixel)) continue;
      const std::size_t at = index_of(pixel), k = std::size_t(pixel);
      planes_.ao[at] = count_[k] > 0.0f ? open_[k] / count_[k] : 1.0f;
      planes_.confidence[at] = count_[k] / (count_[k] + 1.0f);
      if (planes_.bent[0]) {
        const float length = glm::length(bent_[k]);
        store(planes_.bent, at, length > 0.0f ? (bent_[k] / length) * to_world_ : glm::vec3(0.0f));
      }
      if (planes_.indirect[0]) store(planes_.indirect, at, light_[k] / std::max(count_[k], 1.0f));
    }
  }

  static void store(const std::array<float*, 3>& planes, std::size_t at, glm::vec3 v) {
    for (int axis = 0; axis < 3; ++axis) planes[std::size_t(axis)][at] = v[axis];
  }

  const RayTask& task_;
  const CameraRays& rays_;
  const RayPlanes& planes_;
  const HitLighting* lighting_;
  const glm::mat3 to_world_;
  const std::size_t stride_;
  std::vector<KernelPlane> kernel_planes_;  // those of the task, then `ray`
  std::array<std::vector<float>, 3> made_;  // directions that the kernel makes, for the rows of the block
  int x0_ = 0, y0_ = 0, x1_ = 0, y1_ = 0;
  int ray_ = 0;  // index of the rays that are being added
  std::array<glm::vec3, kBlockPixels> bent_{}, light_{};
  std::array<float, kBlockPixels> open_{}, count_{};
  ShortRays list_;
};

}  // namespace

long ray_steps(const Rows& rows) { return (rows.count() + kBandRows - 1) / kBandRows; }

void trace_rays(const RayTask& task, Watch& watch) {
  const CameraRays rays = camera_rays(task.traced, task.info);
  const RayPlanes planes(task.frame);
  std::optional<HitLighting> lighting;
  if (task.settings.light > 0.0f)
    lighting =
        hit_lighting(task.traced, task.info, task.settings.ambient_bounce, task.settings.radius * task.traced.scale);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, int(ray_steps(task.rows)), 1),
      [&](const tbb::blocked_range<int>& range) {
        RayBlock block(task, rays, planes, lighting ? &*lighting : nullptr);
        for (int band = range.begin(); band < range.end() && !watch.ended(); ++band) {
          fault_point();
          const int y0 = task.rows.begin + band * kBandRows, y1 = std::min(y0 + kBandRows, task.rows.end);
          for (int x0 = 0; x0 < task.info.width; x0 += kBlockWidth)
            if (!task.mask || task.mask->any(x0, std::min(x0 + kBlockWidth, task.info.width), y0, y1))
              block.trace(x0, y0);
          watch.done(1);
        }
      },
      tbb::simple_partitioner());
}

}  // namespace umbrage
