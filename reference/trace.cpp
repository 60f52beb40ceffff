#include "reference/trace.h"

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
#include <glm/trigonometric.hpp>
#include <mutex>

#include "core/check.h"
#include "rays/camera_rays.h"
#include "rays/pixel_material.h"
#include "rays/ray_packet.h"
#include "reference/metal_rough.h"
#include "reference/sampler.h"

namespace umbrage {
namespace {

constexpr int kTile = 16;  // side of the tile of one task, pixels
constexpr float kPi = 3.14159265f;

/// The independent sets of sample points of a pixel.
enum SampleSet : std::uint32_t { kHemisphere = 1, kBounceLight = 2, kFirstLight = 3 };

/// Returns an orthonormal basis with z = n, continuous except at n.z = 0 [Duff et al. 2017].
glm::mat3 basis_around(glm::vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Returns a direction about +z with a probability density proportional to its cosine: a point of the disc, by the
/// concentric map, which keeps neighbouring samples close [Shirley and Chiu 1997], projected to the sphere.
glm::vec3 cosine_direction(glm::vec2 sample) {
  const float a = 2.0f * sample.x - 1.0f, b = 2.0f * sample.y - 1.0f;
  float radius = 0.0f, angle = 0.0f;
  if (std::abs(a) > std::abs(b)) {
    radius = a;
    angle = kPi / 4.0f * (b / a);
  } else if (b != 0.0f) {
    radius = b;
    angle = kPi / 2.0f - kPi / 4.0f * (a / b);
  }
  // No sample is on the disc's edge, so z > 0. (1 - r) (1 + r) keeps it above 0; 1 - x x - y y may round to 0.
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt((1.0f - radius) * (1.0f + radius))};
}

/// Returns a direction about +z within a cone, uniform in solid angle. `cone_height` is 1 minus the cosine of its half
/// angle, which floats represent even for the narrowest cone.
glm::vec3 cone_direction(glm::vec2 sample, float cone_height) {
  const float below = sample.x * cone_height;
  const float across = std::sqrt(below * (2.0f - below)), angle = 2.0f * kPi * sample.y;
  return {across * std::cos(angle), across * std::sin(angle), 1.0f - below};
}

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

/// Returns the weight of a hit at distance `fraction` times the radius.
float weight_of(Falloff falloff, float fraction) {
  if (falloff == Falloff::kNone) return 1.0f;
  if (falloff == Falloff::kLinear) return 1.0f - fraction;
  return 1.0f - fraction * fraction * (3.0f - 2.0f * fraction);
}

/// A light in the unit space of TracedScene.
struct TracedLight {
  bool point = false;
  bool from_camera = false;  ///< directional light that starts at the plane of the camera
  glm::vec3 where{0.0f};     ///< unit direction to the light, or position of its centre
  glm::vec3 color{0.0f};
  float reach_squared = 0.0f;  ///< 0: no distance falloff
  float radius = 0.0f;         ///< radius of a spherical light
  float cone_height = 0.0f;    ///< 1 minus the cosine of the half angle of a directional light
  bool casts_shadow = true;
};

std::vector<TracedLight> traced_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const LightSettings& settings) {
  std::vector<TracedLight> lights;
  for (const Light& light : info.lights) {
    TracedLight out{.color = light.color};
    const bool head = light.kind == LightKind::kHead, points = settings.captured_shadows;
    if (points) out.casts_shadow = light.casts_shadow && !head && int(lights.size()) < kMaxShadows;
    out.point = light.kind == LightKind::kPoint || (head && info.camera.projection == Projection::kPerspective);
    if (head) {
      out.where = out.point ? rays.eye : rays.world_from_view[2];
      out.from_camera = !out.point;
    } else if (out.point) {
      out.where = rays.eye + rays.world_from_view * (light.position * traced.scale);
      out.reach_squared = light.reach * light.reach * traced.scale * traced.scale;
      out.radius = points ? 0.0f : light.radius * traced.scale;
    } else {
      out.where = glm::normalize(rays.world_from_view * light.direction);
      const float light_deg = settings.sun_angle_deg > 0.0f ? settings.sun_angle_deg : light.angle_deg;
      const float angle_deg = points ? 0.0f : light_deg;
      const float sine = std::sin(glm::radians(0.25f * angle_deg));
      out.cone_height = 2.0f * sine * sine;
    }
    lights.push_back(out);
  }
  return lights;
}

/// Returns the length of the shadow ray to a light. 0 for a light without shadows: a ray of length 0 hits nothing.
float ray_length(const TracedLight& light, float distance) { return light.casts_shadow ? distance : 0.0f; }

/// One sample of a light, for one surface point: unit direction and distance to the light, and the radiance of a white
/// surface that faces this direction.
struct LightSample {
  glm::vec3 direction;
  float distance;
  glm::vec3 color;
};

/// Returns the factor that makes a white surface that faces the cone's axis as bright as under a point light of the
/// same colour: 1 over the mean cosine of the cone's directions to its axis.
float cone_gain(float cone_height) { return 1.0f / (1.0f - 0.5f * cone_height); }

LightSample sample_light(const TracedLight& light, const CameraRays& rays, glm::vec3 from, glm::vec2 sample) {
  if (!light.point) {
    const glm::vec3 direction = basis_around(light.where) * cone_direction(sample, light.cone_height);
    const float distance =
        light.from_camera ? glm::dot(rays.eye - from, light.where) : std::numeric_limits<float>::infinity();
    return {direction, distance, light.color * cone_gain(light.cone_height)};
  }
  const glm::vec3 to_center = light.where - from;
  const float squared = std::max(glm::dot(to_center, to_center), 1e-20f), distance = std::sqrt(squared);
  const glm::vec3 toward = to_center / distance;
  // The falloff is clamped at the sphere's surface: points inside a light would be fireflies.
  const float falloff_squared = std::max(squared, light.radius * light.radius);
  const glm::vec3 color =
      light.reach_squared > 0.0f ? light.color * (light.reach_squared / falloff_squared) : light.color;
  if (!(light.radius > 0.0f)) return {toward, distance, color};
  // Seen from outside, the sphere fills a cone; from inside, a hemisphere is used.
  const float sine_squared = std::min(1.0f, light.radius * light.radius / squared);
  const float cone_height = sine_squared / (1.0f + std::sqrt(1.0f - sine_squared));
  const glm::vec3 local = cone_direction(sample, cone_height);
  const float to_sphere = distance * local.z -
                          std::sqrt(std::max(0.0f, light.radius * light.radius - squared * (1.0f - local.z * local.z)));
  return {basis_around(toward) * local, std::max(to_sphere, 0.0f), color * cone_gain(cone_height)};
}

/// Returns the texture's unfiltered value at a surface that is not directly visible; white if there is no texture.
glm::vec3 unfiltered_texel(const TracedScene& traced, const Surface& surface, int texture) {
  if (texture == kNoTexture || surface.mesh->uvs.empty()) return glm::vec3(1.0f);
  const glm::vec2 uv = uv_at(*surface.mesh, surface.triangle, surface.u, surface.v);
  return glm::vec3(sample_filtered(traced.textures[texture], uv, glm::vec2(0.0f), glm::vec2(0.0f)));
}

glm::vec3 unfiltered_albedo(const TracedScene& traced, const Surface& surface) {
  return surface.material->albedo * mesh_color(surface) * unfiltered_texel(traced, surface, surface.material->texture);
}

/// Returns the Blinn-Phong highlight of a light sample, as in effects/lighting.
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
        sum.highlight += color * highlight_of(surface, sample[k].direction, to_eye);
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
      sum += hits[k].material->emission * unfiltered_texel(traced, hits[k], hits[k].material->emission_texture);
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

Result<Image> trace_occlusion(const TracedScene& traced, const PictureInfo& info, const OcclusionSettings& settings,
                              const TraceControl& control) {
  check_less(0, settings.samples, "samples of the reference");
  check_less(settings.samples, kMaxSamples + 1, "samples of the reference");
  Image image =
      filled_image(info, {{"ao", 1.0f}, {"bent_normal.x", 0.0f}, {"bent_normal.y", 0.0f}, {"bent_normal.z", 0.0f}});
  Plane& ao = image.plane("ao");
  const VectorPlanes bent_normal = vector_planes(image, {"bent_normal.x", "bent_normal.y", "bent_normal.z"});
  const SampleTable table = sample_table(settings.samples);
  const float radius = settings.radius * traced.scale;
  const glm::mat3 view_from_world(info.camera.view_from_world);
  const auto done =
      for_each_surface(traced, info, control, [&](int x, int y, const Surface& surface, const CameraRays& rays) {
        const glm::vec3 start = ray_origin_above(traced, surface, rays.eye);
        const glm::vec3 normal = settings.normal == HemisphereNormal::kTriangle ? surface.geometric : surface.normal;
        const glm::mat3 basis = basis_around(normal);
        const std::uint32_t seed = hash(pixel_seed(info, x, y, settings.seed), kHemisphere);
        float open = 0.0f;
        glm::vec3 bent(0.0f);
        for (int first = 0; first < settings.samples; first += kPacket) {
          const int n = std::min(kPacket, settings.samples - first);
          RayPacket packet;
          std::array<glm::vec3, kPacket> directions;
          for (int k = 0; k < n; ++k) {
            directions[k] = basis * cosine_direction(sample_point(table, first + k, seed));
            if (glm::dot(directions[k], surface.geometric) > 0.0f) packet.set(k, start, directions[k], 0.0f, radius);
          }
          if (settings.falloff == Falloff::kNone)
            packet.find_blocked(traced, Coherence::kIncoherent);
          else
            packet.find_hits(traced, Coherence::kIncoherent);
          for (int k = 0; k < n; ++k) {
            if (!packet.is_set(k)) continue;
            float visible = 1.0f;
            if (settings.falloff == Falloff::kNone)
              visible = packet.arrives(k) ? 1.0f : 0.0f;
            else if (packet.hit(k))
              visible = 1.0f - weight_of(settings.falloff, std::min(packet.hit_distance(k) / radius, 1.0f));
            open += visible;
            bent += directions[k] * visible;
          }
        }
        ao.at(x, y) = open / float(settings.samples);
        const float length = glm::length(bent);
        bent_normal.store(x, y, view_from_world * (length > 0.0f ? bent / length : normal));
      });
  if (!done) return done.error();
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
  const std::vector<TracedLight> lights = traced_lights(traced, camera_rays(traced, info), info, settings);
  const bool orthographic = info.camera.projection == Projection::kOrthographic;
  const float reach = settings.reach * traced.scale;
  const auto done =
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
  if (!done) return done.error();
  return image;
}

}  // namespace umbrage
