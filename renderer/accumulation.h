// Accumulation: averages several renderings of one picture, each sampled at another offset within its pixels. The
// average is anti-aliased and has less noise.
#pragma once
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"

namespace umbrage {

inline constexpr int kMaxAveragedPictures = 256;

/// Returns the offset of the sample positions from the pixel centres for sample index `sample` of `count`, in pixels.
/// The offsets are well distributed over (-0.5, 0.5)^2; their mean is 0 for `count` >= 3. Index 0 samples the centres.
/// Indices from `count` on continue the sequence without repeating. Based on [Roberts 2018], R2.
glm::vec2 sample_offset(int sample, int count);

/// Returns a camera whose pixel centres show the points that `camera` shows `offset` pixels to the right of and below
/// its pixel centres, in a picture of width x height pixels.
Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height);

/// A sum of pictures with the same planes.
struct PictureSum {
  bool as_square_roots = false;  ///< the sum is of square roots of light, as in mixed_as_square_roots
  int per_sample = 1;            ///< number of pictures per sample, whose weights have the sum 1
  int threads = 1;               ///< number of threads to use
  Plane marks = {};              ///< 1: pixels to which all pictures are added; others get only whole ones. Empty: all
  int count = 0;                 ///< number of pictures
  int whole = 0;                 ///< number of those that were added to all pixels
  Image sum;  ///< colour (or its square roots) times alpha; alpha; likewise beauty; the other planes unchanged
};

/// Adds a picture. Its planes: color.r, .g, .b (linear light, straight alpha) and color.a, or none of these four; the
/// same of beauty, which is premultiplied; and any other planes.
void add_picture(PictureSum& total, const Image& picture);

/// Makes one picture of those that were added, where some were added at the marks only: pixels beside the marks have
/// one picture then, and those at the marks the mean of theirs. Further pictures weigh alike at all pixels.
void count_as_one(PictureSum& total);

/// Counts a picture, of which rows are then added. `whole`: to all pixels, not only at the marks.
void count_picture(PictureSum& total, bool whole);

/// Adds rows of a picture with the planes of the sum, one for each name, to all pixels or only at the marks, if there
/// are any. `first`: index of the first added row.
void add_planes(PictureSum& total, const std::vector<std::string>& names, std::span<const Plane* const> planes,
                int first, bool whole);

/// Adds rows of a picture of `height` rows to all pixels; `first` is the index of the first added row. Row 0 of a
/// picture must be added first: it counts the picture, and the first picture gives the sum its planes.
void add_rows(PictureSum& total, const Image& rows, int first, int height);

/// Returns the sum of `count` rows, from row `first`.
PictureSum rows_of(const PictureSum& total, int first, int count);

/// Returns the average of `pass`, color or beauty, as a G-buffer for effect `output`: lit (multiplied by alpha), cover
/// (mean alpha; named `cover_for_eye` if `as_square_roots` is set), and a depth of infinity everywhere. Takes
/// the planes of the pass out of the sum.
GBuffer mean_picture(PictureSum& total, const PictureInfo& info, const std::string& pass = "color");

/// Returns the means of these planes. They must be neither colour nor beauty.
Image mean_planes(const PictureSum& total, std::span<const std::string> names);

}  // namespace umbrage
