// Moving scenes: the frames of a sequence whose scene is another in each frame, such as an animation. What moves is
// found in another frame by the triangles: the point of a triangle that a pixel shows is the same point of it there.
#pragma once
#include <functional>
#include <memory>

#include "renderer/steady.h"

namespace umbrage {

/// A frame of a moving scene.
struct MovingFrame {
  std::shared_ptr<const Scene> scene;
  Plan plan;  ///< all frames have one recipe
};

/// Returns the frames of a moving scene, joined with `reach` frames before and after. `frame` returns a frame, for
/// which the device is not prepared. Meshes of two frames with as many vertices are one mesh that has moved; others are
/// not joined, nor are shadows, nor surfaces that something covers in one of the frames. All frames should have the
/// same noise: then nothing changes where nothing moves, and what moves passes over the noise of other pixels. The
/// device must outlive the functions.
SteadyFrames frames_of_moving_scene(Device& device, Recipe recipe, int reach,
                                    std::function<Result<MovingFrame>(int frame)> frame);

}  // namespace umbrage
