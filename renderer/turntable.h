// A model on a turntable: camera and light stand still and the model turns, as in a studio. Seen from the model, camera
// and light go around it.
#pragma once
#include <vector>

#include "renderer/job.h"

namespace umbrage {

class Turntable {
 public:
  /// Of a furnished scene, before anything is drawn.
  Turntable(const Scene& scene, const DrawSettings& settings);

  /// Makes scene and settings those of a frame in which the camera has gone so far around, counterclockwise as seen
  /// from above; 0, the first frame, leaves both as they are. The light of an image around the scene goes along, and so
  /// do the lights that the first frame has given to a scene without any; those that a scene brings, and those that
  /// were made for a camera inside it, are part of the model. The exposure of all frames is that of the first one
  /// drawn.
  void turn_to(float angle_deg, Scene& scene, DrawSettings& settings);

 private:
  Framing framing_;
  float rotation_deg_;         // of the image around the scene
  bool has_lights_;            // of its own
  bool lit_inside_;            // the camera stands in the model
  std::vector<Light> lights_;  // of the first frame
  std::optional<float> stops_;
};

}  // namespace umbrage
