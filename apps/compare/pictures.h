// Pictures for compare and tune: the cameras of a scene, the ground truth of a picture, the planes that are scored.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "apps/compare/compare.h"
#include "core/device.h"
#include "reference/metrics.h"
#include "scene/framing.h"
#include "scene/scene.h"

namespace umbrage {

/// The planes of each quantity.
extern const std::array<std::vector<std::string>, kQuantities> kQuantityPlanes;

/// The ground truth of one picture.
struct Truth {
  Quantity quantity = Quantity::kOcclusion;
  Image planes;        ///< planes of the quantity
  Image of_view;       ///< the same of what the view holds (compare's ErrorBudget); empty if it is not traced
  double error = 0.0;  ///< mean squared standard error over all planes and all pixels that show a surface
  double sum = 0.0;    ///< sum of the first plane over pixels that show a surface
  long pixels = 0;     ///< number of pixels that show a surface
};

/// Returns the ground truth as the mean of two independent halves, which `trace` computes from a seed. Their difference
/// yields the noise.
Result<Truth> trace_truth(Quantity quantity, const PictureInfo& info, const ClassMap& classes,
                          const std::function<Result<Image>(std::uint32_t seed)>& trace);

/// A camera of a scene: one of its suggested views, or a view from around it.
struct CameraShot {
  std::string name;
  Framing framing;
  std::vector<View> views;
};

/// Returns the techniques of the settings, also the reference. Errors: kUsage.
Result<std::vector<const Effect*>> techniques_of(const CompareSettings& settings);

/// Formats a camera, rounded so that differences in floating-point rounding between compilers do not matter.
std::string view_text(const Camera& camera);

/// Checks --cameras, --samples and --runs, and that no model is given twice. Errors: kUsage.
Result<void> check_picture_options(const std::vector<std::string>& models, int cameras, int samples, int runs);

/// Returns the default radius of the reference, as an option value.
std::string reference_radius();

/// Returns at most `cameras` cameras of a scene. If `requested` sets position, focal point or direction, it is the only
/// one.
std::vector<CameraShot> shots_of(const Scene& scene, const Framing& requested, int cameras);

/// Downloads the planes that classify pixels, depth and normal, without the guard band. Errors: those of the device.
Result<GBuffer> download_gbuffer(Device& device, const Frame& frame);

/// Runs a look `runs` times, `warms_up`: after a run that is not timed. The results remain in the frame. Returns the
/// median time, milliseconds.
Result<double> median_time(const LookRun& run, Device& device, Frame& frame, int runs, bool warms_up = true);

/// Returns the filter of a look; null if it has none.
const Effect* look_filter(const Look& look);

/// Returns the root of the mean squared difference of `ao` over pixels that show a surface; 0 if there are none.
double covered_rmse(const Image& a, const Image& b, const ClassMap& classes);

/// Clamps `ao` to [0, 1]. The unsharp mask also brightens, so its values may exceed 1.
void clamp_occlusion(Image& image);

}  // namespace umbrage
