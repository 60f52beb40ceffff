// Device: the interface of the backends that capture scenes and run effects. The implementations are in devices/.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/effect.h"
#include "core/gbuffer.h"
#include "core/progress.h"
#include "core/result.h"
#include "core/strip.h"

namespace umbrage {

struct Scene;  // scene/scene.h

/// A picture being rendered: its information, and its planes in the memory of the device that made them. A plane of
/// depth layer n > 0 is named `layerN.NAME`.
struct Frame {
  PictureInfo info;
  std::shared_ptr<void> storage;  ///< planes, in a type private to the device
};

inline constexpr int kMaxLayers = 16;

inline constexpr int kMaxExtraViews = 4;
/// Max layers of all kinds in a capture with back sides or extra views: the number that kernels can read.
inline constexpr int kMaxMixedLayers = 8;

struct CaptureSettings {
  int width = 1024, height = 1024;  ///< without the guard band
  int shadows = kMaxShadows;        ///< number of lights, from the first, with traced shadows; 1: key light only
  // Order of the layers: `layers`, then as many back sides if `back_sides` is set, then `extra_views`.
  int layers = 1;           ///< surfaces along each primary ray, 1 to kMaxLayers
  bool back_sides = false;  ///< also capture the back sides of each layer, as one more layer
  int extra_views = 0;      ///< further cameras, one layer each, 0 to kMaxExtraViews
  int guard = 0;            ///< guard band, pixels on each side; see PictureInfo::guard
  /// Shadow rays per pixel to each light that has a size. With two or more, blocks of 4 x 4 pixels take one ray per
  /// pixel where the light is either fully visible or fully blocked. Shadows are then averaged over pixels of the same
  /// surface: 4 x 4 pixels, or more where penumbrae are wide. 0: lights are points.
  int shadow_rays = 0;
  std::optional<Lighting> lighting = {};  ///< replaces the lighting of the scene
  /// Captures blended surfaces as if they were opaque; otherwise rays pass through them. With them, the planes
  /// `opacity` and `transmittance` of core/gbuffer.h.
  bool blended = false;
  bool ray_offsets = false;  ///< also capture the planes ray_offset.x .y .z of core/gbuffer.h
  int occluders = 0;         ///< size of the set PictureInfo::occluders; 0: there is none
  int sample = 0;            ///< sample index of an accumulation; selects the shadow rays
  /// The material and id planes to capture, by their names on the first layer; nullopt: all. Depth, normals and shadows
  /// are always captured.
  std::optional<std::vector<std::string>> planes = {};
  std::optional<Strip> strip = {};  ///< draw only this strip; requires Device::draws_strips()

  bool operator==(const CaptureSettings&) const = default;
};

/// Returns the number of layers of a capture, all kinds together. Errors: kUsage if there are more than kMaxMixedLayers
/// with back sides or extra views.
Result<int> layer_count(const CaptureSettings& settings);

/// The time of one dispatch, on a device that measures it itself.
struct DispatchTime {
  std::string effect, dispatch;
  double ms = 0.0;
};

class Device {
 public:
  virtual ~Device() = default;
  /// Returns the name: "cpu", "vulkan:0".
  virtual std::string_view name() const = 0;
  /// Returns one line for users: model, driver, SIMD target, threads.
  virtual std::string description() const = 0;
  /// Returns the number of CPU threads that work for the device.
  virtual int threads() const = 0;
  /// Returns the plane pool for the planes of its pictures. Use it with ScopedPlanePool while several pictures are
  /// drawn.
  virtual PlanePoolPtr pool() const = 0;
  /// Returns whether the device can draw pictures in strips. On a strip's frame all functions process only the rows of
  /// the strip.
  virtual bool draws_strips() const { return false; }
  /// Prepares the scene for capture (acceleration structure, textures). The scene must live until its last capture or
  /// the next prepare. After an error nothing is prepared, and capture throws InternalError. Errors: kDevice,
  /// kInterrupted.
  virtual Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor = {}) = 0;
  /// Frees the memory that prepare allocated, if the device can. The next capture requires a new call of prepare.
  virtual void release_scene() {}
  /// Captures the prepared scene. Returns a frame with the planes of core/gbuffer.h.
  virtual Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                                const ProgressMonitor& monitor = {}) = 0;
  /// Captures a further sample of a picture at the pixels that are marked: where the plane `marks` of `first`, the
  /// frame of the first sample, is 1. Other pixels have undefined values. The marks become a plane of the frame, as by
  /// add_first. Soft shadows are not captured, since their filter needs all pixels: their planes are 1. `settings` must
  /// be of one layer. A device may capture all pixels. Errors: as capture.
  virtual Result<Frame> capture_marked(const Camera& camera, const CaptureSettings& settings, const Frame& first,
                                       const ProgressMonitor& monitor = {});
  /// Adds planes of `first` to the frame of a further sample, under the names of first_plane. They may share their
  /// memory with those of `first`, which must then not change before the frame is gone.
  virtual Result<void> add_first(const Frame& first, const std::vector<std::string>& names, Frame& frame);
  /// Returns a frame with planes from the host. Planes that are views are read during the lifetime of the frame, and
  /// never written.
  virtual Result<Frame> upload(GBuffer gbuffer) = 0;
  /// Returns a frame of a strip. gbuffer.info describes the whole picture; the planes have only the rows of
  /// rows_with_margin. Throws InternalError unless draws_strips().
  virtual Result<Frame> upload_strip(GBuffer gbuffer, const Strip& strip);
  /// Returns a frame that starts with the planes of `frame` and shares their memory. `frame` must be of a whole
  /// picture, not of a strip. Effects that run on the branch leave the original unchanged. While the branch or a branch
  /// of it lives, calling run, add or place on the original throws InternalError.
  virtual Frame branch(const Frame& frame) = 0;
  /// Adds planes from the host to a frame and replaces those of the same names. Their size is that of the frame, guard
  /// band included; for a strip, its rows_with_margin.
  virtual Result<void> add(Image planes, Frame& frame) = 0;
  /// Runs the dispatches of an effect; its outputs become planes of the frame. On layer n > 0 all its inputs and
  /// outputs are planes of that layer. PixelSet::kMissing requires runs_for_missing. On a strip the effect may remain
  /// unfinished, if WholePlanes must be completed first or the margin is too small. After kInterrupted the outputs are
  /// incomplete. Errors: kUsage if an input plane is missing; kInterrupted.
  virtual Result<RunState> run(const Effect& effect, const ParameterBytes& params, Frame& frame, int layer = 0,
                               PixelSet pixels = PixelSet::kAll, const ProgressMonitor& monitor = {}) = 0;
  /// Frees these planes of a frame, which nothing reads any more; names of other planes are ignored. A branch does not
  /// free the planes of its original. A device may keep planes, or all of them.
  virtual void release(Frame& /*frame*/, const std::vector<std::string>& /*names*/) {}
  /// As release, for planes of the first layer that only the next run still uses: the device frees each of them when
  /// the last dispatch of that run that reads or writes it is done.
  virtual void release_in_run(Frame& /*frame*/, std::vector<std::string> /*names*/) {}
  /// Returns a frame with one pixel in `factor`, across and down, of these planes in all layers that have them: see
  /// reduced_info. Planes that no layer has are left out.
  virtual Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) = 0;
  /// Copies planes of a reduced frame into the frame that it was made from, under the name reduced_plane(name). They
  /// are in the upper left corner, since all planes of a frame have one size; the remainder is 0. Errors: kUsage if a
  /// plane is missing.
  virtual Result<void> place(const Frame& small, const std::vector<std::string>& names, Frame& full) = 0;
  /// Waits until all submitted work is done. A device that works asynchronously may defer work until this call or a
  /// download, and reports its errors only there.
  virtual Result<void> finish() { return {}; }
  /// Returns the times of all dispatches since the last call, in order, if the device measures them itself.
  virtual std::vector<DispatchTime> take_dispatch_times() { return {}; }
  /// Returns the names of all planes of a frame: first those captured, added or computed, then the constant planes that
  /// dispatches read in place of missing ones.
  virtual std::vector<std::string> plane_names(const Frame& frame) const = 0;
  /// Returns the planes of these names, in this order, without the guard band; of a strip only its own rows: see
  /// missing_rows. Errors: kUsage if a plane is missing.
  virtual Result<Image> download(const Frame& frame, const std::vector<std::string>& names) = 0;
  /// Returns the same as download. Without a copy if the device can: the planes are then views, which are valid until
  /// the frame changes or ends.
  virtual Result<Image> view(const Frame& frame, const std::vector<std::string>& names) {
    return download(frame, names);
  }
  /// Returns all planes of a frame.
  Result<Image> download_all(const Frame& frame) { return download(frame, plane_names(frame)); }
  /// Returns by how many rows the margin of a strip is too small for its own rows of these planes to be valid, and
  /// `around` rows above and below them; 0: they are valid.
  virtual int missing_rows(const Frame&, const std::vector<std::string>& /*names*/, int /*around*/ = 0) const {
    return 0;
  }
};

}  // namespace umbrage
