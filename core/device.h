// Device: where effects run. Looks get one handed in; devices/ has those that there are.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/band.h"
#include "core/effect.h"
#include "core/gbuffer.h"
#include "core/progress.h"
#include "core/result.h"

namespace umbrage {

struct Scene;  // scene/scene.h

/// A picture in the making: its information, and its planes on the device that made them. A plane of depth layer n > 0
/// is called `layerN.NAME`.
struct Frame {
  PictureInfo info;
  std::shared_ptr<void> storage;  ///< the device's own
};

inline constexpr int kMaxLayers = 16;

inline constexpr int kMaxExtraViews = 4;
/// The most layers, all kinds together, of a capture with back sides or extra views: as many as kernels read.
inline constexpr int kMaxMixedLayers = 8;

struct CaptureSettings {
  int width = 1024, height = 1024;  ///< without the guard band
  int shadows = kMaxShadows;  ///< of how many lights, from the first on, shadows are traced: 1 is the key light alone
  // Layers come in this order: `layers`, then as many of `back_sides`, then `extra_views`.
  int layers = 1;           ///< surfaces along each primary ray, 1 to kMaxLayers
  bool back_sides = false;  ///< a layer of the other side of each of those too
  int extra_views = 0;      ///< further cameras, one layer each, 0 to kMaxExtraViews
  int guard = 0;            ///< pixels drawn beyond each side: see PictureInfo::guard
  /// Rays of a pixel to a light that has a size; where there are several, and the light is seen whole or not at all,
  /// one. What arrives is averaged along surfaces, over 4 x 4 pixels, or more where penumbrae are wide. 0: points.
  int shadow_rays = 0;
  std::optional<Lighting> lighting = {};  ///< in place of the scene's own
  int sample = 0;                         ///< of pictures that are averaged: each has other shadow rays
  /// Planes of materials and ids, by their names on the first layer, that alone are captured; nothing: all. Depth,
  /// normals and shadows always are.
  std::optional<std::vector<std::string>> planes = {};
  std::optional<Band> band = {};  ///< draw this band of the picture alone, on devices that can

  bool operator==(const CaptureSettings&) const = default;
};

/// How many layers such a capture has. Errors: kUsage where they are too many.
Result<int> layer_count(const CaptureSettings& settings);

/// What a pass took on a device that measures it itself.
struct PassTime {
  std::string effect, pass;
  double ms = 0.0;
};

class Device {
 public:
  virtual ~Device() = default;
  /// "cpu", "vulkan:0".
  virtual std::string_view name() const = 0;
  /// One line for people: model, driver, SIMD target, threads.
  virtual std::string description() const = 0;
  /// CPU threads that work for it.
  virtual int threads() const = 0;
  /// Memory for the planes of its pictures: hold it by KeptPlanes while pictures are drawn one after the other.
  virtual PlanePoolPtr pool() const = 0;
  /// Whether it draws pictures band by band. Of a frame that is one all functions work on its rows.
  virtual bool draws_bands() const { return false; }
  /// Gets the scene ready (acceleration structure, textures); capture does it when it has not been done. The scene
  /// must live until the next prepare or the last capture. After kInterrupted it is not ready.
  virtual Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor = {}) = 0;
  /// Frees what prepare made, where the device can: capture takes a prepare again.
  virtual void forget_scene() {}
  /// Draws the prepared scene into a frame with the planes of core/gbuffer.h.
  virtual Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                                const ProgressMonitor& monitor = {}) = 0;
  /// A frame from planes on the host. Planes that are views are read as long as the frame lives, and not written.
  virtual Result<Frame> upload(GBuffer gbuffer) = 0;
  /// A frame that starts with the planes of another one, of a whole picture, and shares their memory. What is run on it
  /// leaves the other one as it is. While it or a branch of it lives, nothing may be run on the other one, added to it
  /// or placed there: that throws InternalError.
  virtual Frame branch(const Frame& frame) = 0;
  /// Adds planes from the host to a frame, in place of those of the same names. They are of the frame's whole size, its
  /// guard band included; of a band's, those rows that it holds: held_rows.
  virtual Result<void> add(const Image& planes, Frame& frame) = 0;
  /// Runs an effect's passes; its outputs become planes of the frame. Errors: kUsage where an input plane is missing.
  /// On layer n > 0 all its inputs and outputs are that layer's. For missing pixels only an effect can run of which
  /// runs_for_missing holds. A band may not be finished: where WholePlanes have to be completed first, or its margin is
  /// too small. After kInterrupted what was to be made is not whole.
  virtual Result<Progression> run(const Effect& effect, const ParameterBytes& params, Frame& frame, int layer = 0,
                                  PixelSet pixels = PixelSet::kAll, const ProgressMonitor& monitor = {}) = 0;
  /// A frame that holds every `factor`th pixel, across and down, of these planes in all the layers that have them: see
  /// reduced_info. Planes that no layer has are left out.
  virtual Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) = 0;
  /// Makes planes of a reduced frame planes of the one that it was made from, called reduced_plane(name), at their
  /// upper left corner, since all planes of a frame have one size; the rest of them is 0. Errors: kUsage for one that
  /// is missing.
  virtual Result<void> place(const Frame& small, const std::vector<std::string>& names, Frame& full) = 0;
  /// Waits until all that was asked for is done. Devices that work on their own put off what they were asked for until
  /// then, or until a download, and report only there what went wrong with it.
  virtual Result<void> finish() { return {}; }
  /// What the passes took that ran since this was last asked, in order, of devices that measure it themselves.
  virtual std::vector<PassTime> take_pass_times() { return {}; }
  /// Names of all planes that a frame has: those that were captured, added or made, and then those of one value that a
  /// pass asked for.
  virtual std::vector<std::string> plane_names(const Frame& frame) const = 0;
  /// The planes of these names, in this order, without the guard band. Errors: kUsage for one that is missing. Of a
  /// band its own rows, of which missing_rows says whether they are all there.
  virtual Result<Image> download(const Frame& frame, const std::vector<std::string>& names) = 0;
  /// Hands such planes on one after the other, by their place in `names`, without a copy where the device can.
  virtual Result<void> visit(const Frame& frame, const std::vector<std::string>& names,
                             const std::function<void(std::size_t name, const Plane& plane)>& take) {
    const auto image = download(frame, names);
    if (!image) return image.error();
    for (std::size_t k = 0; k < names.size(); ++k) take(k, image->planes[k]);
    return {};
  }
  /// All planes that a frame has.
  Result<Image> download_all(const Frame& frame) { return download(frame, plane_names(frame)); }
  /// By how many rows a band's margin is too small for its own rows of these planes to be right; 0: they are.
  virtual int missing_rows(const Frame&, const std::vector<std::string>& /*names*/) const { return 0; }
};

}  // namespace umbrage
