// The camera of a G-buffer: from options, from the header, or from positions.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gbuffers/fit.h"
#include "gbuffers/roles.h"
#include "gbuffers/samples.h"

namespace umbrage {

/// What is known of a camera before depth is understood.
struct KnownCamera {
  Camera camera;
  std::string source;     ///< text for the facts; empty: the window is unknown
  bool has_view = false;  ///< camera.view_from_world is known
  double aspect = 1.0;    ///< width / height of the picture, with the shape of its pixels

  bool has_window() const { return !source.empty(); }
};

/// Returns the camera that options, header and positions give, in that order. Errors: kUsage for options that
/// contradict each other.
Result<KnownCamera> known_camera(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                 const std::optional<ProjectionFit>& position, int width, int height);

/// Returns the camera of intrinsics: one focal length; fx,fy,cx,cy; or a matrix, 3 x 3 or 4 x 4, by rows. In pixels, or
/// in widths and heights of the picture if the centre is below 1. Centres are counted, as by calibrations, from the
/// centre of the first pixel; one of half the size is the middle. Returns nothing for other numbers.
std::optional<Camera> camera_of_intrinsics(const std::vector<float>& numbers, int width, int height);

/// Returns a warning if the centre of intrinsics is so far from the middle that they belong to a picture of another
/// size; else nothing.
std::string center_warning(const Camera& camera, int width, int height);

/// Returns the camera that projects the sampled positions to their pixels; nothing if there are none, or no camera
/// does, within `max_px` in the median.
std::optional<ProjectionFit> position_camera(const Samples& samples, double max_px);

/// Returns whether positions of this fit are relative to the camera.
bool is_camera_space(const ProjectionFit& fit);

/// Returns the rotation to view space, mirroring included.
glm::dmat3 view_rotation(const ProjectionFit& fit);

/// Returns the vertical angle of view of a camera in degrees; 0 for an orthographic one.
double angle_of(const Camera& camera);

}  // namespace umbrage
