// The values of a block of 4 x 4 pixels, which one packet of rays captures, and the planes that store them.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "core/device.h"
#include "rays/ray_packet.h"
#include "rays/shadow_lights.h"

namespace umbrage {

/// Values of a block of pixels. They are stored row by row once complete, since scattering single floats over a dozen
/// planes costs more than shading.
struct alignas(64) Block {
  float depth[kPacket], nx[kPacket], ny[kPacket], nz[kPacket], ar[kPacket], ag[kPacket], ab[kPacket];
  float specular[kPacket], shininess[kPacket], shadow[kMaxShadows][kPacket], er[kPacket], eg[kPacket], eb[kPacket];
  float metallic[kPacket], roughness[kPacket], material_ao[kPacket], object[kPacket], material[kPacket];
  float opacity[kPacket], tr[kPacket], tg[kPacket], tb[kPacket], ox[kPacket], oy[kPacket], oz[kPacket];
  PenumbraSize penumbra[kMaxShadows];
};

/// A plane to capture, and the offset of its values in a block.
struct DrawnPlane {
  std::string name;
  std::size_t offset;
  float background_value = 0.0f;  ///< value where there is no surface

  float* in(Block& block) const { return reinterpret_cast<float*>(reinterpret_cast<char*>(&block) + offset); }
  const float* in(const Block& block) const {
    return reinterpret_cast<const float*>(reinterpret_cast<const char*>(&block) + offset);
  }
};

/// Returns the planes of a layer, and their offsets in a block.
std::vector<DrawnPlane> drawn_planes(const Scene& scene, const PictureInfo& info, const CaptureSettings& settings);

}  // namespace umbrage
