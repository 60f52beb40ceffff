// Metrics: how far a picture is from the truth, over all that is covered and by class of pixel.
//
// A picture is one plane (occlusion, shown on a screen as it is) or three (light, linear Rec.709, shown through the
// sRGB curve). Values are meant for [0, 1]; what lies outside counts as it is in the errors and is clamped where the
// eye is asked (FLIP).
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/gbuffer.h"
#include "core/image.h"

namespace umbrage {

/// Where in the picture a pixel lies. Each covered pixel has one class: the first of this order that fits.
enum class PixelClass : std::uint8_t {
  kBorder,      ///< near the frame's border, behind which a screen-space technique sees nothing
  kThin,        ///< on something narrow that stands before something farther
  kSilhouette,  ///< beside a jump in depth, on either side
  kOpen,        ///< all other surfaces
  kBackground,  ///< no surface: never counted
};
inline constexpr int kPixelClasses = 4;  // those that are counted
inline constexpr std::array<std::string_view, kPixelClasses> kPixelClassNames = {"border", "thin", "silhouette",
                                                                                 "open"};

/// One class per pixel, row by row from the top.
struct ClassMap {
  int width = 0, height = 0;
  std::vector<PixelClass> classes;
  const PixelClass* row(int y) const { return classes.data() + std::size_t(y) * width; }
};

/// Sorts the pixels of a G-buffer's first layer by its planes `depth` and `normal` and the camera. Nothing depends on
/// the scene's scale; widths follow the picture's height, so that a thing keeps its class at any resolution. Without a
/// depth all is background; a normal that is missing, 0 or no number counts as facing the viewer.
ClassMap classify(const GBuffer& gbuffer);

/// Scores over a set of pixels; channels count alike. Of no pixels: all 0, psnr infinite, ssim 1.
struct Scores {
  long pixels = 0;
  double rmse = 0.0;  ///< root of the mean squared error
  double bias = 0.0;  ///< mean of picture minus truth: below 0 is too dark
  double psnr = 0.0;  ///< dB, for a peak of 1; infinite where the pictures are equal
  double ssim = 1.0;  ///< mean structural similarity [Wang et al. 2004]
  double p99 = 0.0;   ///< the smallest number that 99 % of the absolute errors do not exceed
  double flip = 0.0;  ///< mean of the perceptual error [Andersson et al. 2020], 0 to 1
};

struct ScoreCard {
  Scores covered;
  std::array<Scores, kPixelClasses> by_class;
};

/// Compares a picture with the truth: both one plane or both three, in the same order, of the map's size. A value that
/// is infinite or no number counts as 0. The scores are the same to the bit on any number of threads.
ScoreCard score(const Image& picture, const Image& truth, const ClassMap& classes);

/// The mean of the truth's light is shown as this much: middle grey.
inline constexpr double kMiddleGrey = 0.18;

/// Mean over the counted pixels and all planes; 0 of none.
double mean_of(const Image& picture, const ClassMap& classes);

/// Compares light, whose unit means nothing: errors are shares of the truth's mean (a black picture has the bias -1),
/// and the eye is asked (SSIM, FLIP) at the exposure at which the truth's mean is middle grey. Of a truth that is black
/// all over: as score().
ScoreCard score_light(const Image& picture, const Image& truth, const ClassMap& classes);

/// The perceptual error of each pixel, as score() uses it. What is background in the map counts as white in both
/// pictures, and has no error.
Plane flip_map(const Image& picture, const Image& truth, const ClassMap& classes);

}  // namespace umbrage
