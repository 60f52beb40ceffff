#include "devices/cpu/capture.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <new>

#include "core/guarded.h"
#include "core/progress.h"
#include "devices/cpu/capture_block.h"
#include "devices/cpu/soften.h"
#include "devices/shared/soften.h"
#include "rays/camera_rays.h"
#include "rays/pixel_material.h"
#include "rays/ray_packet.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

constexpr int kBlock = kSoftenBlock;
constexpr int kTileBlocks = 8;  // blocks per side of a tile that one task draws: 32 pixels
// The search for the next surface along a ray starts this far behind the last hit, as a fraction of the sum of the
// hit's distances from the scene's origin and from the camera. Two triangles that share an edge then count as one
// surface, but the two sides of a sheet of paper as two.
constexpr float kLayerStep = 1e-5f;
// Max error of a ray's end, relative to its length: a ray that starts at a light must end farther than this above the
// surface.
constexpr float kEndRounding = 1e-6f;
// Squared radius of a penumbra, pixels squared, up to which the second filter is as narrow as the first one.
const float kNarrowPenumbra = kSoftenMin * kSoftenMin / (kSoftenFraction * kSoftenFraction);

/// Data shared by all blocks of a view.
struct Drawing {
  const TracedScene& traced;
  PictureInfo info;  ///< for the camera of the view
  Rows rows;         ///< rows of the picture to draw; begin is a multiple of kBlock
  CameraRays rays;
  std::vector<ShadowLight> lights;
  bool blended = false;                             ///< capture blended surfaces
  bool ray_offsets = false;                         ///< capture `ray_offset`
  int sample = 0;                                   ///< sample index of an accumulation
  std::vector<DrawnPlane> planes;                   ///< planes of each layer, in order
  std::vector<PenumbraRadii>* penumbrae = nullptr;  ///< of the first layer, one per softened light
  const PixelMask* mask = nullptr;                  ///< the pixels to capture; null: all
  MaterialParts parts;                              ///< those that the planes need
};

void clear(const Drawing& drawing, Block& block) {
  for (const DrawnPlane& plane : drawing.planes) std::fill_n(plane.in(block), kPacket, plane.background_value);
  std::fill_n(block.penumbra, kMaxShadows, PenumbraSize{});
}

/// Stores the rows of block (x0, y0) that lie in `drawing.rows`. Rows are padded to kRowAlignment floats, so that a
/// block may extend beyond the right border of the picture.
void store(const Drawing& drawing, const Block& block, int x0, int y0, int layer, Image& image) {
  for (std::size_t p = 0; p < drawing.planes.size(); ++p) {
    Plane& plane = image.planes[std::size_t(layer) * drawing.planes.size() + p];
    const float* values = drawing.planes[p].in(block);
    for (int j = 0; j < kBlock && y0 + j < drawing.rows.end; ++j)
      std::memcpy(plane.row(y0 + j - drawing.rows.begin) + x0, values + j * kBlock, kBlock * sizeof(float));
  }
}

void store_penumbrae(const Drawing& drawing, const Block& block, int x0, int y0) {
  for (PenumbraRadii& radii : *drawing.penumbrae) {
    const int i = x0 / kBlock, j = (y0 - drawing.rows.begin) / kBlock;
    radii.across.at(i, j) = std::sqrt(block.penumbra[radii.light].across);
    radii.down.at(i, j) = std::sqrt(block.penumbra[radii.light].down);
  }
}

/// The surfaces that the rays of a block hit.
struct Surfaces {
  std::array<Surface, kPacket> at;
  std::array<glm::vec3, kPacket> to_light_from;  ///< origins of the rays to lights
  std::array<bool, kPacket> is_hit{};
  int x0 = 0, y0 = 0;  ///< first pixel of the block
  /// Record penumbra sizes: only for the first layer, whose shadows are softened.
  bool softened = false;
};

/// Stores the origins of the rays to lights.
void find_ray_origins(const Drawing& drawing, Surfaces& surfaces) {
  if (drawing.lights.empty()) return;
  for (int k = 0; k < kPacket; ++k)
    if (surfaces.is_hit[k])
      surfaces.to_light_from[k] = ray_origin_to_light(drawing.traced, surfaces.at[k], drawing.rays.eye);
}

/// The nearest occluder of each pixel on its rays to a light: the ratio of its distances to the pixel and, if the light
/// is a point, to the light; otherwise to the distance 1 on a ray's direction.
using Nearest = std::array<float, kPacket>;

/// Limits the penumbra of a block to the sizes that the occluders cause.
void narrow_block(const Drawing& drawing, const Surfaces& surfaces, const ShadowLight& light, const Nearest& nearest,
                  Block& block) {
  for (int k = 0; k < kPacket; ++k) {
    if (nearest[k] == std::numeric_limits<float>::infinity()) continue;
    const Surface& surface = surfaces.at[k];
    const float x = float(surfaces.x0 + k % kBlock) + 0.5f, y = float(surfaces.y0 + k / kBlock) + 0.5f;
    narrow(block.penumbra[light.index], drawing.rays, surface, block.depth[k], drawing.rays.direction_at(x, y),
           light.point ? light.where - surface.position : light.where, light.size * nearest[k]);
  }
}

/// Traces one ray per pixel: to the point `disc_places` of a light's disc if `soft`, otherwise to the centre. Adds 1 to
/// `lit` where the ray is unblocked. Where it is blocked, and the occluder may limit a penumbra that is softened, keeps
/// the nearest one.
void trace_to_light(const Drawing& drawing, const Surfaces& surfaces, const ShadowLight& light, bool soft,
                    const std::array<glm::vec2, kPacket>& disc_places, std::array<float, kPacket>& lit,
                    Nearest& nearest, Block& block) {
  RayPacket to_light;
  PenumbraSize& penumbra = block.penumbra[light.index];
  for (int k = 0; k < kPacket; ++k) {
    if (!surfaces.is_hit[k]) continue;
    const Surface& surface = surfaces.at[k];
    glm::vec3 toward = light.point ? light.where - surface.position : light.where;
    const bool faces_center = glm::dot(surface.normal, toward) > 0.0f;
    glm::vec3 where = light.where;
    if (soft) {
      const auto [right, up] = light.point ? disc_axes(toward) : std::pair(light.right, light.up);
      where = light.where + light.size * (disc_places[k].x * right + disc_places[k].y * up);
      toward = light.point ? where - surface.position : where;
    }
    // Only surfaces with a roughness reflect a light whose centre is below their horizon.
    const bool reflects = faces_center || (soft && block.roughness[k] >= 0.0f);
    if (!reflects || !(glm::dot(surface.normal, toward) > 0.0f)) {
      penumbra = {0.0f, 0.0f};  // radius 0: the surface itself blocks the light
      continue;
    }
    const glm::vec3 start = surfaces.to_light_from[k];
    if (!light.point) {
      to_light.set(k, start, toward, 0.0f, std::numeric_limits<float>::infinity());
    } else if (!soft && glm::distance(start, surface.position) > kEndRounding * glm::length(toward)) {
      // Rays start at the light, where all rays of the packet meet: this takes two thirds of the time
      // of rays that start at the surfaces.
      to_light.set(k, where, start - where, 0.0f, 1.0f);
    } else {
      to_light.set(k, start, where - start, 0.0f, 1.0f);
    }
  }
  // Rays to points all over a light are hardly coherent.
  const Coherence coherence = soft ? Coherence::kIncoherent : Coherence::kCoherent;
  if (!soft || !surfaces.softened || std::max(penumbra.across, penumbra.down) <= kNarrowPenumbra) {
    to_light.find_blocked(drawing.traced, coherence, kMinShadowOpacity);
    for (int k = 0; k < kPacket; ++k)
      if (to_light.arrives(k)) lit[k] += 1.0f;
    return;
  }
  to_light.find_hits(drawing.traced, coherence, kMinShadowOpacity);
  for (int k = 0; k < kPacket; ++k) {
    if (!to_light.is_set(k)) continue;
    if (!to_light.hit(k)) {
      lit[k] += 1.0f;
      continue;
    }
    const float t = to_light.hit_distance(k);
    nearest[k] = std::min(nearest[k], light.point ? t / std::max(1.0f - t, 1e-6f) : t);
  }
}

/// Computes the unblocked fraction of each light. For a light with several rays per pixel, each pixel of the block
/// first traces one ray, to a point of its own on the border of the light: an occluder that blocks a part of the light
/// crosses its border. If all these rays agree, the block is fully lit or fully dark; otherwise each pixel traces its
/// own set of rays. The first of two rays takes the place of the ray to the border, for speed: less than a sixteenth of
/// a light may then be taken for none, or for all.
void trace_shadows(const Drawing& drawing, const Surfaces& surfaces, Block& out) {
  static const DiscPoints points = disc_points();
  static const auto border_points = disc_border_points();
  for (const ShadowLight& light : drawing.lights) {
    const auto points_of = [&](int ray) -> const std::array<glm::vec2, kPacket>& {
      return points[std::size_t(ray + drawing.sample * light.rays) % kDiscPoints];
    };
    const bool keeps_first = light.rays == 2;
    std::array<float, kPacket> lit{};
    Nearest nearest;
    nearest.fill(std::numeric_limits<float>::infinity());
    float scale = 1.0f;
    bool partly_lit = light.rays > 0;
    if (light.rays != 1) {
      trace_to_light(drawing, surfaces, light, light.rays > 0, keeps_first ? points_of(0) : border_points, lit, nearest,
                     out);
      narrow_block(drawing, surfaces, light, nearest, out);
      int lit_pixels = 0, pixels = 0;
      for (int k = 0; k < kPacket; ++k) {
        pixels += surfaces.is_hit[k];
        lit_pixels += surfaces.is_hit[k] && lit[k] > 0.0f;
      }
      partly_lit = partly_lit && lit_pixels != 0 && lit_pixels != pixels;
    }
    if (partly_lit) {
      if (!keeps_first) lit = {};
      for (int ray = keeps_first ? 1 : 0; ray < light.rays; ++ray)
        trace_to_light(drawing, surfaces, light, true, points_of(ray), lit, nearest, out);
      narrow_block(drawing, surfaces, light, nearest, out);
      scale = 1.0f / float(light.rays);
    }
    for (int k = 0; k < kPacket; ++k)
      if (surfaces.is_hit[k]) out.shadow[light.index][k] = lit[k] * scale;
  }
}

/// Shades a block from the hits of its primary rays.
void shade_block(const Drawing& drawing, int x0, int y0, const RayPacket& primary, Surfaces& surfaces, Block& out) {
  clear(drawing, out);
  const glm::mat3 view(drawing.info.camera.view_from_world);
  surfaces.is_hit = {};
  surfaces.x0 = x0;
  surfaces.y0 = y0;
  for (int k = 0; k < kPacket; ++k) {
    if (!primary.hit(k)) continue;
    // Constructed in place: copying a partly written object stalls until the writes are done.
    const Surface& surface = *new (&surfaces.at[k]) Surface(primary.surface(drawing.traced, k));
    surfaces.is_hit[k] = true;
    const float px = float(x0 + k % kBlock) + 0.5f, py = float(y0 + k / kBlock) + 0.5f;
    const PixelMaterial material = pixel_material(drawing.traced, drawing.rays, surface, px, py, drawing.parts);
    const glm::vec3 n = view * material.normal;
    out.depth[k] = primary.hit_distance(k);
    out.nx[k] = n.x;
    out.ny[k] = n.y;
    out.nz[k] = n.z;
    out.ar[k] = material.albedo.r;
    out.ag[k] = material.albedo.g;
    out.ab[k] = material.albedo.b;
    out.er[k] = material.emission.r;
    out.eg[k] = material.emission.g;
    out.eb[k] = material.emission.b;
    out.metallic[k] = material.metallic;
    out.roughness[k] = material.roughness;
    out.material_ao[k] = material.occlusion;
    out.specular[k] = surface.material->specular_strength;
    out.shininess[k] = surface.material->specular_exponent;
    if (drawing.ray_offsets) {
      const float height = ray_origin_height(drawing.traced, surface, drawing.rays.eye) / drawing.traced.scale;
      const glm::vec3 offset = view * surface.geometric * height;
      out.ox[k] = offset.x;
      out.oy[k] = offset.y;
      out.oz[k] = offset.z;
    }
    out.object[k] = float(surface.mesh->object);
    out.material[k] = float(surface.mesh->material);
  }
  find_ray_origins(drawing, surfaces);
  trace_shadows(drawing, surfaces, out);
}

/// Flips the surfaces to their back side, which has its own shadows, but no highlight, since no camera sees it.
void flip_block(const Drawing& drawing, Surfaces& surfaces, Block& block) {
  for (const ShadowLight& light : drawing.lights) std::fill_n(block.shadow[light.index], kPacket, 1.0f);
  for (int k = 0; k < kPacket; ++k) {
    if (!surfaces.is_hit[k]) continue;
    block.nx[k] = -block.nx[k];
    block.ny[k] = -block.ny[k];
    block.nz[k] = -block.nz[k];
    block.ox[k] = -block.ox[k];
    block.oy[k] = -block.oy[k];
    block.oz[k] = -block.oz[k];
    block.specular[k] = 0.0f;
    block.roughness[k] = kNoRoughness;
    surfaces.at[k].geometric = -surfaces.at[k].geometric;
    surfaces.at[k].normal = -surfaces.at[k].normal;
  }
  find_ray_origins(drawing, surfaces);
  trace_shadows(drawing, surfaces, block);
}

/// Moves the start of each ray behind its hit; rays without a hit become idle.
void start_behind_hits(const Drawing& drawing, RayPacket& rays) {
  for (int k = 0; k < kPacket; ++k) {
    if (!rays.hit(k)) {
      rays.set_idle(k);
      continue;
    }
    const float depth = rays.hit_distance(k);
    const glm::vec3 direction = rays.direction(k), hit = rays.origin(k) + direction * depth;
    const float step = kLayerStep * (glm::length(hit) + glm::distance(hit, drawing.rays.eye)) / glm::length(direction);
    rays.set_range(k, depth + step, std::numeric_limits<float>::infinity());
  }
}

/// Returns the opacity of a surface as seen along `direction`.
float seen_opacity(const TracedScene& traced, const Surface& surface, const glm::vec3& direction) {
  const float opacity = opacity_at(traced, *surface.mesh, surface.triangle, surface.u, surface.v);
  if (!surface.material->blended || !surface.material->glass) return opacity;
  const float slant = 1.0f - std::min(std::abs(glm::dot(surface.normal, glm::normalize(direction))), 1.0f);
  const float reflectance = kGlassReflectance + (1.0f - kGlassReflectance) * slant * slant * slant * slant * slant;
  return opacity + (1.0f - opacity) * reflectance;
}

/// Follows the rays from their first hits to an opaque surface, and stores the opacity, the transmittance and the mean
/// albedo of the blended surfaces up to there. The first pixel of the block is (x0, y0).
void see_through(const Drawing& drawing, const RayPacket& primary, int x0, int y0, Block& out) {
  constexpr int kMaxSurfaces = 16;
  const MaterialParts parts{.albedo = drawing.parts.albedo, .emission = false, .surface = false, .normal = false};
  RayPacket rays = primary;
  for (int n = 0; n < kMaxSurfaces && rays.any(); ++n) {
    for (int k = 0; k < kPacket; ++k) {
      if (!rays.hit(k)) continue;
      const Surface surface = rays.surface(drawing.traced, k);
      const float opacity = seen_opacity(drawing.traced, surface, rays.direction(k));
      if (!surface.material->blended || opacity >= kOpaque) {
        // Where a blended surface becomes opaque, its weight must not change.
        if (n == 0 && surface.material->blended) {
          out.opacity[k] = 1.0f;
          out.tr[k] = out.tg[k] = out.tb[k] = 0.0f;
        }
        rays.set_idle(k);
        continue;
      }
      const float px = float(x0 + k % kBlock) + 0.5f, py = float(y0 + k / kBlock) + 0.5f;
      const glm::vec3 albedo = pixel_material(drawing.traced, drawing.rays, surface, px, py, parts).albedo;
      const float added = (1.0f - out.opacity[k]) * opacity;
      out.opacity[k] += added;
      const float fraction = added / out.opacity[k];
      out.ar[k] += fraction * (albedo.r - out.ar[k]);
      out.ag[k] += fraction * (albedo.g - out.ag[k]);
      out.ab[k] += fraction * (albedo.b - out.ab[k]);
      const glm::vec3 passing = (1.0f - opacity) * surface.material->tint;
      out.tr[k] *= passing.r;
      out.tg[k] *= passing.g;
      out.tb[k] *= passing.b;
    }
    start_behind_hits(drawing, rays);
    rays.find_hits(drawing.traced, Coherence::kCoherent, kMinOpacity);
  }
}

/// The layers of the image that the rays of a camera fill.
struct DrawnLayers {
  int first = 0;   ///< layer of the nearest surfaces
  int count = 1;   ///< number of consecutive layers, front to back
  int backs = -1;  ///< first of the `count` layers of their back sides; -1: none
};

/// Draws all layers of the block of 4 x 4 pixels that starts at (x0, y0).
void draw_block(const Drawing& drawing, const DrawnLayers& layers, int x0, int y0, Image& image) {
  const CameraRays& rays = drawing.rays;
  RayPacket primary;
  // One component at a time, so that the compiler vectorizes the loops.
  const auto fill = [&](float* out, float constant, float per_x, float per_y) {
    for (int k = 0; k < kPacket; ++k)
      out[k] = constant + per_x * (float(x0 + k % kBlock) + 0.5f) + per_y * (float(y0 + k / kBlock) + 0.5f);
  };
  for (int axis = 0; axis < 3; ++axis) {
    fill(primary.origins(axis), rays.origin[axis], rays.origin_x[axis], rays.origin_y[axis]);
    fill(primary.directions(axis), rays.direction[axis], rays.direction_x[axis], rays.direction_y[axis]);
  }
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int k = 0; k < kPacket; ++k)
    if (const int x = x0 + k % kBlock, y = y0 + k / kBlock;
        x < drawing.info.width && y < drawing.info.height && (!drawing.mask || drawing.mask->at(x, y)))
      primary.set_range(k, 0.0f, kInfinity);
  Block block;
  Surfaces surfaces;
  for (int layer = 0; layer < layers.count; ++layer) {
    if (layer > 0) start_behind_hits(drawing, primary);
    if (!primary.any()) {
      clear(drawing, block);
      store(drawing, block, x0, y0, layers.first + layer, image);
      if (layers.backs >= 0) store(drawing, block, x0, y0, layers.backs + layer, image);
      continue;
    }
    primary.find_hits(drawing.traced, Coherence::kCoherent, drawing.blended ? kMinOpacity : kOpaque);
    surfaces.softened = layer == 0 && drawing.penumbrae;
    shade_block(drawing, x0, y0, primary, surfaces, block);
    if (drawing.blended) see_through(drawing, primary, x0, y0, block);
    store(drawing, block, x0, y0, layers.first + layer, image);
    if (surfaces.softened) store_penumbrae(drawing, block, x0, y0);
    surfaces.softened = false;
    if (layers.backs < 0) continue;
    flip_block(drawing, surfaces, block);
    store(drawing, block, x0, y0, layers.backs + layer, image);
  }
}

/// Draws the blocks in these columns and rows of blocks, counted from the first drawn row.
void draw_tile(const Drawing& drawing, const DrawnLayers& layers, const tbb::blocked_range2d<int>& range,
               Image& image) {
  constexpr int kMaskBlocks = kMaskWidth / kBlock;
  for (int r = range.rows().begin(); r < range.rows().end(); ++r) {
    const int y0 = drawing.rows.begin + r * kBlock, y1 = std::min(y0 + kBlock, drawing.rows.end);
    bool any = true;
    for (int c = range.cols().begin(); c < range.cols().end(); ++c) {
      const int x0 = c * kBlock;
      if (drawing.mask && (c % kMaskBlocks == 0 || c == range.cols().begin())) {
        const int first = c / kMaskBlocks * kMaskWidth;
        any = drawing.mask->any(first, std::min(first + kMaskWidth, drawing.info.width), y0, y1);
      }
      if (any) draw_block(drawing, layers, x0, y0, image);
    }
  }
}

/// Draws the layers of one camera: that of the picture if `view` is 0, otherwise that of layer `view`.
void draw_view(const TracedScene& traced, const PictureInfo& info, const Rows& drawn,
               const std::vector<DrawnPlane>& planes, const CaptureSettings& settings, int view,
               const DrawnLayers& layers, std::vector<PenumbraRadii>* penumbrae, Watch& watch, Image& image) {
  Drawing drawing{.traced = traced,
                  .info = layer_info(info, view),
                  .rows = drawn,
                  .rays = {},
                  .lights = {},
                  .blended = settings.blended,
                  .ray_offsets = settings.ray_offsets,
                  .sample = settings.sample,
                  .planes = planes,
                  .penumbrae = penumbrae,
                  .mask = settings.mask.get()};
  const auto has_plane = [&](std::string_view name) {
    return std::any_of(planes.begin(), planes.end(), [&](const DrawnPlane& plane) { return plane.name == name; });
  };
  drawing.parts.albedo = has_plane("albedo.r") || has_plane("albedo.g") || has_plane("albedo.b");
  drawing.parts.emission = has_plane("emission.r") || has_plane("emission.g") || has_plane("emission.b");
  drawing.parts.surface = has_plane("metallic") || has_plane("roughness") || has_plane("material_ao");
  drawing.rays = camera_rays(traced, drawing.info);
  drawing.lights = shadow_lights(traced, drawing.rays, drawing.info, settings);
  if (!settings.soft_shadows) std::erase_if(drawing.lights, [](const ShadowLight& light) { return light.rays > 0; });
  if (!rays_within_limit(drawing.rays, drawing.info)) {
    // The camera is too far away for rays to be traced.
    Block background;
    clear(drawing, background);
    for (int y = drawn.begin; y < drawn.end; y += kBlock)
      for (int x = 0; x < info.width; x += kBlock)
        for (int layer = 0; layer < layers.count; ++layer)
          for (const int first : {layers.first, layers.backs})
            if (first >= 0) store(drawing, background, x, y, first + layer, image);
    return;
  }
  const int columns = (info.width + kBlock - 1) / kBlock, rows = (drawn.count() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, kTileBlocks, 0, columns, kTileBlocks), [&](const auto& range) {
    if (watch.ended()) return;
    draw_tile(drawing, layers, range, image);
    fault_point();
    watch.done(long(range.rows().size()) * long(range.cols().size()));
  });
}

/// Returns the number of blocks in these rows.
long blocks_of(const PictureInfo& info, const Rows& rows) {
  return long((info.width + kBlock - 1) / kBlock) * long((rows.count() + kBlock - 1) / kBlock);
}

/// Returns the radii for each shadow to soften, infinite everywhere.
std::vector<PenumbraRadii> penumbra_radii(const PictureInfo& info, const Rows& rows, const CaptureSettings& settings) {
  std::vector<PenumbraRadii> all;
  for (const int light : softened_lights(info, settings)) {
    const Plane none(info.width, soften_blocks(rows.count()), std::numeric_limits<float>::infinity());
    all.push_back({light, none, none});
  }
  return all;
}

}  // namespace

Result<Image> capture_planes(const TracedScene& traced, const PictureInfo& info, const CaptureSettings& settings,
                             const ProgressMonitor& monitor, bool scalar) {
  const std::vector<DrawnPlane> planes = drawn_planes(*traced.scene, info, settings);
  const int all = 1 + int(info.more_layers.size());
  const Rows rows = settings.strip ? rows_with_margin(*settings.strip, info.height) : Rows{0, info.height};
  Image image(info.width, rows.count());
  image.planes.reserve(std::size_t(all) * planes.size());
  for (int layer = 0; layer < all; ++layer)
    for (const DrawnPlane& plane : planes) image.add(layer_plane(layer, plane.name));
  DrawnLayers own;
  for (int layer = 1; layer < all; ++layer) {
    const LayerKind kind = info.more_layers[std::size_t(layer) - 1].kind;
    if (kind == LayerKind::kBehind) ++own.count;
    if (kind == LayerKind::kBack && own.backs < 0) own.backs = layer;
  }
  const auto others = std::count_if(info.more_layers.begin(), info.more_layers.end(),
                                    [](const LayerInfo& layer) { return layer.kind == LayerKind::kOther; });
  Watch watch(monitor, blocks_of(info, rows) * (1 + long(others)));
  std::vector<PenumbraRadii> penumbrae;
  if (settings.soft_shadows) penumbrae = penumbra_radii(info, rows, settings);
  // The filter of shadows reads pixels beside those of the mask, and weights of blended surfaces count at all pixels.
  for (std::size_t k = 0; settings.mask && (settings.soft_shadows || settings.blended) && k < planes.size(); ++k)
    image.planes[k] = Plane(info.width, rows.count(), planes[k].background_value);
  draw_view(traced, info, rows, planes, settings, 0, own, settings.soft_shadows ? &penumbrae : nullptr, watch, image);
  for (int layer = 1; layer < all; ++layer)
    if (info.more_layers[std::size_t(layer) - 1].kind == LayerKind::kOther)
      draw_view(traced, info, rows, planes, settings, layer, {.first = layer}, nullptr, watch, image);
  if (watch.ended()) return interrupted();
  soften_shadows(info, rows, penumbrae, scalar, image);
  return image;
}

}  // namespace umbrage
