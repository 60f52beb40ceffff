// Frames: several pictures of one scene, each sampled elsewhere within its pixels, averaged to one without jagged edges
// and with less noise.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "looks/agreement.h"

namespace umbrage {

inline constexpr int kMostFrames = 256;

/// Where frame `frame` of `count` samples its pixels, from their centres, in pixels: well spread over (-0.5, 0.5)^2,
/// the mean 0 for 3 frames and more. Frame 0 has the centres. Based on [Roberts 2018], R2.
glm::vec2 frame_offset(int frame, int count);

/// The camera that sees at pixel centres what `camera` sees `offset` pixels to the right and below of them, in a
/// picture of that size.
Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height);

/// A sum of pictures.
struct PictureSum {
  bool for_eye = false;  ///< colour is averaged as square roots of light, as mixed_for_the_eye has it
  float opacity = 0.0f;  ///< of lines, plane `outline`, if pictures are to agree on them; or 0
  float line_px = 1.0f;  ///< their width
  int count = 0;
  Image sum;                       ///< colour, or its roots, multiplied by alpha; alpha; and what else is averaged
  std::vector<LinePicture> lines;  ///< of the last kMostLinePictures, until they agree
  Plane agreed;                    ///< lines that they agreed on, or empty
};

/// Of more pictures the lines of so many count where they disagree, since each takes a byte a pixel; of others what
/// they have alone stays in the mean.
inline constexpr int kMostLinePictures = 16;

/// Adds a picture: planes color.r, .g, .b as light with straight alpha, color.a, and any others. All have the planes of
/// the first. `offset`: of its samples, as frame_offset has it.
void add_picture(PictureSum& total, const Image& picture, glm::vec2 offset);

/// Adds rows of a picture of that height, the first of them `first`; the first rows of each picture come first.
void add_rows(PictureSum& total, const Image& rows, int first, int height, glm::vec2 offset);

/// After the last picture, where three or more are to agree on lines: lets them.
void agree_on_lines(PictureSum& total);

/// So many rows of a plane.
Plane some_rows(const Plane& from, int first, int count);

/// The sum of so many rows, without what single pictures have.
PictureSum rows_of(const PictureSum& total, int first, int count);

/// The average of the pictures' colour over their mean alpha, as planes that effect `output` makes the finished picture
/// of: lit (multiplied by alpha), cover (alpha), depth (none). For the eye alpha is `outline`, which `output` mixes so.
/// Where pictures are to agree on lines `line` is the colour of those in the pictures, as light.
GBuffer mean_picture(const PictureSum& total, const PictureInfo& info, glm::vec3 line = glm::vec3(0.0f));

/// The average of planes besides color.
Image mean_planes(const PictureSum& total, std::span<const std::string> names);

}  // namespace umbrage
