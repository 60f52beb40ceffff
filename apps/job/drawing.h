// What drawing a picture whole and drawing it in bands share. For apps/job alone.
#pragma once
#include <string>
#include <vector>

#include "apps/job/job.h"
#include "looks/frames.h"

namespace umbrage {

/// A picture that is about to be drawn.
struct Drawing {
  Recipe recipe;  ///< of one frame
  Camera camera;
  CaptureSettings capture;
  ParameterBytes output;  ///< how the finished picture is made of averaged frames
  std::string noise;      ///< the parameter that each frame has another value of, "hemisphere.seed", or empty
  int first_noise = 0;    ///< of frame 0
  bool radius_known = false;

  /// Frames are drawn from the last to the first, which has its samples at the pixels' centres.
  bool averages() const { return recipe.frames > 1; }
};

/// Adds lights to a scene that has none. `most_pixels`: see capture_settings.
Result<Drawing> begin_drawing(Device& device, Scene& scene, const DrawSettings& settings, long most_pixels);

/// Makes it that frame, and returns its camera.
Camera begin_frame(Drawing& drawing, int frame, const DrawSettings& settings);

/// Adds the image around the scene to a frame, where it is to be seen.
Result<void> add_sky(Device& device, const Scene& scene, const Drawing& drawing, const DrawSettings& settings,
                     Frame& frame);

/// Applies what hangs on the picture: --ao-radius.
Result<void> know_picture(Drawing& drawing, const PictureInfo& info, const DrawSettings& settings);

/// An empty sum of its frames, of pictures of that height.
PictureSum empty_sum(const Recipe& recipe, int height);

/// The planes of a frame that are averaged.
std::vector<std::string> averaged_planes(const DrawSettings& settings, const PictureSum& total);

/// The finished colour of averaged frames, as planes color.r, .g, .b and .a. `stops`: of exposure, that were added to
/// each frame's. `info`: of a picture of the sum's size.
Result<Image> finished_color(Device& device, const PictureSum& total, const Drawing& drawing, float stops,
                             const PictureInfo& info);

}  // namespace umbrage
