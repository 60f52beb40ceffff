#include "reference/trace.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <mutex>

#include "core/check.h"
#include "rays/camera_rays.h"
#include "rays/directions.h"
#include "rays/hit_light.h"
#include "rays/pixel_material.h"
#include "rays/ray_packet.h"
#include "reference/metal_rough.h"
#include "reference/sampler.h"

namespace umbrage {
namespace {

constexpr int kTile = 16;  // side of the tile of one task, pixels

/// The independent sets of sample points of a pixel.
enum SampleSet : std::uint32_t { kHemisphere = 1, kBounceLight = 2, kFirstLight = 3 };

/// Returns the seed of a pixel. Pixels are counted from the inner border of the guard band, so that the guard band does
/// not change the noise.
std::uint32_t pixel_seed(const PictureInfo& info, int x, int y, std::uint32_t seed) {
  return hash(hash(std::uint32_t(x - info.guard), seed), std::uint32_t(y - info.guard));
}

/// Finds the surface on the ray through a pixel's centre, if any.
bool primary_surface(const TracedScene& traced, const CameraRays& rays, int x, int y, float min_opacity,
                     Surface& surface) {
  const float px = float(x) + 0.5f, py = float(y) + 0.5f;
  const glm::vec3 origin = rays.origin_at(px, py), direction = rays.direction_at(px, py);
  alignas(16) RTCRayHit rh;
  if (!first_hit(traced, origin, direction, rh, min_opacity)) return false;
  surface = surface_at(traced, rh.hit.geomID, rh.hit.primID, rh.hit.u, rh.hit.v, origin, direction,
                       {rh.hit.Ng_x, rh.hit.Ng_y, rh.hit.Ng_z}, rh.ray.tfar);
  return true;
}

/// Calls trace(x, y, surface, rays) for every pixel inside the guard band that has a surface, from all threads.
template <class Trace>
Result<void> for_each_surface(const TracedScene& traced, const PictureInfo& info, const TraceControl& control,
                              const Trace& trace) {
  const CameraRays rays = camera_rays(traced, info);
  if (!rays_within_limit(rays, info)) {  // such a camera sees no surface
    if (!control.progress(1.0)) return Error{ErrorKind::kInterrupted, "interrupted"};
    return {};
  }
  const int columns = (info.inner_width() + kTile - 1) / kTile, rows = (info.inner_height() + kTile - 1) / kTile;
  std::atomic<int> done = 0;
  std::atomic<bool> ended = false;
  std::mutex report_mutex;
  const int max = tbb::info::default_concurrency();
  tbb::task_arena arena(control.threads > 0 ? std::min(control.threads, max) : max);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, rows * columns, 1),
        [&](const tbb::blocked_range<int>& range) {
          for (int t = range.begin(); t < range.end() && !ended; ++t) {
            const int x0 = info.guard + t % columns * kTile, y0 = info.guard + t / columns * kTile;
            for (int y = y0; y < std::min(y0 + kTile, info.height - info.guard); ++y)
              for (int x = x0; x < std::min(x0 + kTile, info.width - info.guard); ++x)
                if (Surface surface; primary_surface(traced, rays, x, y, control.min_opacity, surface))
                  trace(x, y, surface, rays);
            // Only the last task waits to report. The count is read under the lock, so that it never decreases.
            const bool last = ++done == rows * columns;
            std::unique_lock lock(report_mutex, std::try_to_lock);
            if (last && !lock.owns_lock()) lock.lock();
            if (lock.owns_lock() && !ended && !control.progress(double(done) / (rows * columns))) ended = true;
          }
        },
        tbb::simple_partitioner());
  });
  if (ended) return Error{ErrorKind::kInterrupted, "interrupted"};
  return {};
}

/// Three planes of an image that hold a vector or a colour.
struct VectorPlanes {
  std::array<Plane*, 3> planes;

  void store(int x, int y, glm::vec3 v) const {
    for (int c = 0; c < 3; ++c) planes[c]->at(x, y) = v[c];
  }
};

/// Makes an image of these planes. Each is filled with one value.
Image filled_image(const PictureInfo& info, std::initializer_list<std::pair<const char*, float>> planes) {
  Image image(info.width, info.height);
  for (const auto& [name, value] : planes) image.add(name) = Plane(info.width, info.height, value);
  return image;
}

VectorPlanes vector_planes(Image& image, std::array<const char*, 3> names) {
  return {{&image.plane(names[0]), &image.plane(names[1]), &image.plane(names[2])}};
}

/// Returns for each ray of a packet the fraction that occluders within `radius` leave visible; 0 for an idle lane. If
/// there are views, only occluders that they hold count.
std::array<float, kPacket> visible_fractions(const TracedScene& traced, const std::vector<HeldView>& views,
                                             const OcclusionSettings& settings, float radius, float min_opacity,
                                             RayPacket& packet) {
  std::array<float, kPacket> visible{};
  for (int k = 0; k < kPacket; ++k) visible[k] = packet.is_set(k) ? 1.0f : 0.0f;
  const auto hide_at = [&](int k, float distance) {
    visible[k] = 1.0f - falloff_weight(settings.falloff, std::min(distance / radius, 1.0f));
  };
  if (!views.empty()) {
    const auto distances = held_hit_distances(traced, views, radius, min_opacity, packet);
    for (int k = 0; k < kPacket; ++k)
      if (std::isfinite(distances[k])) hide_at(k, distances[k]);
  } else if (settings.falloff == Falloff::kNone) {
    packet.find_blocked(traced, Coherence::kIncoherent);
    for (int k = 0; k < kPacket; ++k)
      if (packet.is_set(k) && !packet.arrives(k)) visible[k] = 0.0f;
  } else {
    packet.find_hits(traced, Coherence::kIncoherent);
    for (int k = 0; k < kPacket; ++k)
      if (packet.hit(k)) hide_at(k, packet.hit_distance(k));
  }
  return visible;
}

/// Returns the Blinn-Phong highlight of a light sample, before the cosine of its direction, as in effects/lighting.
float highlight_of(const Surface& surface, glm::vec3 to_light, glm::vec3 to_eye) {
  const Material& material = *surface.material;
  if (!(material.specular_strength > 0.0f)) return 0.0f;
  const glm::vec3 halfway = to_light + to_eye;
  const float length = glm::length(halfway);
  const float cosine = length > 0.0f ? std::max(glm::dot(surface.normal, halfway) / length, 0.0f) : 0.0f;
  return material.specular_strength * std::pow(cosine, material.specular_exponent);
}

/// Direct light at one pixel.
struct DirectLight {
  glm::vec3 diffuse{0.0f};  ///< before the albedo
  glm::vec3 highlight{0.0f};
  float key_visibility = 1.0f;
};

/// Returns the finish of a surface whose material has a roughness.
MetalRough finish_of(const PixelMaterial& material, glm::vec3 to_eye) {
  return {material.normal, to_eye, material.albedo, material.metallic, material.roughness};
}

DirectLight direct_light(const TracedScene& traced, const CameraRays& rays, const Surface& surface,
                         const PixelMaterial& material, glm::vec3 to_eye, const std::vector<TracedLight>& lights,
                         const SampleTable& table, int samples, std::uint32_t seed) {
  DirectLight sum;
  const glm::vec3 start = ray_origin_to_light(traced, surface, rays.eye);
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const TracedLight& light = lights[l];
    const bool has_hard_shadow = light.point ? !(light.radius > 0.0f) : !(light.cone_height > 0.0f);
    const int count = has_hard_shadow ? 1 : samples;  // all samples of a point light are equal
    int arrived = 0;
    for (int first = 0; first < count; first += kPacket) {
      const int n = std::min(kPacket, count - first);
      RayPacket packet;
      std::array<LightSample, kPacket> sample;
      for (int k = 0; k < n; ++k) {
        sample[k] = sample_light(light, rays, surface.position,
                                 sample_point(table, first + k, hash(seed, kFirstLight + unsigned(l))));
        if (glm::dot(sample[k].direction, surface.normal) > 0.0f)
          packet.set(k, start, sample[k].direction, 0.0f, ray_length(light, sample[k].distance));
      }
      packet.find_blocked(traced, Coherence::kIncoherent);
      for (int k = 0; k < n; ++k) {
        if (!packet.arrives(k)) continue;
        ++arrived;
        const float lambert = glm::dot(material.normal, sample[k].direction);
        if (!(lambert > 0.0f)) continue;
        const glm::vec3 color = sample[k].color / float(count);
        if (material.roughness >= 0.0f) {
          sum.highlight += color * reflected_light(finish_of(material, to_eye), sample[k].direction);
          continue;
        }
        sum.diffuse += color * lambert;
        sum.highlight += color * (lambert * highlight_of(surface, sample[k].direction, to_eye));
      }
    }
    if (l == 0) sum.key_visibility = float(arrived) / float(count);
  }
  return sum;
}

/// Returns the mean radiance from the hemisphere: the emission of surfaces within `reach`, and the light that they
/// reflect, with one sample per light.
glm::vec3 bounced_light(const TracedScene& traced, const CameraRays& rays, const Surface& surface,
                        const std::vector<TracedLight>& lights, const SampleTable& table, int samples, float reach,
                        std::uint32_t seed) {
  glm::vec3 sum(0.0f);
  const glm::vec3 start = ray_origin_above(traced, surface, rays.eye);
  const glm::mat3 basis = basis_around(surface.normal);
  for (int first = 0; first < samples; first += kPacket) {
    const int n = std::min(kPacket, samples - first);
    RayPacket packet;
    for (int k = 0; k < n; ++k) {
      const glm::vec3 direction = basis * cosine_direction(sample_point(table, first + k, hash(seed, kHemisphere)));
      if (glm::dot(direction, surface.geometric) > 0.0f) packet.set(k, start, direction, 0.0f, reach);
    }
    packet.find_hits(traced, Coherence::kIncoherent);
    std::array<Surface, kPacket> hits;
    std::array<glm::vec3, kPacket> albedo;
    for (int k = 0; k < n; ++k) {
      if (!packet.hit(k)) continue;
      hits[k] = packet.surface(traced, k);
      albedo[k] = unfiltered_albedo(traced, hits[k]);
      sum += unfiltered_emission(traced, hits[k]);
    }
    for (std::size_t l = 0; l < lights.size(); ++l) {
      RayPacket to_light;
      std::array<glm::vec3, kPacket> reflected;
      for (int k = 0; k < n; ++k) {
        if (!packet.hit(k)) continue;
        const std::uint32_t light_seed = hash(hash(seed, kBounceLight), unsigned(l));
        const LightSample sample = sample_light(
            lights[l], rays, hits[k].position, sample_point(table, shuffled(table, first + k, light_seed), light_seed));
        const float lambert = glm::dot(hits[k].normal, sample.direction);
        if (!(lambert > 0.0f)) continue;
        reflected[k] = albedo[k] * sample.color * lambert;
        to_light.set(k, ray_origin_to_light(traced, hits[k], surface.position), sample.direction, 0.0f,
                     ray_length(lights[l], sample.distance));
      }
      to_light.find_blocked(traced, Coherence::kIncoherent);
      for (int k = 0; k < n; ++k)
        if (to_light.arrives(k)) sum += reflected[k];
    }
  }
  return sum / float(samples);
}

/// Returns the radiance of a white diffuse surface under the environment, without occlusion.
glm::vec3 irradiance(glm::vec3 normal, const LightSettings& settings, const SampleTable& table, std::uint32_t seed) {
  const glm::mat3 basis = basis_around(normal);
  glm::vec3 sum(0.0f);
  for (int k = 0; k < settings.samples; ++k)
    sum += settings.environment(basis * cosine_direction(sample_point(table, k, hash(seed, kHemisphere))));
  return sum / float(settings.samples);
}

}  // namespace

Result<void> trace_surfaces(const TracedScene& traced, const PictureInfo& info, const TraceControl& control,
                            const std::function<void(int x, int y, const Surface& surface)>& take) {
  return for_each_surface(traced, info, control,
                          [&](int x, int y, const Surface& surface, const CameraRays&) { take(x, y, surface); });
}

Result<Image> trace_occlusion(const TracedScene& traced, const PictureInfo& info, const OcclusionSettings& settings,
                              const TraceControl& control) {
  check_less(0, settings.samples, "samples of the reference");
  check_less(settings.samples, kMaxSamples + 1, "samples of the reference");
  Image image =
      filled_image(info, {{"ao", 1.0f}, {"bent_normal.x", 0.0f}, {"bent_normal.y", 0.0f}, {"bent_normal.z", 0.0f}});
  const std::size_t skies = settings.skies.size();
  std::vector<VectorPlanes> of_sky;
  for (std::size_t s = 0; s < skies; ++s)
    for (const char* channel : {"r", "g", "b"})
      image.add(fmt::format("sky{}.{}", s, channel)) = Plane(info.width, info.height, 0.0f);
  Plane& ao = image.plane("ao");
  const VectorPlanes bent_normal = vector_planes(image, {"bent_normal.x", "bent_normal.y", "bent_normal.z"});
  for (std::size_t s = 0; s < skies; ++s)
    of_sky.push_back({{&image.plane(fmt::format("sky{}.r", s)), &image.plane(fmt::format("sky{}.g", s)),
                       &image.plane(fmt::format("sky{}.b", s))}});
  const SampleTable table = sample_table(settings.samples);
  const float radius = settings.radius * traced.scale;
  const glm::mat3 view_from_world(info.camera.view_from_world);
  const std::vector<HeldView> views = held_views(traced, info, settings.occluders);
  const auto status =
      for_each_surface(traced, info, control, [&](int x, int y, const Surface& surface, const CameraRays& rays) {
        const glm::vec3 start = ray_origin_above(traced, surface, rays.eye);
        const glm::vec3 normal = settings.normal == HemisphereNormal::kTriangle ? surface.geometric : surface.normal;
        const glm::mat3 basis = basis_around(normal);
        const std::uint32_t seed = hash(pixel_seed(info, x, y, settings.seed), kHemisphere);
        float open = 0.0f;
        glm::vec3 bent(0.0f);
        std::vector<glm::vec3> light(skies, glm::vec3(0.0f));
        for (int first = 0; first < settings.samples; first += kPacket) {
          const int n = std::min(kPacket, settings.samples - first);
          RayPacket packet;
          std::array<glm::vec3, kPacket> directions;
          for (int k = 0; k < n; ++k) {
            directions[k] = basis * cosine_direction(sample_point(table, first + k, seed));
            if (glm::dot(directions[k], surface.geometric) > 0.0f) packet.set(k, start, directions[k], 0.0f, radius);
          }
          const auto visible = visible_fractions(traced, views, settings, radius, control.min_opacity, packet);
          for (int k = 0; k < n; ++k) {
            open += visible[k];
            bent += directions[k] * visible[k];
            if (!(visible[k] > 0.0f)) continue;
            for (std::size_t s = 0; s < skies; ++s) light[s] += settings.skies[s](directions[k]) * visible[k];
          }
        }
        ao.at(x, y) = open / float(settings.samples);
        for (std::size_t s = 0; s < skies; ++s) of_sky[s].store(x, y, light[s] / float(settings.samples));
        const float length = glm::length(bent);
        bent_normal.store(x, y, view_from_world * (length > 0.0f ? bent / length : normal));
      });
  if (!status) return status.error();
  return image;
}

Result<Image> trace_light(const TracedScene& traced, const PictureInfo& info, const LightSettings& settings,
                          const TraceControl& control) {
  check_less(0, settings.samples, "samples of the reference");
  check_less(settings.samples, kMaxSamples + 1, "samples of the reference");
  Image image(info.width, info.height);
  for (const char* name : {"direct.r", "direct.g", "direct.b", "shadow"})
    if (settings.direct) image.add(name) = Plane(info.width, info.height, name[0] == 's' ? 1.0f : 0.0f);
  for (const char* name : {"indirect.r", "indirect.g", "indirect.b"})
    if (settings.bounce) image.add(name) = Plane(info.width, info.height, 0.0f);
  for (const char* name : {"ambient.r", "ambient.g", "ambient.b"})
    if (settings.environment) image.add(name) = Plane(info.width, info.height, 0.0f);
  VectorPlanes direct, indirect, ambient;
  if (settings.environment) ambient = vector_planes(image, {"ambient.r", "ambient.g", "ambient.b"});
  if (settings.direct) direct = vector_planes(image, {"direct.r", "direct.g", "direct.b"});
  Plane* shadow = image.find("shadow");
  if (settings.bounce) indirect = vector_planes(image, {"indirect.r", "indirect.g", "indirect.b"});
  const SampleTable table = sample_table(settings.samples);
  const std::vector<TracedLight> lights =
      traced_lights(traced, camera_rays(traced, info), info, {settings.captured_shadows, settings.sun_angle_deg});
  const bool orthographic = info.camera.projection == Projection::kOrthographic;
  const float reach = settings.reach * traced.scale;
  const auto status =
      for_each_surface(traced, info, control, [&](int x, int y, const Surface& surface, const CameraRays& rays) {
        const std::uint32_t seed = pixel_seed(info, x, y, settings.seed);
        if (settings.bounce)
          indirect.store(x, y, bounced_light(traced, rays, surface, lights, table, settings.samples, reach, seed));
        if (!settings.direct && !settings.environment) return;
        const glm::vec3 to_eye = orthographic ? rays.world_from_view[2] : glm::normalize(rays.eye - surface.position);
        const PixelMaterial material = pixel_material(traced, rays, surface, float(x) + 0.5f, float(y) + 0.5f);
        if (settings.environment) {
          const bool rough = material.roughness >= 0.0f;
          // Without a roughness, a surface is diffuse.
          ambient.store(x, y,
                        rough ? reflected_environment(finish_of(material, to_eye), settings.environment, table,
                                                      settings.samples, seed)
                              : material.albedo * irradiance(material.normal, settings, table, seed));
        }
        if (!settings.direct) return;
        const DirectLight light =
            direct_light(traced, rays, surface, material, to_eye, lights, table, settings.samples, seed);
        direct.store(x, y, light.diffuse * material.albedo + light.highlight + material.emission);
        shadow->at(x, y) = light.key_visibility;
      });
  if (!status) return status.error();
  return image;
}

}  // namespace umbrage
