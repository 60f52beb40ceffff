// GBufferFile: the G-buffer in image files of any renderer, in the conventions of core/gbuffer.h.
//
// Roles, spaces and encodings are recognised from names and values and checked against each other; each fact is stated
// in one line and can be overridden by GBufferSettings.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/gbuffer.h"
#include "core/result.h"
#include "core/strip.h"
#include "gbuffers/settings.h"

namespace umbrage {

struct Conventions;

/// What was understood about a G-buffer.
struct GBufferFacts {
  std::vector<std::string> lines;     ///< one per fact: "depth: ViewLayer.Depth.Z, planar, background 1e+10"
  std::vector<std::string> warnings;  ///< sentences
  std::vector<std::string> layers;    ///< every layer of the files, with its channels: "ViewLayer.Depth (Z)"
};

/// An opened G-buffer. Planes of rows(), each present if the files have it: those of core/gbuffer.h, and
///   beauty.r .g .b   the renderer's own picture, scene-linear, not multiplied by alpha
///   beauty.a         its coverage, 0 to 1
///   ambient.r .g .b  the part of the beauty that ambient occlusion darkens: indirect diffuse light times albedo
/// `object_id` holds small integers, equal for equal ids, and -1 where there is no surface.
class GBufferFile {
 public:
  /// Opens the files and recognises what they hold. `memory`: bytes that may be used for pixels; stored values that
  /// need more than a quarter of it are kept in an unnamed file in `scratch_folder`. Errors: kUsage; kFile, also if
  /// there is neither depth nor position, listing the layers that there are. `first`: conventions of the first frame of
  /// a sequence, or null. A later frame takes the meaning of depth from them, and the camera's window if no file tells
  /// it. `is_unreadable`, unless null: whether the reading of pixels failed.
  static Result<GBufferFile> open(const GBufferSettings& settings, double memory, const std::string& scratch_folder,
                                  const Conventions* first = nullptr, bool* is_unreadable = nullptr);
  GBufferFile(GBufferFile&&) noexcept;
  GBufferFile& operator=(GBufferFile&&) noexcept;
  ~GBufferFile();

  /// Returns size, camera, scene_radius and depth range of the picture; no lights.
  const PictureInfo& info() const;
  const GBufferFacts& facts() const;
  const Conventions& conventions() const;
  /// Returns the names of the planes that rows() returns.
  const std::vector<std::string>& plane_names() const;
  bool has_plane(std::string_view name) const;
  /// Returns these rows of all planes. Errors: kFile.
  Result<Image> rows(const Rows& rows) const;
  /// Returns the stored values of the motion vectors, two planes for each pair of channels; none if there are none. See
  /// motion_planes. Errors: kFile.
  Result<Image> stored_motion() const;
  /// Returns whether the picture fits in memory as a whole.
  bool is_in_memory() const;
  /// Returns the bytes of memory that `open` was given.
  double memory() const;
  /// Returns the meaning of the stored depth.
  DepthMeaning depth_meaning() const;
  /// Returns whether the beauty holds display values (PNG, JPEG) rather than scene-linear light.
  bool is_display_referred() const;
  /// Returns the path of the file whose layers were recognised, for write_merged; empty if it is not an EXR.
  std::string merge_base() const;

 private:
  struct State;
  explicit GBufferFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Returns what is known about the layers of image files, also if they hold no G-buffer. Errors: kFile,
/// also if the pixels of such files cannot be read.
Result<GBufferFacts> describe_gbuffer(const GBufferSettings& settings);

}  // namespace umbrage
