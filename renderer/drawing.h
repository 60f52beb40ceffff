// What drawing a picture whole and drawing it in bands share. For renderer/ alone.
#pragma once
#include <string>
#include <vector>

#include "renderer/accumulation.h"
#include "renderer/job.h"

namespace umbrage {

/// A picture that is about to be drawn.
struct Drawing {
  Recipe recipe;  ///< of one frame
  Camera camera;
  CaptureSettings capture;
  ParameterBytes output;  ///< how the finished picture is made of averaged frames
  std::string noise;      ///< the parameter that each frame has another value of, "hemisphere.seed", or empty
  int first_noise = 0;    ///< of frame 0
  ParameterBytes lines;   ///< of `outline`, where that is drawn once, by frame 0, over averaged frames; or empty
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

/// Sets the parameters of lines aside that are drawn once, over the average; each frame goes without. Those of the
/// paper's rule are in each.
void keep_lines(Drawing& drawing);

/// The planes of a frame that are averaged; and those of them that are no colour.
std::vector<std::string> averaged_planes(const DrawSettings& settings, const Drawing& drawing);
std::vector<std::string> also_averaged(const DrawSettings& settings, const Drawing& drawing);

/// Draws the lines that lie over averaged frames, on frame 0: on others nothing.
Result<void> draw_lines(Device& device, const Drawing& drawing, Frame& frame, StageTimes& times);

/// The planes of frame 0 that `output` draws them from.
std::vector<std::string> line_planes(const Drawing& drawing);

/// The finished colour of averaged frames, as planes color.r, .g, .b and .a. `lines`: their line_planes. `info`: of a
/// picture of the sum's size.
Result<Image> finished_color(Device& device, const PictureSum& total, const Drawing& drawing, const Image& lines,
                             const PictureInfo& info);

/// Makes the finished picture of averaged frames, and puts it and what else was averaged into frame 0.
Result<void> finish_average(Device& device, const PictureSum& total, const Drawing& drawing,
                            const std::vector<std::string>& averaged, Frame& frame);

}  // namespace umbrage
