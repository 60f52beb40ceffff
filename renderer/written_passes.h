// Passes as they are written: with their values at pixels that show no surface, also not the unseen ground under a
// model, and as pictures for files and displays that hold display values.
#pragma once
#include <string>
#include <vector>

#include "core/device.h"
#include "core/gbuffer.h"
#include "looks/settings.h"

namespace umbrage {

/// Returns the planes from which set_background finds the pixels without surface, for those of `names` that it changes:
/// depth, and object_id if the picture has an unseen ground.
std::vector<std::string> background_planes(const std::vector<std::string>& names, bool has_ground);

/// Gives pixels without surface their background values: 1 in occlusion and shadows, -1 in ids and roughness, infinity
/// in depth, and 0 in other planes of geometry and of light that is reflected. `image` includes background_planes.
/// `ground_object`: object id of the unseen ground; < 0: there is none.
void set_background(Image& image, int ground_object);

/// Returns the planes `names` of a frame as they are written, after set_background; perhaps with further planes behind
/// them. They may be views: see Device::view. Errors: those of Device::download.
Result<Image> download_passes(Device& device, const Frame& frame, const std::vector<std::string>& names);

/// Converts the planes `names` of passes to display values: colours and light are encoded by sRGB, vectors map from
/// [-1, 1] to [0, 1], depth from white (near) to black (far). One plane keeps its name; several become color.r, .g, .b
/// and .a. `info`: for the range of depth.
Image picture_of_passes(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info);

/// Returns lines alone, in their colour, with alpha. `cover`: the pass `outline`.
Image picture_of_lines(const Plane& cover, const EffectSettings& settings);

}  // namespace umbrage
