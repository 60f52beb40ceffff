#include "devices/vulkan/device_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "core/color.h"
#include "devices/vulkan/capture.h"
#include "devices/vulkan/hierarchy.h"
#include "rays/mip_texture.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

constexpr std::size_t kChunk = std::size_t(64) << 20;  // bytes copied at once

using Bytes = std::span<const std::byte>;

template <class T>
Bytes bytes_of(const std::vector<T>& v) {
  return std::as_bytes(std::span(v));
}

Result<DevicePlanePtr> upload(Bytes bytes, Memory& memory, Commands& commands, const Gpu& gpu) {
  auto to = memory.plane(std::max<std::size_t>(bytes.size(), 1));
  if (!to) return to;
  for (std::size_t done = 0; done < bytes.size(); done += kChunk) {
    const std::size_t size = std::min(kChunk, bytes.size() - done);
    const auto staged = memory.host(size);
    if (!staged) return staged.error();
    std::memcpy((*staged)->mapped, bytes.data() + done, size);
    const auto buffer = commands.buffer();
    if (!buffer) return buffer.error();
    commands.barrier();
    const VkBufferCopy region{0, (*to)->offset + done, size};
    gpu.vk.CmdCopyBuffer(*buffer, (*staged)->buffer, (*to)->buffer, 1, &region);
    if (auto copied = commands.finish(); !copied) return copied.error();
  }
  return to;
}

/// Returns the meshes with their materials. Vertex colours are stored only for meshes that have them, one mesh after
/// the other.
std::vector<CaptureMesh> meshes_of(const Scene& scene) {
  std::vector<CaptureMesh> meshes;
  int vertices = 0, colors = 0;
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[mesh.material];
    CaptureMesh out{};
    for (int c = 0; c < 3; ++c) {
      out.albedo[c] = material.albedo[c];
      out.emission[c] = material.emission[c];
    }
    out.specular = material.specular_strength;
    out.shininess = material.specular_exponent;
    out.texture_index = mesh.uvs.empty() ? kNoTexture : material.texture;
    out.emission_texture = mesh.uvs.empty() ? kNoTexture : material.emission_texture;
    out.surface_texture = mesh.uvs.empty() ? kNoTexture : material.surface_texture;
    out.normal_texture = mesh.uvs.empty() ? kNoTexture : material.normal_texture;
    out.metallic = material.metallic;
    out.roughness = material.roughness;
    out.occlusion_strength = material.occlusion_strength;
    out.normal_scale = material.normal_scale;
    if (material.blended)
      out.masked = kBlended;
    else if (material.alpha_mask && out.texture_index != kNoTexture)
      out.masked = kMasked;
    out.cutoff = material.alpha_cutoff;
    out.opacity = material.opacity;
    out.glass = material.glass ? 1 : 0;
    for (int c = 0; c < 3; ++c) out.tint[c] = material.tint[c];
    out.object_id = float(mesh.object);
    out.material_id = float(mesh.material);
    out.colored = mesh.colors.empty() ? 0 : 1;
    out.color_shift = colors - vertices;
    vertices += int(mesh.positions.size());
    colors += int(mesh.colors.size());
    meshes.push_back(out);
  }
  return meshes;
}

/// Returns the sample points on lights, followed by the linear values of sRGB bytes.
std::vector<float> point_table() {
  std::vector<float> out;
  const auto points = disc_points();
  for (const auto& set : points)
    for (const glm::vec2& p : set) out.insert(out.end(), {p.x, p.y});
  for (const glm::vec2& p : disc_border_points()) out.insert(out.end(), {p.x, p.y});
  for (int byte = 0; byte < 256; ++byte) out.push_back(linear_from_srgb(float(byte) / 255.0f));
  return out;
}

}  // namespace

Result<DeviceScene> upload_scene(const Scene& scene, Memory& memory, Commands& commands, const Gpu& gpu,
                                 const ProgressMonitor& monitor) {
  static_assert(kCaptureDiscPoints == kDiscPoints && kPacket == 16);
  DeviceScene out;
  out.scene = &scene;
  out.center = scene.center();
  if (const float radius = scene.radius(); radius > 0.0f) out.scale = std::exp2(-std::round(std::log2(radius)));
  const auto hierarchy = build_hierarchy(scene, out.center, out.scale, monitor);
  if (!hierarchy) return hierarchy.error();
  out.root = hierarchy->root;
  out.empty = hierarchy->empty();
  out.points = scene.point_count() > 0;
  out.triangles = int(hierarchy->triangles.size());

  Poll poll(monitor);
  poll.part(1.0, 1.0);
  std::vector<glm::vec3> normals, colors;
  std::vector<glm::vec2> uvs;
  for (const Mesh& mesh : scene.meshes) {
    const std::size_t vertices = normals.size() + mesh.positions.size();
    normals.insert(normals.end(), mesh.normals.begin(), mesh.normals.end());
    normals.resize(vertices, glm::vec3(0.0f));
    uvs.insert(uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
    uvs.resize(vertices, glm::vec2(0.0f));
    colors.insert(colors.end(), mesh.colors.begin(), mesh.colors.end());
  }
  std::vector<CaptureTexture> textures;
  std::vector<CaptureLevel> levels;
  std::vector<std::uint8_t> texels;
  for (const Texture& texture : scene.textures) {
    if (poll.passing(0.0)) return interrupted();
    const MipTexture mips = make_mips(texture);
    textures.push_back({int(levels.size()), int(mips.levels.size()), mips.linear ? 1 : 0});
    for (const MipLevel& level : mips.levels) {
      levels.push_back(
          {int(texels.size() / 4), level.width, level.height, level.nearest ? 1 : 0, level.clamped ? 1 : 0});
      texels.insert(texels.end(), level.rgba.begin(), level.rgba.end());
    }
  }
  const std::vector<CaptureMesh> meshes = meshes_of(scene);
  out.masks = std::any_of(meshes.begin(), meshes.end(), [](const CaptureMesh& mesh) { return mesh.masked != 0; });
  const std::vector<float> points = point_table();
  for (const Bytes bytes :
       {bytes_of(hierarchy->nodes), bytes_of(hierarchy->triangles), bytes_of(normals), bytes_of(uvs), bytes_of(meshes),
        bytes_of(textures), bytes_of(levels), bytes_of(texels), bytes_of(points), bytes_of(colors)}) {
    if (poll.passing(0.0)) return interrupted();
    auto buffer = upload(bytes, memory, commands, gpu);
    if (!buffer) return buffer.error();
    out.buffers.push_back(std::move(*buffer));
  }
  return out;
}

}  // namespace umbrage
