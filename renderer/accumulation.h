// Accumulation: averages several renderings of one picture, each sampled at another offset within its pixels. The
// average is anti-aliased and has less noise.
#pragma once
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/device.h"
#include "core/strip.h"

namespace umbrage {

inline constexpr int kMaxAveragedPictures = 256;

/// Returns the offset of the sample positions from the pixel centres for sample index `sample` of `count`, in pixels.
/// The offsets are well distributed over (-0.5, 0.5)^2; their mean is 0 for `count` >= 3. Index 0 samples the centres.
/// Of an odd `count`, each of as many rows and columns of a pixel has one. Indices from `count` on continue the
/// sequence without repeating. Based on [Roberts 2018], R2.
glm::vec2 sample_offset(int sample, int count);

/// Returns a camera whose pixel centres show the points that `camera` shows `offset` pixels to the right of and below
/// its pixel centres, in a picture of width x height pixels.
Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height);

/// A sum of samples of a picture, or of rows of it.
struct PictureSum {
  bool as_square_roots = false;  ///< the sum is of square roots of light, as in mixed_as_square_roots
  int threads = 1;               ///< number of threads to use
  int first = 0;                 ///< index of the row of the picture that is row 0 of the sum
  Plane marks = {};              ///< 1: pixels to which all samples are added; others get only whole ones. Empty: all
  int count = 0;                 ///< number of samples
  int whole = 0;                 ///< number of those that were added to all pixels
  Image sum;  ///< colour (or its square roots) times alpha; alpha; likewise beauty; the other planes unchanged
};

/// Returns an empty sum of these planes.
PictureSum empty_sum(const std::vector<std::string>& names, int width, const Rows& rows);

/// Makes one sample of those that were added, where some were added at the marks only: pixels beside the marks have
/// one sample then, and those at the marks the mean of theirs. Further samples weigh alike at all pixels.
void count_as_one(PictureSum& total);

/// Counts a sample, of which rows are then added. `whole`: to all pixels, not only at the marks.
void count_sample(PictureSum& total, bool whole);

/// Adds rows of a picture, which have the planes of the sum, to all pixels or only at the marks, if there are any.
/// `first`: index of the first row in the picture. The planes: color.r, .g, .b (linear light, straight alpha) and
/// color.a, or none of these four; the same of beauty, which is premultiplied; and any other planes.
void add_rows(PictureSum& total, const Image& rows, int first, bool whole);

/// Adds to the rows from `first` of the picture on their mean, as the last sample, which the rows above have.
void repeat_mean(PictureSum& total, int first);

/// Returns the sum of `count` rows, from row `first` of the picture.
PictureSum rows_of(const PictureSum& total, int first, int count);

/// Returns the average of `pass`, color or beauty, as a G-buffer for effect `output`: lit (multiplied by alpha), cover
/// (mean alpha; named `cover_for_eye` if `as_square_roots` is set), and a depth of infinity everywhere. Takes
/// the planes of the pass out of the sum.
GBuffer mean_picture(PictureSum& total, const PictureInfo& info, const std::string& pass = "color");

/// Returns the means of these planes. They must be neither colour nor beauty.
Image mean_planes(const PictureSum& total, std::span<const std::string> names);

}  // namespace umbrage
