// What an image around a scene does to it: lights it, and lies behind it.
#pragma once
#include "renderer/job.h"

namespace umbrage {

/// Puts the light of the image, which must have been read, in the place of the scene's own.
void light_by(const Hdri& hdri, Scene& scene);

/// How high above the horizon the lowest light stands, of those above it; nothing where there is none.
std::optional<float> lowest_light_deg(const Scene& scene);

/// The planes sky.r, sky.g and sky.b of a picture: the image's radiance, times `gain`, as each pixel's ray sees it.
/// Those rows of them alone.
Image sky_planes(const Hdri& hdri, glm::vec3 up, float gain, const PictureInfo& info, const Rows& rows);

}  // namespace umbrage
