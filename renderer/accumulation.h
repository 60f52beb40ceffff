// Accumulation: averages several renderings of one picture, each sampled at another offset within its pixels. The
// average is anti-aliased and has less noise.
#pragma once
#include <glm/vec2.hpp>
#include <span>
#include <string>

#include "core/device.h"

namespace umbrage {

inline constexpr int kMaxFrames = 256;

/// Returns the offset of the sample positions from the pixel centres for sample index `frame` of `count`, in pixels:
/// well distributed over (-0.5, 0.5)^2, with mean 0 for `count` >= 3. Index 0 samples the centres.
/// Based on [Roberts 2018], R2.
glm::vec2 sample_offset(int frame, int count);

/// Returns the camera that samples at its pixel centres what `camera` sees `offset` pixels to the right of and below
/// its own, in a picture of width x height pixels.
Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height);

/// A sum of pictures.
struct PictureSum {
  bool as_square_roots = false;  ///< colour is averaged as square roots of light, as in mixed_as_square_roots
  int count = 0;
  Image sum;  ///< colour (or its square roots) multiplied by alpha; alpha; the other averaged planes, unchanged
};

/// Adds a picture. Planes: color.r, .g, .b (linear light, straight alpha) and color.a, or none of the four, and any
/// others. All pictures of a sum have the same planes.
void add_picture(PictureSum& total, const Image& picture);

/// Adds rows of a picture of `height` rows; `first` is the index of the first one. Row 0 of each picture comes first.
void add_rows(PictureSum& total, const Image& rows, int first, int height);

/// Returns the sum of `count` rows, from row `first`.
PictureSum rows_of(const PictureSum& total, int first, int count);

/// Returns the averaged colour as a G-buffer for effect `output`: lit (multiplied by alpha), cover (mean alpha; named
/// `cover_for_eye` if `as_square_roots` is set), and a depth of infinity everywhere.
GBuffer mean_picture(const PictureSum& total, const PictureInfo& info);

/// Returns the means of these planes, which are not colour.
Image mean_planes(const PictureSum& total, std::span<const std::string> names);

}  // namespace umbrage
