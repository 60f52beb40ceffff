#include "devices/cpu/capture_block.h"

#include <algorithm>
#include <limits>

#include "devices/shared/capture_info.h"

namespace umbrage {

std::vector<DrawnPlane> drawn_planes(const Scene& scene, const PictureInfo& info, const CaptureSettings& settings) {
  std::vector<DrawnPlane> all = {{"depth", offsetof(Block, depth), std::numeric_limits<float>::infinity()},
                                 {"normal.x", offsetof(Block, nx)},
                                 {"normal.y", offsetof(Block, ny)},
                                 {"normal.z", offsetof(Block, nz)},
                                 {"albedo.r", offsetof(Block, ar)},
                                 {"albedo.g", offsetof(Block, ag)},
                                 {"albedo.b", offsetof(Block, ab)},
                                 {"specular", offsetof(Block, specular)},
                                 {"shininess", offsetof(Block, shininess)},
                                 {"object_id", offsetof(Block, object), -1.0f},
                                 {"material_id", offsetof(Block, material), -1.0f},
                                 {"emission.r", offsetof(Block, er)},
                                 {"emission.g", offsetof(Block, eg)},
                                 {"emission.b", offsetof(Block, eb)},
                                 {"metallic", offsetof(Block, metallic)},
                                 {"roughness", offsetof(Block, roughness), kNoRoughness},
                                 {"material_ao", offsetof(Block, material_ao), 1.0f},
                                 {"opacity", offsetof(Block, opacity)},
                                 {"transmittance.r", offsetof(Block, tr), 1.0f},
                                 {"transmittance.g", offsetof(Block, tg), 1.0f},
                                 {"transmittance.b", offsetof(Block, tb), 1.0f},
                                 {"ray_offset.x", offsetof(Block, ox)},
                                 {"ray_offset.y", offsetof(Block, oy)},
                                 {"ray_offset.z", offsetof(Block, oz)}};
  for (int k = 0; k < kMaxShadows; ++k)
    all.push_back({shadow_plane(k), offsetof(Block, shadow) + std::size_t(k) * sizeof(Block::shadow[0]), 1.0f});
  std::vector<DrawnPlane> planes;
  for (const std::string& name : captured_planes(scene, info, settings))
    planes.push_back(
        *std::find_if(all.begin(), all.end(), [&](const DrawnPlane& plane) { return plane.name == name; }));
  return planes;
}

}  // namespace umbrage
