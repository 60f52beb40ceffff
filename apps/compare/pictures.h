// What is scored: the cameras of a scene, the truth of a picture, what a technique wrote as it is seen.
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

/// The truth of one picture.
struct Truth {
  Image planes;        ///< of the quantity
  double error = 0.0;  ///< mean square over covered pixels and planes of its own noise
  double sum = 0.0;    ///< of the first plane over covered pixels, of which there are
  long pixels = 0;
};

/// The truth as the mean of two independent halves, which `trace` makes from a seed; their difference tells its noise.
Result<Truth> trace_truth(Quantity quantity, const PictureInfo& info, const ClassMap& classes,
                          const std::function<Result<Image>(std::uint32_t seed)>& trace);

/// A camera of a scene: a view that it suggests, or a turn around it.
struct CameraShot {
  std::string name;
  Framing framing;
  std::vector<View> views;
};

/// Finds what is wrong with what pictures are to be taken and scored: the same model twice, --cameras, --samples,
/// --runs. Errors: kUsage.
Result<void> check_pictures(const std::vector<std::string>& models, int cameras, int samples, int runs);

/// The radius of the reference when nobody sets it, as written.
std::string reference_radius();

/// At most so many of a scene; one where the user said where it is.
std::vector<CameraShot> shots_of(const Scene& scene, const Framing& wish, int cameras);

/// The planes that tell what a pixel shows, without the guard band. Errors: those of the device.
Result<GBuffer> downloaded(Device& device, const Frame& frame);

/// Occlusion as it is seen: an unsharp mask also brightens, and its shade may exceed 1.
void clamp_to_shown(Image& image);

}  // namespace umbrage
