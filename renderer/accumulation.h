// Frames: several pictures of one scene, each sampled elsewhere within its pixels, averaged to one without jagged edges
// and with less noise.
#pragma once
#include <glm/vec2.hpp>
#include <span>
#include <string>

#include "core/device.h"

namespace umbrage {

inline constexpr int kMaxFrames = 256;

/// Where frame `frame` of `count` samples its pixels, from their centres, in pixels: well spread over (-0.5, 0.5)^2,
/// the mean 0 for 3 frames and more. Frame 0 has the centres. Based on [Roberts 2018], R2.
glm::vec2 frame_offset(int frame, int count);

/// The camera that sees at pixel centres what `camera` sees `offset` pixels to the right and below of them, in a
/// picture of that size.
Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height);

/// A sum of pictures.
struct PictureSum {
  bool for_eye = false;  ///< colour is averaged as square roots of light, as mixed_for_the_eye has it
  int count = 0;
  Image sum;  ///< colour, or its roots, multiplied by alpha; alpha; and what else is averaged
};

/// Adds a picture: planes color.r, .g, .b as light with straight alpha and color.a, or none of these, and any others.
/// All have the planes of the first.
void add_picture(PictureSum& total, const Image& picture);

/// Adds rows of a picture of that height, the first of them `first`; the first rows of each picture come first.
void add_rows(PictureSum& total, const Image& rows, int first, int height);

/// The sum of so many rows.
PictureSum rows_of(const PictureSum& total, int first, int count);

/// The average of the pictures' colour over their mean alpha, as planes that effect `output` makes the finished picture
/// of: lit (multiplied by alpha), cover (alpha), depth (none). For the eye alpha is `cover_for_eye`.
GBuffer mean_picture(const PictureSum& total, const PictureInfo& info);

/// The average of planes besides color.
Image mean_planes(const PictureSum& total, std::span<const std::string> names);

}  // namespace umbrage
