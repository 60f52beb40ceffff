// Held occluders: the occluders that the depth layers of a picture hold, as opposed to all of the scene. They bound
// what a screen-space technique can know.
#pragma once
#include <array>
#include <vector>

#include "core/gbuffer.h"
#include "rays/camera_rays.h"
#include "rays/ray_packet.h"

namespace umbrage {

/// The occluders that count. A surface point is held by a picture if it is inside the picture, guard band included, and
/// among the first surfaces along the ray of the camera through it. The sides of a surface do not matter.
enum class Occluders {
  kAll,     ///< all of the scene
  kWindow,  ///< those held by the first layer
  kLayers,  ///< those held by any layer of the picture, those of its extra views included
};

/// One camera of a picture with the surfaces that its layers hold.
struct HeldView {
  Camera camera;
  CameraRays rays;
  int layers = 1;  ///< number of surfaces along each ray
};

/// Returns the views of a picture that hold occluders; none for kAll.
std::vector<HeldView> held_views(const TracedScene& traced, const PictureInfo& info, Occluders occluders);

/// Returns for each ray of the packet, from 0 to `length`, the distance of its nearest hit that one of the views holds;
/// infinity if there is none. Whether a view holds a hit is decided by a ray of its camera that ends at the hit, raised
/// along the triangle's normal as in ray_origin_above, and at whose start surfaces closer to each other than 1e-5 of
/// their distances from the scene's centre and the camera count as one, as in captures. Camera rays pass through
/// blended surfaces with less than `min_opacity`. The hits of the packet are undefined afterwards.
std::array<float, kPacket> held_hit_distances(const TracedScene& traced, const std::vector<HeldView>& views,
                                              float length, float min_opacity, RayPacket& rays);

}  // namespace umbrage
