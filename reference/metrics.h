// Metrics: the error of a picture against the reference, over all covered pixels and by class of pixel.
//
// A picture is one plane (occlusion, display values) or three (light, linear Rec.709, displayed with the sRGB curve).
// Values are expected in [0, 1]. Other values count unchanged in the errors and are clamped in the perceptual metric
// (FLIP).
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/gbuffer.h"
#include "core/image.h"

namespace umbrage {

/// The class of a pixel: the first in this order that applies.
enum class PixelClass : std::uint8_t {
  kBorder,      ///< near the picture's border, beyond which a screen-space technique has no data
  kThin,        ///< on a narrow surface in front of a farther one
  kSilhouette,  ///< beside a depth discontinuity, on either side
  kOpen,        ///< all other surfaces
  kBackground,  ///< no surface: never counted
};
inline constexpr int kPixelClasses = 4;  // without kBackground
inline constexpr std::array<std::string_view, kPixelClasses> kPixelClassNames = {"border", "thin", "silhouette",
                                                                                 "open"};

/// One class per pixel, row by row from the top.
struct ClassMap {
  int width = 0, height = 0;
  std::vector<PixelClass> classes;
  const PixelClass* row(int y) const { return classes.data() + std::size_t(y) * width; }
};

/// Classifies the pixels of a G-buffer's first layer by its planes `depth` and `normal` and the camera. The result does
/// not depend on the scene's scale; widths are proportional to the picture's height, so that an object keeps its class
/// at any resolution. Without a depth plane all pixels are background. A normal that is missing, 0 or NaN counts as
/// facing the camera.
ClassMap classify(const GBuffer& gbuffer);

/// Scores of a set of pixels. All channels have the same weight. Without pixels, psnr is infinite, ssim 1, all others
/// 0.
struct Scores {
  long pixels = 0;
  double rmse = 0.0;  ///< root of the mean squared error
  double bias = 0.0;  ///< mean of picture minus reference; < 0: too dark
  double psnr = 0.0;  ///< dB, for a peak of 1; infinite if the pictures are equal
  double ssim = 1.0;  ///< mean structural similarity [Wang et al. 2004]
  double p99 = 0.0;   ///< 99th percentile of the absolute errors
  double flip = 0.0;  ///< mean of the perceptual error [Andersson et al. 2020], 0 to 1
};

/// Scores of a picture: over all covered pixels and by class.
struct ScoreCard {
  Scores covered;
  std::array<Scores, kPixelClasses> by_class;
};

/// Compares a picture with the reference. Both must have one plane or both three, in the same order, of the map's size.
/// Values that are not finite count as 0. The scores are bitwise identical for any number of threads.
ScoreCard score(const Image& picture, const Image& truth, const ClassMap& classes);

/// Value to which the mean of the reference's light is exposed, linear: middle grey.
inline constexpr double kMiddleGrey = 0.18;

/// Returns the mean over the counted pixels and all planes; 0 if there are none.
double mean_of(const Image& picture, const ClassMap& classes);

/// Compares light of arbitrary unit: errors are relative to the reference's mean (a black picture has a bias of -1),
/// and the perceptual metrics (SSIM, FLIP) use the exposure at which the reference's mean is middle grey. If the
/// reference is black everywhere, returns score().
ScoreCard score_light(const Image& picture, const Image& truth, const ClassMap& classes);

/// Returns the perceptual error of each pixel, as score() uses it. Background pixels count as white in both
/// pictures and have no error.
Plane flip_map(const Image& picture, const Image& truth, const ClassMap& classes);

/// Returns the structural similarity [Wang et al. 2004] around each covered pixel, -1 to 1, averaged over the planes; 1
/// at background pixels. Windows contain only covered pixels inside the picture.
Plane ssim_map(const Image& picture, const Image& truth, const ClassMap& classes);

/// Values that count in a comparison: those of covered pixels, with 0 in place of NaN and infinity.
inline constexpr int kRowsPerTask = 16;  ///< of flip and SSIM: enough to outweigh the scratch memory of a task

inline bool is_counted(PixelClass pixel) { return pixel != PixelClass::kBackground; }

inline float finite_or_zero(float value) { return std::isfinite(value) ? value : 0.0f; }

/// Copies a row of a plane: `background` where there is no surface, 0 where the value is not finite.
inline void counted_row(const float* values, const PixelClass* classes, int width, float background, float* out) {
  for (int x = 0; x < width; ++x) out[x] = is_counted(classes[x]) ? finite_or_zero(values[x]) : background;
}

}  // namespace umbrage
