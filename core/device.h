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
  /// Capture only these pixels: the others have undefined values, also those that dispatches write to this frame; but
  /// `opacity` is 0 and `transmittance` 1 there. Requires one layer, and dispatches that read no row at any distance.
  /// Null: all pixels. A device may capture all.
  std::shared_ptr<const PixelMask> mask = {};
  /// Without it, a device need not trace the shadows of lights that have a size: their planes are undefined.
  bool soft_shadows = true;

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

/// What a device is; it does not change.
struct DeviceInfo {
  std::string name;         ///< "cpu", "vulkan:0"
  std::string description;  ///< one line for users: model, driver, SIMD target, threads
  int threads = 1;          ///< number of CPU threads that work for the device
  /// The plane pool for the planes of its pictures. Use it with ScopedPlanePool while several pictures are drawn.
  PlanePoolPtr pool = std::make_shared<PlanePool>();
  /// It can draw pictures in strips. On a strip's frame all functions process only the rows of the strip.
  bool draws_strips = false;
};

/// How to run an effect.
struct EffectRun {
  int layer = 0;  ///< all inputs and outputs are planes of this layer
  PixelSet pixels = PixelSet::kAll;
  /// Planes of the first layer that nothing reads after the run. A device may free each of them when the last dispatch
  /// that reads or writes it is done.
  std::vector<std::string> last_used = {};
};

class Device {
 public:
  virtual ~Device() = default;
  std::string_view name() const { return info_.name; }
  const std::string& description() const { return info_.description; }
  int threads() const { return info_.threads; }
  PlanePoolPtr pool() const { return info_.pool; }
  bool draws_strips() const { return info_.draws_strips; }

  /// Prepares the scene for capture (acceleration structure, textures). The scene must live until its last capture or
  /// the next prepare. After an error nothing is prepared, and capture throws InternalError. Errors: kDevice,
  /// kInterrupted.
  virtual Result<void> prepare(const Scene& scene, const ProgressMonitor& monitor = {}) = 0;
  /// Frees the memory that prepare allocated, if the device can. The next capture requires a new call of prepare.
  virtual void release_scene() {}
  /// Captures the prepared scene. Returns a frame with the planes of core/gbuffer.h.
  virtual Result<Frame> capture(const Camera& camera, const CaptureSettings& settings,
                                const ProgressMonitor& monitor = {}) = 0;
  /// Returns a frame with planes from the host. Planes that are views are read during the lifetime of the frame, and
  /// never written. `strip`: if not null, gbuffer.info describes the whole picture, and the planes have only the rows
  /// of rows_with_margin; requires draws_strips().
  virtual Result<Frame> upload(GBuffer gbuffer, const Strip* strip = nullptr) = 0;
  /// Returns a frame that starts with the planes of `frame` and shares their memory. `frame` must be of a whole
  /// picture, not of a strip. Effects that run on the branch leave the original unchanged. While the branch or a branch
  /// of it lives, calling run, add or add_planes_of on the original throws InternalError.
  virtual Frame branch(const Frame& frame) = 0;
  /// Adds planes from the host to a frame and replaces those of the same names. Their size is that of the frame, guard
  /// band included; for a strip, its rows_with_margin.
  virtual Result<void> add(Image planes, Frame& frame) = 0;
  /// Adds planes of another frame. Those of a frame that `reduced` made from this one get the names of reduced_plane;
  /// they are in the upper left corner, since all planes of a frame have one size, and the remainder is 0. Those of a
  /// frame of the same size get the names of other_plane; they may share the memory of `from`, which must then not
  /// change before the frame is gone. Errors: kUsage if a plane is missing.
  virtual Result<void> add_planes_of(const Frame& from, const std::vector<std::string>& names, Frame& frame) = 0;
  /// Runs the dispatches of an effect; its outputs become planes of the frame. PixelSet::kMissing requires
  /// runs_for_missing. On a strip the effect may remain unfinished, if WholePlanes must be completed first. After
  /// kInterrupted the outputs are incomplete. Errors: kUsage if an input plane is missing; kInterrupted.
  virtual Result<RunState> run(const Effect& effect, const ParameterBytes& params, Frame& frame,
                               const EffectRun& settings = {}, const ProgressMonitor& monitor = {}) = 0;
  /// Frees these planes of a frame, which nothing reads any more; names of other planes are ignored. A branch does not
  /// free the planes of its original. A device may keep planes, or all of them.
  virtual void release(Frame& /*frame*/, const std::vector<std::string>& /*names*/) {}
  /// Returns a frame with one pixel in `factor`, across and down, of these planes in all layers that have them: see
  /// reduced_info. Planes that no layer has are left out.
  virtual Result<Frame> reduced(const Frame& frame, int factor, const std::vector<std::string>& names) = 0;
  /// Waits until all submitted work is done. A device that works asynchronously may defer work until this call or a
  /// download, and reports its errors only there. Returns the times of all dispatches since the last call, in order, if
  /// the device measures them itself.
  virtual Result<std::vector<DispatchTime>> finish() { return std::vector<DispatchTime>(); }
  /// Returns the names of all planes of a frame: first those captured, added or computed, then the constant planes that
  /// dispatches read in place of missing ones.
  virtual std::vector<std::string> plane_names(const Frame& frame) const = 0;
  /// Returns the planes of these names, in this order, without the guard band; of a strip only its own rows. Errors:
  /// kUsage if a plane is missing.
  Result<Image> download(const Frame& frame, const std::vector<std::string>& names) {
    return read(frame, names, false);
  }
  /// Returns the same. Without a copy if the device can: the planes are then views, which are valid until the frame
  /// changes or ends.
  Result<Image> view(const Frame& frame, const std::vector<std::string>& names) { return read(frame, names, true); }
  /// Returns the same as download, with the guard band.
  Result<Image> download_with_guard(Frame frame, const std::vector<std::string>& names) {
    frame.info.guard = 0;
    return download(frame, names);
  }
  /// Returns all planes of a frame.
  Result<Image> download_all(const Frame& frame) { return download(frame, plane_names(frame)); }

 protected:
  explicit Device(DeviceInfo info) : info_(std::move(info)) {}

 private:
  /// Implements download and, with `views`, view.
  virtual Result<Image> read(const Frame& frame, const std::vector<std::string>& names, bool views) = 0;

  DeviceInfo info_;
};

}  // namespace umbrage
